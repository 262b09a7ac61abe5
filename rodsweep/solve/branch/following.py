"""A branch of cycles, followed from a Hopf point or symmetry breaking to the end."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import nan

from ...model.parameters import PARAMETERS
from ...watch import SolvePosition, report
from ...wording import counted
from ..orbit.matrix.workspace import NewtonWorkspace
from ..orbit.orbit_mesh import mesh_of
from ..point import Unsolvable
from .arc import ARC_STEPS, ArcPoint, arc_between, next_point, point_at
from .beginning import HopfBirth, first_cycle, special_hopf
from .branch_curve import BranchCurve, BranchEnd
from .range_end import cycle_at_range_end, range_end_condition
from .settling import measurement_due
from .special.least_stretch import stretch_at
from .special.locating import located
from .special.point import EndReason, SpecialKind, SpecialPoint
from .special.points import special_points
from .symmetry import ENDINGS, SymmetryBreaking, beginning_without_symmetry, breaking_between, mirrored
from .trail import Trail, end_at
from .work import share_done


@dataclass(frozen=True, slots=True)
class BranchLimits:
    """Limits within which branches are followed, and known points where they may end."""

    hopfs: Sequence[HopfBirth]
    """Hopf points of the rod."""
    ends: tuple[float, float]
    """Coordinates of the parameter at which branches end."""
    reasons: tuple[EndReason, EndReason]
    """Why branches end at each of the two coordinates."""
    accuracy: float
    max_cycles: int
    """Maximum number of stored cycles of a branch."""
    workspace: NewtonWorkspace
    """Memory of all matrices."""
    breakings: Sequence[SymmetryBreaking] = ()
    """Known symmetry breakings of the rod."""


def follow_branch(number: int, limits: BranchLimits) -> BranchCurve:
    """The branch from Hopf point `number` of the list; a failure is its last special point."""
    hopf = limits.hopfs[number]
    curve = BranchCurve(hopf=number)
    curve.add(special_hopf(hopf))
    return _followed(curve, limits, lambda: first_cycle(hopf, limits.accuracy, limits.workspace))


def follow_without_symmetry(which: int, name: str, limits: BranchLimits) -> BranchCurve:
    """The branch of asymmetric cycles along the parameter `name`, from symmetry breaking
    `limits.breakings[which]`."""
    breaking = limits.breakings[which]
    curve = BranchCurve(hopf=-1, breaking=breaking)
    curve.add(replace(breaking.point, message="", orbit=None))

    def first() -> ArcPoint:
        return beginning_without_symmetry(breaking, name, limits.accuracy, limits.workspace)

    return _followed(curve, limits, first)


def _followed(curve: BranchCurve, limits: BranchLimits, first: Callable[[], ArcPoint]) -> BranchCurve:
    """A branch from a special point to its end. first: gives the first cycle or raises Unsolvable."""
    if limits.max_cycles < 1:
        curve.end(BranchEnd(_end_beside(curve, EndReason.list_full), complete=False, full=True))
        return curve
    try:
        start = first()
    except Unsolvable as why:
        curve.end(BranchEnd(_end_beside(curve, EndReason.no_cycle_found, str(why)), complete=False))
        return curve
    outside = _beyond(start, limits)
    if outside >= 0:
        curve.end(BranchEnd(_end_beside(curve, limits.reasons[outside]), complete=True))
        return curve
    return followed_from(curve, start, limits)


def followed_from(curve: BranchCurve, first: ArcPoint, limits: BranchLimits) -> BranchCurve:
    """A branch followed to its end from a first cycle with measured errors."""
    trail = Trail(curve, limits.accuracy, first)
    going: ArcPoint | BranchEnd = first
    while isinstance(going, ArcPoint):
        report(partial(_place_on, curve, going, limits))
        going = _next(trail, going, limits)
    trail.end(going)
    return curve


def _place_on(curve: BranchCurve, start: ArcPoint, limits: BranchLimits) -> SolvePosition:
    """Position of a branch's last cycle, and the fraction of the branch's work that is done."""
    name = start.scale.name
    # The end of the range towards which the parameter moves at present; behind a fold it is the other one.
    aim = limits.ends[1 if start.ahead[-1] > 0 else 0]
    value = PARAMETERS[name].value(start.at)
    aim_value = PARAMETERS[name].value(aim)
    words = f"{name} = {value:.5g} on the way to {aim_value:.5g}, {counted(len(curve.points), 'cycle')}"
    return SolvePosition(words, share_done(PARAMETERS[name].coordinate(curve.special[0].at), start.at, aim))


def _end_beside(curve: BranchCurve, reason: EndReason, message: str = "") -> SpecialPoint:
    """The end of a branch that has no cycle, at its first special point."""
    born = curve.special[0]
    return replace(
        born,
        kind=SpecialKind.end,
        reason=reason,
        message=message,
        amplitude_coefficient=nan,
        coefficient_error=nan,
    )


def _beyond(point: ArcPoint, limits: BranchLimits) -> int:
    """Index of the end of the range that a cycle lies beyond, -1 within the range."""
    low, high = limits.ends
    if point.at < low:
        return 0
    return 1 if point.at > high else -1


def _next(trail: Trail, start: ArcPoint, limits: BranchLimits) -> ArcPoint | BranchEnd:
    """The next cycle, added to the branch with the special points before it; or the end of the branch."""
    curve = trail.curve
    if len(curve.points) >= limits.max_cycles:
        return BranchEnd(end_at(start, EndReason.list_full), complete=False, full=True)
    try:
        end = next_point(start, limits.accuracy)
        if _passed_mirror_image(start, end, limits):
            # Beyond the point of symmetry the branch runs back through its own mirror images.
            return (_end_at_hopf if start.orbit.symmetric else _end_at_breaking)(start, end, limits)
        outside = _beyond(end, limits)
        range_end = range_end_condition(start, limits.ends[outside]) if outside >= 0 else None
        if range_end is not None:
            end = cycle_at_range_end(start, end, range_end, limits.accuracy)
        if range_end is not None and _hides_corner(start, end):
            range_end = None  # after the cycle half way
            end = point_at(start, arc_between(start, end) / 2, limits.accuracy)
        # h1 = 0: the model ends here, whatever the discrete equations still solve.
        if stretch_at(end) <= 0:
            return BranchEnd(located(SpecialKind.left_the_model, start, end, limits.accuracy), complete=True)
        _add_special_points(curve, start, end, limits)
        trail.append(end)
        last = trail.settle(range_end) if range_end is not None or measurement_due(end) else end
    except Unsolvable as why:
        message = f"no further cycle of the branch is found: {why}"
        return BranchEnd(end_at(start, EndReason.no_cycle_found, message), complete=False)
    if range_end is None:
        return last
    at = getattr(last.orbit.form.rod, last.scale.name)
    return BranchEnd(
        replace(end_at(last, limits.reasons[outside]), error=ENDINGS.range_end_error * abs(at)), complete=True
    )


def _add_special_points(curve: BranchCurve, start: ArcPoint, end: ArcPoint, limits: BranchLimits) -> None:
    """Adds the special points between the last stored cycle and the next cycle, which is not stored yet."""

    step = partial(point_at, accuracy=limits.accuracy)
    curve.add_found(*special_points(start, end, step, limits.accuracy))


def _passed_mirror_image(start: ArcPoint, end: ArcPoint, limits: BranchLimits) -> bool:
    """Whether the branch passes its own mirror image between two cycles."""
    if start.orbit.symmetric:
        return turned_round(start, end)
    return mirrored(start, end, limits.breakings, limits.accuracy)


def _hides_corner(start: ArcPoint, end: ArcPoint) -> bool:
    """Whether the largest y has a corner between a cycle and the last one, too far from it to be located.

    At a corner another maximum of y(t) becomes the largest. A figure finds it from two cycles on each side.
    """
    apart = abs(end.cycle.path.time_of_largest_y - start.cycle.path.time_of_largest_y)
    other = min(apart, 1 - apart) > ENDINGS.same_maximum
    return other and arc_between(start, end) > ENDINGS.largest_hidden_corner


def turned_round(start: ArcPoint, end: ArcPoint) -> bool:
    """Whether the bending moments at t = 0 have changed sign between two cycles, as they do beyond a Hopf
    point.

    The tip's y is no criterion: on a large cycle an extremum of y may pass through 0.
    """
    mesh = mesh_of(end.orbit)
    layout = end.orbit.form.layout
    one = layout.field(mesh.carry(start.orbit).start, "m3")
    # The phase fixes t = 0 at the largest y; a sign change of the moments there means that the cycle passed
    # through amplitude 0.
    return float(one @ layout.field(end.orbit.start, "m3")) < 0


def _end_at_hopf(start: ArcPoint, end: ArcPoint, limits: BranchLimits) -> ArcPoint | BranchEnd:
    """The Hopf point between two cycles where the branch ends; or the first cycle, for a shorter step."""
    shorter = arc_between(start, end) / 2
    if start.cycle.measures.tip_y_max > ENDINGS.small_cycle:
        if shorter < ARC_STEPS.shortest:
            raise Unsolvable("the bending moments of the cycle change sign within the shortest step")
        return replace(start, length=shorter)
    # Near a Hopf point parameter and period are quadratic in the deflection.
    tangent = start.tangent
    # Back to deflection d = 0 a parabola p = p0 + k d^2 changes by half of what its tangent says.
    share = start.deflection / (2 * start.ahead[0] * start.scale.deflection)
    at = start.at - share * tangent[-1]
    period = start.orbit.period - share * tangent[-2]
    rounding = max(ENDINGS.min_place_tolerance, limits.accuracy)
    for number, hopf in enumerate(limits.hopfs):
        tolerance = ENDINGS.place_share * abs(start.at - hopf.coordinate) + rounding * abs(hopf.coordinate)
        period_tolerance = ENDINGS.place_share * abs(start.orbit.period - hopf.period)
        period_tolerance += ENDINGS.period_tolerance * hopf.period
        if abs(at - hopf.coordinate) <= tolerance and abs(period - hopf.period) <= period_tolerance:
            return BranchEnd(special_hopf(hopf), complete=True, end_hopf=number)
    why = "the cycles shrink to zero amplitude, but no Hopf point is known there"
    return BranchEnd(end_at(start, EndReason.no_cycle_found, why), complete=False)


def _end_at_breaking(start: ArcPoint, end: ArcPoint, limits: BranchLimits) -> ArcPoint | BranchEnd:
    """The symmetry breaking between two cycles where the branch ends; else the first, for a shorter step."""
    which = breaking_between(start, end, limits.breakings, limits.accuracy)
    if which is None:
        return replace(start, length=arc_between(start, end) / 2)
    if which >= 0:
        breaking = limits.breakings[which]
        special = replace(breaking.point, message="", orbit=None)
        return BranchEnd(special, complete=True, end_breaking=breaking)
    why = "the cycles become symmetric at a cycle of a branch that was not followed"
    return BranchEnd(end_at(start, EndReason.no_cycle_found, why), complete=False)
