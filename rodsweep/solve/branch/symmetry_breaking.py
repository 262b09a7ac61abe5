"""Symmetry breaking of cycles, and the end of a branch of asymmetric cycles at a symmetry breaking.

A symmetric cycle equals its own mirror image half a period later. A branch of asymmetric cycles crosses the
symmetric branch where a multiplier of the half-period map composed with the reflection is -1. The two halves
of the asymmetric branch are mirror images of each other, shifted by half a period; only one half is followed,
with cycles solved over the whole period. Near the crossing the deflection at t = 0 is linear in the
asymmetry; parameter and period are quadratic. Where an asymmetric branch returns to a symmetric cycle, the
branch continues as its own mirror image, as does a branch that ends at a Hopf point.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...arrays import Array
from ..orbit.orbit import Orbit, node_time_fractions
from ..orbit.symmetry import NO_SYMMETRY
from ..unsolvable import Unsolvable
from .arc_length_step import ARC_STEP_CONTROL, BranchCycle, arc_length_between
from .settings import BRANCH_END_SETTINGS
from .special.special_point import SpecialPoint, SpecialPointKind


@dataclass(frozen=True, slots=True)
class SymmetryBreaking:
    """A symmetry breaking on a branch. branch_number: number of the branch, from 1. special_point_index:
    index of the symmetry breaking in the list of special points of this branch, from 0."""

    branch_number: int
    special_point_index: int
    special_point: SpecialPoint
    """The symmetry breaking as a special point of its branch, with the symmetric cycle."""


def symmetry_breakings_in(branches: Sequence[Sequence[SpecialPoint]]) -> list[SymmetryBreaking]:
    """The symmetry breakings whose cycle is known, among the special points of all branches. branches:
    special points of each branch."""
    return [
        SymmetryBreaking(branch_number, index, point)
        for branch_number, special in enumerate(branches, 1)
        for index, point in enumerate(special)
        if point.kind == SpecialPointKind.symmetry_breaking and point.orbit is not None
    ]


def extended_to_whole_period(orbit: Orbit) -> Orbit:
    """A symmetric orbit, which stores half a period, extended by its symmetry to the whole period and to
    twice as many time intervals."""
    interval_count = 2 * orbit.interval_count
    grading = orbit.grading.over_two_solved_parts
    # In units of half a period, which the symmetric orbit covers.
    times = 2 * node_time_fractions(interval_count, orbit.stage_count, grading)
    is_second_half = times > 1
    points = orbit.states_at_time_fractions(np.where(is_second_half, times - 1, times))
    # The second half of the period is the mirror image of the first.
    points[is_second_half] = orbit.symmetry.apply(points[is_second_half], orbit.form.layout)
    values = np.append(points.ravel(), orbit.period)
    return replace(orbit, symmetry=NO_SYMMETRY, interval_count=interval_count, values=values, grading=grading)


def bending_moment_asymmetry(orbit: Orbit) -> Array:
    """Asymmetry of an orbit: bending moments at t = 0 plus bending moments half a period later, (nodes,); 0
    for a symmetric orbit."""
    return _bending_moments(orbit.start_state, orbit) + _bending_moments(
        orbit.states_at_time_fractions(np.array([0.5]))[0], orbit
    )


def _bending_moments(states: Array, orbit: Orbit) -> Array:
    """Bending moments, (..., nodes), of states, (..., n), at the nodes of an orbit's mesh."""
    # Moments are unknowns of the state, whereas positions would need an integration over the arms.
    return orbit.form.layout.stress_field(states, "m3")


def reaches_symmetric_cycle(
    start: BranchCycle, end: BranchCycle, breakings: Sequence[SymmetryBreaking], accuracy: float
) -> bool:
    """Whether an asymmetric branch reaches or passes a symmetric cycle between the cycles `start` and `end`:
    the asymmetry changes sign or almost vanishes; or the parameter turns back near a symmetry breaking in
    `breakings`, because a mesh without the symmetry of the cycle perturbs the crossing of the branches.
    accuracy: relative accuracy of the branch."""
    start_asymmetry = bending_moment_asymmetry(start.orbit)
    # The scalar product needs both asymmetries at the same nodes.
    orbit_on_mesh = end.orbit.on_mesh(start.orbit.form.mesh, end.orbit.interval_count, end.orbit.stage_count)
    # The asymmetry changes sign where the branch passes a symmetric cycle, and is small near this cycle.
    max_asymmetry = BRANCH_END_SETTINGS.lost_asymmetry_ratio * float(start_asymmetry @ start_asymmetry)
    if float(bending_moment_asymmetry(orbit_on_mesh) @ start_asymmetry) < max_asymmetry:
        return True
    # Past the symmetric cycle the branch runs back as its own mirror image, so the parameter turns there.
    turns_back = start.parameter_per_arc_length * end.parameter_per_arc_length < 0 and _is_nearly_symmetric(
        start
    )
    return turns_back and _symmetry_breaking_index_ahead(start, breakings, accuracy) >= 0


