"""The task `branch` for one rod: all branches of cycles from Hopf points along a parameter, to their ends.
The Hopf points come from the search of `task: thresholds`. A branch between two Hopf points is followed
only once, from the first Hopf point. At a symmetry breaking on such a branch, the branch of asymmetric cycles
is followed too. Cycles on other branches are found only if a special point on the branch is known."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache
from math import nan

from ...determinant.parameter_path import ParameterPath
from ...discretization.stress.form import has_small_rotational_drag
from ...model.crushing import uncrushed_interval
from ...model.rod import Rod
from ..changes.threshold_kinds import Threshold
from ..changes.thresholds_along_path import ThresholdSearchResult, find_imaginary_axis_crossings
from ..orbit.matrix.workspace import NewtonWorkspace
from ..point_outcome import FAILURE_EXCEPTIONS, cause_of, outcome_or_failure
from .branch_curve import BranchCurve
from .branch_limits import BranchLimits, BranchRequest
from .branch_search import BranchSearch
from .regions_beyond_range import regions_beyond_range
from .special.special_point import SPECIAL_POINT_SETTINGS, SpecialPoint
from .start.hopf_point import HopfBranchStart, accuracy_near_hopf_points, hopf_branch_start
from .status import BranchEndReason, BranchStatus


@dataclass(frozen=True, slots=True, kw_only=True)
class BranchSettings:
    """Settings for all branches of a rod."""

    crushing_margin: float = 1e-4
    """A branch ends where the relative distance of F from the crushing force is this number, because the rod
    at rest is then almost crushed. Branches along F, k1 or taper have this margin."""
    min_coordinate_unit_per_range_length: float = 0.01
    """Lower limit of the unit of the parameter coordinate (`min_coordinate_unit` of an `ArcLengthScale`),
    divided by the length of the range. If the unit were always the modulus of the coordinate, steps towards
    gamma3 = 0 would become ever shorter and not reach 0."""
    max_cycles_per_diagram_row: int = 500
    """Maximum number of cycles on all branches of one row of a phase diagram."""


BRANCH_SETTINGS = BranchSettings()


@dataclass(frozen=True, slots=True, kw_only=True)
class BranchesOfRod:
    """Outcome of the task `branch` for one rod. crossings: Hopf points within the range, by ascending
    parameter. unstable_modes_at_start: number of unstable modes of the straight rod at the start, -1 if
    unknown. are_crossings_proved_complete: whether `crossings` is proved complete. curves: all branches.
    seconds: computing time, in s."""

    status: BranchStatus
    """Status of the first problem, in the order of `BranchStatus`; `ok` without a problem."""
    message: str = ""
    """Message for the user about all problems; "" without a problem."""
    seconds: float = 0.0
    crossings: tuple[Threshold, ...] = ()
    unstable_modes_at_start: int = -1
    are_crossings_proved_complete: bool = False
    curves: tuple[BranchCurve, ...] = field(default_factory=tuple)
    followed_range: tuple[float, float] = (nan, nan)
    """Smallest and largest value of the parameter up to which branches are followed, inside the range and
    beyond its ends. A branch that enters the range, but is missing in `curves`, passes one of these two
    values."""
    folds_beyond_range: tuple[SpecialPoint, ...] = ()
    """Located folds of the branches followed beyond the range."""


def solve_branches(
    rod: Rod,
    request: BranchRequest,
    workspace: NewtonWorkspace | None = None,
    starts: Sequence[SpecialPoint] = (),
) -> BranchesOfRod:
    """All branches that start at Hopf points of a rod along the parameter `request.along`, and the branches
    through the special points `starts`; a failure becomes a status, never an exception. The rod's own value
    of this parameter is not used. workspace: memory of Newton's matrices, which rods may share; None: a new
    workspace."""
    memory = workspace or NewtonWorkspace()
    memory.limit_work(request.max_multiplications)
    try:
        return outcome_or_failure(
            lambda: _solve_branches_or_raise(rod, request, memory, starts),
            lambda cause: BranchesOfRod(status=BranchStatus.failed, message=cause),
        )
    finally:
        # The limit of the work belongs to this rod, and a large buffer is freed for other solvers.
        memory.release()


@cache
def warm_up() -> None:
    """Solves one rod, so that compiled code is loaded and solver objects exist before the first point."""
    solve_branches(
        Rod(F=0.0, k1=1e4, k2=1e4, gamma3=1e-4), BranchRequest("F", 0.0, 40.0, 1e-5, False, 100, 10)
    )


def _solve_branches_or_raise(
    rod: Rod, request: BranchRequest, workspace: NewtonWorkspace, starts: Sequence[SpecialPoint]
) -> BranchesOfRod:
    low, high = uncrushed_interval(
        rod.material,
        {"F": rod.F, "k1": rod.k1, "taper": rod.taper},
        (request.along, request.start, request.stop),
        BRANCH_SETTINGS.crushing_margin,
    )
    if not low < high:
        reason = f"the force crushes the rod everywhere in the range of {request.along}"
        return BranchesOfRod(status=BranchStatus.ok, message=reason, are_crossings_proved_complete=True)
    # The rod's own value along the path may be one at which it is crushed.
    path = ParameterPath(rod.with_values(**{request.along: low}), request.along)
    crossings = find_imaginary_axis_crossings(path, low, high, request.certify)
    ends = (path.coordinate(low), path.coordinate(high))
    # The smallest drag of the range is at one of its ends.
    is_omega_always_unknown = any(has_small_rotational_drag(path.rod_at(end)) for end in ends)
    # The coordinate may pass 0, where a relative step would have no length.
    unit = BRANCH_SETTINGS.min_coordinate_unit_per_range_length * abs(ends[1] - ends[0])
    hopfs, failures = _hopf_branch_starts(path, crossings, is_omega_always_unknown, unit)
    end_reasons = _range_end_reason(low > request.start), _range_end_reason(high < request.stop)
    # The compliance 1/k decreases with k, so both ends and their reasons change places.
    if path.is_compliance_path:
        ends = ends[::-1]
        end_reasons = end_reasons[::-1]
    accuracy = accuracy_near_hopf_points(hopfs, request.accuracy)
    limits = BranchLimits(
        hopfs, ends, end_reasons, accuracy, request.cycles, workspace, unit, is_omega_always_unknown
    )
    regions = regions_beyond_range(path, limits, BRANCH_SETTINGS.crushing_margin)
    search = BranchSearch(limits, request.along, regions)
    search.follow_all(starts)
    status, message = _status_and_message(crossings, search.curves, failures + search.failures, request)
    return BranchesOfRod(
        status=status,
        message=message,
        crossings=crossings.thresholds,
        # A search that began later has counted at another value.
        unstable_modes_at_start=crossings.unstable_at_start if crossings.searched_interval[0] == low else -1,
        are_crossings_proved_complete=crossings.is_proved_to_the_end,
        curves=tuple(search.curves),
        followed_range=search.followed_range,
        folds_beyond_range=tuple(search.folds_beyond_range),
    )


def _range_end_reason(is_crushed: bool) -> BranchEndReason:
    """Reason for the end of a branch at an end of the range. is_crushed: whether the force crushes the rod
    there."""
    return BranchEndReason.crushed if is_crushed else BranchEndReason.range_end


def _hopf_branch_starts(
    path: ParameterPath, crossings: ThresholdSearchResult, is_omega_always_unknown: bool, unit: float
) -> tuple[list[HopfBranchStart], list[str]]:
    """Returns (Hopf points `crossings` with their normal forms, messages on Hopf points whose normal form
    failed). is_omega_always_unknown: whether the angular velocity Omega is an unknown for all cycles. unit:
    lower limit of the unit of the parameter coordinate (`min_coordinate_unit` of an `ArcLengthScale`)."""
    hopfs = []
    failures = []
    for crossing in crossings.thresholds:
        try:
            hopfs.append(hopf_branch_start(path, crossing, is_omega_always_unknown, unit))
        except FAILURE_EXCEPTIONS as error:
            place = f"{path.parameter_name} = {crossing.value:.12g}"
            failures.append(f"no branch is followed from the Hopf point at {place}: {cause_of(error)}")
    return hopfs, failures


def _status_and_message(
    crossings: ThresholdSearchResult, curves: list[BranchCurve], failures: list[str], request: BranchRequest
) -> tuple[BranchStatus, str]:
    """Returns (status, message) for all branches of a rod: status of the first problem in the order of
    `BranchStatus`, and all messages. crossings: result of the search for Hopf points. curves: the branches.
    failures: messages on Hopf points without a normal form, and on known special points without a branch."""
    messages = [
        f"branch {number}: {special.message} at {request.along} = {special.parameter_value:.9g}"
        for number, curve in enumerate(curves, 1)
        for special in curve.special_points
        if special.message
    ]
    special_points = [point for curve in curves for point in curve.special_points]
    # Special points are solved to their own accuracy even if less is asked of the branch.
    tolerance = max(request.accuracy, SPECIAL_POINT_SETTINGS.accuracy)
    is_inaccurate = any(
        point.error > tolerance * abs(point.parameter_value) or point.is_unlocated for point in special_points
    )
    if any(not curve.are_unit_circle_crossings_explained for curve in curves):
        messages.append("multipliers cross the unit circle where no special point was found")
    applies_by_status = {
        BranchStatus.stopped: bool(failures)
        or any(not curve.is_complete and not curve.reached_max_cycles for curve in curves),
        BranchStatus.list_full: any(curve.reached_max_cycles for curve in curves)
        or len(special_points) > request.special,
        BranchStatus.special_undecided: is_inaccurate
        or any(not curve.are_unit_circle_crossings_explained for curve in curves),
        BranchStatus.search_open: crossings.ended_early or (request.certify and not crossings.is_proved),
    }
    status = next((status for status, applies in applies_by_status.items() if applies), BranchStatus.ok)
    return status, "; ".join(filter(None, [*failures, *messages, crossings.doubt_text]))
