"""The end of a branch at an end of the range next to a Hopf point, by the normal form of this Hopf point, or
next to a symmetry breaking.

The cycles there are so small that they may not exist on a mesh: the mesh displaces the Hopf point by more
than the distance between this point and the end of the range.
"""

from dataclasses import replace
from math import inf

import numpy as np

from ...arrays import Array, list_of
from ...model.parameters import PARAMETERS
from ..cycle.accuracy.cycle_errors import CycleErrors
from ..orbit.measures import CycleMotion
from ..orbit.orbit import Orbit
from ..orbit.orbit_mesh import mesh_of_orbit
from .arc_length_step import BranchCycle
from .branch_curve import BranchCurve, BranchEnd, RangeEndPassage
from .branch_limits import BranchLimits
from .settings import BRANCH_END_SETTINGS
from .special.special_point import SpecialPoint, SpecialPointKind
from .start.hopf_point import HopfBranchStart


def end_at_range_end_near_hopf(
    start: BranchCycle, hopf: HopfBranchStart, limits: BranchLimits
) -> BranchEnd | None:
    """The end of a branch at the end of the range between its last cycle `start`, within the range, and the
    Hopf point `hopf` beyond the range; None if this end of the range does not lie between the two, or if the
    normal form has no cycles there."""
    low, high = limits.coordinate_range
    index = 0 if hopf.parameter_coordinate < low else 1
    distance = limits.coordinate_range[index] - hopf.parameter_coordinate
    start_distance = start.parameter_coordinate - hopf.parameter_coordinate
    fraction = distance / start_distance if start_distance else inf
    if not 0 <= fraction < 1 or hopf.parameter_direction * distance < 0:
        return None
    special = _normal_form_point_at_range_end(start, hopf, limits, index)
    passage = RangeEndPassage(start, index, limits.accuracy, hopf, special)
    return BranchEnd(special, is_complete=True, range_end_passage=passage)


def end_before_first_cycle(
    curve: BranchCurve, first: BranchCycle, limits: BranchLimits, index: int
) -> BranchEnd:
    """The end of a branch that leaves the range before its first cycle. curve: the branch, which has only its
    first special point. first: its first cycle, which lies beyond the range. index: index of the end of the
    range that the branch passes."""
    passage = RangeEndPassage(first, index, limits.accuracy)
    if curve.start_hopf_index >= 0:
        hopf = limits.hopfs[curve.start_hopf_index]
        special = _normal_form_point_at_range_end(first, hopf, limits, index)
    else:
        breaking = curve.special_points[0]
        measures = first.cycle.measures
        value = float(PARAMETERS[first.scale.parameter_name].value(limits.coordinate_range[index]))
        special = replace(
            breaking,
            kind=SpecialPointKind.end,
            parameter_value=value,
            error=BRANCH_END_SETTINGS.relative_parameter_error_at_range_end * abs(value),
            # The cycle at the end of the range lies between the symmetry breaking and the first cycle.
            period_error=breaking.period_error + abs(measures.period / breaking.period - 1),
            tip_y_max_error=breaking.tip_y_max_error + abs(measures.tip_y_max / breaking.tip_y_max - 1),
            end_reason=limits.end_reasons[index],
        )
    return BranchEnd(special, is_complete=True, range_end_passage=passage)


def has_accurate_range_end(
    end: BranchEnd | None, start: BranchCycle, hopf: HopfBranchStart, limits: BranchLimits
) -> bool:
    """Whether `end`, the result of `end_at_range_end_near_hopf`, is not None and has errors of period and
    largest tip y that are within the accuracy, or at most the expected errors of a cycle solved at the end of
    the range. start, hopf, limits: as for `end_at_range_end_near_hopf`.

    A mesh displaces the Hopf point, so the errors of the largest y of its cycles grow with 1/distance from
    this point. The errors of the normal form decrease with the distance.
    """
    if end is None or end.range_end_passage is None:
        return False
    range_end = limits.coordinate_range[end.range_end_passage.range_end_index]
    solved_errors = expected_errors_of_solved_cycle(start, range_end, hopf)
    errors = np.array([end.special_point.period_error, end.special_point.tip_y_max_error])
    return bool((errors <= np.maximum(limits.accuracy, solved_errors)).all())


def expected_errors_of_solved_cycle(start: BranchCycle, coordinate: float, hopf: HopfBranchStart) -> Array:
    """Expected relative errors of period and largest tip y, (2,), of a cycle that is solved at the coordinate
    `coordinate` of the branch parameter (1/k for a stiffness k, else the value), between the cycle `start`
    and the Hopf point `hopf`; inf at the Hopf point."""
    distance = abs(coordinate - hopf.parameter_coordinate)
    growth = _distance_from_hopf(start.orbit, hopf) / distance if distance else inf
    return growth * _period_and_largest_tip_y_errors(start.cycle.errors)


def _period_and_largest_tip_y_errors(errors: CycleErrors) -> Array:
    """Relative errors of period and largest tip y, (2,)."""
    return np.array([errors.period_error, errors.amplitude_error])


