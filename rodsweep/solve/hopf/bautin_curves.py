"""Curves of generalised Hopf points over three parameters.

Generalised Hopf points, D(i eta) = 0 and Re c = 0 (D: determinant, c: Landau coefficient), form a curve over
three parameters. Each step prescribes the parameter that changes fastest, so folds in all parameters are
possible. The predictor is the line through the last two points; the corrector moves along the Hopf curve.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import IntEnum
from itertools import pairwise

import numpy as np

from ...arrays import Array
from ...determinant.parameter_plane import Plane, PlaneAxis
from ...determinant.stability_boundary import Boundary
from ...model.rod import Rod
from ...solve_progress import SolvePosition, report
from ..continuation.follower import CurveStop, StepResult, follow_curve
from ..point_outcome import FAILURES
from ..unsolvable import Unsolvable
from .bautin_points import GENERALISED_HOPF_SETTINGS, GeneralisedHopfPoint, HopfCurve
from .bautin_settings import BAUTIN_SETTINGS, BAUTIN_STEP_CONTROL


class BautinEnd(IntEnum):
    """Reason why a curve ends. none: no end. range_end: end of the third parameter's range. plane_edge: end
    of another range. not_found: no further point. list_full: too many points. closed: at its first point."""

    none = 0
    range_end = 1
    plane_edge = 2
    not_found = 3
    list_full = 4
    closed = 5


END_BY_STOP_REASON = {
    CurveStop.closed: BautinEnd.closed,
    CurveStop.no_further_solution: BautinEnd.not_found,
    CurveStop.max_solutions: BautinEnd.list_full,
}
"""`BautinEnd` for each `CurveStop` except `zero_margin`, which means an end of a parameter's range."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BautinCurvePoint:
    """A generalised Hopf point over three parameters. values, errors: both parameters of the plane, then the
    third parameter, (3,). frequency in 1/tau2, landau_imag = Im c in 1/(tau2 L^2)."""

    values: Array
    errors: Array
    frequency: float
    landau_imag: float


@dataclass(frozen=True, slots=True)
class BautinCurve:
    """Points of a curve in order, and the reasons for its two ends."""

    points: tuple[BautinCurvePoint, ...]
    end_reasons: tuple[BautinEnd, BautinEnd]


@dataclass(frozen=True, slots=True)
class _CurvePoint:
    """Generalised Hopf point. v: continuation coordinates, (4,): three scaled parameters, log frequency."""

    v: Array
    point: BautinCurvePoint


