"""Result file of a run: created with all variables at the start, replaced as a whole when points are added.

The file is netCDF-4-compatible HDF5, is only ever replaced by a rename, and can be opened at any time. Ranks
write finished points to journals beside the file (`rodsweep.results.run.journal`). The points of journals are
added to the file at the end of a run, or at the start of the next run after a kill. A journal is recognised
by its fingerprint, even without a file; other journals are moved away, never deleted.
"""

import json
import shutil
from collections.abc import Iterator, Sequence
from itertools import chain
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from ...errors import EnvironmentIncomplete, InputError
from ...sweep.points.ranges import IndexRange, index_count
from ..layouts.variables import MISSING_STATUS, Layout
from ..run.checkpoints import CHECKPOINT_GLOB
from ..run.journal import (
    JOURNAL_GLOB,
    delete_matching_files,
    journal_directory,
    journals_with_fingerprint,
    journals_without_fingerprint,
    kept_points_clause,
    move_journals_aside,
    read_failure_reasons,
    read_journals,
)
from .combination.extension import extension_of
from .creation import NO_FINAL_VARIABLES, FilePlan, FinalAdditions, add_variables, create_file
from .current_state import SNAPSHOT_ATTRIBUTE
from .points import iterate_statuses, missing_ranges, points_of_file, records_of_points, write_records
from .provenance import merged_history, updated_reasons_attribute
from .refusals import header_of_existing_file, require_disk_space, require_same_config
from .replacement import FileReplacement, disk_errors_as_refusals, file_identity
from .validation import ResultHeader, damage_as_refusals, is_rodsweep_or_damaged_file

BACKUP_GLOB = "before-*.h5"
"""Pattern of the names of backups of the file, kept with the journals until an extension is complete."""


