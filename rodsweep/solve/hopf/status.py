"""Status of the Hopf points of one rod, with a sentence of cause and remedy for the user."""

from ..status import PointStatus


class CriticalityStatus(PointStatus):
    """Status of the search for the Hopf points of one rod and of the computation of their coefficients."""

    ok = 0, "every Hopf point is found, with coefficients to the requested accuracy", True
    not_certified = (
        1,
        "the coefficients are accurate, but a count of the unstable modes between the Hopf points is "
        "undecided or contradicts the list; `certify: false` accepts such a count",
    )
    window_open = (
        2,
        "two Hopf points nearly coincide, so it is undecided whether the rod flutters between them, in the "
        "range from open_from to open_to; the coefficients of all other Hopf points are stored; change a "
        "parameter slightly",
    )
    accuracy_not_reached = (
        3,
        "the error estimate of a Hopf point or of a coefficient exceeds the requested accuracy; use a larger "
        "number for the accuracy",
    )
    list_full = 4, "the list has no room for all Hopf points; raise the option crossings"
    failed = (
        5,
        "the search for Hopf points failed and nothing is stored; the message says why; "
        "shorten the range, change the accuracy, or move a parameter slightly",
    )
    coefficients_failed = (
        6,
        "the normal form of a Hopf point could not be computed; the other Hopf points are stored; the "
        "message says why",
    )
    sign_undecided = (
        7,
        "the sign of Re c at a Hopf point is within its error, as happens near generalised Hopf points: c is "
        "correct, but the criticality is undecided; move a parameter slightly",
    )
    ended_early = (
        9,
        "the search stopped before the end of the requested range of F, at a rod whose unstable modes "
        "could not be counted, or because the list was full; Hopf points beyond this rod are not known; "
        "the message says why",
    )
