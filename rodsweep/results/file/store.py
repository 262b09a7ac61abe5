"""The result file of a run: created whole at the start, replaced whole when points are folded in.

The file is netCDF-4-compatible HDF5 and is only ever exchanged by a rename, so it opens at any
instant. What ranks finish goes to the journal beside it (`rodsweep.results.run.journal`) and is folded
in at the end of a run, or at the start of the next one where a run was killed.
"""

import json
import shutil
from collections.abc import Sequence
from itertools import chain
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from ...errors import EnvironmentLacks, InputError
from ...sweep.ranges import IndexRange
from ..layouts.variables import MISSING, Filled
from ..run.checkpoints import CHECKPOINTS
from ..run.journal import JOURNALS, drop_files, read_journals
from .creation import Plan, add_variables, create_file
from .exchange import Exchange, disk_refusals
from .points import missing_ranges, statuses, write_points
from .seal import check_seal
from .validation import DAMAGES, change_between, is_ours, reason_of, refuse_misfit, what_is_asked

SPACE_FACTOR, SPACE_FIXED = 3, 300_000
"""Room that a run needs: the file, the journals and the copy in units of the file, and bytes besides."""
KEPT = "; what is done is kept"


class Store:
    """A result file under one run; only the first rank has one, and only one run at a time."""

    def __init__(self, path: Path, plan: Plan, fresh: bool = False):
        """Opens the file that continues `plan`, or creates it; InputError if it is another's."""
        self.path, self.plan = path, plan
        with disk_refusals(path, KEPT):
            self.exchange = Exchange(path)
            self.journals = self.exchange.journals
            try:
                self._open(fresh)
            except BaseException:
                self.close()
                raise

    def _open(self, fresh: bool) -> None:
        if self.path.exists() and not fresh:
            self._refuse_another()
            self.fold(self._new_title())
            return
        if self.path.exists() and not is_ours(self.path):
            raise InputError(f"{self.path} is no result file, so --fresh leaves it alone")
        self._need_room()
        drop_files(self.journals, JOURNALS)
        drop_files(self.journals, CHECKPOINTS)
        with self.exchange.replacing(None) as copy:
            create_file(copy, self.plan)

    def _new_title(self) -> dict[str, Any]:
        """The attributes that change where the config has another title than the file; else none."""
        names = {name: self.plan.attributes.get(name, "") for name in ("title", "config")}
        stored = self.attributes().get("title", "")
        if (
            not isinstance(stored, str) or names["title"] == stored
        ):  # what another program wrote is left alone
            return {}
        return names | {"config_resolved": json.dumps(self.plan.config)}

    def _need_room(self) -> None:
        """EnvironmentLacks unless the file, its journals and the copy that replaces it have room."""
        size = SPACE_FACTOR * self.plan.points.count * (self.plan.layout.bytes_per_point + 12)
        size += SPACE_FIXED
        free = shutil.disk_usage(self.path.parent).free
        if free < size:
            raise EnvironmentLacks(
                f"{self.path} needs {size / 1e6:.3g} MB on its disk while it is computed, and "
                f"{free / 1e6:.3g} MB are free"
            )

    def attributes(self) -> dict[str, Any]:
        """What the file says of itself."""
        with h5py.File(self.path, "r") as file:
            return dict(file.attrs)

    def missing(self) -> list[IndexRange]:
        """Ranges of flat indices that are not computed yet, in order."""
        return missing_ranges(self.path)

    def fold(self, attributes: dict[str, Any], additions: Sequence[Filled] = ()) -> None:
        """Puts journalled points, attributes and whole variables into the file at once; drops journals."""
        plan = self.plan
        with disk_refusals(self.path, KEPT):
            blocks = read_journals(self.journals, plan.layout, plan.fingerprint, plan.points.count)
            first = next(blocks, None)
            if first is not None or attributes or additions:
                with self.exchange.replacing(self.path) as copy:
                    if first is not None:
                        write_points(copy, chain([first], blocks), plan.layout)
                    if attributes or additions:
                        with h5py.File(copy, "r+") as file:
                            add_variables(file, additions)
                            file.attrs.update(attributes)
            drop_files(self.journals, JOURNALS)
            if not self.missing():
                drop_files(self.journals, CHECKPOINTS)

    def status_counts(self) -> dict[str, int]:
        """How many points have each status, by the name of the status."""
        names = {MISSING: "missing", **dict(self.plan.flags)}
        counts: dict[str, int] = {}
        for _, status in statuses(self.path):
            for value, n in zip(*np.unique(status, return_counts=True), strict=True):
                name = names.get(int(value), f"unknown ({value})")
                counts[name] = counts.get(name, 0) + int(n)
        return counts

    def close(self) -> None:
        """Releases the file for another run."""
        self.exchange.close()

    def _refuse_another(self) -> None:
        """InputError unless the existing file answers the same config."""
        if not self.path.is_file():
            raise InputError(f"{self.path} is not a file; choose another with -o")
        try:
            check_seal(self.path, values=True)
            with h5py.File(self.path, "r") as file:
                theirs = json.loads(file.attrs["config_resolved"])
                fingerprint = file.attrs["fingerprint"]
                if fingerprint == self.plan.fingerprint:
                    refuse_misfit(file, self.plan.layout)
        except DAMAGES as error:
            raise InputError(
                f"{self.path} exists and is not a whole rodsweep result ({reason_of(error)}); it is left as "
                "it is: choose another file with -o, or replace it with --fresh"
            ) from None
        if fingerprint != self.plan.fingerprint or what_is_asked(theirs) != what_is_asked(self.plan.config):
            raise InputError(
                f"{self.path} was made from another config ({change_between(theirs, self.plan.config)}); "
                "choose another file with -o, or replace it with --fresh"
            )
