"""Reasons for the end of a branch of cycles; their stored names are in `rodsweep.results.layouts.branch`."""

from enum import IntEnum

from ..unsolvable import Unsolvable, WorkLimitReached


class BranchEndReason(IntEnum):
    """Reason for the end of a branch at a special point of kind `end`. range_end (end of the parameter range)
    and crushed (the force nearly crushes the rod) are true ends; no_cycle_found and list_full (maximum number
    of cycles, or limit of the work on the rod) are failures."""

    range_end = 1
    crushed = 2
    no_cycle_found = 3
    list_full = 4


def reason_of_failure(reason: Unsolvable) -> BranchEndReason:
    """Reason for the end of a branch at which no further cycle could be solved because of the error
    `reason`."""
    is_limit = isinstance(reason, WorkLimitReached) or isinstance(reason.__cause__, WorkLimitReached)
    return BranchEndReason.list_full if is_limit else BranchEndReason.no_cycle_found
