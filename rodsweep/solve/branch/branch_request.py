"""Request for the branches of cycles of rods (`branches`)."""

from dataclasses import dataclass
from math import inf

WORK_UNIT = 1e9
"""Unit of `BranchRequest.work`: number of multiplications in the eliminations of Newton matrices."""


@dataclass(frozen=True, slots=True)
class BranchRequest:
    """Request for the branches of every rod. along, start, stop: name and range of the continuation
    parameter. accuracy: relative accuracy of the cycles. certify: whether to prove that no Hopf point is
    missing. cycles, special: maximum numbers of stored cycles and special points. work: limit of the work on
    the branches of a rod, in `WORK_UNIT`; None: no limit."""

    along: str
    start: float
    stop: float
    accuracy: float
    certify: bool
    cycles: int
    special: int
    work: float | None = None

    @property
    def max_work(self) -> float:
        """Largest number of multiplications in the eliminations of all Newton matrices for one rod; inf
        without a limit."""
        return inf if self.work is None else WORK_UNIT * self.work
