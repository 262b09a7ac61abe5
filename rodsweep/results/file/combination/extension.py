"""Extension of a result file to a larger config: whether an extension is possible, and which stored points
are reused.

A stored point is reused only if a run of the larger config would give results that are equal bit by bit: the
parameters are equal bit by bit, and every requested result is present. In a chain all previous points, and in
a group all points, must satisfy the same conditions.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....arrays import Array
from ....config.document.reading import config_from_resolved
from ....errors import InputError
from ....sweep.points.groups import MAX_GROUP_POINTS, groups_along_longest_axis
from ....sweep.points.points import Points
from ....wording import enumeration
from ...layouts import REUSE_RULES_BY_TASK
from ...layouts.variables import Layout, ReuseRule
from ..creation import FilePlan
from ..points import stored_records
from ..validation import ResultHeader
from .config_comparison import compared_settings, config_difference

ROUNDING_TOLERANCE = 4 * np.finfo(float).eps
"""Two values on an axis with at most this relative difference are treated as equal up to rounding."""
Indices = NDArray[np.int64]
"""Flat indices of points, or positions on an axis, (n,); -1 if there is no such point or position."""


@dataclass(frozen=True, slots=True)
class StoredToNewPointMap:
    """Map from stored points to new points: by the positions on each axis of a grid, or in a list."""

    stored_shape: tuple[int, ...]
    """Shape of the stored grid or list."""
    new_shape: tuple[int, ...]
    """Shape of the new grid or list."""
    new_axis_positions: tuple[Indices, ...]
    """For each axis, the position of every stored value on the new axis, (n,); -1 if the points with this
    value are computed again."""

    def __call__(self, index: Indices) -> Indices:
        """New flat indices of the points with the stored flat indices `index`, (n,); -1 for a point that is
        computed again."""
        old_places = np.unravel_index(index, self.stored_shape)
        places = [positions[i] for positions, i in zip(self.new_axis_positions, old_places, strict=True)]
        is_kept = np.min(places, axis=0) >= 0
        # Positions of -1 are replaced only to keep the conversion valid.
        new_index = np.ravel_multi_index([np.maximum(positions, 0) for positions in places], self.new_shape)
        return np.where(is_kept, new_index, -1)


@dataclass(frozen=True, slots=True)
class Extension:
    """The stored points of a result file that the file of a larger config reuses.

    stored_path: stored file. stored_layout, new_layout: layouts of the stored and the new file. point_map:
    map from stored to new points.
    """

    stored_path: Path
    stored_layout: Layout
    new_layout: Layout
    point_map: StoredToNewPointMap
    increased_options: tuple[tuple[ReuseRule, Any], ...]
    """(rule, old value) for every option that the new config increases."""
    recomputes_all: bool
    """Whether every stored point is computed again."""

    def reused_records(self) -> Iterator[np.ndarray]:
        """Yields records, (n,) in the new layout, of the stored points that are reused."""
        if self.recomputes_all:
            return
        for records in stored_records(self.stored_path, self.stored_layout):
            index = self.point_map(records["index"])
            is_kept = index >= 0
            for option, old_value in self.increased_options:
                is_kept &= option.has_additional_data(records, old_value)
            if is_kept.any():
                yield self._records_in_new_layout(records[is_kept], index[is_kept])

    def _records_in_new_layout(self, records: np.ndarray, index: Indices) -> np.ndarray:
        """Stored records converted to the new layout, (n,), at new flat indices `index`, (n,). Values that
        the old layout lacks are fill values."""
        converted = np.empty(len(records), self.new_layout.record_dtype)
        converted["index"] = index
        for variable in self.new_layout.variables:
            target = converted[variable.name]
            target[...] = variable.fill_value
            if variable.name in (records.dtype.names or ()):
                values = records[variable.name]
                common_part = tuple(map(slice, np.minimum(values.shape, target.shape)))
                target[common_part] = values[common_part]
        return converted


def extension_of(header: ResultHeader, points: Points, plan: FilePlan) -> Extension:
    """Extension of the stored file of `header`, with the points `points`, to the file of `plan`.

    Raises InputError, naming the difference, if the plan lacks a point or a result of the stored file, or has
    another task, arm, material, accuracy or option that cannot be increased.
    """
    in_file = compared_settings(config_from_resolved(header.config))
    requested = compared_settings(config_from_resolved(plan.config))
    task = in_file["task"]
    _refuse_difference(header, config_difference(task, requested["task"], "task"))
    has_longer_line = False
    for key, value in in_file["parameters"].items():
        new_value = requested["parameters"].get(key)
        if isinstance(value, dict) and isinstance(new_value, dict):  # the line of a phase diagram
            _new_positions_of_old_values(
                header, key, np.array(value["values"]), np.array(new_value["values"])
            )
            has_longer_line = has_longer_line or value != new_value
        else:
            _refuse_difference(header, config_difference(value, new_value, f"parameters.{key}"))
    _refuse_difference(header, config_difference(in_file.get("arm"), requested.get("arm"), "parameters.arm"))
    other_keys = {*in_file, *requested} - {"task", "parameters", "arm", task, "together"}
    stored = {option: value for option, value in in_file.items() if option in other_keys}
    new_rest = {option: value for option, value in requested.items() if option in other_keys}
    _refuse_difference(header, config_difference(stored, new_rest))
    longer = []
    for name, value in in_file[task].items():
        if name not in requested[task] or requested[task][name] == value:
            continue
        rule = REUSE_RULES_BY_TASK[task].get(name)
        if rule is None or not rule.requests_more_data(value, requested[task][name]):
            _refuse_difference(header, config_difference(value, requested[task][name], f"{task}.{name}"))
        else:
            longer.append((rule, value))
    point_map = _stored_to_new_point_map(header, points, plan)
    return Extension(header.path, header.layout, plan.layout, point_map, tuple(longer), has_longer_line)


def _refuse_difference(header: ResultHeader, difference: str) -> None:
    """Raises InputError if the text `difference`, on how the file of `header` and the config differ, is not
    empty."""
    if difference:
        raise InputError(
            f"{header.path} cannot be extended to this config ({difference}); choose another file with -o, "
            "or replace it with --fresh"
        )


def points_description(points: Points) -> str:
    """Kind and parameters of points, such as "a grid of F and k1", for a message."""
    return (
        f"a grid of {enumeration(tuple(points.axes))}"
        if points.axes
        else f"a list of {enumeration(points.names)}"
    )


def _stored_to_new_point_map(header: ResultHeader, old: Points, plan: FilePlan) -> StoredToNewPointMap:
    """Map from the stored points `old` to the points of the plan; raises InputError if the plan lacks a
    point."""
    new_points = plan.points
    if tuple(old.axes) != tuple(new_points.axes) or old.names != new_points.names:
        kinds_of_points = points_description(old), points_description(new_points)
        _refuse_difference(header, config_difference(*kinds_of_points, "parameters"))
    if not old.axes:
        return StoredToNewPointMap(
            old.shape, new_points.shape, (_positions_of_old_in_new_list(header, old, new_points),)
        )
    positions = [
        _new_positions_of_old_values(header, name, values, new_points.axes[name])
        for name, values in old.axes.items()
    ]
    if chains := plan.chains:
        new_length = new_points.shape[chains.axis]
        kept_positions = _positions_before_first_change(positions[chains.axis], new_length, chains.is_upward)
        positions[chains.axis] = kept_positions
    if plan.groups:
        axis = plan.groups.axis
        old_groups = groups_along_longest_axis(old.shape, old.varied_parameter_by_axis)
        is_same_axis = old_groups is not None and old_groups.axis == axis
        is_kept = is_same_axis & _is_group_unchanged(positions[axis], new_points.shape[axis])
        positions[axis] = np.where(is_kept, positions[axis], -1)
    return StoredToNewPointMap(old.shape, new_points.shape, tuple(positions))


def _new_positions_of_old_values(header: ResultHeader, name: str, old: Array, new: Array) -> Indices:
    """Position of every value of the old axis `old`, (n,), on the new axis `new`, (m,); -1 where the two
    values differ, but only by rounding. Raises InputError for an old value that is not on the new axis.
    header, name: file and parameter, for the message."""
    # Rounding moves a value to either side, so both neighbours are compared.
    above = np.searchsorted(new, old).clip(max=len(new) - 1)
    below = (above - 1).clip(min=0)
    # An axis may contain inf, whose difference from itself is nan.
    with np.errstate(invalid="ignore"):
        nearest_indices = np.where(np.abs(new[below] - old) < np.abs(new[above] - old), below, above)
        distance = np.abs(new[nearest_indices] - old)
        is_rounded = np.isfinite(distance) & (distance <= ROUNDING_TOLERANCE * np.abs(old))
    is_equal = new[nearest_indices] == old
    if not (is_equal | is_rounded).all():
        value = old[~(is_equal | is_rounded)][0]
        _refuse_difference(header, f"parameters.{name} = {value:.15g} is in the file and not in the config")
    return np.where(is_equal, nearest_indices, -1).astype(np.int64)


def _positions_before_first_change(positions: Indices, new_length: int, upward: bool) -> Indices:
    """The new positions `positions` of the values along a chain, (n,), with -1 for the first value whose
    position has changed and for all later values of the chain. new_length: number of values on the new axis.
    upward: whether chains run towards larger values."""
    forward_positions = positions if upward else np.where(positions < 0, -1, new_length - 1 - positions)[::-1]
    is_kept = np.logical_and.accumulate(forward_positions == np.arange(len(forward_positions)))
    return np.where(is_kept if upward else is_kept[::-1], positions, -1)


def _is_group_unchanged(positions: Indices, new_length: int) -> NDArray[np.bool_]:
    """Whether the group of each old value, (n,), a stretch of at most MAX_GROUP_POINTS successive values on
    the axis, is unchanged on the new axis. positions: new position of each old value, (n,). new_length:
    number of values on the new axis."""
    indices = np.arange(len(positions))
    stretch_ends = (indices // MAX_GROUP_POINTS + 1) * MAX_GROUP_POINTS
    same_length = np.minimum(stretch_ends, len(positions)) == np.minimum(stretch_ends, new_length)
    has_moved = np.logical_or.reduceat(positions != indices, np.arange(0, len(positions), MAX_GROUP_POINTS))
    return same_length & ~has_moved[indices // MAX_GROUP_POINTS]


def _positions_of_old_in_new_list(header: ResultHeader, old: Points, new: Points) -> Indices:
    """Position of every old point in the new list, (n,). Raises InputError for a point not in the new list.
    header: file, for the message."""
    # Adding 0.0 turns -0.0 into 0.0, so that equal rows have equal bytes.
    rows = [np.column_stack(points.columns) + 0.0 for points in (new, old)]
    index_by_row: dict[bytes, int] = {}
    for i, row in enumerate(rows[0]):
        index_by_row.setdefault(row.tobytes(), i)
    positions = np.array([index_by_row.get(row.tobytes(), -1) for row in rows[1]], dtype=np.int64)
    if (positions < 0).any():
        point_text = old.parameter_text(int(np.argmax(positions < 0)))
        _refuse_difference(header, f"the point {point_text} is in the file and not in the list")
    return positions
