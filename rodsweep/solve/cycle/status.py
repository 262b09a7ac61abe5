"""How the search for a limit cycle ended: the sentence that the user reads for each outcome."""

from enum import IntEnum


class CycleStatus(IntEnum):
    """Outcome of a point, as `rodsweep.solve.spectrum.status.Status` is for spectra."""

    cycle = 0
    straight = 1
    not_settled = 2
    left_the_model = 3
    failed = 4

    @property
    def sentence(self) -> str:
        """Cause and remedy."""
        return SENTENCES[self]

    @property
    def succeeded(self) -> bool:
        """Whether the rod's fate is known to the accuracy asked for."""
        return self in (CycleStatus.cycle, CycleStatus.straight)


SENTENCES = {
    CycleStatus.cycle: (
        "the rod beats: the cycle closes, and no sooner, all its Floquet multipliers lie inside the circle, "
        "and its period and extrema are as accurate as asked for"
    ),
    CycleStatus.straight: "the rod is straight again, and stays so: nothing beats from this start",
    CycleStatus.not_settled: (
        "no stable cycle was found within the periods allowed, or not to the accuracy asked for, as its "
        "errors say; raise the periods allowed, start from a neighbour's cycle, or ask for a lower accuracy"
    ),
    CycleStatus.left_the_model: (
        "the rod was crushed somewhere (h1 <= 0), where the model ends; start from a smaller amplitude or "
        "from a neighbour's cycle, or lower F or raise k1"
    ),
    CycleStatus.failed: "the integration failed and nothing is stored; the message says why",
}
