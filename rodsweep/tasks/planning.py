"""From a job to the plan of its result file."""

from ..results.file import provenance
from ..results.file.creation import Plan
from ..sweep.shards import Shard
from .job import Job
from .protocol import Solver


def plan_of(job: Job, solver: Solver, shard: Shard, kernels: str) -> Plan:
    """The file that a run of the job, with these BLAS kernels, makes or continues."""
    from ..solve.backend import petsc

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
    return Plan(
        points=job.points,
        layout=job.layout,
        coordinates=job.task.coordinates(),
        constants=job.task.constants,
        quantities=job.quantities,
        config=job.resolved,
        attributes=attributes | job.config.parameters.numbers | versions | provenance.provenance(),
        flags=tuple((int(s), s.name) for s in solver.statuses),
        chains=job.task.chains,
        stretches=job.task.stretches,
    )
