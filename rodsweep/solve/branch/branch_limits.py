"""Request for the branches of a rod, and their limits: range, number of cycles, Hopf points and symmetry
breakings."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf

from ..orbit.matrix.workspace import NewtonWorkspace
from .start.hopf_point import HopfBranchStart
from .status import BranchEndReason
from .symmetry_breaking import SymmetryBreaking

MULTIPLICATIONS_PER_WORK_UNIT = 1e9
"""Unit of `BranchRequest.work`: number of multiplications in the eliminations of Newton matrices."""


@dataclass(frozen=True, slots=True)
class BranchRequest:
    """Request for the branches of every rod. along, start, stop: name and range of the continuation
    parameter. accuracy: relative accuracy of the cycles. certify: whether to prove that no Hopf point is
    missing. cycles, special: maximum numbers of stored cycles and special points. work: limit of the work on
    the branches of a rod, in `MULTIPLICATIONS_PER_WORK_UNIT`; None: no limit."""

    along: str
    start: float
    stop: float
    accuracy: float
    certify: bool
    cycles: int
    special: int
    work: float | None = None

    @property
    def max_multiplications(self) -> float:
        """Largest number of multiplications in the eliminations of all Newton matrices for one rod; inf
        without a limit."""
        return inf if self.work is None else MULTIPLICATIONS_PER_WORK_UNIT * self.work


@dataclass(frozen=True, slots=True)
class BranchLimits:
    """Limits of the branches of a rod: parameter range, number of cycles, relative accuracy of the cycles,
    and the Hopf points and symmetry breakings at which a branch may end."""

    hopfs: Sequence[HopfBranchStart]
    """Hopf points of the rod within the range."""
    coordinate_range: tuple[float, float]
    """Smallest and largest coordinate of the continuation parameter, at which branches end."""
    end_reasons: tuple[BranchEndReason, BranchEndReason]
    """Reasons for the end of a branch at the smallest and at the largest coordinate."""
    accuracy: float
    max_cycles: int
    """Maximum number of cycles of one branch."""
    workspace: NewtonWorkspace
    """Memory of Newton's matrices."""
    min_coordinate_unit: float = 0.0
    """Lower limit of the unit in which the parameter coordinate enters the arc length, see
    `ArcLengthScale`."""
    is_omega_always_unknown: bool = False
    """Whether the angular velocity Omega is an unknown for all cycles, see `StressForm`."""
    breakings: Sequence[SymmetryBreaking] = ()
    """Symmetry breakings found so far on the branches of the rod."""
    hopfs_beyond_range: Sequence[HopfBranchStart] = ()
    """Hopf points of the rod beyond the ends of the range; a branch may end at such a point just beyond."""
    locates_special_points: bool = True
    """Whether all special points between the ends of a branch are located; on parts beyond the range only
    folds and symmetry breakings are."""

    @property
    def all_hopfs(self) -> list[HopfBranchStart]:
        """Hopf points within the range and beyond."""
        return [*self.hopfs, *self.hopfs_beyond_range]
