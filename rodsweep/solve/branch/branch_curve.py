"""A branch of cycles as it is stored: its cycles and its special points."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ...model.floquet import least_outside
from ..cycle.accuracy.cycle_errors import CycleErrors
from ..cycle.accuracy.refinement import MULTIPLIER_FACTOR
from ..orbit.measures import Measures
from .arc import ArcPoint
from .special.point import SpecialPoint
from .symmetry import Breaking


@dataclass(frozen=True, slots=True, kw_only=True)
class BranchPoint:
    """A cycle of a branch.

    at: the parameter; at_error: relative, of the parameter where the moment at the clamp is the same; errors:
    at the value of the parameter. multiplier: the largest nontrivial one's modulus; unstable: how many lie
    outside the circle, -1 where one is on it within its error.
    """

    at: float
    at_error: float
    measures: Measures
    errors: CycleErrors
    multiplier: float
    unstable: int

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
    def least_outside(self) -> int:
        """Least number of multipliers outside the circle; 0: stable, -1: stability not known."""
        return least_outside(self.unstable, self.multiplier, self.errors.multiplier_error)


def _margin(point: ArcPoint) -> float:
    """How far a multiplier's modulus near 1 must be from it to be told from it.

    The errors of others are as small as they are, in units of the largest one's; that of the trivial one is
    known.
    """
    cycle = point.cycle
    relative = cycle.errors.multiplier_error / max(cycle.largest_multiplier, 1.0)
    return relative + MULTIPLIER_FACTOR * cycle.trivial_error


@dataclass(frozen=True, slots=True)
class BranchEnd:
    """The special point at which a branch ends, and whether it is followed to an end that is one.

    arrives, meets and full: as in `BranchCurve`.
    """

    special: SpecialPoint
    complete: bool
    arrives: int = -1
    meets: Breaking | None = None
    full: bool = False


@dataclass(kw_only=True, slots=True)
class BranchCurve:
    """A branch: its cycles and its special points, both in order, from the Hopf point of a number, or -1.

    arrives: the number of the Hopf point at which it ends, -1 for none. breaking: the symmetry breaking where
    a branch without symmetry is born; meets: that at which it ends. complete: whether it was followed to
    an end that is one. full: whether it ends because no more cycles are kept. explained: whether the special
    points explain all multipliers that cross the circle.
    """

    hopf: int
    points: list[BranchPoint] = field(default_factory=list)
    special: list[SpecialPoint] = field(default_factory=list)
    arrives: int = -1
    breaking: Breaking | None = None
    meets: Breaking | None = None
    complete: bool = False
    full: bool = False
    explained: bool = True

    def add(self, special: SpecialPoint) -> None:
        """A special point behind the last cycle."""
        self.special.append(replace(special, after=len(self.points) - 1))

    def add_found(self, between: Sequence[SpecialPoint], explained: bool) -> None:
        """Special points behind the last cycle, and whether they explain the multipliers of the next one."""
        for special in between:
            self.add(special)
        self.explained &= explained

    def judge(self, points: Sequence[BranchPoint]) -> None:
        """Puts cycles with their errors in the place of as many at the end."""
        self.points[-len(points) :] = points

    def cut(self, count: int) -> None:
        """Drops so many cycles at the end, and the special points behind them."""
        del self.points[-count:]
        self.special[:] = [point for point in self.special if point.after < len(self.points)]

    def end(self, end: BranchEnd) -> None:
        """How it ends."""
        self.add(end.special)
        self.complete, self.full = end.complete, end.full
        self.arrives, self.meets = end.arrives, end.meets
