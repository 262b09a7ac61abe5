"""Forces at which the rods of a file of spectra start to oscillate, become unstable, or become stable again.

The forces are computed from the stored eigenvalues after all points are solved, and stored in the file for
`show` and figures. The computation of one force takes about 30 us: 1 % of the time of spectra followed along
lines of 512 forces, and 3 to 5 % along lines of 50 forces. An onset between forces far from each other takes
up to 2 ms.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array, Complex
from ...model.rod import Rod
from ...results.layouts.spectrum import FORCE_CHANGE_VARIABLES
from ...results.layouts.thresholds import CROSSING_KINDS
from ...results.layouts.variables import FilledVariable
from ...sweep.points.points import Points, lines_along

MAX_POINTS_IN_MEMORY = 1 << 13
"""Maximum number of points whose eigenvalues are read at once; this limits memory for large files."""
MAX_FORCE_SPACING = 0.02
"""Two neighbouring forces are far from each other if their difference exceeds this share of the range of all
forces."""


@dataclass(frozen=True, slots=True)
class ForceLines:
    """Lines of points along F in a file; all lines have the same forces.

    names: parameters other than F, among them `taper` where a config says `taper: 1`. fixed_values: values of
    these parameters on each line, (lines, names). F: forces, increasing, (n,). eigenvalues: in 1/tau2,
    leading first, (lines, n, modes). unstable_counts: number of modes with positive growth rate, -1 if
    unknown, (lines, n).
    """

    names: tuple[str, ...]
    fixed_values: Array
    F: Array
    eigenvalues: Complex
    unstable_counts: NDArray[np.int64]


def force_change_variables(points: Points, values: Mapping[str, Any]) -> tuple[FilledVariable, ...]:
    """Thresholds on all lines of points along F, as variables of the file; empty if F does not vary.

    values: variables of the points by name, shape (points, own dimensions), arrays or HDF5 datasets.
    """
    F = points.columns_by_name["F"]
    if len(np.unique(F[np.isfinite(F)])) < 2:
        return ()
    lines = _force_lines_of_grid(points, values) if points.is_grid else _force_lines_of_list(points, values)
    kind = np.dtype([(v.name, v.dtype) for v in FORCE_CHANGE_VARIABLES])
    rows = (
        tuple(row[v.name] for v in FORCE_CHANGE_VARIABLES)
        for some in lines
        for row in _thresholds_on_lines(some)
    )
    table = np.fromiter(rows, kind)
    return tuple((v, table[v.name]) for v in FORCE_CHANGE_VARIABLES)


def _force_lines_of_grid(points: Points, values: Mapping[str, Any]) -> Iterator[ForceLines]:
    """Yields the lines of points along F in a grid, in groups of about MAX_POINTS_IN_MEMORY points. values:
    as in `force_change_variables`.
    """
    along = points.names.index("F")
    others = [axis for axis in range(len(points.names)) if axis != along]
    widest = max(others, key=lambda axis: points.shape[axis])
    step = max(1, MAX_POINTS_IN_MEMORY * points.shape[widest] // prod(points.shape))
    for first in range(0, points.shape[widest], step):
        index: list[slice] = [slice(None)] * len(points.shape)
        index[widest] = slice(first, first + step)
        columns = [points.columns[axis][index[axis]] for axis in others]
        fixed = np.stack([table.ravel() for table in np.meshgrid(*columns, indexing="ij")], axis=-1)
        growth, frequency, unstable = (
            np.moveaxis(values[name][tuple(index)], along, len(others))
            for name in ("growth_rate", "frequency", "unstable_count")
        )
        shape = (len(fixed), points.shape[along])
        w = (growth + 1j * frequency).reshape(*shape, -1)
        names = tuple(points.names[axis] for axis in others)
        yield ForceLines(names, fixed, points.columns[along], w, unstable.reshape(shape))


def _force_lines_of_list(points: Points, values: Mapping[str, Any]) -> Iterator[ForceLines]:
    """Yields the lines of points along F in a list of points, one line at a time. values: as in
    `force_change_variables`.
    """
    w = (values["growth_rate"][...] + 1j * values["frequency"][...]).reshape(points.count, -1)
    unstable = values["unstable_count"][...].ravel()
    for line in lines_along(points.columns_by_name, "F"):
        if len(line.x) > 1:
            order = np.argsort(line.x, kind="stable")
            at = line.indices[order]
            fixed = np.array([[*line.parameters.values()]])
            names = tuple(line.parameters)
            yield ForceLines(names, fixed, line.x[order], w[None, at], unstable[None, at])


def _thresholds_on_lines(lines: ForceLines) -> Iterator[dict[str, float]]:
    """Yields the thresholds on some lines of points, one line after another, as values of variables by
    name."""
    from ...determinant.stability_changes import onset_between, stability_change_between
    from .onset import locate_onset

    F = lines.F.tolist()
    w = lines.eigenvalues
    onsets = _pairs_by_line(_pairs_at_onset(lines.F, w))
    changes = _pairs_by_line(_sign_changes(w))
    for number in sorted(onsets.keys() | changes.keys()):
        fixed = dict(zip(lines.names, lines.fixed_values[number].tolist(), strict=True))
        rod = Rod(F=0.0, **fixed)
        here = w[number]
        rods = rod.coefficients, rod.coefficient_derivative("F")
        far = MAX_FORCE_SPACING * (F[-1] - F[0])
        tried = (
            locate_onset(rods, rod, (F[i], F[j]), here[i], here[j])
            if F[j] - F[i] > far
            else onset_between(rods, (F[i], F[j]), here[i], here[j])
            for i, j in onsets.get(number, ())
        )
        found = [next(filter(None, tried), None)]
        for i, j in changes.get(number, ()):
            counted = lines.unstable_counts[number, [i, j]]
            among_stored = np.count_nonzero(here[[i, j]].real > 0, axis=-1)
            unstable = int(np.where(counted >= 0, counted, among_stored).max())
            found.append(stability_change_between(rods, (F[i], F[j]), here[i], here[j], unstable))
        for change in filter(None, found):
            named = {"kind": CROSSING_KINDS.index(change.kind), "F": change.F, **fixed}
            named |= {"error": change.error / abs(change.F) if change.F else change.error}
            named |= {"growth_rate": change.growth_rate, "frequency": change.frequency}
            yield {f"change_{name}": value for name, value in named.items()}


NeighbourPairs = NDArray[np.int64]
"""Pairs of neighbouring points on lines, (steps, 3): (line, index of the first, index of the second
point)."""


def _sign_changes(w: Complex) -> NeighbourPairs:
    """Pairs of neighbouring points between which the leading growth rate changes its sign.

    w: eigenvalues, (lines, n, modes).
    """
    growing = w[..., 0].real > 0
    line, before, behind = _neighbouring_points(np.isfinite(w[..., 0].real))
    differ = growing[line, before] != growing[line, behind]
    return np.stack([line, before, behind], axis=-1)[differ]


def _pairs_at_onset(F: Array, w: Complex) -> NeighbourPairs:
    """Pairs of neighbouring points between which two leading real eigenvalues can become a complex pair: the
    leading eigenvalue is real at the first point and complex at the second.

    Between forces that are close to each other, the second eigenvalue at the first point is real too;
    otherwise a complex pair overtakes a real eigenvalue. F: forces, (n,). w: eigenvalues, (lines, n, modes).
    """
    if w.shape[-1] < 2:
        return np.empty((0, 3), np.int64)
    real = w[..., :2].imag == 0
    line, before, behind = _neighbouring_points(np.isfinite(w[..., :2].real).all(axis=-1))
    far = F[behind] - F[before] > MAX_FORCE_SPACING * np.ptp(F)
    begins = real[line, before, 0] & (real[line, before, 1] | far) & (w[line, behind, 0].imag > 0)
    return np.stack([line, before, behind], axis=-1)[begins]


def _neighbouring_points(known: NDArray[np.bool_]) -> tuple[NDArray[np.int64], ...]:
    """Returns three index arrays, (pairs,), for pairs of neighbouring points with eigenvalues: line, first
    point, second point.

    Points without eigenvalues are skipped. known: whether a point has eigenvalues, (lines, n).
    """
    line, point = np.nonzero(known)
    together = line[1:] == line[:-1]
    return line[1:][together], point[:-1][together], point[1:][together]


def _pairs_by_line(steps: NeighbourPairs) -> dict[int, list[tuple[int, int]]]:
    """Pairs (index of the first point, index of the second point), by index of the line."""
    found: dict[int, list[tuple[int, int]]] = {}
    for line, before, behind in steps.tolist():
        found.setdefault(line, []).append((before, behind))
    return found
