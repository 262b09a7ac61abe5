"""Status of a search for thresholds, with a sentence of cause and remedy for the user."""

from ..status import PointStatus


class ThresholdStatus(PointStatus):
    """Status of a search for all thresholds along a path of rods."""

    ok = (
        0,
        "all thresholds have the requested accuracy, and their list is certified if requested",
        True,
    )
    not_certified = (
        1,
        "the thresholds are accurate, but a count of the unstable modes between them is undecided or "
        "contradicts the list, or it is not proved which eigenvalue leads; `certify: false` accepts such a "
        "list",
    )
    window_open = (
        2,
        "within the open range two crossings nearly coincide, so it is undecided whether the rod flutters "
        "between them; move a parameter slightly",
    )
    accuracy_not_reached = (
        3,
        "a threshold misses the requested accuracy, as its error says, for example where two thresholds "
        "nearly coincide; use a larger number for the accuracy",
    )
    list_full = 4, "there are more thresholds than the list holds; raise the option crossings"
    failed = 5, "the search failed and nothing is stored; the message says why"
    ended_early = (
        9,
        "the search ends before the requested range, at a rod whose unstable modes could not be counted, or "
        "once the list is full; thresholds beyond this end are not known; the message says why",
    )
