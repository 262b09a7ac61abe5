"""Results of solved points: their arrays at once, their Dataset when it is first used.

Making a Dataset, with its checksums, the text of its config and the versions of all libraries, takes longer
than a spectrum.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import xarray as xr

from ..results.file.creation import Plan
from ..results.file.validation import FORMAT, PROGRAM
from ..results.file.view import View
from ..results.layouts.variables import Filled
from ..solve.status import PointStatus
from ..tasks.running.in_memory import blas_kernels, stored, view_in_memory
from ..tasks.running.job import Job, attributes_of
from .dataset import in_layout_order, view_of, with_arm_selection, with_checksums


class Result(Protocol):
    """A result in the two forms that an answer needs."""

    @property
    def dataset(self) -> xr.Dataset:
        """The result as read by xarray from a file."""

    @property
    def view(self) -> View:
        """The result as tables read it, with the attributes `task` and `config_resolved`."""


@dataclass(frozen=True, slots=True)
class StoredResult:
    """A result given as a Dataset, from which tables read it."""

    dataset: xr.Dataset

    @property
    def view(self) -> View:
        """The Dataset as tables read it."""
        return view_of(self.dataset, Path(str(self.dataset.attrs.get("title", "data"))))


@dataclass(frozen=True, kw_only=True)
class SolvedPoints:
    """Solved points of a job. A pickle or a deep copy has the Dataset in their place."""

    job: Job
    plan: Plan = field(repr=False)
    """Plan of the results, without the attributes of a file."""
    statuses: Sequence[PointStatus]
    values: Mapping[str, np.ndarray] = field(repr=False)
    """Variables of the layout, shape (points, own dimensions)."""
    filled: Sequence[Filled] = field(repr=False)
    """Further variables of the whole file."""
    history: Mapping[str, Any]
    """Attributes that say when, where and with which options the points were solved."""
    messages: Sequence[str]
    """Message of each point solved on its own."""

    @cached_property
    def dataset(self) -> xr.Dataset:
        """The Dataset of the points, as read from a file."""
        coordinates, variables = stored(self.plan, self.values, self.filled)
        header = {
            "program": PROGRAM,
            "format": FORMAT,
            "fingerprint": self.plan.fingerprint,
            "config_resolved": json.dumps(self.plan.config),
        }
        attributes = attributes_of(self.job, self.statuses, blas_kernels())
        whole = xr.Dataset(variables, coordinates, header | attributes | dict(self.history))
        return with_arm_selection(with_checksums(in_layout_order(whole, self.plan.layout, self.plan.config)))

    @cached_property
    def view(self) -> View:
        """The points as tables read them."""
        return view_in_memory(self.job, self.plan, self.values, self.filled)

    def __reduce__(self) -> tuple[type[StoredResult], tuple[xr.Dataset]]:
        return StoredResult, (self.dataset,)
