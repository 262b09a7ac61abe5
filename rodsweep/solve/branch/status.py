"""Status of the branches of one rod and of a row of a phase diagram with cycles, with a sentence of cause and
remedy for the user."""

from enum import IntEnum

from ..changes.status import ThresholdStatus
from ..status import PointStatus
from ..unsolvable import Unsolvable, WorkLimitReached


class BranchEndReason(IntEnum):
    """Reason why a branch ends at a special point of kind `end`. range_end: end of the parameter range.
    crushed: the force nearly crushes the rod. These two are ends of the branch within the range;
    no_cycle_found and list_full (maximum number of cycles, or limit of the work on the rod) are failures of
    the continuation."""

    range_end = 1
    crushed = 2
    no_cycle_found = 3
    list_full = 4


def reason_of_failure(reason: Unsolvable) -> BranchEndReason:
    """Reason for the end of a branch at which no further cycle could be solved because of the error
    `reason`."""
    is_limit = isinstance(reason, WorkLimitReached) or isinstance(reason.__cause__, WorkLimitReached)
    return BranchEndReason.list_full if is_limit else BranchEndReason.no_cycle_found


class BranchStatus(PointStatus):
    """Outcome of the search for Hopf points of one rod and of the continuation of its branches."""

    ok = (
        0,
        "every branch from a Hopf point within the range, and every branch from a symmetry breaking on these "
        "branches, is followed to its end to the requested accuracy, and all special points are located",
        True,
    )
    stopped = (
        1,
        "a branch was not followed to its end, because the next cycle was not found or needs a finer mesh "
        "than allowed, or because the limit on the work was reached; the message says where; all other "
        "branches are complete; raise the option `work` if the limit was reached, use a larger number for "
        "the accuracy if no mesh reaches it, otherwise a smaller or larger number, or shorten the range",
    )
    list_full = (
        2,
        "the lists have no room for all cycles or special points; raise the options `cycles` or `special`",
    )
    special_undecided = (
        3,
        "the error of a special point exceeds the requested accuracy, or multipliers cross the unit circle "
        "where no special point was found; try a smaller number for the accuracy",
    )
    search_open = (
        4,
        "the branches are complete, but a Hopf point may be missing: two Hopf points may nearly coincide, "
        "the search may have stopped before the end of the range, or a count of unstable modes may "
        "disagree with the list; `certify: false` accepts results without this proof",
    )
    failed = (
        5,
        "the search for Hopf points failed and nothing is stored; the message says why; try another accuracy "
        "or a shorter range, or move a parameter slightly",
    )


def _values_of_threshold_status(status: ThresholdStatus) -> tuple[int, str, bool]:
    """Returns (value, sentence, success) of a `ThresholdStatus`, from which the `CoexistenceStatus` of the
    same name is made."""
    return int(status), status.sentence, status.succeeded


class CoexistenceStatus(PointStatus):
    """Outcome of a row with cycles: the status of the search for thresholds of the straight rod if this
    search has a problem, otherwise the status of the branches."""

    ok = _values_of_threshold_status(ThresholdStatus.ok)
    not_certified = _values_of_threshold_status(ThresholdStatus.not_certified)
    window_open = _values_of_threshold_status(ThresholdStatus.window_open)
    accuracy_not_reached = _values_of_threshold_status(ThresholdStatus.accuracy_not_reached)
    list_full = _values_of_threshold_status(ThresholdStatus.list_full)
    failed = _values_of_threshold_status(ThresholdStatus.failed)
    ended_early = _values_of_threshold_status(ThresholdStatus.ended_early)
    branches_stopped = (
        6,
        "the thresholds of the straight rod are found, but a branch of cycles is incomplete or a Hopf point "
        "may be missing: the stable states are undecided where no stable cycle is known; the message says "
        "where",
    )
    special_undecided = (
        7,
        "the branches are complete, but the error of a special point exceeds the requested accuracy, or a "
        "stable state is undecided: multipliers of cycles between two special points disagree about "
        "stability or have modulus 1 within their errors; try a smaller number for the accuracy",
    )
    special_full = (
        8,
        "the list has no room for all special points on the branches of the row; choose a smaller range of "
        "the parameter along the row",
    )
