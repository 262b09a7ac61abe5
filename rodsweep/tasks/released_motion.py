"""A rod bent by the tip and released: bent shape, and the motion after the release."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..arrays import Array
from ..discretization.elements.quadrature import lobatto_points
from ..solve.exclusive import solving
from .limit_cycle import LimitCycleTask
from .running.in_memory import blas
from .running.job import Job

NODES = 33
"""Lobatto nodes of each shape."""
FRAMES = 32
"""Shapes per return of the tip; an animation interpolates between them."""
MOTION_ACCURACY = 1e-5
"""Accuracy of the mesh of the shapes, as of motions of the task limit_cycle."""


@dataclass(frozen=True, kw_only=True)
class ReleasedMotion:
    """Motion of a released rod, and where the motion ends."""

    status: str
    """Status of the task limit_cycle."""
    sentence: str
    """Sentence of the status."""
    message: str
    """Message of the task limit_cycle."""
    cycle: Mapping[str, Any]
    """Variables of the cycle by name."""
    step: float
    """Time between two shapes, tau2."""
    x: Array
    """x of the shapes, (frames, nodes), in L."""
    y: Array
    """y of the shapes, (frames, nodes), in L."""
    is_whole: bool
    """Whether the shapes go on until the end is known."""


@solving
def bent_shape(job: Job, tip: tuple[float, float] | None) -> Array:
    """Shape (x, y) in L, (2, NODES), of the only rod of a job, with the tip held at a place, in L; the
    straight rod for None."""
    from ..discretization.beam import Beam
    from ..solve.cycle.transient.motion_mesh import integrable_rod, motion_mesh
    from ..solve.motion.held_tip import held_by_tip

    rod = job.points.rod(0)
    beam = Beam(integrable_rod(rod), motion_mesh(rod, MOTION_ACCURACY))
    z = np.zeros(beam.unknowns) if tip is None else held_by_tip(beam, *tip)
    shape: Array = beam.shape(z)[:2] @ beam.mesh.evaluation(lobatto_points(NODES)).T
    return shape


@solving
def released_motion(job: Job, tip: tuple[float, float]) -> ReleasedMotion | None:
    """The motion of the only rod of a job of the task limit_cycle from a tip at (x, y) in L.

    None where the integration failed before its first step.
    """
    from ..solve.cycle.limit_cycle import solve_cycle

    task = job.task
    assert isinstance(task, LimitCycleTask)
    with blas().limit(limits=1, user_api="blas"):  # as in the command: threads change the order of sums
        cycle = solve_cycle(job.points.rod(0), replace(task.request(), tip=tip, frames=FRAMES))
    if cycle.motion is None:
        return None
    x, y = cycle.motion.shapes
    return ReleasedMotion(
        status=cycle.status.name,
        sentence=cycle.status.sentence,
        message=cycle.message,
        cycle=task.record(job.points.values(0), cycle),
        step=cycle.motion.step,
        x=x,
        y=y,
        is_whole=cycle.motion.is_whole,
    )