def _asymmetry_per_bending_moment(start: BranchCycle) -> float:
    """Largest nodal asymmetry of the cycle `start`, divided by its largest bending moment."""
    orbit = start.orbit
    return float(
        np.abs(bending_moment_asymmetry(orbit)).max()
        / np.abs(_bending_moments(orbit.all_states, orbit)).max()
    )


def _is_nearly_symmetric(start: BranchCycle) -> bool:
    return _asymmetry_per_bending_moment(start) <= BRANCH_END_SETTINGS.max_asymmetry_before_extrapolation


def symmetry_breaking_index_between(
    start: BranchCycle, end: BranchCycle, breakings: Sequence[SymmetryBreaking], accuracy: float
) -> int | None:
    """Index of the symmetry breaking in `breakings` between the cycles `start` and `end` of an asymmetric
    branch; -1 if `breakings` does not contain this symmetry breaking; None if `start` is so asymmetric that a
    shorter step is needed. Raises Unsolvable if no shorter step is allowed. accuracy: relative accuracy of
    the branch."""
    index = _symmetry_breaking_index_ahead(start, breakings, accuracy) if _is_nearly_symmetric(start) else -1
    if index >= 0 or _asymmetry_per_bending_moment(start) <= BRANCH_END_SETTINGS.min_asymmetry_per_moment:
        return index
    if arc_length_between(start, end) / 2 < ARC_STEP_CONTROL.min_length:
        raise Unsolvable(
            "the cycles pass a symmetric cycle within the shortest step along the branch, far from symmetry"
        )
    return None


def ends_within_extrapolation_tolerances(
    extrapolated: tuple[float, float], last: tuple[float, float], end: tuple[float, float], accuracy: float
) -> bool:
    """Whether a branch ends at a Hopf point or a symmetry breaking, within tolerances.

    extrapolated, last, end: (parameter coordinate, period) as extrapolated along the branch from its last
    cycle, at this cycle, and at the Hopf point or symmetry breaking. accuracy: relative accuracy of the
    branch.
    """
    settings = BRANCH_END_SETTINGS
    # The extrapolation is exact at the end, where only the errors of the last cycle and of the end remain.
    tolerances = settings.extrapolated_parameter_tolerance, settings.extrapolated_period_tolerance
    return all(
        abs(value - end_value)
        <= settings.relative_extrapolation_tolerance * abs(last_value - end_value)
        + max(tolerance, accuracy) * abs(end_value)
        for value, last_value, end_value, tolerance in zip(extrapolated, last, end, tolerances, strict=True)
    )


def _symmetry_breaking_index_ahead(
    start: BranchCycle, breakings: Sequence[SymmetryBreaking], accuracy: float
) -> int:
    """Index of the first symmetry breaking in `breakings` whose parameter and period agree, within
    tolerances, with the parameter and period at which the asymmetry, extrapolated from `start`, vanishes; -1
    if none agrees or the asymmetry does not decrease. accuracy: relative accuracy of the branch."""
    orbit = start.orbit
    current_asymmetry = bending_moment_asymmetry(orbit)
    # The asymmetry is linear in the states, so that of the tangent is its derivative.
    change = bending_moment_asymmetry(replace(orbit, values=start.tangent[:-1]))
    # Minus half the derivative of the squared asymmetry: positive if a symmetric cycle lies ahead.
    decrease = -float(current_asymmetry @ change)
    if decrease <= 0:
        return -1
    # Parameter and period are quadratic in the asymmetry.
    period, coordinate = (orbit.period, start.parameter_coordinate) + float(
        current_asymmetry @ current_asymmetry
    ) / decrease / 2 * start.tangent[-2:]
    for index, breaking in enumerate(breakings):
        symmetric_orbit = breaking.special_point.orbit
        if symmetric_orbit is None:
            continue
        symmetric_coordinate = symmetric_orbit.form.rod.coordinate(start.scale.parameter_name)
        symmetric = symmetric_coordinate, symmetric_orbit.period
        if ends_within_extrapolation_tolerances(
            (coordinate, period), (start.parameter_coordinate, orbit.period), symmetric, accuracy
        ):
            return index
    return -1
