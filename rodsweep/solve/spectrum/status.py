"""How the computation of a point ended: the sentence that the user reads for each outcome."""

from enum import IntEnum


class Status(IntEnum):
    """Outcome of a point; the value is what the result file stores, the name its flag meaning."""

    ok = 0
    not_certified = 1
    undecided = 2
    accuracy_not_reached = 3
    modes_missing = 4
    failed = 5

    @property
    def sentence(self) -> str:
        """Cause and remedy."""
        return SENTENCES[self]


SENTENCES = {
    Status.ok: "every number is as accurate as asked for, and certified where asked for",
    Status.not_certified: (
        "the eigenvalues are accurate, but no a-priori bound applies or the winding number could "
        "not be proved, so an unstable mode may be missing; `certify: false` accepts that"
    ),
    Status.undecided: (
        "an eigenvalue lies on the imaginary axis within its error, so the number of unstable modes "
        "is undecided there; move the parameters off the threshold"
    ),
    Status.accuracy_not_reached: (
        "a number is less accurate than asked for and its error estimate says by how much; near "
        "a double eigenvalue half of the digits are lost, so ask for a lower accuracy there"
    ),
    Status.modes_missing: (
        "the eigenvalues found are fewer than the winding number counts, so none are stored; ask for "
        "more modes"
    ),
    Status.failed: "the solver failed and nothing is stored; the log has its message",
}
