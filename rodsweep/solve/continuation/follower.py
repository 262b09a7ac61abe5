"""Numerical continuation of one curve of solutions: the loop shared by all kinds of curves.

A `CurveProblem` predicts and corrects the solution one step ahead. `follow_curve` chooses the step length
from the prediction error and from the angle between successive steps, and halves the length of a failed step.
The curve ends where a margin becomes zero, where the curve closes, or where no step succeeds.

This module knows no rods, meshes, eigenvalues or cycles. Reference: Keller 1977; Govaerts 2000, ch. 2.
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
    """The solution one step ahead on a curve.

    prediction_error: relative distance of the solution from its prediction. cosine: cosine of the angle by
    which the curve turns in the step.
    """

    solution: Solution
    prediction_error: float
    cosine: float


class CurveProblem(Protocol[Solution]):
    """Interface of `follow_curve` to a curve of solutions; `behind`: solutions so far, in order along the
    curve."""

    def step(self, behind: Sequence[Solution], length: float) -> StepResult[Solution]:
        """The solution one step of the given length ahead of `behind[-1]`; raises Unsolvable if Newton's
        method fails."""

    def margins(self, solution: Solution) -> Array:
        """Signed distances, (margins,), of a solution from the limits of the curve; a limit is passed where
        one is negative."""

    def located_zero(self, behind: Sequence[Solution], outer: Solution, margin: int) -> Solution | None:
        """The solution between `behind[-1]` and `outer` at which a margin is 0; None if not found."""

    def closes(self, behind: Sequence[Solution], there: Solution) -> bool:
        """Whether the first solution of the curve lies on the step from `behind[-1]` to the next solution
        `there`."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StepControl:
    """Step length control along a curve. Raises ValueError unless `max_ratio` exceeds 1."""

    first_length: float
    """First step length."""
    max_length: float
    """Longest step length."""
    min_length: float
    """Shortest step length: the curve ends if a step fails and half its length would be below this limit."""
    target_error: float = inf
    """Prediction error at which the length of the next step aims."""
    max_error: float = inf
    """Largest prediction error of an accepted step; beyond it the solution may belong to another curve."""
    prediction_order: int = 1
    """Order of the prediction: the prediction error grows as length**order. With fewer solutions so far, the
    number of solutions is the order."""
    target_angle: float = inf
    """Angle in radians between successive steps at which the length of the next step aims."""
    max_angle: float
    """Largest angle in radians between successive steps; a step with a larger angle fails."""
    max_ratio: float
    """Largest ratio of a step length to the previous step length."""
    min_ratio: float = 0.5
    """Smallest ratio of a step length to the length of the previous, accepted step."""
    max_solutions: int = 5000
    """Maximum number of solutions on a curve; the curve ends there."""
    min_measured: float = 1e-9
    """Smallest prediction error, and smallest angle in radians, used in the choice of a step length: it
    avoids a division by 0."""

    def __post_init__(self) -> None:
        if not self.max_ratio > 1:
            raise ValueError(f"max_ratio = {self.max_ratio} must be above 1, so that steps can grow")

    def accepted(self, there: StepResult[Solution]) -> StepResult[Solution]:
        """The next solution; raises Unsolvable if the solution may lie on another curve."""
        if not there.prediction_error <= self.max_error:
            raise Unsolvable("the corrected solution is too far from its predictor")
        if not _angle(there.cosine) <= self.max_angle:
            raise Unsolvable("the tangent of the curve turns by too large an angle in one step")
        return there

    def next_length(self, length: float, there: StepResult[Solution], solutions: int) -> float:
        """Length of the next step, after an accepted step of a given length; `solutions`: number of solutions
        so far."""
        # The error of a prediction through m solutions grows with the m-th power of the step.
        by_distance = (self.target_error / max(there.prediction_error, self.min_measured)) ** (
            1 / min(self.prediction_order, solutions)
        )
        by_turn = self.target_angle / max(_angle(there.cosine), self.min_measured)
        factor = min(max(min(by_distance, by_turn), self.min_ratio), self.max_ratio)
        return min(self.max_length, length * factor)


def _angle(cosine: float) -> float:
    """Angle in radians of a cosine; a cosine beyond 1 by rounding counts as 1."""
    return acos(min(1.0, max(-1.0, cosine)))


class CurveStop(Enum):
    """Reason for the end of a curve."""

    margin = "a margin is zero"
    closed = "the curve returned to its start"
    lost = "no solution was found beyond"
    full = "the curve has the maximum number of solutions"


@dataclass(frozen=True, slots=True)
class Curve(Generic[Solution]):
    """Solutions in order from the start of the curve, and the reason for the end of the curve.

    margin: index of the margin that becomes negative at the end, or -1. If the zero of the margin was
    located, the last solution is at the zero.
    """

    solutions: list[Solution]
    end: CurveStop
    margin: int = -1


def advance(
    step: Callable[[float], StepResult[Solution]], length: float, control: StepControl
) -> tuple[StepResult[Solution], float]:
    """(the next solution of a curve, the length of the successful step); `length` is halved after every
    failure.

    step: returns the solution one step of a given length ahead, or raises an error of FAILURES. `advance`
    raises the last error if no step succeeds.
    """
    length = min(length, control.max_length)
    while True:
        try:
            return control.accepted(step(length)), length
        except FAILURES:
            if length / 2 < control.min_length:
                raise
            length /= 2


def follow_curve(
    problem: CurveProblem[Solution],
    start: Solution,
    control: StepControl,
    report: Callable[[Sequence[Solution]], None],
) -> Curve[Solution]:
    """The curve from the solution `start` in the direction that the problem chooses. report: function that is
    called with all solutions before every step."""
    solutions = [start]
    length = control.first_length
    margins = problem.margins(start)
    while len(solutions) < control.max_solutions:
        report(solutions)
        try:
            there, length = advance(partial(problem.step, solutions), length, control)
        except FAILURES:
            return Curve(solutions, CurveStop.lost)
        ahead = problem.margins(there.solution)
        outside = first_crossed_margin(margins, ahead)
        if outside >= 0:
            last = problem.located_zero(solutions, there.solution, outside)
            return Curve(solutions if last is None else [*solutions, last], CurveStop.margin, outside)
        if problem.closes(solutions, there.solution):
            # The start itself, not a solution next to it, closes the curve exactly.
            return Curve([*solutions, start], CurveStop.closed)
        solutions.append(there.solution)
        margins = ahead
        length = control.next_length(length, there, len(solutions))
    return Curve(solutions, CurveStop.full)


def first_crossed_margin(before: Array, after: Array) -> int:
    """Index of the margin that is first to become negative along a step; -1 if no margin becomes negative.

    before, after: margins at both ends of the step, (margins,), interpolated linearly.
    """
    # A negative margin that rises is no end: the curve comes in from beyond this limit.
    falls = (after < 0) & (after < before)
    # Linear interpolation gives the fraction of the step at which each falling margin is 0.
    share = np.where(falls, before / np.where(falls, before - after, 1.0), inf)
    first = int(np.argmin(share))
    return first if share[first] < inf else -1


def zero_along_step(
    value: Callable[[float], float], ends: tuple[float, float], length: float, enough: float, relative: float
) -> float:
    """Length at which a function along a step is 0, by Brent's method; raises Unsolvable without a change of
    sign.

    value: the function of the length. ends: known values at length 0 and at the full `length`. enough:
    modulus up to which a value counts as 0. relative: tolerance of the result, in units of `length`.
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
