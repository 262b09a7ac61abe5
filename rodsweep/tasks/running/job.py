"""The job of a config (all data that a run needs, except PETSc and MPI), and the plan of its result file."""

import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...config import Config, read_config, refusals_naming_file
from ...config.document.reading import resolved_config, tree_yaml
from ...errors import InputError
from ...results.file import provenance
from ...results.file.creation import FilePlan
from ...results.layouts import LAYOUT_MAKERS, layout_of
from ...results.layouts.si_units import load_kind_of
from ...results.layouts.si_variables import arm_variables, quantities_at_points, si_values
from ...results.layouts.variables import FilledVariable, Layout
from ...solve.status import PointStatus
from ...sweep.points.flutter_forces import FlutterForceByRod
from ...sweep.points.groups import GroupResult
from ...sweep.points.points import Points
from ...sweep.points.points_from_config import parameter_grid_size, points_of
from ...sweep.points.ranges import Shard
from .. import TASKS
from ..arm.arm_points import SolverSkippingPointsOutsideModel, solver_with_outcome_cache
from ..arm.validity import ArmValidity
from ..base_classes import CertifiedTask
from ..protocol import Solver, Task

MAX_FILE_BYTES = 2**63 - 1
"""Maximum size of a file in bytes; also the maximum number of points."""
SETUP_BYTES_PER_AXIS_VALUE = 40
"""Memory per value of an axis while a run is set up, in bytes, for four arrays and overhead; 33 to 36 bytes
were measured."""
MAX_POINT_RESULT_BYTES = 100_000_000
"""Maximum size of the results of one point in bytes: these results are held in memory and written at once."""


@dataclass(frozen=True)
class Job:
    """A validated config with its points, its task and the layout of its results."""

    config_path: Path
    """Path of the config file; for a call in Python, a path with the name of the task."""
    config: Config
    given_config: str | dict[str, Any]
    """The config as the user wrote it: the text of a YAML file, or the tree of keys of a call in Python."""
    points: Points
    task: Task
    resolved_config: dict[str, Any]
    """The config as a tree of keys with all defaults."""
    layout: Layout
    """Variables of the results of a point."""

    @property
    def given_config_yaml(self) -> str:
        """YAML text of the config as the user wrote it."""
        return self.given_config if isinstance(self.given_config, str) else tree_yaml(self.given_config)

    @property
    def title(self) -> str:
        """The title of the config; if the title is empty, the name of the config file."""
        return self.config.title or self.config_path.stem

    @property
    def quantity_variables(self) -> tuple[FilledVariable, ...]:
        """Quantities of the config's arm as coordinates of the points; empty if the config has no arm."""
        return arm_variables(self.config.parameters, self.points)

    def point_text(self, index: int) -> str:
        """Text with the parameters of the point at a flat index: `F=40.0, k1=200.0`."""
        return ", ".join(
            f"{name}={value!r}" for name, value in self.points.parameter_values_of_point(index).items()
        )

    def solver(self) -> Solver:
        """The solver of the task; for an arm, the results also contain values in SI units and the validity of
        the model. Starts PETSc."""
        solver = self.task.solver()
        if self.config.parameters.arm is None:
            return solver
        cached_solver = solver_with_outcome_cache(self._with_arm_results(solver), self.points, self.layout)
        validity_codes = self.points.validity_codes
        if validity_codes is None or not validity_codes.any():
            return cached_solver
        skipping = SolverSkippingPointsOutsideModel(
            cached_solver, validity_codes, self.points.flutter_search_failures, self.layout
        )
        return skipping.solver_of_all_points()

    def _with_arm_results(self, solver: Solver) -> Solver:
        """The solver, with values in SI units and the validity of the model added to the results of a
        point."""
        layout = LAYOUT_MAKERS[self.config.task](self.resolved_config)
        quantities = quantities_at_points(self.quantity_variables, self.points)
        is_force = load_kind_of(self.resolved_config["parameters"]["arm"]) == "force"
        validity = ArmValidity(self.config, self.points, solver.possible_statuses)

        def complete(values: dict[str, Any], index: int | NDArray[np.int64]) -> dict[str, Any]:
            in_si = si_values(values, index, layout, quantities, is_force)
            return values | in_si | validity.variables_of_points(values, index)

        def together(indices: NDArray[np.int64]) -> GroupResult:
            assert solver.groups_and_group_solver is not None
            result = solver.groups_and_group_solver[1](indices)
            return replace(result, variable_values=complete(result.variable_values, indices))

        return replace(
            solver,
            file_values_of_outcome=lambda index, outcome: complete(
                solver.file_values_of_outcome(index, outcome), index
            ),
            groups_and_group_solver=solver.groups_and_group_solver
            and (solver.groups_and_group_solver[0], together),
        )


def machine_memory() -> int:
    """Memory of this machine in bytes."""
    return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")


def job_of_file(path: Path, overrides: tuple[str, ...]) -> Job:
    """The job of a config file; InputError for every error that can be detected before the run.

    overrides: texts KEY=VALUE that override keys of the config.
    """
    config, text = read_config(path, overrides)
    with refusals_naming_file(path):
        return job_of_config(path, config, text)


