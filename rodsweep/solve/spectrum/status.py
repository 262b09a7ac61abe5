"""How the computation of a spectrum ended: the sentence that the user reads for each outcome."""

from ..status import PointStatus


class SpectrumStatus(PointStatus):
    """Outcome of a point of the tasks spectrum and modes."""

    ok = 0, "every number is as accurate as asked for, and certified where asked for", True
    not_certified = (
        1,
        "the eigenvalues are accurate, but no a-priori bound applies or the winding number could "
        "not be proved, so an unstable mode may be missing; `certify: false` accepts that",
    )
    undecided = (
        2,
        "an eigenvalue lies on the imaginary axis within its error, so the number of unstable modes "
        "is undecided there; move the parameters off the threshold",
    )
    accuracy_not_reached = (
        3,
        "a number is less accurate than asked for and its error estimate says by how much; near "
        "a double eigenvalue half of the digits are lost, so ask for a lower accuracy there",
    )
    modes_missing = (
        4,
        "the eigenvalues found are fewer than the winding number counts, so none are stored; ask for "
        "more modes",
    )
    failed = 5, "the solver failed and nothing is stored; the log has its message"
