"""The end of a branch at an end of the range just before a Hopf point, by the normal form of this Hopf point.

The cycles there are so small that a mesh may not hold them: it displaces the Hopf point by more than the
distance between this point and the end of the range.
"""

from math import inf

import numpy as np

from ...model.parameters import PARAMETERS
from ..orbit.measures import CycleMotion
from ..orbit.orbit import Orbit
from ..orbit.orbit_mesh import mesh_of
from .arc_length_step import BranchCycle
from .branch_curve import BranchEnd, RangePassage
from .branch_limits import BranchLimits
from .settings import BRANCH_END_SETTINGS
from .special.special_point import SpecialKind, SpecialPoint
from .start.hopf_point import HopfBranchStart


def end_at_range_end_near_hopf(
    start: BranchCycle, hopf: HopfBranchStart, limits: BranchLimits
) -> BranchEnd | None:
    """The end of a branch at the end of the range between its last cycle `start`, within the range, and the
    Hopf point `hopf` beyond the range; None if the cycles of the normal form do not lie between both."""
    low, high = limits.coordinate_range
    index = 0 if hopf.parameter_coordinate < low else 1
    distance = limits.coordinate_range[index] - hopf.parameter_coordinate
    start_distance = start.parameter_coordinate - hopf.parameter_coordinate
    fraction = distance / start_distance if start_distance else inf
    if not 0 <= fraction < 1 or hopf.direction * distance < 0:
        return None
    special = _point_at_range_end(start, hopf, limits, index)
    passage = RangePassage(start, index, limits.accuracy, hopf, special)
    return BranchEnd(special, complete=True, range_passage=passage)


def has_accurate_range_end(
    end: BranchEnd | None, start: BranchCycle, hopf: HopfBranchStart, limits: BranchLimits
) -> bool:
    """Whether the branch has the end `end` of `end_at_range_end_near_hopf`, and its errors of period and
    largest tip y meet the accuracy or are at most the errors of a cycle that is solved at the end of the
    range.

    A mesh displaces the Hopf point, so the errors of the largest y of its cycles grow with 1/distance from
    this point. The errors of the normal form decrease with the distance.
    """
    if end is None or end.range_passage is None:
        return False
    end_distance = abs(limits.coordinate_range[end.range_passage.index] - hopf.parameter_coordinate)
    start_distance = abs(start.parameter_coordinate - hopf.parameter_coordinate)
    growth = start_distance / end_distance if end_distance else inf
    errors = start.cycle.errors
    max_period_error = max(limits.accuracy, growth * errors.period_error)
    max_tip_y_error = max(limits.accuracy, growth * errors.amplitude_error)
    special = end.special_point
    return special.period_error <= max_period_error and special.tip_y_max_error <= max_tip_y_error


def _point_at_range_end(
    start: BranchCycle, hopf: HopfBranchStart, limits: BranchLimits, index: int
) -> SpecialPoint:
    """The special point at the end `index` of the range. The errors of the normal form, of its coefficients
    and of the Hopf point are added."""
    coordinate = limits.coordinate_range[index]
    distance = abs(coordinate - hopf.parameter_coordinate)
    period_error, amplitude_error = _errors_of_normal_form(start, hopf, distance)
    period, amplitude = hopf.period_and_amplitude_at(coordinate)
    # The amplitude is the square root of the distance, which is uncertain by the error of the Hopf point.
    hopf_error = abs(hopf.crossing.error / hopf.crossing.value * hopf.parameter_coordinate)
    displacement = hopf_error / (2 * distance) if distance else inf
    value = float(PARAMETERS[hopf.parameter_name].value(coordinate))
    return SpecialPoint(
        kind=SpecialKind.end,
        parameter_value=value,
        period=period,
        tip_y_max=amplitude,
        error=BRANCH_END_SETTINGS.relative_parameter_error_at_range_end * abs(value),
        period_error=period_error + hopf.period_error,
        tip_y_max_error=amplitude_error + hopf.relative_coefficient_error + displacement,
        reason=limits.end_reasons[index],
    )


def _errors_of_normal_form(start: BranchCycle, hopf: HopfBranchStart, distance: float) -> tuple[float, float]:
    """Relative errors of period and largest tip y by the normal form of `hopf`, with exact coefficients, at a
    distance of the parameter coordinate from the Hopf point.

    Near the Hopf point these errors are proportional to the distance. Every cycle there gives an estimate:
    its difference from the normal form, scaled to the distance. An estimate has two errors: the scaled error
    of the cycle, and the effect of higher powers of the distance, by which it differs from the straight line
    through two successive estimates at the Hopf point. The smallest sum of an estimate and its errors is
    returned. The cycles before `start` have at most the errors of `start`, as errors grow towards the Hopf
    point.
    """
    cycle_errors = np.array([start.cycle.errors.period_error, start.cycle.errors.amplitude_error])
    last_fraction, last_estimate = inf, np.zeros(2)
    bounds = []
    for orbit in _orbits_near_hopf(start, hopf):
        fraction = distance / _distance_from_hopf(orbit, hopf)
        normal_form = hopf.period_and_amplitude_at(orbit.form.rod.coordinate(hopf.parameter_name))
        measured = orbit.period, CycleMotion(orbit).extrema["tip_y_max"]
        estimate = fraction * (np.array(normal_form) / measured - 1)
        higher_powers = abs(estimate - last_estimate) / (1 - fraction / last_fraction)
        bounds.append(
            BRANCH_END_SETTINGS.normal_form_safety_factor * (abs(estimate) + higher_powers)
            + fraction * cycle_errors
        )
        last_fraction, last_estimate = fraction, estimate
    period_error, amplitude_error = np.min(bounds, axis=0).tolist()
    return period_error, amplitude_error


def _orbits_near_hopf(start: BranchCycle, hopf: HopfBranchStart) -> list[Orbit]:
    """The cycle `start`, and the cycles before it on its mesh that are small enough for an extrapolation to
    the Hopf point `hopf`; the distance from this point increases along the list."""
    mesh = mesh_of(start.orbit)
    orbits = [start.orbit]
    earlier = start.previous
    while earlier is not None and mesh_of(earlier.orbit) == mesh:
        # A fold lies between two cycles if the distance does not increase.
        is_farther = _distance_from_hopf(earlier.orbit, hopf) > _distance_from_hopf(orbits[-1], hopf)
        y = CycleMotion(earlier.orbit).extrema["tip_y_max"]
        if not is_farther or y > BRANCH_END_SETTINGS.max_last_amplitude:
            break
        orbits.append(earlier.orbit)
        earlier = earlier.previous
    return orbits


def _distance_from_hopf(orbit: Orbit, hopf: HopfBranchStart) -> float:
    """Distance of the parameter coordinate of an orbit from that of the Hopf point `hopf`."""
    return abs(orbit.form.rod.coordinate(hopf.parameter_name) - hopf.parameter_coordinate)
