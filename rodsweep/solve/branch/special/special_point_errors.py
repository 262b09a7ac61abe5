"""Special points with their errors, from solutions on two meshes; special points that are not located; and
the meshes on which special points are located."""

from dataclasses import replace
from math import ceil, exp, log, nan
from typing import NamedTuple

import numpy as np

from ....arrays import Array
from ...orbit.measures import CycleMotion
from ...orbit.mesh_choice import cheapest_stage_count
from ...orbit.orbit import Orbit
from ...orbit.orbit_mesh import OrbitMesh, mesh_of_orbit
from ...orbit.tip_path_differences import PERIOD_INDEX
from ..arc_length_step import BranchCycle
from ..branch_error_measurement import motion_displaced_along_tangent
from ..branch_errors import BranchErrorCalibration
from ..settings import BRANCH_ERROR_SETTINGS
from .branch_segment import BranchSegment
from .special_point import SPECIAL_POINT_SETTINGS, SpecialPoint, SpecialPointKind


class TestFunctionZero(NamedTuple):
    """Zero of a test function along a branch, on one mesh, by the secant method. arc_length: from the start
    of the segment to the zero. orbit: cycle at the zero. test_function_slope: derivative with respect to arc
    length. last_secant_step: last, signed step in arc length; the cycle was moved by this step along its
    tangent."""

    arc_length: float
    orbit: Orbit
    test_function_slope: float
    last_secant_step: float


def special_point_at(kind: SpecialPointKind, zero: TestFunctionZero, parameter_name: str) -> SpecialPoint:
    """The special point of the kind `kind` at the zero `zero` of its test function, without error estimates,
    for a branch along the parameter `parameter_name`."""
    return SpecialPoint(
        kind=kind,
        parameter_value=getattr(zero.orbit.form.rod, parameter_name),
        period=zero.orbit.period,
        tip_y_max=CycleMotion(zero.orbit).tip_extrema["tip_y_max"],
        error=nan,
        orbit=zero.orbit,
    )


def parameter_error_from_meshes(point: SpecialPoint, coarser_point: SpecialPoint) -> float:
    """Error of the parameter of a special point: difference between the values on a mesh (`point`) and on a
    coarser mesh (`coarser_point`), times a safety factor, plus the rounding error."""
    difference = abs(point.parameter_value - coarser_point.parameter_value)
    rounding_error = SPECIAL_POINT_SETTINGS.relative_rounding_error * abs(point.parameter_value)
    return SPECIAL_POINT_SETTINGS.error_safety_factor * difference + rounding_error


def with_mesh_errors(
    point: SpecialPoint,
    coarser_point: SpecialPoint,
    zeros: tuple[TestFunctionZero, TestFunctionZero],
    segment: BranchSegment,
    accuracy: float,
) -> SpecialPoint:
    """The special point `point` with errors. The errors due to the mesh follow from the differences from
    `coarser_point`, the same special point on a coarser mesh. The error of the zero of the test function is
    added, except to the parameter of a fold, which is stationary there. zeros: zeros on both meshes, the
    coarser mesh first. segment: part of the branch with the special point. accuracy: relative accuracy of the
    parameter. If both meshes agree within it, the differences are multiplied by
    `_remaining_error_per_mesh_difference`."""
    coarser_zero, zero = zeros
    values, coarser_values = (
        np.array([each.parameter_value, each.period, each.tip_y_max]) for each in (point, coarser_point)
    )
    rates = (
        np.abs(_parameter_period_and_tip_y_ahead(zero, segment) - values)
        / BRANCH_ERROR_SETTINGS.sensitivity_arc_length
    )
    if point.kind is SpecialPointKind.fold:
        rates[0] = 0.0
    # Numbers on two meshes may agree by coincidence, although the cycles at the special point differ.
    differences = np.max(
        [
            np.abs(values - coarser_values),
            rates * abs(zero.arc_length - coarser_zero.arc_length),
            SPECIAL_POINT_SETTINGS.min_mesh_difference_per_accuracy * accuracy * np.abs(values),
        ],
        axis=0,
    )
    is_accurate = parameter_error_from_meshes(point, coarser_point) <= accuracy * abs(point.parameter_value)
    factor = _remaining_error_per_mesh_difference(coarser_zero, zero, segment) if is_accurate else 1.0
    # The slope of a secant between two nearby cycles may be rounding error; on two meshes this is unlikely.
    slope = min(abs(zero.test_function_slope), abs(coarser_zero.test_function_slope))
    zero_error = (
        SPECIAL_POINT_SETTINGS.relative_slope_error * abs(zero.last_secant_step)
        + _test_function_error(point) / slope
    )
    errors = SPECIAL_POINT_SETTINGS.error_safety_factor * (factor * differences + rates * zero_error)
    errors += SPECIAL_POINT_SETTINGS.relative_rounding_error * np.abs(values)
    return replace(
        point,
        error=float(errors[0]),
        period_error=float(errors[1] / values[1]),
        tip_y_max_error=float(errors[2] / values[2]),
    )


def _test_function_error(point: SpecialPoint) -> float:
    """Error with which the test function is evaluated at a cycle near the special point `point`."""
    settings = SPECIAL_POINT_SETTINGS
    if point.kind is SpecialPointKind.fold:
        growth = settings.tip_y_of_doubled_fold_error / point.tip_y_max
        return settings.test_function_correction_tolerance * (1 + growth)
    # Of the others, only the test function of torus points is corrected by iteration.
    is_corrected = point.kind is SpecialPointKind.torus
    return (
        settings.test_function_correction_tolerance if is_corrected else settings.test_function_rounding_error
    )