@dataclass(frozen=True, slots=True)
class BautinProblem:
    """Problem for `follow_curve`: generalised Hopf points over three parameters. axes: these parameters, with
    ranges. rod: all other parameters. requested_values: values of the third parameter of further points,
    (m,). accuracy: relative accuracy of c. direction: sign of the first step along the third parameter."""

    rod: Rod
    axes: tuple[PlaneAxis, PlaneAxis, PlaneAxis]
    requested_values: Array
    accuracy: float
    direction: float = 1.0

    def scaled_coordinates(self, values: Array, frequency: float) -> Array:
        """Coordinates v, (4,): the parameters `values`, (3,), scaled to [0, 1], and log `frequency`."""
        places = [axis.coordinate(float(value)) for axis, value in zip(self.axes, values, strict=True)]
        return np.array([*places, np.log(frequency)])

    def solve_point(self, guess: Array, held: int) -> _CurvePoint:
        """The generalised Hopf point near the coordinates `guess`, (4,), with the parameter of index `held`
        fixed; raises Unsolvable."""
        free = [i for i in range(3) if i != held]
        values = {axis.name: axis.value(float(x)) for axis, x in zip(self.axes, guess[:3], strict=True)}
        plane = Plane(self.rod.with_values(**values), (self.axes[free[0]], self.axes[free[1]]))
        boundary = Boundary(plane, 0.0)
        # Without points of the curve: the search needs only Hopf points near a guess.
        accuracy = min(self.accuracy, GENERALISED_HOPF_SETTINGS.coarsest_accuracy)
        hopf = HopfCurve(boundary, np.empty((0, 3)), accuracy)
        start = guess[[*free, 3]]
        point = self._zero_by_secants(hopf, start, boundary.tangent(start))
        found_values = np.empty(3)
        errors = np.zeros(3)
        found_values[free] = point.values
        errors[free] = point.errors
        found_values[held] = values[self.axes[held].name]
        found = BautinCurvePoint(
            values=found_values, errors=errors, frequency=point.frequency, landau_imag=point.landau_imag
        )
        return _CurvePoint(self.scaled_coordinates(found_values, point.frequency), found)

    def step(self, behind: Sequence[_CurvePoint], length: float) -> StepResult[_CurvePoint]:
        """The next point after `behind`, predicted along the last chord, at first along the third parameter;
        raises Unsolvable. length: largest predicted change of a parameter, divided by its range."""
        here = behind[-1].v
        tangent = np.array([0.0, 0.0, self.direction, 0.0])
        if len(behind) > 1:
            chord = here - behind[-2].v
            # Step lengths are shares of a parameter's range; the frequency has no range.
            tangent = chord / np.abs(chord[:3]).max()
        try:
            there, on_edge = self._point_in_ranges(here, length * tangent)
        except ValueError as why:
            raise Unsolvable(f"the step leaves the allowed range of the parameters: {why}") from why
        missed = float(np.abs(there.v[:3] - here[:3] - length * tangent[:3]).max()) / length
        # No prediction error for the first step, which has no chord, and for a step that an edge shortened.
        return StepResult(there, 0.0 if on_edge or len(behind) == 1 else missed, 1.0)

    def _point_in_ranges(self, here: Array, change: Array) -> tuple[_CurvePoint, bool]:
        """(point near here + change, (4,), or on the range end that the step crosses; whether on an end).

        No point outside the ranges is solved: its parameters may describe no rod. Raises Unsolvable.
        """
        ahead = (here + change)[:3]
        beyond = np.where(ahead > 1, 1.0, np.where(ahead < 0, 0.0, np.nan))
        shares = (beyond - here[:3]) / np.where(change[:3] == 0, 1.0, change[:3])
        # The parameter that changes most is fixed: at a fold in another parameter the point is unique.
        if np.isnan(shares).all():
            return self.solve_point(here + change, int(np.argmax(np.abs(change[:3])))), False
        which = int(np.nanargmin(shares))
        guess = here + shares[which] * change
        guess[which] = beyond[which]
        return self.solve_point(guess, which), True

    def margins(self, point: _CurvePoint) -> Array:
        """Distances of a point from both ends of each of the three ranges, minus a tolerance, (6,)."""
        return np.ravel([point.v[:3], 1 - point.v[:3]], order="F") - BAUTIN_SETTINGS.edge_tolerance

    def located_zero(
        self, behind: Sequence[_CurvePoint], outer: _CurvePoint, margin: int
    ) -> _CurvePoint | None:
        """The point `outer` itself: `_point_in_ranges` has shortened the step to the end of a range."""
        return outer

    def is_closed_by(self, behind: Sequence[_CurvePoint], there: _CurvePoint) -> bool:
        """Whether the curve has more than `BAUTIN_SETTINGS.min_loop_points` points, and the first point of
        the curve lies between its last point and `there`."""
        first = behind[0].v
        last = behind[-1].v
        step = float(np.linalg.norm(there.v - behind[-1].v))
        near = max(np.linalg.norm(first - last), np.linalg.norm(first - there.v)) < step
        return len(behind) > BAUTIN_SETTINGS.min_loop_points and bool(near)

    @staticmethod
    def _zero_by_secants(hopf: HopfCurve, start: Array, way: Array) -> GeneralisedHopfPoint:
        """The point with Re c = 0 near start + s way, (3,) each, by secant steps of s; raises Unsolvable."""
        # Secants, because the normal form does not give the derivatives of Re c.
        before = 0.0
        s = BAUTIN_SETTINGS.first_secant_step
        last = hopf.hopf_point_on_plane(start, way, hopf.accuracy).relative_real_part
        for _ in range(BAUTIN_SETTINGS.max_secant_steps):
            here = hopf.hopf_point_on_plane(start + s * way, way, hopf.accuracy)
            if here.relative_real_part == last:
                break
            slope = (here.relative_real_part - last) / (s - before)
            step = -here.relative_real_part / slope
            if not abs(s + step) < BAUTIN_STEP_CONTROL.max_length:
                break
            along = here.coefficients.landau_error / abs(slope)
            if abs(step) <= max(BAUTIN_SETTINGS.tolerance, along):
                return hopf.as_generalised_hopf(here, 0, way * (along + abs(step)))
            last = here.relative_real_part
            before = s
            s = s + step
        raise Unsolvable("no generalised Hopf point is found near the predicted point")


