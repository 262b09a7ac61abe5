"""The plan of a job's result file."""

from dataclasses import replace
from typing import Any

from ...config.document.reading import canonical
from ...config.schema import Config
from ...results.file import provenance
from ...results.file.creation import Plan
from ...results.layouts import layout_of
from ...sweep.points.points import Points
from ...sweep.points.shards import Shard
from .. import TASKS
from ..protocol import Solver, Task
from .job import Job


def plan_without_solver(config: Config, points: Points) -> Plan:
    """Plan of a config on given points, without attributes and flags."""
    return _plan(TASKS[config.task](config, replace(points, build=config.build)), canonical(config))


def _plan(task: Task, resolved: dict[str, Any]) -> Plan:
    return Plan(
        points=task.points,
        layout=layout_of(resolved),
        coordinates=task.coordinates(),
        constants=task.constants,
        afterwards=task.afterwards,
        config=resolved,
        attributes={},
        flags=(),
        chains=task.chains,
        stretches=task.stretches,
    )


def plan_of(job: Job, solver: Solver, shard: Shard, kernels: str) -> Plan:
    """Plan of the file that a run of the job, with these BLAS kernels, creates or continues."""
    from ...solve.backend import petsc

    attributes = {
        "Conventions": "CF-1.8",
        "title": job.name,
        "task": job.config.task,
        "time_unit": "tau2 = gamma2 L^4/k3",
        "config": job.text,
        "petsc_options": petsc.options(),
        "shard": str(shard) if shard.of > 1 else "",
        "status_sentences": "\n".join(f"{s.name}: {s.sentence}" for s in solver.statuses),
        provenance.KERNELS: kernels,
    }
    versions = {f"{name}_version": value for name, value in petsc.versions().items()}
    return replace(
        _plan(job.task, job.resolved),
        quantities=job.quantities,
        attributes=attributes | job.config.parameters.numbers | versions | provenance.provenance(),
        flags=tuple((int(s), s.name) for s in solver.statuses),
    )
