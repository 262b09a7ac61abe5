"""Numerical continuation of one curve of solutions, for all kinds of curves.

A `CurveProblem` predicts and corrects the solution one step ahead. `follow_curve` chooses the step length
from the prediction error and from the angle between successive steps, and halves the length of a failed step.
The curve ends where a margin, the distance from a limit of the curve, becomes zero, where the curve closes,
where no step succeeds, or at the maximum number of solutions.

This module does not depend on rods, meshes, eigenvalues or cycles. References: Keller 1977; Govaerts 2000,
ch. 2.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum
from functools import partial
from math import acos, inf
from typing import Generic, NamedTuple, Protocol, TypeVar

import numpy as np

from ...arrays import Array
from ..point_outcome import FAILURE_EXCEPTIONS
from ..unsolvable import Unsolvable

Solution = TypeVar("Solution")


class StepResult(NamedTuple, Generic[Solution]):
    """The solution one step ahead on a curve. prediction_error: relative distance of the solution from its
    prediction. turn_cosine: cosine of the angle by which the direction of the curve changes in the step."""

    solution: Solution
    prediction_error: float
    turn_cosine: float


class CurveProblem(Protocol[Solution]):
    """Interface of `follow_curve` to a curve of solutions. previous: solutions so far, in order along the
    curve."""

    def step(self, previous: Sequence[Solution], length: float) -> StepResult[Solution]:
        """The solution one step of the length `length` beyond `previous[-1]`; raises Unsolvable if Newton's
        method fails."""

    def margins_to_curve_end(self, solution: Solution) -> Array:
        """Signed distances, (margins,), of a solution from all limits of the curve; a negative distance means
        that the solution is beyond this limit. Each of these distances is called a margin."""

    def point_at_zero_margin(
        self, previous: Sequence[Solution], outer: Solution, margin: int
    ) -> Solution | None:
        """The solution between `previous[-1]` and `outer` at which the entry `margin` of
        `margins_to_curve_end` is 0; None if `previous[-1]` is to be the last solution. Raises an error of
        FAILURE_EXCEPTIONS if no solution is found: the step is then repeated with half its length."""

    def is_closed_by(self, previous: Sequence[Solution], solution: Solution) -> bool:
        """Whether the first solution of the curve lies on the step from `previous[-1]` to the next solution
        `solution`."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StepControl:
    """Step length control along a curve. Raises ValueError unless `max_successive_length_ratio` exceeds 1."""

    first_length: float
    """First step length."""
    max_length: float
    """Longest step length."""
    min_length: float
    """Shortest step length: the curve ends if a step fails and half its length would be below this limit."""
    target_prediction_error: float = inf
    """The length of the next step is chosen for this prediction error."""
    max_prediction_error: float = inf
    """Largest prediction error of an accepted step; with a larger error the solution may belong to another
    curve."""
    prediction_order: int = 1
    """Order of the prediction: the prediction error is proportional to length**order. If the curve has fewer
    solutions than this so far, the number of solutions is used as the order."""
    target_angle: float = inf
    """The length of the next step is chosen for this angle, in radians, between successive steps."""
    max_angle: float
    """Largest angle in radians between successive steps; a step with a larger angle fails."""
    max_successive_length_ratio: float
    """Largest ratio of a step length to the length of the last accepted step."""
    min_successive_length_ratio: float = 0.5
    """Smallest ratio of the next chosen step length to the length of the last accepted step; failed steps are
    halved further."""
    max_solutions: int = 5000
    """Maximum number of solutions on a curve."""
    min_error_or_angle: float = 1e-9
    """Lower limit of the prediction error, and of the angle in radians, in the choice of a step length; this
    limit avoids a division by 0."""

    def __post_init__(self) -> None:
        if not self.max_successive_length_ratio > 1:
            raise ValueError(
                f"max_successive_length_ratio = {self.max_successive_length_ratio} must be above 1, so that "
                "steps can grow"
            )

    def require_same_curve(self, result: StepResult[Solution]) -> StepResult[Solution]:
        """The result `result` itself; raises Unsolvable if its prediction error or angle is so large that the
        solution may lie on another curve."""
        # Negated, so that an error of nan is refused.
        if not result.prediction_error <= self.max_prediction_error:
            raise Unsolvable("the corrected solution is too far from its prediction")
        if not _angle(result.turn_cosine) <= self.max_angle:
            raise Unsolvable("the tangent of the curve turns by too large an angle in one step")
        return result

    def next_length(self, length: float, result: StepResult[Solution], solution_count: int) -> float:
        """Length of the next step, from the prediction error and the angle of the last step, within the
        limits of the ratio to the last length and at most `max_length`. length: length of the last, accepted
        step. result: result of the last step. solution_count: number of solutions so far."""
        # The error of a prediction from m solutions is proportional to the m-th power of the step.
        error_ratio = (
            self.target_prediction_error / max(result.prediction_error, self.min_error_or_angle)
        ) ** (1 / min(self.prediction_order, solution_count))
        angle_ratio = self.target_angle / max(_angle(result.turn_cosine), self.min_error_or_angle)
        factor = max(min(error_ratio, angle_ratio), self.min_successive_length_ratio)
        return min(self.max_length, length * min(factor, self.max_successive_length_ratio))