class ResultFileWriter:
    """Result file of one run. Only the first rank has a writer; only one run at a time can open a file."""

    def __init__(self, path: Path, plan: FilePlan, replaces: bool = False, extends: bool = False):
        """Opens the file of a plan at `path` or creates the file; raises InputError for a file of another
        plan. replaces: whether to replace an existing result file of any plan. extends: whether to extend the
        file of a smaller config to the plan, reusing its points where possible."""
        self.path = path
        self.plan = plan
        self.notes: list[str] = []
        """Notes for the user, on points that are computed again, on journals, and on a moved file."""
        with disk_errors_as_refusals(path, self._kept_points_clause):
            self.replacement = FileReplacement(path)
            self.journal_directory = self.replacement.journal_directory
            try:
                self._open(replaces, extends)
            # Any exception, even a stop by the user, must release the lock.
            except BaseException:
                self.close()
                raise

    def _open(self, replaces: bool, extends: bool) -> None:
        """Creates, replaces, continues or extends the file, or refuses it; moves journals of other configs
        out of the journal directory."""
        if replaces or not self.path.exists():
            self._create(replaces)
        else:
            header = self._header()
            if header.fingerprint == self.plan.fingerprint:
                snapshot = {SNAPSHOT_ATTRIBUTE: ""} if self.attributes().get(SNAPSHOT_ATTRIBUTE) else {}
                self.add_journals(self._changed_text_attributes() | snapshot)
            elif extends:
                self._extend(header)
            else:
                require_same_config(header, self.plan, self.journal_directory)
        foreign_journals = journals_without_fingerprint(self.journal_directory, self.plan.fingerprint)
        self._move_aside(foreign_journals, "journals that do not match the config and its points")
        delete_matching_files(self.journal_directory, JOURNAL_GLOB)  # the remaining journals have no points

    def _create(self, replaces: bool) -> None:
        """Creates the file of the plan and, unless `replaces`, adds the points of its journals. Raises
        InputError if the file at its path is not a rodsweep result."""
        if self.path.exists() and not is_rodsweep_or_damaged_file(self.path):
            raise InputError(f"{self.path} is not a result file, so --fresh does not replace it")
        require_disk_space(self.path, self.plan)
        own_journals = journals_with_fingerprint(self.journal_directory, self.plan.fingerprint)
        if replaces:
            delete_matching_files(self.journal_directory, CHECKPOINT_GLOB)
            self._move_aside(own_journals, "journals that --fresh does not use")
        self._move_aside(sorted(self.journal_directory.glob(BACKUP_GLOB)), "points from before an extension")
        with self.replacement.writing_new_file(None) as copy:
            create_file(copy, self.plan)
        if own_journals and not replaces:
            self.add_journals({})
            self.notes.append("the file was missing; a new file holds the points of its journal")

    def _extend(self, header: ResultHeader) -> None:
        """Replaces the file of a smaller config, described by `header`, by the plan's file, with all points
        that can be reused."""
        extension = extension_of(header, points_of_file(self.path, header.layout), self.plan)
        require_disk_space(self.path, self.plan)
        # Points that are only in the journals belong to the smaller config too.
        blocks = read_journals(self.journal_directory, header.layout, header.fingerprint, header.point_count)
        self._add_blocks(blocks, header.layout, header.fingerprint, {})
        stored_count = header.point_count - index_count(self.missing_ranges())
        history = merged_history([header.attributes])
        with self.replacement.writing_new_file(None) as copy:
            create_file(copy, self.plan)
            has_reused = write_records(copy, extension.reused_records(), self.plan.layout)
            lost_count = stored_count - (self.plan.points.count - index_count(missing_ranges(copy)))
            if has_reused:
                with h5py.File(copy, "r+") as file:
                    file.attrs.update(history)
            if lost_count:
                # The backup is made before the file is replaced, at the end of this block.
                backup = self._back_up_file()
                self.notes.append(
                    f"{lost_count} of {stored_count} stored points are computed again; until then {backup} "
                    "has their values"
                )
        delete_matching_files(self.journal_directory, CHECKPOINT_GLOB)
        self.add_journals({})

    def _back_up_file(self) -> Path:
        """Copies the file into the journal directory; returns the path of the copy, which is kept until the
        extension is complete."""
        number = 1 + sum(1 for _ in self.journal_directory.glob(BACKUP_GLOB))
        copy = self.journal_directory / BACKUP_GLOB.replace("*", str(number))
        shutil.copyfile(self.path, copy)
        return copy

    def _move_aside(self, paths: Sequence[Path], noun: str) -> None:
        """Moves `paths` out of the journal directory; notes their new place. noun: name of the files."""
        if paths:
            self.notes.append(f"{noun} are kept in {move_journals_aside(self.journal_directory, paths)}")

    def _changed_text_attributes(self) -> dict[str, Any]:
        """Attributes to change if config and file differ in title or config text; empty otherwise."""
        texts = {name: self.plan.attributes.get(name, "") for name in ("title", "config")}
        stored_attributes = self.attributes()
        is_equal = all(text == stored_attributes.get(name, "") for name, text in texts.items())
        return {} if is_equal else texts | {"config_resolved": json.dumps(self.plan.config)}

    def attributes(self) -> dict[str, Any]:
        """Attributes of the result file, by name."""
        with damage_as_refusals(self.path), h5py.File(self.path, "r") as file:
            return dict(file.attrs)

    def missing_ranges(self) -> list[IndexRange]:
        """Ranges of flat indices of points not computed yet, in order."""
        with damage_as_refusals(self.path):
            return missing_ranges(self.path)

    def finish(self, attributes: dict[str, Any], additions: FinalAdditions = NO_FINAL_VARIABLES) -> None:
        """Stores journalled points, `attributes`, variables computed from all points, and `additions`."""
        self.add_journals(attributes, additions)

    def add_journals(self, attributes: dict[str, Any], additions: FinalAdditions | None = None) -> None:
        """Adds journalled points and `attributes` to the file by one replacement; deletes the journals.
        additions: as for `finish`; None if points are missing."""
        plan = self.plan
        with disk_errors_as_refusals(self.path, self._kept_points_clause):
            self._restore_missing_file()
        blocks = read_journals(self.journal_directory, plan.layout, plan.fingerprint, plan.points.count)
        self._add_blocks(blocks, plan.layout, plan.fingerprint, attributes, additions)
        if not self.missing_ranges():
            for pattern in (CHECKPOINT_GLOB, BACKUP_GLOB):
                delete_matching_files(self.journal_directory, pattern)

    def _restore_missing_file(self) -> None:
        """Creates a moved or deleted file again; EnvironmentIncomplete if another file is in its place."""
        if file_identity(self.path) == self.replacement.last_identity:
            return
        if not self.path.exists():
            with self.replacement.writing_new_file(None) as copy:
                create_file(copy, self.plan)
            self.notes.append("the file was moved or deleted; a new file holds the points since then")
            return
        try:
            header = self._header()
            if header.fingerprint != self.plan.fingerprint:
                require_same_config(header, self.plan, self.journal_directory)
        except InputError as error:
            message = f"the result file was changed or replaced during the run: {error}"
            raise EnvironmentIncomplete(message) from None

    def _add_blocks(
        self,
        blocks: Iterator[np.ndarray],
        layout: Layout,
        fingerprint: str,
        attributes: dict[str, Any],
        additions: FinalAdditions | None = None,
    ) -> None:
        """Writes the records in `blocks`, (n,) each, of journals with the fingerprint into the file; deletes
        the journals. attributes: attributes of the file to change. additions: contents that complete the
        file; None if points are missing."""
        with disk_errors_as_refusals(self.path, self._kept_points_clause):
            # Listed before they are read, so that a journal that appears later is not deleted unread.
            journals = journals_with_fingerprint(self.journal_directory, fingerprint)
            first_block = next(blocks, None)
            reasons = read_failure_reasons(self.journal_directory, layout, fingerprint)
            reasons += additions.failure_reasons if additions else ()
            if first_block is not None or attributes:
                with self.replacement.writing_new_file(self.path) as copy:
                    if first_block is not None:
                        write_records(copy, chain([first_block], blocks), layout)
                    if additions:
                        write_records(copy, [records_of_points(additions.changed_points, layout)], layout)
                    if attributes or reasons:
                        with h5py.File(copy, "r+") as file:
                            if additions:
                                point_variables = self.plan.variables_from_points(file)
                                add_variables(file, (*additions.sweep_wide_variables, *point_variables))
                            file.attrs.update(attributes | updated_reasons_attribute(reasons, file.attrs))
            for journal in journals:
                journal.unlink(missing_ok=True)

    def _kept_points_clause(self) -> str:
        """Clause for messages with the directory of journalled points; empty if no points are in journals."""
        return kept_points_clause(journal_directory(self.path), self.plan.fingerprint)

    def status_counts(self) -> dict[str, int]:
        """Number of points with each status, by the name of the status."""
        names = {MISSING_STATUS: "missing", **dict(self.plan.status_flags)}
        counts: dict[str, int] = {}
        with damage_as_refusals(self.path):
            for _, status in iterate_statuses(self.path):
                for value, count in zip(*np.unique(status, return_counts=True), strict=True):
                    name = names.get(int(value), f"unknown ({value})")
                    counts[name] = counts.get(name, 0) + int(count)
        return counts

    def close(self) -> None:
        """Releases the lock on the file, so that another run can use it."""
        self.replacement.close()

    def _header(self) -> ResultHeader:
        """Header of the existing file; raises InputError if the file is not a complete result."""
        # Taken before reading, so that a replacement in between is noticed later.
        identity = file_identity(self.path)
        header = header_of_existing_file(self.path, self.plan, self.journal_directory)
        self.replacement.last_identity = identity
        return header