def job_of_config(
    path: Path, config: Config, source: str | dict[str, Any], flutter: FlutterForceByRod | None = None
) -> Job:
    """The job of a config. A file of points is relative to the folder of the config file `path`.

    source: the config as the user wrote it. flutter: flutter forces of rods with a load relative to flutter;
    None: the forces are computed here. Raises InputError if the axes do not fit into memory, or the results
    into a file, or if the results of one point exceed MAX_POINT_RESULT_BYTES.
    """
    # Checked before arrays are created.
    axis_value_count = sum(axis.size for axis in config.parameters.axes.values())
    if axis_value_count * SETUP_BYTES_PER_AXIS_VALUE > machine_memory():
        raise InputError(
            f"the grid has {parameter_grid_size(config):.6g} points; the {axis_value_count:.6g} values "
            f"on its axes take {axis_value_count * SETUP_BYTES_PER_AXIS_VALUE / 1e9:.3g} GB, more than the "
            f"{machine_memory() / 1e9:.3g} GB of memory of this machine; use fewer values"
        )
    point_count = parameter_grid_size(config)
    document = resolved_config(config)
    layout = layout_of(document)
    bytes_per_point = layout.bytes_per_point
    if point_count * bytes_per_point > MAX_FILE_BYTES:
        raise InputError(
            f"parameters make a grid of {point_count:.6g} points, whose results take "
            f"{point_count * bytes_per_point:.3g} bytes, more than a file can have ({MAX_FILE_BYTES:.3g}); "
            "use fewer values"
        )
    if bytes_per_point > MAX_POINT_RESULT_BYTES:
        raise InputError(
            f"the results of one point take {bytes_per_point / 1e9:.3g} GB, more than the "
            f"{MAX_POINT_RESULT_BYTES / 1e9:.3g} GB allowed; reduce the options of {config.task} that set "
            "how many values are stored"
        )
    points = replace(points_of(config, path.parent, flutter), material=config.rod_material)
    task = TASKS[config.task](config, points)
    _refuse_search_beyond_law_limits(task, points)
    return Job(path, config, source, points, task, document, layout)


def _refuse_search_beyond_law_limits(task: Task, points: Points) -> None:
    """Raises InputError if a search compresses or stretches rubber beyond the limits of its law."""
    if not isinstance(task, CertifiedTask) or not task.searched_range_ends():
        return
    values = task.parameter_values_with_searches
    if not (values["F"].size and values["k1"].size):
        return
    taper = values["taper"].min() if "taper" in values else 1.0
    try:
        points.material.refuse_extreme_load(values["F"], values["k1"].min(), taper)
    except ValueError as error:
        raise InputError(f"{task.config.task}: {error}") from None


def plan_without_solver(config: Config, points: Points) -> FilePlan:
    """Plan of the result file of a config on given points, without attributes and status flags."""
    document = resolved_config(config)
    task = TASKS[config.task](config, replace(points, material=config.rod_material))
    return _file_plan_of_task(task, document, layout_of(document))


def _file_plan_of_task(task: Task, document: dict[str, Any], layout: Layout) -> FilePlan:
    return FilePlan(
        points=task.points,
        layout=layout,
        coordinates=task.coordinates(),
        variables_from_config=task.variables_from_config,
        variables_from_points=task.variables_from_points,
        config=document,
        attributes={},
        status_flags=(),
        chains=task.chains,
        groups=task.groups,
    )


def plan_in_memory(job: Job, statuses: Sequence[PointStatus]) -> FilePlan:
    """Plan of the results of a job, without the attributes of a file. statuses: all statuses that a point can
    have."""
    flags = tuple((int(status), status.name) for status in statuses)
    return replace(
        _file_plan_of_task(job.task, job.resolved_config, job.layout),
        quantity_variables=job.quantity_variables,
        status_flags=flags,
    )


def result_file_plan(job: Job, solver: Solver, shard: Shard, kernels: str) -> FilePlan:
    """Plan of the result file that a run of the job creates or continues.

    shard: part of the points that the run solves. kernels: names of the BLAS kernels that compute the points.
    """
    shard_text = str(shard) if shard.shard_count > 1 else ""
    attributes = file_attributes(job, solver.possible_statuses, kernels) | {"shard": shard_text}
    return replace(plan_in_memory(job, solver.possible_statuses), attributes=attributes)


def file_attributes(job: Job, statuses: Sequence[PointStatus], kernels: str) -> dict[str, Any]:
    """Attributes of a result file with all points of a job; kernels: BLAS kernels that compute the points."""
    from ...solve.backend import petsc

    attributes = {
        "Conventions": "CF-1.8",
        "title": job.title,
        "task": job.config.task,
        "time_unit": "tau2 = gamma2 L^4/k3",
        "config": job.given_config_yaml,
        "petsc_options": petsc.user_options_text(),
        "shard": "",
        "status_sentences": "\n".join(f"{status.name}: {status.sentence}" for status in statuses),
        provenance.BLAS_KERNELS_ATTRIBUTE: kernels,
    }
    versions = {f"{name}_version": value for name, value in petsc.library_versions().items()}
    return attributes | job.config.parameters.constant_parameters | versions | provenance.provenance()