def _angle(cosine: float) -> float:
    """Angle in radians of a cosine, which is first limited to [-1, 1] because of rounding errors."""
    return acos(min(1.0, max(-1.0, cosine)))


class StopReason(Enum):
    """Reason for the end of a curve."""

    zero_margin = "a margin is zero"
    closed = "the curve returned to its start"
    no_further_solution = "no solution was found beyond the last solution"
    max_solutions = "the curve has the maximum number of solutions"


@dataclass(frozen=True, slots=True)
class Curve(Generic[Solution]):
    """Solutions in order from the start of the curve, and the reason for the end of the curve. A closed curve
    has its start as the last solution, too.

    margin_index: index of the margin, the entry of `margins_to_curve_end`, that becomes negative at the end;
    -1 for another end. The last solution is the solution at the zero of this margin, if
    `point_at_zero_margin` returns one."""

    solutions: list[Solution]
    end_reason: StopReason
    margin_index: int = -1


def next_solution_and_step_length(
    step: Callable[[float], StepResult[Solution]], length: float, control: StepControl
) -> tuple[StepResult[Solution], float]:
    """(next solution of a curve, length of the successful step); raises the error of the last step if no step
    succeeds. length: first step length, at most `control.max_length`. A step that fails, or whose prediction
    error or angle is too large, is repeated with half the length, if `control.min_length` allows. step:
    function that returns the solution one step of a given length ahead, or raises an error of
    FAILURE_EXCEPTIONS."""
    length = min(length, control.max_length)
    while True:
        try:
            return control.require_same_curve(step(length)), length
        except FAILURE_EXCEPTIONS:
            if length / 2 < control.min_length:
                raise
            length /= 2


def follow_curve(
    problem: CurveProblem[Solution],
    start: Solution,
    control: StepControl,
    report: Callable[[Sequence[Solution]], None],
) -> Curve[Solution]:
    """The curve from the solution `start`, in the direction that `problem` chooses. report: function that is
    called before every step with all solutions so far. control: step length control."""
    solutions = [start]
    length = control.first_length
    margins = problem.margins_to_curve_end(start)
    while len(solutions) < control.max_solutions:
        report(solutions)
        try:
            result, length = next_solution_and_step_length(partial(problem.step, solutions), length, control)
        except FAILURE_EXCEPTIONS:
            return Curve(solutions, StopReason.no_further_solution)
        new_margins = problem.margins_to_curve_end(result.solution)
        crossed_margin = first_crossed_margin(margins, new_margins)
        if crossed_margin >= 0:
            try:
                last_solution = problem.point_at_zero_margin(solutions, result.solution, crossed_margin)
            except FAILURE_EXCEPTIONS:
                if length / 2 < control.min_length:
                    return Curve(solutions, StopReason.no_further_solution)
                length /= 2
                continue
            return Curve(
                solutions if last_solution is None else [*solutions, last_solution],
                StopReason.zero_margin,
                crossed_margin,
            )
        if problem.is_closed_by(solutions, result.solution):
            # `start` is appended again, so that the curve is closed exactly.
            return Curve([*solutions, start], StopReason.closed)
        solutions.append(result.solution)
        margins = new_margins
        length = control.next_length(length, result, len(solutions))
    return Curve(solutions, StopReason.max_solutions)


def first_crossed_margin(margins_before: Array, margins_after: Array) -> int:
    """Index of the margin (signed distance from a limit of the curve) that becomes 0 first along a step,
    among the margins that decrease to a negative value; -1 if there is no such margin. A margin that is
    negative before the step counts if it decreases further. margins_before, margins_after: margins at the two
    ends of the step, (margins,), between which each margin is interpolated linearly."""
    # A negative margin that grows does not end the curve, which enters from beyond this limit.
    decreases = (margins_after < 0) & (margins_after < margins_before)
    # Linear interpolation gives the fraction of the step at which each falling margin is 0.
    fraction = np.where(
        decreases, margins_before / np.where(decreases, margins_before - margins_after, 1.0), inf
    )
    first = int(np.argmin(fraction))
    return first if fraction[first] < inf else -1


def step_length_to_zero(
    value: Callable[[float], float],
    ends: tuple[float, float],
    length: float,
    zero_tolerance: float,
    relative_tolerance: float,
) -> float:
    """Length along a step at which a function is 0, by Brent's method; raises Unsolvable if the function has
    the same sign at both ends of the step.

    value: function of the length. ends: values of the function at the lengths 0 and `length`. zero_tolerance:
    values with at most this modulus are treated as 0. relative_tolerance: tolerance of the result, divided by
    `length`."""
    from scipy.optimize import brentq  # slow import: 0.1 s, for few runs

    end_values = {0.0: ends[0], length: ends[1]}
    if not ends[0] * ends[1] <= 0:
        raise Unsolvable("the function has the same sign at both ends of the step, so no zero lies between")

    def settled(position: float) -> float:
        value_here = end_values[position] if position in end_values else value(position)
        # The value 0 ends Brent's method, which would otherwise bisect within rounding errors.
        return 0.0 if abs(value_here) <= zero_tolerance else value_here

    return float(brentq(settled, 0.0, length, xtol=relative_tolerance * length))
