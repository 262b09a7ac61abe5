"""Joining of result files of a task with different points: grids into a larger grid, lists into a longer
list.

The joined grid must be complete: every point belongs to the grid of some file. A point computed in several
files must have the same values in all files.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import h5py
import numpy as np

from ....arrays import Array, list_of
from ....config.axis import Axis
from ....config.base_config import Config
from ....config.document.reading import config_from_resolved, config_yaml, resolved_config
from ....errors import InputError
from ....sweep.points.points import Points
from ...layouts.variables import MISSING_STATUS, SECONDS_VARIABLE
from ..content_digests import SEAL_ATTRIBUTE
from ..creation import FilePlan
from ..points import points_of_file, records_at, stored_records, write_records
from ..provenance import MAX_ATTRIBUTE_LENGTH, blas_kernels_in
from ..validation import ResultHeader
from .config_comparison import compared_settings, config_difference
from .extension import ROUNDING_TOLERANCE, StoredToNewPointMap, points_description

NOT_INHERITED_ATTRIBUTES = (
    "program", "format", "fingerprint", "config_resolved", "coordinates", "finished", "snapshot",
    SEAL_ATTRIBUTE,
)  # fmt: skip
"""Names of the attributes that a joined file does not copy from the first source."""
MAX_DIFFERENCE_PER_ACCURACY = 1e3
"""Two results with a relative difference of at most this multiple of the requested accuracy are treated as
equal up to rounding."""
FilePlanMaker = Callable[[Config, Points], FilePlan]
"""Function from a config and its points to the plan of the result file, without attributes and flags."""


@dataclass(frozen=True, slots=True)
class JoinedFile:
    """File joined from `sources`. point_maps: map from the points of each source to the points of `plan`."""

    plan: FilePlan
    sources: Sequence[ResultHeader]
    point_maps: Sequence[StoredToNewPointMap]

    def write(self, path: Path) -> list[ResultHeader]:
        """Writes the points of all sources into the file at `path`; returns the sources from which points
        were written.

        Raises InputError if the values of a point in two sources differ by more than rounding errors.
        """
        owner = np.full(self.plan.points.count, -1, np.int32)
        for number, (source, point_map) in enumerate(zip(self.sources, self.point_maps, strict=True)):
            for records in stored_records(source.path, source.layout):
                records["index"] = point_map(records["index"])
                is_new = owner[records["index"]] < 0
                self._refuse_different(path, records[~is_new], owner, number)
                write_records(path, [records[is_new]], self.plan.layout)
                owner[records["index"][is_new]] = number
        return [self.sources[number] for number in np.unique(owner[owner >= 0])]

    def _refuse_different(self, path: Path, records: np.ndarray, owner: np.ndarray, number: int) -> None:
        """Raises InputError if `records`, (n,), of the source `number` differ from the values already stored
        in the file `path` for the same points. Rounding errors, and different computing times, are allowed.
        owner: number of the source of each stored point, (points,)."""
        if not len(records):
            return
        stored_records = records_at(path, records["index"], self.plan.layout)
        for name in (
            variable.name for variable in self.plan.layout.variables if variable.name != SECONDS_VARIABLE.name
        ):
            old_values = stored_records[name]
            new_values = records[name]
            is_equal = (old_values == new_values) | (np.isnan(old_values) & np.isnan(new_values))
            is_different = ~is_equal.reshape(len(is_equal), -1).all(axis=1)
            for i in np.flatnonzero(is_different):
                index = int(records["index"][i])
                pair = (self.sources[owner[index]], self.sources[number])
                if not self._is_rounding_error(name, stored_records[i][name], records[i][name], pair):
                    text = self.plan.points.parameter_text(index)
                    paths = " and ".join(str(source.path) for source in pair)
                    raise InputError(
                        f"{paths} disagree about the point {text}: the values of {name} differ; repeat one "
                        "of the runs, or merge without one of the files"
                    )

    def _is_rounding_error(self, name: str, a: Any, b: Any, sources: Sequence[ResultHeader]) -> bool:
        """Whether two different values a and b of the variable `name` differ only by rounding: relatively by
        at most MAX_DIFFERENCE_PER_ACCURACY times the accuracy. Always True for error estimates and for values
        that are not floats; always False for `status`, and for all variables if eigenvalues are not followed
        from point to point and one BLAS kernel computed all `sources`."""
        kernels = {kernel for source in sources for kernel in blas_kernels_in(source.attributes)}
        if (len(kernels) < 2 and not self.plan.groups) or name == "status":
            return False
        # Rounding changes the size of an error estimate, and the cost of a solve, by any factor.
        if np.asarray(a).dtype.kind != "f" or name.endswith(("error", "error_estimate")):
            return True
        tolerance = MAX_DIFFERENCE_PER_ACCURACY * float(self.plan.config["accuracy"])
        scale = np.nanmax(np.abs([a, b]), initial=0.0)
        return bool(np.allclose(a, b, rtol=tolerance, atol=tolerance * scale, equal_nan=True))


def joined_file_of(sources: Sequence[ResultHeader], planner: FilePlanMaker) -> JoinedFile:
    """The `JoinedFile` of sources with different points; raises InputError if the files cannot be joined.
    planner: function from config and points to the plan of a file."""
    first, *other_sources = sources
    settings = compared_settings(config_from_resolved(first.config))
    grids = [points_of_file(source.path, source.layout) for source in sources]
    for header, points in zip(other_sources, grids[1:], strict=True):
        other_settings = compared_settings(config_from_resolved(header.config)) | {"together": None}
        names = (first.path.name, header.path.name)
        difference = config_difference(settings | {"together": None}, other_settings, "", names)
        if difference:
            raise InputError(
                f"{header.path} was made from another config than {first.path} ({difference}); leave one of "
                "them out"
            )
        kinds = points_description(grids[0]), points_description(points)
        if kinds[0] != kinds[1]:
            raise InputError(
                f"{first.path} and {header.path} cannot be merged: one has {kinds[0]}, the other {kinds[1]}; "
                "leave one of them out"
            )
    if "arm" in settings:
        raise InputError(
            f"{first.path} is the file of an arm, and such files are merged only as shards of a single "
            "config; run --extend adds points to the file"
        )
    points, point_maps = _joined_grid(grids) if grids[0].is_grid else _joined_list_and_maps(grids)
    config = _joined_config(first, settings, points)
    plan = planner(config, points)
    _refuse_broken_chains(sources, grids, plan)
    return JoinedFile(_with_attributes(plan, first, config), sources, point_maps)


def _joined_grid(grids: Sequence[Points]) -> tuple[Points, list[StoredToNewPointMap]]:
    """Returns (joined grid, maps from the grids to the joined grid). The axes of the joined grid have the
    values of all grids. Raises InputError if a point of the joined grid is in no grid, or if two values on an
    axis differ only by rounding."""
    axes = []
    for name in grids[0].names:
        axis = np.unique(np.concatenate([grid.columns_by_name[name] for grid in grids]))
        close = np.flatnonzero(np.diff(axis) <= ROUNDING_TOLERANCE * np.abs(axis[:-1]))
        if len(close):
            equal_values_text = " and ".join(repr(float(value)) for value in axis[close[0] : close[0] + 2])
            raise InputError(
                f"the files have {name} = {equal_values_text}, which differ by rounding only; write one "
                "of these values into all configs, and compute the files with the other value again"
            )
        axes.append(axis)
    union = Points(grids[0].names, tuple(axes), is_grid=True)
    covered = np.zeros(union.shape, bool)
    maps = []
    for grid in grids:
        positions = [np.searchsorted(axis, column) for axis, column in zip(axes, grid.columns, strict=True)]
        covered[np.ix_(*positions)] = True
        maps.append(StoredToNewPointMap(grid.shape, union.shape, tuple(positions)))
    if not covered.all():
        raise InputError(
            f"together the files do not form a full grid: {np.count_nonzero(~covered)} of {covered.size} "
            f"points are in no file, the first at {union.parameter_text(int(np.argmin(covered)))}; compute "
            "these points into a separate file, or merge fewer files"
        )
    return union, maps


def _joined_list_and_maps(lists: Sequence[Points]) -> tuple[Points, list[StoredToNewPointMap]]:
    """Returns (joined list, maps from the lists to the joined list). The joined list has the points of all
    lists without repetition."""
    numbers: dict[bytes, int] = {}
    rows = [np.column_stack(points.columns) + 0.0 for points in lists]
    maps = [np.array([numbers.setdefault(row.tobytes(), len(numbers)) for row in table]) for table in rows]
    all_rows = np.empty((len(numbers), rows[0].shape[1]))
    for point_map, table in zip(maps, rows, strict=True):
        all_rows[point_map] = table
    union = Points(lists[0].names, tuple(np.ascontiguousarray(all_rows.T)), is_grid=False)
    shapes = (points.shape for points in lists)
    return union, [
        StoredToNewPointMap(shape, union.shape, (row_map,))
        for shape, row_map in zip(shapes, maps, strict=True)
    ]


def _joined_config(header: ResultHeader, settings: dict[str, Any], points: Points) -> Config:
    """Config of the joined file: the config of the first file, described by `header`; for a grid, its axes
    are replaced by the axes of the joined `points`. settings: `Config.settings_of_results` of the first
    file's config, in which task options without effect have their default values. Derived entries, such as
    the gamma1 of a diagram, are left out."""
    task = header.config["task"]
    parameters = dict(header.config["parameters"])
    if points.is_grid:
        own_axes = config_from_resolved(header.config).parameters.axes
        columns = points.columns_by_name
        axes = {name: _axis_from_values(own_axes[name], column) for name, column in columns.items()}
        parameters |= {name: axis.model_dump(mode="json", exclude_none=True) for name, axis in axes.items()}
    options = {name: settings[task][name] for name in header.config[task] if name in settings[task]}
    return config_from_resolved(header.config | {"parameters": parameters, task: options})


def _axis_from_values(own_axis: Axis, values: Array) -> Axis:
    """An axis with the given values, (n,): `own_axis` if it has these values bit by bit, else a range with
    these values bit by bit, else a list."""
    if np.array_equal(own_axis.array(), values):
        return own_axis
    if len(values) > 2 and np.isfinite(values).all():
        spacings: tuple[Literal["linear", "log"], ...] = ("linear", "log") if values[0] > 0 else ("linear",)
        for spacing in spacings:
            start = float(values[0])
            axis = Axis(start=start, stop=float(values[-1]), num=len(values), spacing=spacing)
            if np.array_equal(axis.array(), values):
                return axis
    return Axis(values=tuple(list_of(values)))


def _refuse_broken_chains(sources: Sequence[ResultHeader], grids: Sequence[Points], plan: FilePlan) -> None:
    """Raises InputError if the points of a chain of `plan`, the joined file, would come from several files.
    sources, grids: source files and their grids."""
    if not plan.chains:
        return
    name = plan.points.names[plan.chains.axis]
    for source, grid in zip(sources, grids, strict=True):
        if not np.array_equal(grid.columns_by_name[name], plan.points.columns_by_name[name]):
            raise InputError(
                f"{source.path} differs from the other files in {name}, along which each point starts from "
                "its neighbour; parts of such a line of points cannot be merged; use run --extend"
            )


def _with_attributes(plan: FilePlan, header: ResultHeader, config: Config) -> FilePlan:
    """Copy of the plan with the attributes and status flags of the first file, and the joined config. Raises
    InputError if the config is too long for an attribute."""
    text = config_yaml(config)
    tree = resolved_config(config)
    if max(len(text), len(str(tree))) > MAX_ATTRIBUTE_LENGTH:
        raise InputError(
            "the axes of the merged grid are too long to be listed; compute the grid with `run` from ranges"
        )
    with h5py.File(header.path, "r") as file:
        described = file["status"].attrs
        pairs = zip(described["flag_values"], str(described["flag_meanings"]).split(), strict=True)
        flags = tuple((int(value), word) for value, word in pairs if value != MISSING_STATUS)
    inherited = {
        name: value for name, value in header.attributes.items() if name not in NOT_INHERITED_ATTRIBUTES
    }
    return replace(plan, attributes=inherited | {"config": text}, status_flags=flags)