def _parameter_period_and_tip_y_ahead(zero: TestFunctionZero, segment: BranchSegment) -> Array:
    """Parameter, period and largest tip y, (3,), of the cycle at the arc length `sensitivity_arc_length` from
    the last located zero of `segment`, along the tangent there. zero: this zero."""
    name = segment.start.scale.parameter_name
    motion = motion_displaced_along_tangent(zero.orbit, name, segment.last_arc_length_cycle_and_tangent[2])
    value = getattr(motion.orbit.form.rod, name)
    return np.array([value, motion.orbit.period, motion.tip_extrema["tip_y_max"]])


def _remaining_error_per_mesh_difference(
    coarser_zero: TestFunctionZero, zero: TestFunctionZero, segment: BranchSegment
) -> float:
    """Assumed error on the mesh of `zero`, divided by its difference from the coarser mesh of `coarser_zero`:
    q/(1 - q), where q < 1 is the factor by which the error decreases from the coarser mesh to the mesh of
    `zero`: the factor in space or the factor in time, whichever is larger."""
    coarser_mesh, mesh = mesh_of_orbit(coarser_zero.orbit), mesh_of_orbit(zero.orbit)
    measured_decay = float(
        segment.end.calibration.errors_at_equal_parameter.log_space_error_decay_per_order[PERIOD_INDEX]
    )
    decay = max(measured_decay, SPECIAL_POINT_SETTINGS.log_space_error_decay_per_order)
    order = SPECIAL_POINT_SETTINGS.time_order_per_stage_of_remaining_error * mesh.stage_count
    ratio = max(
        exp(decay * (coarser_mesh.order - mesh.order)),
        (coarser_mesh.interval_count / mesh.interval_count) ** order,
    )
    return ratio / (1 - ratio)


def unlocated_point(
    kind: SpecialPointKind, start: BranchCycle, end: BranchCycle, message: str
) -> SpecialPoint:
    """A special point that is not located: values at the cycle `end`, with the differences between `start`
    and `end` as errors. message: reason. A fold may lie outside the interval from `start` to `end`: where the
    parameter is nearly constant, as near a generalised Hopf point, rounding errors may reverse its change.
    For a fold the relative error of the largest tip y is therefore at least 1, and that of the period grows
    in proportion."""
    name = start.scale.parameter_name
    measures = end.cycle.measures
    start_measures = start.cycle.measures
    end_value, start_value = (getattr(point.orbit.form.rod, name) for point in (end, start))
    tip_y_max_error = abs(start_measures.tip_y_max / measures.tip_y_max - 1)
    period_error = abs(start_measures.period / measures.period - 1)
    if kind is SpecialPointKind.fold and 0 < tip_y_max_error < 1:
        period_error /= tip_y_max_error
        tip_y_max_error = 1.0
    return SpecialPoint(
        kind=kind,
        parameter_value=end_value,
        period=measures.period,
        tip_y_max=measures.tip_y_max,
        # The two cycles may have the same parameter value, as on the two sides of a fold.
        error=max(abs(end_value - start_value), SPECIAL_POINT_SETTINGS.accuracy * abs(end_value)),
        period_error=period_error,
        tip_y_max_error=tip_y_max_error,
        message=message,
    )


def first_mesh_for_special_point(calibration: BranchErrorCalibration, accuracy: float) -> OrbitMesh:
    """The first mesh for a special point of the relative accuracy `accuracy`. calibration: errors of the
    cycle after the special point.

    The number of stages is at least the number with the smallest cost at this accuracy. With s' instead of s
    stages an error e in time becomes about e^(s'/s) on the same intervals, as in
    `mesh_from_coefficient_tails`. The intervals are therefore chosen for the larger error that s stages may
    have: with the intervals that s stages need, the first mesh of a cone had 3.8 times the necessary number,
    and 2.3 GB of factors.
    """
    target_accuracy = SPECIAL_POINT_SETTINGS.first_mesh_accuracy_ratio * accuracy
    mesh = calibration.cheapest_mesh_at_equal_deflection(target_accuracy)
    stage_count = max(mesh.stage_count, cheapest_stage_count(accuracy))
    if stage_count == mesh.stage_count:
        return mesh
    coarser_mesh = calibration.cheapest_mesh_at_equal_deflection(
        # The calibration knows only the stages of the branch; on k times the stages the same mesh has the
        # error to the power k.
        target_accuracy ** (mesh.stage_count / stage_count)
    )
    return replace(
        mesh, stage_count=stage_count, interval_count=min(mesh.interval_count, coarser_mesh.interval_count)
    )


def next_finer_mesh(mesh: OrbitMesh, error_ratio: float) -> OrbitMesh:
    """The next finer mesh. error_ratio: ratio of the error on `mesh` to the accuracy; 1 gives the smallest
    refinement."""
    # The error is assumed proportional to intervals^-p, p: `time_order_per_stage` times the number of stages.
    growth = error_ratio ** (1 / (SPECIAL_POINT_SETTINGS.time_order_per_stage * mesh.stage_count))
    # Without growth the two meshes would share their error, and their difference would not show it.
    growth = min(
        max(growth, SPECIAL_POINT_SETTINGS.min_time_interval_count_ratio),
        SPECIAL_POINT_SETTINGS.max_time_interval_count_ratio,
    )
    order_increase = min(
        max(
            ceil(log(error_ratio) / SPECIAL_POINT_SETTINGS.log_space_error_decay_per_order),
            SPECIAL_POINT_SETTINGS.min_element_order_increase,
        ),
        SPECIAL_POINT_SETTINGS.max_element_order_increase,
    )
    return replace(
        mesh.with_order(mesh.order + order_increase), interval_count=ceil(growth * mesh.interval_count)
    )
