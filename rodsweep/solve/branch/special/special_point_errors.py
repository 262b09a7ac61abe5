"""Special points with their errors, from solutions on two meshes; special points that are not located; and
the meshes on which special points are located."""

from dataclasses import replace
from math import ceil, log

from ...orbit.mesh_choice import cheapest_stage_count
from ...orbit.orbit_mesh import OrbitMesh
from ..arc_length_step import BranchCycle
from ..branch_errors import BranchCalibration
from .special_point import SPECIAL_POINT_SETTINGS, SpecialKind, SpecialPoint


def with_mesh_errors(
    point: SpecialPoint, coarser_point: SpecialPoint, start: BranchCycle, end: BranchCycle
) -> SpecialPoint:
    """The special point with errors: its differences from `coarser_point`, the same point on a coarser mesh,
    times a safety factor. The errors of period and largest tip y include a fraction of their difference
    between `start` and `end`, the cycles before and after the point: for the error of the last secant step,
    and, except at a fold, for the error of the parameter."""
    error = SPECIAL_POINT_SETTINGS.error_factor * abs(
        point.parameter_value - coarser_point.parameter_value
    ) + SPECIAL_POINT_SETTINGS.rounding_error * abs(point.parameter_value)
    secant_error = SPECIAL_POINT_SETTINGS.secant_error_per_branch_step_at_fold
    if point.kind is not SpecialKind.fold:
        # Period and tip y of two meshes may agree by coincidence, although the parameter does not.
        name = start.scale.parameter_name
        difference = abs(getattr(start.orbit.form.rod, name) - getattr(end.orbit.form.rod, name))
        slope_error = (
            SPECIAL_POINT_SETTINGS.max_slope_per_chord_slope * error / difference if difference else 1.0
        )
        secant_error = SPECIAL_POINT_SETTINGS.secant_error_per_branch_step + min(slope_error, 1.0)
    start_measures = start.cycle.measures
    end_measures = end.cycle.measures
    factor = SPECIAL_POINT_SETTINGS.error_factor
    period_error = factor * abs(point.period - coarser_point.period) + secant_error * abs(
        start_measures.period - end_measures.period
    )
    tip_y_error = factor * abs(point.tip_y_max - coarser_point.tip_y_max) + secant_error * abs(
        start_measures.tip_y_max - end_measures.tip_y_max
    )
    return replace(
        point,
        error=error,
        period_error=period_error / point.period + SPECIAL_POINT_SETTINGS.rounding_error,
        tip_y_max_error=tip_y_error / point.tip_y_max + SPECIAL_POINT_SETTINGS.rounding_error,
    )


def unlocated_point(kind: SpecialKind, start: BranchCycle, end: BranchCycle, message: str) -> SpecialPoint:
    """A special point that is not located: values at the cycle `end`, with the differences between `start`
    and `end` as errors. message: cause."""
    name = start.scale.parameter_name
    measures = end.cycle.measures
    start_measures = start.cycle.measures
    end_value, start_value = (getattr(point.orbit.form.rod, name) for point in (end, start))
    return SpecialPoint(
        kind=kind,
        parameter_value=end_value,
        period=measures.period,
        tip_y_max=measures.tip_y_max,
        # The two cycles may have the same parameter value, as on the two sides of a fold.
        error=max(abs(end_value - start_value), SPECIAL_POINT_SETTINGS.accuracy * abs(end_value)),
        period_error=abs(start_measures.period / measures.period - 1),
        tip_y_max_error=abs(start_measures.tip_y_max / measures.tip_y_max - 1),
        message=message,
    )


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
