"""Status of a search for thresholds, with a sentence of cause and remedy for the user."""

from ..status import PointStatus


class ThresholdStatus(PointStatus):
    """Status of a search for all thresholds along a path of rods."""

    ok = 0, "all thresholds have the requested accuracy; if certified, none is missing", True
    not_certified = (
        1,
        "the thresholds are accurate, but a count of the unstable modes between them is undecided or "
        "contradicts the list, or it is not proved which eigenvalue leads; `certify: false` accepts results "
        "without this proof",
    )
    window_open = (
        2,
        "two crossings nearly coincide, so it is undecided whether the rod flutters between them, in the "
        "range from open_from to open_to; change a parameter slightly",
    )
    accuracy_not_reached = (
        3,
        "the error estimate of a threshold exceeds the requested accuracy, for example where two thresholds "
        "nearly coincide; use a larger number for the accuracy",
    )
    list_full = 4, "the list has no room for all thresholds; raise the option crossings"
    failed = (
        5,
        "the search failed and nothing is stored; the message says why; try another accuracy or a "
        "shorter range, or move a parameter slightly",
    )
    ended_early = (
        9,
        "only a part of the requested range is searched, because unstable modes could not be counted in the "
        "other part, or because the list of crossings was full; thresholds in the other part are not known; "
        "the message says where the searched part begins or ends, and why",
    )
