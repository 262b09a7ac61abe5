"""Stored form of a branch: numbers of the cycles, and special points."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ...model.floquet import min_unstable_multipliers
from ..cycle.accuracy.cycle_errors import CycleErrors
from ..cycle.accuracy.refinement_settings import REFINEMENT
from ..orbit.measures import Measures
from .arc import ArcPoint
from .special.point import SpecialPoint
from .symmetry import SymmetryBreaking


@dataclass(frozen=True, slots=True, kw_only=True)
class BranchPoint:
    """Numbers of one cycle of a branch."""

    at: float
    """Value of the parameter."""
    at_error: float
    """Relative error of the parameter at an equal deflection."""
    measures: Measures
    errors: CycleErrors
    """Errors at an equal parameter."""
    multiplier: float
    """Modulus of the largest nontrivial Floquet multiplier."""
    unstable: int
    """Number of multipliers outside the unit circle, -1 if one lies on the circle within its error."""

    @classmethod
    def of(cls, point: ArcPoint, accuracy: float) -> "BranchPoint":
        """The numbers of a cycle that was solved to an accuracy."""
        cycle = point.cycle
        sizes = np.abs(cycle.multipliers)
        beyond = sizes - 1
        undecided = bool((np.abs(beyond) <= _margin(point)).any())
        return cls(
            at=getattr(point.orbit.form.rod, point.scale.name),
            at_error=point.calibration.parameter_error(accuracy),
            measures=cycle.measures,
            errors=cycle.errors,
            multiplier=cycle.largest_multiplier,
            unstable=-1 if undecided else int((beyond > 0).sum()),
        )

    @property
    def min_unstable_multipliers(self) -> int:
        """Least number of multipliers outside the circle; 0: stable, -1: stability not known."""
        return min_unstable_multipliers(self.unstable, self.multiplier, self.errors.multiplier_error)


def _margin(point: ArcPoint) -> float:
    """Error of the moduli of multipliers near 1: a modulus closer to 1 is undecided.

    The largest multiplier's error, relative to that multiplier, holds for the others too; the trivial
    multiplier's error is known, because its exact value is 1.
    """
    cycle = point.cycle
    relative = cycle.errors.multiplier_error / max(cycle.largest_multiplier, 1.0)
    return relative + REFINEMENT.multiplier_factor * cycle.trivial_error


@dataclass(frozen=True, slots=True)
class BranchEnd:
    """The special point where a branch ends, and whether it is a true end of the branch.

    complete, end_hopf, end_breaking and full: as in `BranchCurve`.
    """

    special: SpecialPoint
    complete: bool
    end_hopf: int = -1
    end_breaking: SymmetryBreaking | None = None
    full: bool = False


@dataclass(kw_only=True, slots=True)
class BranchCurve:
    """A branch: its cycles and its special points, each in order along the branch."""

    hopf: int
    """Number of the Hopf point where the branch starts, or -1."""
    points: list[BranchPoint] = field(default_factory=list)
    special: list[SpecialPoint] = field(default_factory=list)
    end_hopf: int = -1
    """Number of the Hopf point where the branch ends, or -1."""
    breaking: SymmetryBreaking | None = None
    """Symmetry breaking where a branch without symmetry starts."""
    end_breaking: SymmetryBreaking | None = None
    """Symmetry breaking where a branch without symmetry ends."""
    complete: bool = False
    """Whether the branch was followed to a true end."""
    full: bool = False
    """Whether the branch ends because the limit on the number of cycles is reached."""
    explained: bool = True
    """Whether the special points account for all multipliers that cross the unit circle."""

    def add(self, special: SpecialPoint) -> None:
        """Adds a special point behind the last cycle."""
        self.special.append(replace(special, after=len(self.points) - 1))

    def add_found(self, between: Sequence[SpecialPoint], explained: bool) -> None:
        """Adds special points behind the last cycle. explained: whether these account for the multipliers of
        the next cycle."""
        for special in between:
            self.add(special)
        self.explained &= explained

    def judge(self, points: Sequence[BranchPoint]) -> None:
        """Replaces the last cycles by the same cycles with errors."""
        self.points[-len(points) :] = points

    def cut(self, count: int) -> None:
        """Drops a number of cycles at the end, and the special points behind them."""
        del self.points[-count:]
        self.special[:] = [point for point in self.special if point.after < len(self.points)]

    def end(self, end: BranchEnd) -> None:
        """Ends the branch at a special point."""
        self.add(end.special)
        self.complete = end.complete
        self.full = end.full
        self.end_hopf = end.end_hopf
        self.end_breaking = end.end_breaking
