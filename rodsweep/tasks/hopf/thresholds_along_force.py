"""Forces at which the rods of a file of spectra start to oscillate, become unstable, or become stable again.

The forces are computed from the stored eigenvalues after all points are solved, and stored in the file for
`show` and figures. The computation of one force takes about 30 us: 1 % of the time of spectra followed along
lines of 512 forces, and 3 to 5 % along lines of 50 forces. An onset takes up to 2 ms if the neighbouring
forces are far apart.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array, Complex, list_of
from ...model.rod import Rod
from ...results.layouts.spectrum import FORCE_THRESHOLD_VARIABLES
from ...results.layouts.thresholds import CROSSING_KINDS
from ...results.layouts.variables import FilledVariable
from ...sweep.points.points import Points, lines_along

MAX_POINTS_IN_MEMORY = 1 << 13
"""About the maximum number of points of a grid that are read at once, to limit memory. At least one value of
the longest axis other than F is read, with all values of the other axes."""
MAX_SPACING_TO_FORCE_RANGE_RATIO = 0.02
"""Two neighbouring forces are far from each other if their difference exceeds this share of the range of all
forces."""


@dataclass(frozen=True, slots=True)
class ForceLines:
    """Lines of points along F in a file; all lines have the same forces.

    parameter_names: parameters other than F, among them `taper` where a config says `taper: 1`. fixed_values:
    values of these parameters on each line, (lines, names). F: forces, increasing, (n,). eigenvalues: in
    1/tau2, leading first, (lines, n, modes). unstable_counts: number of modes with positive growth rate, -1
    if unknown, (lines, n).
    """

    parameter_names: tuple[str, ...]
    fixed_values: Array
    F: Array
    eigenvalues: Complex
    unstable_counts: NDArray[np.int64]


def force_threshold_variables(points: Points, values: Mapping[str, Any]) -> tuple[FilledVariable, ...]:
    """Thresholds on all lines of points along F, as variables of the file; empty if F does not vary.

    values: variables of the points by name, shape (points, own dimensions), arrays or HDF5 datasets.
    """
    F = points.columns_by_name["F"]
    if len(np.unique(F[np.isfinite(F)])) < 2:
        return ()
    lines = _force_lines_of_grid(points, values) if points.is_grid else _force_lines_of_list(points, values)
    record_dtype = np.dtype([(declared.name, declared.dtype) for declared in FORCE_THRESHOLD_VARIABLES])
    changes = (change for some_lines in lines for change in _thresholds_on_lines(some_lines))
    names = [variable.name for variable in FORCE_THRESHOLD_VARIABLES]
    table = np.fromiter((tuple(change[name] for name in names) for change in changes), record_dtype)
    return tuple((declared, table[declared.name]) for declared in FORCE_THRESHOLD_VARIABLES)


def _force_lines_of_grid(points: Points, values: Mapping[str, Any]) -> Iterator[ForceLines]:
    """Yields the lines of points along F in a grid, in groups of about MAX_POINTS_IN_MEMORY points. values:
    variables of the points by name, shape (points, own dimensions), arrays or HDF5 datasets."""
    F_axis = points.names.index("F")
    other_axes = [axis for axis in range(len(points.names)) if axis != F_axis]
    longest_axis = max(other_axes, key=lambda axis: points.shape[axis])
    step = max(1, MAX_POINTS_IN_MEMORY * points.shape[longest_axis] // prod(points.shape))
    for start in range(0, points.shape[longest_axis], step):
        index: list[slice] = [slice(None)] * len(points.shape)
        index[longest_axis] = slice(start, start + step)
        columns = [points.columns[axis][index[axis]] for axis in other_axes]
        fixed = np.stack([table.ravel() for table in np.meshgrid(*columns, indexing="ij")], axis=-1)
        growth, frequency, unstable = (
            np.moveaxis(values[name][tuple(index)], F_axis, len(other_axes))
            for name in ("growth_rate", "frequency", "unstable_count")
        )
        shape = (len(fixed), points.shape[F_axis])
        eigenvalues = (growth + 1j * frequency).reshape(*shape, -1)
        names = tuple(points.names[axis] for axis in other_axes)
        yield ForceLines(names, fixed, points.columns[F_axis], eigenvalues, unstable.reshape(shape))


def _force_lines_of_list(points: Points, values: Mapping[str, Any]) -> Iterator[ForceLines]:
    """For a list of points, yields each group of points that differ only in F, sorted by F, as a `ForceLines`
    with one line. values: variables of the points by name, shape (points, own dimensions), arrays or HDF5
    datasets."""
    eigenvalues = (values["growth_rate"][...] + 1j * values["frequency"][...]).reshape(points.count, -1)
    unstable = values["unstable_count"][...].ravel()
    for line in lines_along(points.columns_by_name, "F"):
        if len(line.values) > 1:
            order = np.argsort(line.values, kind="stable")
            indices = line.indices[order]
            fixed = np.array([[*line.other_parameters.values()]])
            names = tuple(line.other_parameters)
            yield ForceLines(
                names, fixed, line.values[order], eigenvalues[None, indices], unstable[None, indices]
            )


def _thresholds_on_lines(lines: ForceLines) -> Iterator[dict[str, float]]:
    """Yields the thresholds on some lines of points, one line after another, as values of variables by
    name."""
    from ...determinant.stability_changes import oscillation_onset_between, stability_change_between
    from .oscillation_onset import locate_oscillation_onset

    F = list_of(lines.F)
    eigenvalues = lines.eigenvalues
    onsets = _point_pairs_by_line(_point_pairs_around_onset(lines.F, eigenvalues))
    changes = _point_pairs_by_line(_sign_changes(eigenvalues))
    for number in sorted(onsets.keys() | changes.keys()):
        fixed = dict(zip(lines.parameter_names, list_of(lines.fixed_values[number]), strict=True))
        rod = Rod(F=0.0, **fixed)
        eigenvalues_here = eigenvalues[number]
        rods = rod.coefficients, rod.coefficient_derivative("F")
        max_spacing = MAX_SPACING_TO_FORCE_RANGE_RATIO * (F[-1] - F[0])
        candidates = (
            locate_oscillation_onset(rods, rod, (F[i], F[j]), eigenvalues_here[i], eigenvalues_here[j])
            if F[j] - F[i] > max_spacing
            else oscillation_onset_between(rods, (F[i], F[j]), eigenvalues_here[i], eigenvalues_here[j])
            for i, j in onsets.get(number, ())
        )
        located = [next(filter(None, candidates), None)]
        for i, j in changes.get(number, ()):
            counts = lines.unstable_counts[number, [i, j]]
            stored_counts = np.count_nonzero(eigenvalues_here[[i, j]].real > 0, axis=-1)
            unstable = int(np.where(counts >= 0, counts, stored_counts).max())
            pair = eigenvalues_here[i], eigenvalues_here[j]
            located.append(stability_change_between(rods, (F[i], F[j]), *pair, unstable))
        for change in filter(None, located):
            values = {"kind": CROSSING_KINDS.index(change.kind), "F": change.F, **fixed}
            values |= {"error": change.error_of_F / abs(change.F) if change.F else change.error_of_F}
            values |= {"growth_rate": change.growth_rate, "frequency": change.frequency}
            yield {f"change_{name}": value for name, value in values.items()}


NeighbourPairs = NDArray[np.int64]
"""Pairs of neighbouring points on lines, (steps, 3): (line, index of the first, index of the second
point)."""


def _sign_changes(eigenvalues: Complex) -> NeighbourPairs:
    """Pairs of neighbouring points between which the leading growth rate changes its sign. eigenvalues:
    eigenvalues, (lines, n, modes)."""
    growing = eigenvalues[..., 0].real > 0
    line, lower, upper = _neighbouring_points(np.isfinite(eigenvalues[..., 0].real))
    differ = growing[line, lower] != growing[line, upper]
    return np.stack([line, lower, upper], axis=-1)[differ]


def _point_pairs_around_onset(F: Array, eigenvalues: Complex) -> NeighbourPairs:
    """Pairs of neighbouring points between which two leading real eigenvalues may become a complex pair: the
    leading eigenvalue is real at the first point and complex at the second. The second eigenvalue at the
    first point must be real too, if the forces are close; else a complex pair overtakes a real eigenvalue. F:
    forces, (n,). eigenvalues: leading first, (lines, n, modes)."""
    if eigenvalues.shape[-1] < 2:
        return np.empty((0, 3), np.int64)
    is_real = eigenvalues[..., :2].imag == 0
    line, lower, upper = _neighbouring_points(np.all(np.isfinite(eigenvalues[..., :2].real), axis=-1))
    is_far = F[upper] - F[lower] > MAX_SPACING_TO_FORCE_RANGE_RATIO * np.ptp(F)
    is_complex = eigenvalues[line, upper, 0].imag > 0
    is_onset = is_real[line, lower, 0] & (is_real[line, lower, 1] | is_far) & is_complex
    return np.stack([line, lower, upper], axis=-1)[is_onset]


def _neighbouring_points(has_eigenvalues: NDArray[np.bool_]) -> tuple[NDArray[np.int64], ...]:
    """Returns three index arrays, (pairs,), for pairs of neighbouring points with eigenvalues: line, first
    point, second point. Points without eigenvalues are skipped. has_eigenvalues: whether a point has
    eigenvalues, (lines, n)."""
    line, point = np.nonzero(has_eigenvalues)
    same_line = line[1:] == line[:-1]
    return line[1:][same_line], point[:-1][same_line], point[1:][same_line]


def _point_pairs_by_line(steps: NeighbourPairs) -> dict[int, list[tuple[int, int]]]:
    """Pairs (index of the first point, index of the second point), by index of the line."""
    pairs: dict[int, list[tuple[int, int]]] = {}
    for line, lower, upper in list_of(steps):
        pairs.setdefault(line, []).append((lower, upper))
    return pairs
