"""Status of a spectrum, with a sentence of cause and remedy for the user."""

from ..status import PointStatus


class SpectrumStatus(PointStatus):
    """Outcome of one rod in the tasks spectrum and modes."""

    ok = 0, "every number has the requested accuracy; if certified, no mode is missing", True
    not_certified = (
        1,
        "the eigenvalues are accurate, but no a-priori bound applies or the winding number could "
        "not be proved, so an unstable mode may be missing; `certify: false` accepts such eigenvalues",
    )
    undecided = (
        2,
        "an eigenvalue lies on the imaginary axis within its error, so the number of unstable modes "
        "is undecided there; move the parameters off the threshold",
    )
    accuracy_not_reached = (
        3,
        "a number misses the requested accuracy, as its error estimate says; near a double eigenvalue "
        "half of the digits are lost: use a larger number for the accuracy there",
    )
    modes_missing = (
        4,
        "eigenvalues are missing: fewer are found than the winding number counts, or no mesh resolves all "
        "that may lead; no eigenvalue is stored; request more modes",
    )
    failed = (
        5,
        "the solver failed, and results that it did not find are missing; the message says why; "
        "change the accuracy, or move a parameter slightly",
    )
