"""Continuation of one curve of solutions: the loop that all curves share.

A step of some length ahead predicts a solution and corrects it; how, the curve's problem knows. The follower
chooses the length by how good the prediction was and how far the curve turned, takes back a step that fails,
and ends the curve where the first of its margins becomes zero, where it closes, or where no step succeeds.

Knows nothing of rods, meshes, eigenvalues or cycles. Reference: Keller 1977; Govaerts 2000, ch. 2.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum
from functools import partial
from math import acos, inf
from typing import Generic, NamedTuple, Protocol, TypeVar

import numpy as np

from ...arrays import Array
from ..point import FAILURES, Unsolvable

Solution = TypeVar("Solution")

LEAST = 1e-9
"""Distance from a prediction, or angle in radians, below which a step was as good as one can be."""


class Stepped(NamedTuple, Generic[Solution]):
    """A solution a step ahead.

    off: its distance from the prediction, relative. cosine: of the angle by which the curve has turned.
    """

    solution: Solution
    off: float
    cosine: float


class CurveProblem(Protocol[Solution]):
    """What a curve must know of itself."""

    def step(self, behind: Sequence[Solution], length: float) -> Stepped[Solution]:
        """The solution at a length ahead of the last of some; raises Unsolvable where none is near."""

    def margins(self, solution: Solution) -> Array:
        """Numbers that are positive as long as the curve goes on, (margins,)."""

    def landed(self, behind: Sequence[Solution], outer: Solution, margin: int) -> Solution | None:
        """The solution between the last of some and the next at which a margin is 0; None if not found."""

    def closes(self, behind: Sequence[Solution], there: Solution) -> bool:
        """Whether the first solution of the curve lies between the last one and the next."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StepControl:
    """How long the steps along a curve are.

    first, longest, shortest: lengths; a step as short as that which still fails ends the curve. aim: distance
    from the prediction that the next step is chosen for; far: beyond which the solution may be of another
    curve. order: of the prediction, whose distance grows as length**order; with fewer solutions behind it is
    their number. turn: angle in radians that the next step is chosen for; sharpest: the largest one of a
    step. growth, shrinkage: ratios of successive steps. most: solutions on one curve, more than any has.
    """

    first: float
    longest: float
    shortest: float
    aim: float = inf
    far: float = inf
    order: int = 1
    turn: float = inf
    sharpest: float
    growth: float
    shrinkage: float = 0.5
    most: int = 5000

    def accepted(self, there: Stepped[Solution]) -> Stepped[Solution]:
        """Next solution of the same curve; raises Unsolvable if it may lie on another curve."""
        if not there.off <= self.far:
            raise Unsolvable("the solution is far from its prediction")
        if not _angle(there.cosine) <= self.sharpest:
            raise Unsolvable("the curve bends")
        return there

    def next_length(self, length: float, there: Stepped[Solution], solutions: int) -> float:
        """Length of the step after one that was accepted, when the curve has a number of solutions."""
        by_distance = (self.aim / max(there.off, LEAST)) ** (1 / min(self.order, solutions))
        by_turn = self.turn / max(_angle(there.cosine), LEAST)
        factor = min(max(min(by_distance, by_turn), self.shrinkage), self.growth)
        return min(self.longest, length * factor)


def _angle(cosine: float) -> float:
    """Angle in radians of a cosine that rounding may have moved beyond 1."""
    return acos(min(1.0, max(-1.0, cosine)))


class CurveStop(Enum):
    """Why a curve ends."""

    margin = "a margin is zero"
    closed = "the curve came back to its start"
    lost = "no solution was found beyond"
    full = "the curve has as many solutions as are kept"


@dataclass(frozen=True, slots=True)
class Curve(Generic[Solution]):
    """Solutions in order from the start, and why the curve ends.

    margin: that which is negative beyond the end, -1 for none. The last solution is where it is 0, if that
    was found.
    """

    solutions: list[Solution]
    end: CurveStop
    margin: int = -1


def advance(
    step: Callable[[float], Stepped[Solution]], length: float, control: StepControl
) -> tuple[Stepped[Solution], float]:
    """(the next solution of a curve, the length of the step to it), the length given or halves of it.

    step: the solution at a length ahead; raises one of FAILURES where none is near. So does this where no
    step is short enough.
    """
    length = min(length, control.longest)
    while True:
        try:
            return control.accepted(step(length)), length
        except FAILURES:
            if length / 2 < control.shortest:
                raise
            length /= 2


def follow(
    problem: CurveProblem[Solution],
    start: Solution,
    control: StepControl,
    report: Callable[[Sequence[Solution]], None],
) -> Curve[Solution]:
    """The curve ahead of a solution; the problem knows which way that is. report: hears of every step."""
    solutions, length = [start], control.first
    margins = problem.margins(start)
    while len(solutions) < control.most:
        report(solutions)
        try:
            there, length = advance(partial(problem.step, solutions), length, control)
        except FAILURES:
            return Curve(solutions, CurveStop.lost)
        ahead = problem.margins(there.solution)
        outside = crossed(margins, ahead)
        if outside >= 0:
            last = problem.landed(solutions, there.solution, outside)
            return Curve(solutions if last is None else [*solutions, last], CurveStop.margin, outside)
        if problem.closes(solutions, there.solution):
            return Curve([*solutions, start], CurveStop.closed)
        solutions.append(there.solution)
        margins = ahead
        length = control.next_length(length, there, len(solutions))
    return Curve(solutions, CurveStop.full)


def crossed(before: Array, after: Array) -> int:
    """Index of the margin, of (margins,), that falls below 0 first along a straight step; -1 if none does."""
    falls = (after < 0) & (after < before)
    share = np.where(falls, before / np.where(falls, before - after, 1.0), inf)
    first = int(np.argmin(share))
    return first if share[first] < inf else -1


def zero_along(
    value: Callable[[float], float], ends: tuple[float, float], length: float, enough: float, relative: float
) -> float:
    """Where a number along a step is zero, by Brent's method; raises Unsolvable where its signs agree.

    value: at a length; ends: its values at 0 and at the length, which are not computed again; enough: modulus
    of a value that is none. relative: last bracket in units of the length.
    """
    from scipy.optimize import brentq  # a tenth of a second of every start

    known = {0.0: ends[0], length: ends[1]}
    if not ends[0] * ends[1] <= 0:
        raise Unsolvable("there is no change of sign along the step")

    def settled(at: float) -> float:
        here = known[at] if at in known else value(at)
        return 0.0 if abs(here) <= enough else here

    return float(brentq(settled, 0.0, length, xtol=relative * length))
