"""Outcome of the integration of a motion (`transient`)."""

from dataclasses import dataclass

from ..accuracy.cycle_verdict import RefinedCycle
from ..status import CycleStatus


@dataclass(frozen=True, eq=False)
class TransientOutcome:
    """Outcome of the transient. periods: returns of the tip; found: the cycle, if the motion reached one.

    around: the unstable cycle inside a torus.
    """

    status: CycleStatus
    message: str
    periods: int
    found: RefinedCycle | None = None
    around: RefinedCycle | None = None
