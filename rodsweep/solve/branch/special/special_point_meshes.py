"""Meshes on which a special point of a branch is located."""

from dataclasses import replace
from math import ceil, log

from ...orbit.mesh_choice import cheapest_stage_count
from ...orbit.orbit_mesh import OrbitMesh
from ..branch_errors import BranchCalibration
from .special_point import SPECIAL_POINT_SETTINGS


def first_mesh(calibration: BranchCalibration, accuracy: float) -> OrbitMesh:
    """The first mesh for a special point of the relative accuracy `accuracy`. calibration: errors of the
    cycle after the special point.

    The number of stages is at least the number with the smallest cost at this accuracy. With s' instead of s
    stages an error e in time becomes about e^(s'/s) on the same intervals, as in `mesh_from_tails`. The
    intervals are therefore chosen for the larger error that s stages may have: with the intervals that s
    stages need, the first mesh of a cone had 3.8 times the necessary number, and 2.3 GB of factors.
    """
    target_accuracy = SPECIAL_POINT_SETTINGS.first_mesh_accuracy_ratio * accuracy
    mesh = calibration.cheapest_mesh_for_parameter(target_accuracy)
    stage_count = max(mesh.stage_count, cheapest_stage_count(accuracy))
    if stage_count == mesh.stage_count:
        return mesh
    coarser_mesh = calibration.cheapest_mesh_for_parameter(
        # The calibration knows only the stages of the branch; on k times the stages the same mesh has the
        # error to the power k.
        target_accuracy ** (mesh.stage_count / stage_count)
    )
    return replace(
        mesh, stage_count=stage_count, interval_count=min(mesh.interval_count, coarser_mesh.interval_count)
    )


def next_mesh(mesh: OrbitMesh, error_ratio: float) -> OrbitMesh:
    """The next finer mesh. error_ratio: ratio of the error on `mesh` to the accuracy; 1 gives the smallest
    refinement."""
    # The error is assumed proportional to intervals^-p, p: `time_order_per_stage` times the number of stages.
    growth = error_ratio ** (1 / (SPECIAL_POINT_SETTINGS.time_order_per_stage * mesh.stage_count))
    # Without growth the two meshes would share their error, and their difference would not show it.
    growth = min(
        max(growth, SPECIAL_POINT_SETTINGS.min_interval_ratio), SPECIAL_POINT_SETTINGS.max_interval_ratio
    )
    order_increase = min(
        max(
            ceil(log(error_ratio) / SPECIAL_POINT_SETTINGS.space_decay),
            SPECIAL_POINT_SETTINGS.min_order_increase,
        ),
        SPECIAL_POINT_SETTINGS.max_order_increase,
    )
    return replace(
        mesh.with_order(mesh.order + order_increase), interval_count=ceil(growth * mesh.interval_count)
    )
