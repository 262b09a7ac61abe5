"""Extension of a result file to a larger config: whether an extension is possible, and which stored points
are reused.

A stored point is reused only if a run of the larger config would give results that are equal bit by bit: the
parameters are equal bit by bit, and every requested result is present. In a chain all previous points, and in
a stretch all points, must satisfy the same conditions.
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
from ....sweep.points.points import Points
from ....sweep.points.stretches import STRETCH_POINTS, stretches_along_longest_axis
from ....wording import enumeration
from ...layouts import EXTENSION_RULES
from ...layouts.variables import ExtensionRule, Layout
from ..creation import Plan
from ..points import stored_records
from ..validation import ResultHeader
from .identity import config_difference

ROUNDING_TOLERANCE = 4 * np.finfo(float).eps
"""Two values on an axis with at most this relative difference are treated as equal up to rounding."""
Indices = NDArray[np.int64]
"""Flat indices of points, or positions on an axis, (n,); -1 if there is no such point or position."""


@dataclass(frozen=True, slots=True)
class StoredPointMap:
    """Map from stored points to new points: by the positions on each axis of a grid, or in a list."""

    shape: tuple[int, ...]
    """Shape of the stored grid or list."""
    new_shape: tuple[int, ...]
    """Shape of the new grid or list."""
    axis_positions: tuple[Indices, ...]
    """For each axis, the position of every stored value on the new axis, (n,); -1 if the points with this
    value are computed again."""

    def __call__(self, index: Indices) -> Indices:
        """New flat indices of the points with the stored flat indices `index`, (n,); -1 for a point that is
        computed again.
        """
        each = [
            place[i]
            for place, i in zip(self.axis_positions, np.unravel_index(index, self.shape), strict=True)
        ]
        stays = np.min(each, axis=0) >= 0
        new = np.ravel_multi_index([np.maximum(place, 0) for place in each], self.new_shape)
        return np.where(stays, new, -1)


@dataclass(frozen=True, slots=True)
class Extension:
    """The stored points of a result file that the file of a larger config reuses.

    path: stored file. stored_layout, new_layout: layouts of the stored and the new file. point_map: map from
    stored to new points.
    """

    path: Path
    stored_layout: Layout
    new_layout: Layout
    point_map: StoredPointMap
    increased_options: tuple[tuple[ExtensionRule, Any], ...]
    """(rule, old value) for every option that the new config increases."""
    recomputes_all: bool
    """Whether every stored point is computed again."""

    def reused_records(self) -> Iterator[np.ndarray]:
        """Yields records, (n,) in the new layout, of the stored points that are reused."""
        if self.recomputes_all:
            return
        for records in stored_records(self.path, self.stored_layout):
            index = self.point_map(records["index"])
            stays = index >= 0
            for increase, before in self.increased_options:
                stays &= increase.has_data(records, before)
            if stays.any():
                yield self._converted(records[stays], index[stays])

    def _converted(self, records: np.ndarray, index: Indices) -> np.ndarray:
        """Stored records converted to the new layout, (n,), at new flat indices `index`, (n,).

        Values that the old layout lacks are fill values.
        """
        found = np.empty(len(records), self.new_layout.record_dtype)
        found["index"] = index
        for variable in self.new_layout.variables:
            target = found[variable.name]
            target[...] = variable.fill
            if variable.name in records.dtype.names:
                values = records[variable.name]
                part = tuple(map(slice, np.minimum(values.shape, target.shape)))
                target[part] = values[part]
        return found


def extension_of(header: ResultHeader, points: Points, plan: Plan) -> Extension:
    """Extension of the stored file of `header`, with the points `points`, to the file of `plan`.

    Raises InputError, naming the difference, if the plan lacks a point or a result of the stored file, or has
    another task, arm, material, accuracy or option that cannot be increased.
    """
    theirs = config_from_resolved(header.config).settings_of_results
    ours = config_from_resolved(plan.config).settings_of_results
    task = theirs["task"]
    _refuse_difference(header, config_difference(task, ours["task"], "task"))
    line_grew = False
    for key, value in theirs["parameters"].items():
        new = ours["parameters"].get(key)
        if isinstance(value, dict) and isinstance(new, dict):  # the line of a phase diagram
            _positions_on_axis(header, key, np.array(value["values"]), np.array(new["values"]))
            line_grew = line_grew or value != new
        else:
            _refuse_difference(header, config_difference(value, new, f"parameters.{key}"))
    _refuse_difference(header, config_difference(theirs.get("arm"), ours.get("arm"), "parameters.arm"))
    compared = {"task", "parameters", "arm", task, "together"}
    stored, asked = ({k: v for k, v in each.items() if k not in compared} for each in (theirs, ours))
    _refuse_difference(header, config_difference(stored, asked))
    grown = []
    for name, value in theirs[task].items():
        if name not in ours[task] or ours[task][name] == value:
            continue
        increase = EXTENSION_RULES[task].get(name)
        if increase is None or not increase.requests_more_data(value, ours[task][name]):
            _refuse_difference(header, config_difference(value, ours[task][name], f"{task}.{name}"))
        else:
            grown.append((increase, value))
    places = _stored_point_map(header, points, plan)
    return Extension(header.path, header.layout, plan.layout, places, tuple(grown), line_grew)


def _refuse_difference(header: ResultHeader, difference: str) -> None:
    """Raises InputError if the text `difference`, on how file and config differ, is not empty."""
    if difference:
        raise InputError(
            f"{header.path} cannot be extended to this config ({difference}); choose another file with -o, "
            "or replace it with --fresh"
        )


def _stored_point_map(header: ResultHeader, old: Points, plan: Plan) -> StoredPointMap:
    """Map from the stored points `old` to the points of the plan; InputError if the plan lacks a
    point."""
    new = plan.points
    if tuple(old.axes) != tuple(new.axes) or old.names != new.names:
        kinds = [
            f"a grid of {enumeration(tuple(p.axes), 'and')}"
            if p.axes
            else f"a list of {enumeration(p.names, 'and')}"
            for p in (old, new)
        ]
        _refuse_difference(header, config_difference(kinds[0], kinds[1], "parameters"))
    if not old.axes:
        return StoredPointMap(old.shape, new.shape, (_positions_in_list(header, old, new),))
    places = [_positions_on_axis(header, name, axis, new.axes[name]) for name, axis in old.axes.items()]
    if plan.chains:
        axis = plan.chains.axis
        places[axis] = _positions_before_first_change(places[axis], new.shape[axis], plan.chains.is_upward)
    if plan.stretches:
        axis = plan.stretches.axis
        before = stretches_along_longest_axis(old.shape, old.varying_parameters)
        same = _is_stretch_unchanged(places[axis], new.shape[axis])
        places[axis] = np.where(same & (before is not None and before.axis == axis), places[axis], -1)
    return StoredPointMap(old.shape, new.shape, tuple(places))


def _positions_on_axis(header: ResultHeader, name: str, old: Array, new: Array) -> Indices:
    """Position of every old value, (n,), on the new axis, (m,); -1 where the values differ by rounding.

    Raises InputError for an old value that is not on the new axis. name: name of the axis.
    """
    right = np.searchsorted(new, old).clip(max=len(new) - 1)
    left = (right - 1).clip(min=0)
    with np.errstate(invalid="ignore"):
        nearest = np.where(np.abs(new[left] - old) < np.abs(new[right] - old), left, right)
        apart = np.abs(new[nearest] - old)
        near = (new[nearest] == old) | (np.isfinite(apart) & (apart <= ROUNDING_TOLERANCE * np.abs(old)))
    if not near.all():
        _refuse_difference(
            header, f"parameters.{name} = {old[~near][0]:.15g} is in the file and not in the config"
        )
    return np.where(new[nearest] == old, nearest, -1).astype(np.int64)


def _positions_before_first_change(places: Indices, count: int, upward: bool) -> Indices:
    """Positions `places` of the values along a chain, (n,), with -1 from the first changed position
    of the chain on.

    count: number of values on the new axis. upward: direction of the chains.
    """
    ahead = places if upward else np.where(places < 0, -1, count - 1 - places)[::-1]
    stays = np.logical_and.accumulate(ahead == np.arange(len(ahead)))
    return np.where(stays if upward else stays[::-1], places, -1)


def _is_stretch_unchanged(places: Indices, count: int) -> NDArray[np.bool_]:
    """Whether the stretch of each old value, (n,), is unchanged on the new axis. places: new position of each
    old value, (n,). count: number of values on the new axis.
    """
    at = np.arange(len(places))
    first = at // STRETCH_POINTS * STRETCH_POINTS
    same_length = np.minimum(first + STRETCH_POINTS, len(places)) == np.minimum(first + STRETCH_POINTS, count)
    moved = np.logical_or.reduceat(places != at, np.arange(0, len(places), STRETCH_POINTS))
    return same_length & ~moved[at // STRETCH_POINTS]


def _positions_in_list(header: ResultHeader, old: Points, new: Points) -> Indices:
    """Position of every old point in the new list, (n,); InputError for a point not in the new list."""
    # Adding 0.0 turns -0.0 into 0.0, so that equal rows have equal bytes.
    rows = [np.column_stack(points.columns) + 0.0 for points in (new, old)]
    known: dict[bytes, int] = {}
    for i, row in enumerate(rows[0]):
        known.setdefault(row.tobytes(), i)
    found = np.array([known.get(row.tobytes(), -1) for row in rows[1]], dtype=np.int64)
    if (found < 0).any():
        values = old.values(int(np.argmax(found < 0)))
        where = ", ".join(f"{name} = {value:.15g}" for name, value in values.items())
        _refuse_difference(header, f"the point {where} is in the file and not in the list")
    return found
