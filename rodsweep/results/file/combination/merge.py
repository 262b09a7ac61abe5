"""Merging of the result files of a run's shards, or of files with parts of a larger grid, into a single file.

Points are copied a block at a time, in constant memory. The new file appears complete, by a rename.
"""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import h5py

from ....config.document.reading import config_from_resolved
from ....errors import InputError
from ....sweep.points.ranges import index_count
from ...run.journal import JOURNAL_GLOB, journal_directory
from ..creation import FilePlan, add_variables, create_file
from ..points import missing_ranges, points_of_file, records_to_add, write_records
from ..provenance import BLAS_KERNELS_ATTRIBUTE, merged_history, several_blas_kernels_warning, utc_time
from ..replacement import FileReplacement, disk_errors_as_refusals
from ..validation import ResultHeader, read_header
from .joining import FilePlanMaker, JoinedFile, joined_file_of


@dataclass(frozen=True, slots=True)
class MergeResult:
    """Outcome of a merge."""

    computed_point_count: int
    """Number of computed points in the merged file."""
    missing_point_count: int
    """Number of points that are in none of the merged files."""
    is_finished: bool
    """Whether the merged file is finished: no point is missing."""
    kernel_warning: str
    """Warning about the BLAS kernels that computed the points; empty for a single kernel."""


def merge(output: Path, paths: Sequence[Path], planner: FilePlanMaker) -> MergeResult:
    """Writes `output` with all points of the result files `paths`: shards of one sweep, or several grids or
    lists; returns the outcome of the merge.

    An existing `output` is the first source. If several shards have a point, the values in the first shard
    are written; different grids or lists must have equal values up to rounding errors. planner: function from
    config and points to the plan of a file. Raises InputError for a file that is not a result, was made for
    another config, or has points in a journal, and for grids that do not form a larger grid;
    EnvironmentIncomplete if the disk fails.
    """
    sources = _read_headers(paths)
    with disk_errors_as_refusals(output):
        replacement = FileReplacement(output)
    try:
        with disk_errors_as_refusals(output, lambda: "; the shards are untouched"):
            if output.exists():  # the file may have appeared while another run held the lock
                other_paths = [path for path in paths if not os.path.samefile(output, path)]
                sources = _read_headers([output, *other_paths])
            if all(_has_same_fingerprint(sources[0], source) for source in sources):
                return _merge(replacement, sources, planner)
            return _write_joined_file(replacement, joined_file_of(sources, planner))
    finally:
        replacement.close()


def _merge(
    replacement: FileReplacement, sources: Sequence[ResultHeader], planner: FilePlanMaker
) -> MergeResult:
    """Replaces the output (`replacement`) by a copy of the first source with the points of all other sources
    added. planner: function from config and points to the plan of a file."""
    layout = sources[0].layout
    plan = planner(config_from_resolved(sources[0].config), points_of_file(sources[0].path, layout))
    with replacement.writing_new_file(sources[0].path) as copy:
        used = [sources[0]]
        for source in sources[1:]:
            if write_records(copy, records_to_add(copy, source.path, layout), layout):
                used.append(source)
        return _write_provenance_and_finish(copy, plan, used)


def _write_joined_file(replacement: FileReplacement, joined: JoinedFile) -> MergeResult:
    """Replaces the output by the planned joined file and writes the points of all sources into it."""
    with replacement.writing_new_file(None) as copy:
        create_file(copy, joined.plan)
        used = joined.write(copy)
        return _write_provenance_and_finish(copy, joined.plan, used or joined.sources[:1])


def _write_provenance_and_finish(copy: Path, plan: FilePlan, used: Sequence[ResultHeader]) -> MergeResult:
    """Writes the provenance of the points into the merged file `copy`, and finishes the file if no point is
    missing; returns the outcome of the merge. plan: plan of the file. used: sources of the stored points."""
    missing_indices = missing_ranges(copy)
    finished = not missing_indices and not plan.layout.has_sweep_wide_variables
    history = merged_history([source.attributes for source in used])
    with h5py.File(copy, "r+") as file:
        if finished and "finished" not in file.attrs:
            add_variables(file, plan.variables_from_points(file))
            file.attrs["finished"] = utc_time()
        file.attrs.update(history)
        points = file["status"].size
    count = index_count(missing_indices)
    return MergeResult(
        points - count, count, finished, several_blas_kernels_warning(history[BLAS_KERNELS_ATTRIBUTE])
    )


def _read_headers(paths: Sequence[Path]) -> list[ResultHeader]:
    """Headers of the result files at `paths`; raises InputError for a file with points in its journal."""
    files = []
    for path in paths:
        files.append(read_header(path))
        if any(journal_directory(path).glob(JOURNAL_GLOB)):
            raise InputError(
                f"{path} has points in the journal that are not in the file yet; first repeat the run of "
                "this file, which adds them"
            )
    return files


def _has_same_fingerprint(header: ResultHeader, other: ResultHeader) -> bool:
    """Whether two files have the same fingerprint (digest of config and points); raises InputError if only
    the layouts differ."""
    if header.fingerprint != other.fingerprint:
        return False
    if (header.layout.record_dtype, header.point_count) != (other.layout.record_dtype, other.point_count):
        raise InputError(
            f"{other.path} was written by another version of rodsweep than {header.path}; repeat the run of "
            "one file with the version of the other"
        )
    return True
