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
        "within the open range two Hopf points nearly coincide, so it is undecided whether the rod flutters "
        "between them; the coefficients of all other Hopf points are stored; move a parameter slightly",
    )
    accuracy_not_reached = (
        3,
        "a Hopf point or a coefficient misses the requested accuracy, as its error says; use a larger number "
        "for the accuracy",
    )
    list_full = 4, "there are more Hopf points than the list holds; raise the option crossings"
    failed = 5, "the search for Hopf points failed and nothing is stored; the message says why"
    coefficients_failed = (
        6,
        "a Hopf point has no coefficients; the other Hopf points are stored; the message says why",
    )
    sign_undecided = (
        7,
        "the sign of Re c at a Hopf point is within its error, as happens near generalised Hopf points: c is "
        "correct, but the criticality is undecided; move a parameter slightly",
    )
    ended_early = (
        9,
        "the search ends before the requested force, at a rod whose unstable modes could not be counted, or "
        "once the list is full; Hopf points beyond this end are not known; the message says why",
    )
