"""Results of solved points as arrays, from which the xarray Dataset is made only when it is first used.

The Dataset has checksums, the text of the config and the versions of all libraries; making it takes longer
than solving a spectrum.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import xarray as xr

from ..results.file.creation import FilePlan
from ..results.file.validation import FORMAT_NUMBER, PROGRAM_NAME
from ..results.file.view import ResultView
from ..results.layouts.variables import FilledVariable
from ..solve.status import PointStatus
from ..tasks.running.in_memory import blas_kernels, stored_coordinates_and_variables, view_in_memory
from ..tasks.running.job import Job, file_attributes
from .dataset import in_layout_order, view_of_dataset, with_arm_indexes, with_checksums


class Result(Protocol):
    """A result in the two forms that an `Answer` needs: an xarray Dataset and a `ResultView`."""

    @property
    def dataset(self) -> xr.Dataset:
        """The Dataset that xarray would read from the result file."""

    @property
    def view(self) -> ResultView:
        """The `ResultView` from which tables are made, with the attributes `task` and `config_resolved`."""


@dataclass(frozen=True, slots=True)
class DatasetResult:
    """A result given as a Dataset, from which the view is made. dataset: the Dataset of the whole file."""

    dataset: xr.Dataset

    @property
    def view(self) -> ResultView:
        """A `ResultView` of the Dataset, from which tables are made."""
        return view_of_dataset(self.dataset, Path(str(self.dataset.attrs.get("title", "data"))))


@dataclass(frozen=True, kw_only=True)
class SolvedPoints:
    """Results of all points of a job. Pickling or deep copying gives a `DatasetResult` with the Dataset."""

    job: Job
    plan: FilePlan = field(repr=False)
    """Plan of the results, without the attributes of a file."""
    possible_statuses: Sequence[PointStatus]
    """All statuses that a point of the task can have."""
    values: Mapping[str, np.ndarray] = field(repr=False)
    """Variables of the layout by name, shape (points, own dimensions)."""
    sweep_wide_variables: Sequence[FilledVariable] = field(repr=False)
    """Variables of the file that do not belong to single points."""
    run_attributes: Mapping[str, Any]
    """Attributes with the times, the host and the PETSc options of the solve."""
    messages: Sequence[str]
    """Message of each point; "" for points solved together in a group."""

    @cached_property
    def dataset(self) -> xr.Dataset:
        """The Dataset of the points, as xarray would read it from a result file."""
        coordinates, variables = stored_coordinates_and_variables(
            self.plan, self.values, self.sweep_wide_variables
        )
        header = {
            "program": PROGRAM_NAME,
            "format": FORMAT_NUMBER,
            "fingerprint": self.plan.fingerprint,
            "config_resolved": json.dumps(self.plan.config),
        }
        attributes = file_attributes(self.job, self.possible_statuses, blas_kernels())
        result = xr.Dataset(variables, coordinates, header | attributes | dict(self.run_attributes))
        return with_arm_indexes(with_checksums(in_layout_order(result, self.plan.layout, self.plan.config)))

    @cached_property
    def view(self) -> ResultView:
        """A `ResultView` of the points, from which tables are made."""
        return view_in_memory(self.job, self.plan, self.values, self.sweep_wide_variables)

    def __reduce__(self) -> tuple[type[DatasetResult], tuple[xr.Dataset]]:
        return DatasetResult, (self.dataset,)