def bautin_curve(problem: BautinProblem, start: BautinCurvePoint) -> BautinCurve:
    """The curve of generalised Hopf points through `start`, followed in both directions."""
    here = _CurvePoint(problem.scaled_coordinates(start.values, start.frequency), start)
    back, first = _follow_in_direction(replace(problem, direction=-1.0), here)
    if first is BautinEnd.closed:
        return BautinCurve(tuple(point.point for point in back), (first, first))
    on, last = _follow_in_direction(problem, here)
    # Both lists begin with the start, which is taken once.
    return BautinCurve(tuple(point.point for point in [*back[:0:-1], *on]), (first, last))


def as_curve_point(point: GeneralisedHopfPoint, third: float) -> BautinCurvePoint:
    """A generalised Hopf point of a plane as a point of a curve. third: value of the third parameter."""
    return BautinCurvePoint(
        values=np.array([*point.values, third]),
        errors=np.array([*point.errors, 0.0]),
        frequency=point.frequency,
        landau_imag=point.landau_imag,
    )


def lies_on_curve(problem: BautinProblem, point: BautinCurvePoint, curve: BautinCurve) -> bool:
    """Whether `point`, at a requested third parameter, equals a point of `curve`."""
    v = problem.scaled_coordinates(point.values, point.frequency)
    others = [problem.scaled_coordinates(other.values, other.frequency) for other in curve.points]
    return any(float(np.abs(v - other).max()) < BAUTIN_SETTINGS.same_point_distance for other in others)


def _follow_in_direction(problem: BautinProblem, start: _CurvePoint) -> tuple[list[_CurvePoint], BautinEnd]:
    """(points from `start` in the direction `problem.direction` of the third parameter, including points
    at its requested values; reason for the end of the curve)."""
    if not 0 < start.v[2] + problem.direction * BAUTIN_STEP_CONTROL.min_length < 1:
        return [start], BautinEnd.range_end
    curve = follow_curve(problem, start, BAUTIN_STEP_CONTROL, _report_point_count)
    places = curve.solutions[:1]
    for here, there in pairwise(curve.solutions):
        try:
            places += [*_requested_points(problem, here, there), there]
        except (*FAILURES, ValueError):
            return places, BautinEnd.not_found
    if curve.end_reason is CurveStop.zero_margin:
        return places, BautinEnd.range_end if curve.margin_index // 2 == 2 else BautinEnd.plane_edge
    return places, END_BY_STOP_REASON[curve.end_reason]


def _report_point_count(places: Sequence[_CurvePoint]) -> None:
    """Reports the number of points of the curve as progress."""
    report(lambda: SolvePosition(f"curve of generalised Hopf points, {len(places)} points"))


def _requested_points(problem: BautinProblem, here: _CurvePoint, there: _CurvePoint) -> list[_CurvePoint]:
    """Points at the requested third parameters between `here` and `there`; raises Unsolvable, ValueError."""
    a = here.v[2]
    b = there.v[2]
    new = [z for z in map(problem.axes[2].coordinate, problem.requested_values) if min(a, b) < z < max(a, b)]
    found = []
    for z in sorted(new, reverse=bool(a > b)):
        if min(abs(z - a), abs(z - b)) > BAUTIN_SETTINGS.same_point_distance:
            guess = here.v + (z - a) / (b - a) * (there.v - here.v)
            guess[2] = z
            found.append(problem.solve_point(guess, 2))
    return found
