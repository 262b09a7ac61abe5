"""Outcome of integrating a motion until its cycle is found (`transient_integration`)."""

from dataclasses import dataclass
from math import nan

from ..accuracy.refined_cycle import RefinedCycle
from ..status import CycleStatus


@dataclass(frozen=True, eq=False)
class TransientOutcome:
    """Outcome of integrating a motion. return_count: number of returns of the tip. cycle: the cycle that the
    motion approached, or None. unstable_cycle: the unstable cycle inside the torus, or None if the motion is
    not on a torus. modulation_ratio: frequency of the modulation of a motion on a torus over the frequency of
    its oscillation; NaN for other motions."""

    status: CycleStatus
    message: str
    return_count: int
    cycle: RefinedCycle | None = None
    unstable_cycle: RefinedCycle | None = None
    modulation_ratio: float = nan
