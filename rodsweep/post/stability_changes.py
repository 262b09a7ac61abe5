"""Where a rod of a file of spectra becomes unstable or stable along F, to the digits that rounding leaves.

Between two forces of the file at which the leading growth rate has different signs a pair crosses the
imaginary axis: D(0) = 1, so none passes through 0. The stored eigenvalues next to it are starts for Newton's
method on D(i eta; F) = 0. What opens and closes between two forces of the file is not seen; the task
thresholds proves that nothing is missing. Knows neither meshes nor PETSc.
"""

from collections.abc import Iterator
from itertools import pairwise, product

import numpy as np

from ..arrays import Array
from ..model.parameters import LINEAR_PARAMETERS
from ..model.rod import Rod
from ..results.file.view import View
from .hopf_points import HopfPoint, ParameterLine

SAME_CROSSING = 1e-8
"""Relative distance within which two zeros are one: Newton's method repeats itself to rounding."""


def stability_changes(line: ParameterLine, view: View) -> list[HopfPoint]:
    """The forces on a line over F where the leading growth rate changes sign, in increasing order.

    Where the zeros of D found between two neighbours are not exactly those that the numbers of unstable modes
    ask for, the middle between the two is given, and half of their distance as its error.
    """
    modes = view.variables["growth_rate"].shape[-1]
    growth, frequency = (
        view.variables[name].reshape(-1, modes)[line.at] for name in ("growth_rate", "frequency")
    )
    unstable = view.variables["unstable_count"].ravel()[line.at]
    unstable = np.where(unstable < 0, (growth > 0).sum(axis=-1), unstable)
    known = np.flatnonzero(np.isfinite(growth[:, 0]))
    found = []
    for i, j in pairwise(known[np.argsort(line.x[known], kind="stable")]):
        if (growth[i, 0] > 0) != (growth[j, 0] > 0):
            ends = [(float(line.x[k]), growth[k] + 1j * frequency[k]) for k in (i, j)]
            count = max(int(unstable[i]), int(unstable[j]))
            found.append(_change_between(line.parameters, ends, count))
    return found


def _change_between(
    parameters: dict[str, float], ends: list[tuple[float, Array]], unstable: int
) -> HopfPoint:
    """The change between two forces, each with its leading eigenvalues; `unstable` modes on one side."""
    (low, before), (high, after) = ends
    destabilises = bool(after[0].real > 0)
    zeros = sorted(_zeros_between(parameters, ends))
    if not zeros or 2 * len(zeros) != unstable:
        return HopfPoint((low + high) / 2, (high - low) / 2, destabilises)
    F, eta, error = zeros[0 if destabilises else -1]
    return HopfPoint(F, error, destabilises, eta)


def _zeros_between(
    parameters: dict[str, float], ends: list[tuple[float, Array]]
) -> Iterator[tuple[float, float, float]]:
    """(F, frequency, error of F) of the zeros of D(i eta; F) that Newton's method reaches, each once."""
    from ..determinant.newton import crossing_newton  # compiled code, which most files do not need
    from ..determinant.parameter_path import Path

    low, high = ends[0][0], ends[1][0]
    rod = Rod(**{name: parameters.get(name, low) for name in LINEAR_PARAMETERS})
    path = Path(rod, "F")
    a, b = (float(w[0].real) for _, w in ends)
    chord = low + (high - low) * a / (a - b)
    seen: list[tuple[float, float]] = []
    for F, (_, eigenvalues) in product((chord, low, high), ends):
        for eta in map(float, eigenvalues.imag[eigenvalues.imag > 0]):
            scale = (eta, max(abs(F), high - low))
            zero = crossing_newton(eta, F, path.origin, path.direction, scale)
            place = (zero.p, zero.eta_or_x)
            if low <= zero.p <= high and not any(np.allclose(place, p, rtol=SAME_CROSSING) for p in seen):
                seen.append(place)
                yield zero.p, zero.eta_or_x, zero.error_of_p
