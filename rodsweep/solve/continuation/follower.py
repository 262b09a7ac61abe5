"""Continuation of one curve of solutions: the loop that all curves share.

The problem of the curve predicts and corrects a solution at a step length ahead. The follower chooses the
length from the prediction error and the turn of the curve, repeats a failed step with half its length, and
ends the curve where a margin becomes zero, where the curve closes, or where no step succeeds.

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


class StepResult(NamedTuple, Generic[Solution]):
    """A solution at one step ahead.

    off: relative distance from the prediction. cosine: cosine of the angle by which the curve has turned.
    """

    solution: Solution
    off: float
    cosine: float


class CurveProblem(Protocol[Solution]):
    """Interface to a curve of solutions, used by the follower."""

    def step(self, behind: Sequence[Solution], length: float) -> StepResult[Solution]:
        """The solution at a length ahead of `behind[-1]`; raises Unsolvable if no solution is near."""

    def margins(self, solution: Solution) -> Array:
        """Numbers that are positive as long as the curve continues, (margins,)."""

    def landed(self, behind: Sequence[Solution], outer: Solution, margin: int) -> Solution | None:
        """The solution between `behind[-1]` and `outer` at which a margin is 0; None if not found."""

    def closes(self, behind: Sequence[Solution], there: Solution) -> bool:
        """Whether the first solution of the curve lies between its last solution and the next."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StepControl:
    """Control of the step lengths along a curve. Raises ValueError unless steps may grow."""

    first: float
    """First step length."""
    longest: float
    """Longest step length."""
    shortest: float
    """Shortest step length: the curve ends if a step fails whose half would be shorter."""
    aim: float = inf
    """Prediction error for which the next step is chosen."""
    far: float = inf
    """Prediction error beyond which the solution may belong to another curve."""
    order: int = 1
    """Order of the prediction, whose error grows as length**order; limited by the number of solutions
    behind."""
    turn: float = inf
    """Angle in radians for which the next step is chosen."""
    sharpest: float
    """Largest angle of a step."""
    growth: float
    """Largest ratio of successive lengths."""
    shrinkage: float = 0.5
    """Smallest ratio of successive lengths."""
    most: int = 5000
    """Maximum number of solutions; no curve has more."""
    min_measured: float = 1e-9
    """Smallest prediction error, or angle, distinguished from 0."""

    def __post_init__(self) -> None:
        if not self.growth > 1:
            raise ValueError(f"growth = {self.growth} must be above 1, so that steps can grow")

    def accepted(self, there: StepResult[Solution]) -> StepResult[Solution]:
        """The next solution; raises Unsolvable if the solution may lie on another curve."""
        if not there.off <= self.far:
            raise Unsolvable("the corrected solution is too far from its predictor")
        if not _angle(there.cosine) <= self.sharpest:
            raise Unsolvable("the tangent of the curve turns by too large an angle in one step")
        return there

    def next_length(self, length: float, there: StepResult[Solution], solutions: int) -> float:
        """Length of the step after an accepted step, for a curve with a number of solutions."""
        # The error of a prediction through m solutions grows with the m-th power of the step.
        by_distance = (self.aim / max(there.off, self.min_measured)) ** (1 / min(self.order, solutions))
        by_turn = self.turn / max(_angle(there.cosine), self.min_measured)
        factor = min(max(min(by_distance, by_turn), self.shrinkage), self.growth)
        return min(self.longest, length * factor)


def _angle(cosine: float) -> float:
    """Angle in radians of a cosine, which may exceed 1 by rounding."""
    return acos(min(1.0, max(-1.0, cosine)))


class CurveStop(Enum):
    """Reason for the end of a curve."""

    margin = "a margin is zero"
    closed = "the curve returned to its start"
    lost = "no solution was found beyond"
    full = "the curve has the maximum number of solutions"


@dataclass(frozen=True, slots=True)
class Curve(Generic[Solution]):
    """Solutions in order from the start, and the reason for the end of the curve.

    margin: index of the margin that is negative beyond the end, -1 for none; the last solution is its zero,
    if found.
    """

    solutions: list[Solution]
    end: CurveStop
    margin: int = -1


def advance(
    step: Callable[[float], StepResult[Solution]], length: float, control: StepControl
) -> tuple[StepResult[Solution], float]:
    """(the next solution of a curve, the length of the step); the given length is halved after every failure.

    step: returns the solution at a length ahead, or raises an error of FAILURES. `advance` raises the last
    error if no step succeeds.
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
    """The curve ahead of a solution; the problem knows the direction. report: called before every step."""
    solutions = [start]
    length = control.first
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
            # The start itself, not a point close to it, closes the curve exactly.
            return Curve([*solutions, start], CurveStop.closed)
        solutions.append(there.solution)
        margins = ahead
        length = control.next_length(length, there, len(solutions))
    return Curve(solutions, CurveStop.full)


def crossed(before: Array, after: Array) -> int:
    """Index of the margin, of (margins,), that is first to fall below 0 along a straight step; -1 for
    none."""
    # A margin that is negative already, but rises, is being entered from outside.
    falls = (after < 0) & (after < before)
    # Linear interpolation gives the fraction of the step at which each falling margin is 0.
    share = np.where(falls, before / np.where(falls, before - after, 1.0), inf)
    first = int(np.argmin(share))
    return first if share[first] < inf else -1


def zero_along(
    value: Callable[[float], float], ends: tuple[float, float], length: float, enough: float, relative: float
) -> float:
    """Zero of a function along a step, by Brent's method; raises Unsolvable without a change of sign.

    value: at a length. ends: values at 0 and at the full length, which are not computed again. enough:
    modulus below which a value counts as zero. relative: last bracket in units of the length.
    """
    from scipy.optimize import brentq  # slow import: 0.1 s, for few runs

    known = {0.0: ends[0], length: ends[1]}
    if not ends[0] * ends[1] <= 0:
        raise Unsolvable("there is no change of sign along the step")

    def settled(at: float) -> float:
        here = known[at] if at in known else value(at)
        # An exact 0 ends Brent's method, which would otherwise bisect rounding errors.
        return 0.0 if abs(here) <= enough else here

    return float(brentq(settled, 0.0, length, xtol=relative * length))