def _normal_form_point_at_range_end(
    start: BranchCycle, hopf: HopfBranchStart, limits: BranchLimits, index: int
) -> SpecialPoint:
    """The special point at the end `index` of the range (0 or 1): the normal form of `hopf`, corrected by its
    deviation from `start` and earlier cycles near the Hopf point. The errors of the correction, of the
    coefficients of the normal form and of the Hopf point are added."""
    coordinate = limits.coordinate_range[index]
    distance = abs(coordinate - hopf.parameter_coordinate)
    deviations, (period_error, amplitude_error) = _deviations_of_normal_form(start, hopf, distance)
    period, amplitude = list_of(np.array(hopf.period_and_amplitude_at(coordinate)) / (1 + deviations))
    # The amplitude is the square root of the distance, which is uncertain by the error of the Hopf point.
    hopf_error = abs(hopf.crossing.error / hopf.crossing.value * hopf.parameter_coordinate)
    displacement = hopf_error / (2 * distance) if distance else inf
    value = float(PARAMETERS[hopf.parameter_name].value(coordinate))
    return SpecialPoint(
        kind=SpecialPointKind.end,
        parameter_value=value,
        period=period,
        tip_y_max=amplitude,
        error=BRANCH_END_SETTINGS.relative_parameter_error_at_range_end * abs(value),
        period_error=period_error + hopf.period_error,
        tip_y_max_error=amplitude_error + hopf.relative_amplitude_coefficient_error + displacement,
        end_reason=limits.end_reasons[index],
    )


def _deviations_of_normal_form(
    start: BranchCycle, hopf: HopfBranchStart, distance: float
) -> tuple[Array, Array]:
    """Returns (deviations, errors), (2,) each: relative deviations of period and largest tip y in the normal
    form of `hopf`, with exact coefficients, from the true cycle, and the errors of these deviations.
    distance: distance of the true cycle from the Hopf point in the parameter coordinate. start: a solved
    cycle of the branch near the Hopf point.

    Near the Hopf point these deviations are proportional to the distance. Every solved cycle there gives an
    estimate: its own deviation, scaled to `distance`. The estimate has two errors: the scaled error of the
    cycle, and the effect of higher powers of the distance. The second error is the change of the estimate
    from this cycle to the Hopf point, extrapolated linearly from two successive cycles. The estimate with the
    smallest sum of both errors is returned.
    """
    last_fraction = inf
    last_estimate: Array = np.zeros(2)
    last_error: Array = np.zeros(2)
    estimates, estimate_errors = [], []
    cycles = _cycles_near_hopf(start, hopf)
    for orbit, _ in cycles:
        cycle_distance = _distance_from_hopf(orbit, hopf)
        fraction = distance / cycle_distance
        normal_form = hopf.period_and_amplitude_at(orbit.form.rod.coordinate(hopf.parameter_name))
        measured = orbit.period, CycleMotion(orbit).tip_extrema["tip_y_max"]
        estimate = fraction * (np.array(normal_form) / measured - 1)
        higher_powers = abs(estimate - last_estimate) / (1 - fraction / last_fraction)
        # On a mesh the error of y grows with 1/distance at most. Cycles that are not measured have the errors
        # of another cycle. The error of the period does not grow.
        on_mesh = [cycle for cycle in cycles if mesh_of_orbit(cycle[0]) == mesh_of_orbit(orbit)]
        tip_y_error = max(
            _distance_from_hopf(other, hopf) * errors.amplitude_error for other, errors in on_mesh
        )
        error = fraction * np.array([on_mesh[0][1].period_error, tip_y_error / cycle_distance])
        estimates.append(estimate)
        # The error of the cycle nearer to the Hopf point enters `higher_powers`, too.
        estimate_errors.append(
            BRANCH_END_SETTINGS.normal_form_safety_factor * higher_powers + np.maximum(error, last_error)
        )
        last_fraction, last_estimate, last_error = fraction, estimate, error
    best = np.argmin(estimate_errors, axis=0), np.arange(2)
    return np.array(estimates)[best], np.array(estimate_errors)[best]


def _cycles_near_hopf(start: BranchCycle, hopf: HopfBranchStart) -> list[tuple[Orbit, CycleErrors]]:
    """Orbits and errors of the cycle `start`, and of the cycles before it that are small enough for an
    extrapolation to the Hopf point `hopf`; the distance from this point increases along the list."""
    cycles = [(start.orbit, start.cycle.errors)]
    earlier = start.previous
    while earlier is not None:
        # A fold lies between two cycles if the distance does not increase.
        is_farther = _distance_from_hopf(earlier.orbit, hopf) > _distance_from_hopf(cycles[-1][0], hopf)
        y = CycleMotion(earlier.orbit).tip_extrema["tip_y_max"]
        if not is_farther or y > BRANCH_END_SETTINGS.max_amplitude_before_extrapolation:
            break
        cycles.append((earlier.orbit, earlier.errors))
        earlier = earlier.previous
    return cycles


def _distance_from_hopf(orbit: Orbit, hopf: HopfBranchStart) -> float:
    """Distance of an orbit from the Hopf point `hopf` in the coordinate of the branch parameter: 1/k for a
    stiffness k, else the value."""
    return abs(orbit.form.rod.coordinate(hopf.parameter_name) - hopf.parameter_coordinate)
