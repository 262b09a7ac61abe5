"""Where a rod of a file of spectra starts to oscillate along F, becomes unstable, or stable again.

Between two forces of the file at which the leading growth rate has different signs a pair crosses the
imaginary axis: D(0) = 1, so none passes through 0. The stored eigenvalues next to it are starts for Newton's
method on D(i eta; F) = 0. Where the two leading real ones are a pair at the next force, a double eigenvalue
D = D_w = 0 lies between. What opens and closes between two forces of the file is not seen; the task
thresholds proves that nothing is missing. Knows neither meshes nor PETSc.
"""

from collections.abc import Iterator
from itertools import pairwise, product
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array
from ..model.parameters import LINEAR_PARAMETERS
from ..model.rod import Rod
from ..results.file.view import View
from .hopf_points import Bracket, Change, HopfPoint, Located, OscillationOnset, ParameterLine

if TYPE_CHECKING:
    from ..determinant.parameter_path import Path

SAME_CROSSING = 1e-8
"""Relative distance within which two zeros are one: Newton's method repeats itself to rounding."""


def thresholds_on(line: ParameterLine, view: View) -> list[Located | Bracket]:
    """The first onset of oscillation, if there is one, and the changes of stability on a line over F."""
    first = onset(line, view)
    return [*([first] if first else []), *stability_changes(line, view)]


def onset(line: ParameterLine, view: View) -> OscillationOnset | None:
    """The first force on a line over F at which the two leading real eigenvalues become a pair.

    None where they do not, or where a pair that was there before takes the lead.
    """
    if view.variables["growth_rate"].shape[-1] < 2:
        return None
    growth, frequency = _eigenvalues(line, view)
    known = np.flatnonzero(np.isfinite(growth[:, :2]).all(axis=-1))
    for i, j in pairwise(known[np.argsort(line.x[known], kind="stable")]):
        if (frequency[i, :2] == 0).all() and frequency[j, 0] > 0:
            found = _double_between(line, (i, j), growth, frequency)
            if found is not None:
                return found
    return None


def _double_between(
    line: ParameterLine, ends: tuple[int, int], growth: Array, frequency: Array
) -> OscillationOnset | None:
    """The double eigenvalue between two points of a line: two real ones before, a pair behind.

    Their squared half difference, d, passes through 0 about linearly. growth, frequency: (points, modes).
    """
    from ..determinant.newton import double_newton  # compiled code, which most files do not need

    i, j = ends
    low, high = float(line.x[i]), float(line.x[j])
    before, after = ((growth[i, 0] - growth[i, 1]) / 2) ** 2, frequency[j, 0] ** 2
    path = _path_over_force(line.parameters, low)
    guess = low + (high - low) * before / (before + after)
    centre = float(growth[i, :2].mean() + growth[j, 0]) / 2
    zero = double_newton(centre, guess, path.origin, path.direction, high - low)
    return OscillationOnset(zero.p, zero.error_of_p) if low <= zero.p <= high else None


def stability_changes(line: ParameterLine, view: View) -> list[Change]:
    """The forces on a line over F where the leading growth rate changes sign, in increasing order.

    Where the zeros of D found between two neighbours are not exactly those that the numbers of unstable modes
    ask for, the change is only known to lie between the two.
    """
    growth, frequency = _eigenvalues(line, view)
    unstable = view.variables["unstable_count"].ravel()[line.at]
    unstable = np.where(unstable < 0, (growth > 0).sum(axis=-1), unstable)
    known = np.flatnonzero(np.isfinite(growth[:, 0]))
    found: list[Change] = []
    for i, j in pairwise(known[np.argsort(line.x[known], kind="stable")]):
        if (growth[i, 0] > 0) != (growth[j, 0] > 0):
            ends = [(float(line.x[k]), growth[k] + 1j * frequency[k]) for k in (i, j)]
            count = max(int(unstable[i]), int(unstable[j]))
            found.append(_change_between(line.parameters, ends, count))
    return found


def _eigenvalues(line: ParameterLine, view: View) -> tuple[Array, Array]:
    """(growth rates, frequencies) of the modes on a line, each (points, modes)."""
    modes = view.variables["growth_rate"].shape[-1]
    growth, frequency = (
        view.variables[name].reshape(-1, modes)[line.at] for name in ("growth_rate", "frequency")
    )
    return growth, frequency


def _path_over_force(parameters: dict[str, float], F: float) -> "Path":
    """The rods of a line over F."""
    from ..determinant.parameter_path import Path

    return Path(Rod(**{name: parameters.get(name, F) for name in LINEAR_PARAMETERS}), "F")


def _change_between(parameters: dict[str, float], ends: list[tuple[float, Array]], unstable: int) -> Change:
    """The change between two forces, each with its leading eigenvalues; `unstable` modes on one side."""
    (low, before), (high, after) = ends
    destabilises = bool(after[0].real > 0)
    zeros = sorted(_zeros_between(parameters, ends))
    if not zeros or 2 * len(zeros) != unstable:
        return Bracket(low, high, destabilises)
    F, eta, error = zeros[0 if destabilises else -1]
    return HopfPoint(F, error, destabilises, eta)


def _zeros_between(
    parameters: dict[str, float], ends: list[tuple[float, Array]]
) -> Iterator[tuple[float, float, float]]:
    """(F, frequency, error of F) of the zeros of D(i eta; F) that Newton's method reaches, each once."""
    from ..determinant.newton import crossing_newton  # compiled code, which most files do not need

    low, high = ends[0][0], ends[1][0]
    path = _path_over_force(parameters, low)
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
