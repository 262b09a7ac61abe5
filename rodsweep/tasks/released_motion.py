"""A rod whose tip is displaced and released: shape before the release, and motion after the release."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..arrays import Array
from ..discretization.elements.quadrature import lobatto_points
from ..solve.solve_lock import exclusive_solve
from .limit_cycle import LimitCycleTask
from .running.in_memory import blas_thread_controller
from .running.job import Job

SHAPE_NODE_COUNT = 33
"""Number of Lobatto nodes of each shape."""
FRAMES_PER_RETURN = 32
"""Number of shapes per return of the tip to theta = 0; an animation interpolates between the shapes."""
HELD_SHAPE_MESH_ACCURACY = 1e-5
"""Relative accuracy of the mesh on which the bent shape is computed, equal to the accuracy of motions in the
task limit_cycle."""


@dataclass(frozen=True, kw_only=True)
class ReleasedMotion:
    """Motion of a rod after its tip is released, and the limit cycle or state of rest that the motion
    reaches."""

    status: str
    """Status of the task limit_cycle."""
    sentence: str
    """Sentence of the status."""
    message: str
    """Message of the task limit_cycle."""
    cycle: Mapping[str, Any]
    """Variables of the task limit_cycle by name."""
    shape_interval: float
    """Time between two shapes, in tau2."""
    x: Array
    """Coordinates x of the shapes in L, (frames, nodes)."""
    y: Array
    """Coordinates y of the shapes in L, (frames, nodes)."""
    is_motion_complete: bool
    """Whether the shapes cover the complete motion up to the cycle or to rest."""


@exclusive_solve
def shape_with_held_tip(job: Job, tip: tuple[float, float] | None) -> Array:
    """Shape (x, y) in L, (2, SHAPE_NODE_COUNT), of the only rod of a job.

    tip: position (x, y) in L at which the tip is held; None for the straight rod.
    """
    from ..discretization.explicit_system import ExplicitSystem
    from ..solve.cycle.transient.motion_mesh import motion_mesh, rod_for_time_integration
    from ..solve.motion.tip_target import bent_state_with_tip_at

    rod = job.points.rod(0)
    system = ExplicitSystem(rod_for_time_integration(rod), motion_mesh(rod, HELD_SHAPE_MESH_ACCURACY))
    state = np.zeros(system.unknown_count) if tip is None else bent_state_with_tip_at(system, *tip)
    shape: Array = system.shape(state)[:2] @ system.mesh.evaluation_matrix(lobatto_points(SHAPE_NODE_COUNT)).T
    return shape


@exclusive_solve
def released_motion(job: Job, tip: tuple[float, float]) -> ReleasedMotion | None:
    """Motion of the only rod of a job of the task limit_cycle after the release of its tip; None if
    the integration fails before its first step.

    tip: position (x, y) of the tip before the release, in L.
    """
    from ..solve.cycle.limit_cycle import solve_cycle

    task = job.task
    assert isinstance(task, LimitCycleTask)
    request = replace(task.cycle_request(), tip=tip, frames=FRAMES_PER_RETURN)
    # One thread, as in the command: threads change the order of sums.
    with blas_thread_controller().limit(limits=1, user_api="blas"):
        cycle = solve_cycle(job.points.rod(0), request)
    if cycle.motion_shapes is None:
        return None
    x, y = cycle.motion_shapes.shapes
    return ReleasedMotion(
        status=cycle.status.name,
        sentence=cycle.status.sentence,
        message=cycle.message,
        cycle=task.cycle_values(job.points.parameter_values_of_point(0), cycle),
        shape_interval=cycle.motion_shapes.time_step,
        x=x,
        y=y,
        is_motion_complete=cycle.motion_shapes.covers_whole_motion,
    )
