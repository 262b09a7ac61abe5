"""Following of curves, on curves that are known."""

from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rodsweep.solve.continuation.curve import (
    StepControl,
    StepResult,
    StopReason,
    first_crossed_margin,
    follow_curve,
    step_length_to_zero,
)
from rodsweep.solve.unsolvable import Unsolvable

STEPS = StepControl(
    first_length=0.01,
    max_length=0.2,
    min_length=1e-6,
    target_angle=0.1,
    max_angle=0.3,
    max_successive_length_ratio=2.0,
    max_solutions=500,
)


@dataclass(frozen=True)
class Ellipse:
    """x = a cos t, y = b sin t, followed anticlockwise; solutions are points, (2,); ends where x < least."""

    a: float
    b: float
    least: float = -10.0
    gap: tuple[float, float] = (9.0, 9.0)

    def at(self, t):
        return np.array([self.a * np.cos(t), self.b * np.sin(t)])

    def angle(self, point):
        return np.arctan2(point[1] / self.b, point[0] / self.a)

    def tangent(self, point):
        t = self.angle(point)
        way = np.array([-self.a * np.sin(t), self.b * np.cos(t)])
        return way / np.linalg.norm(way)

    def step(self, behind, length):
        """Newton's method for F = 0 with the length along the tangent held."""
        last, tangent = behind[-1], self.tangent(behind[-1])
        guess = point = last + length * tangent
        for _ in range(30):
            residual = (point[0] / self.a) ** 2 + (point[1] / self.b) ** 2 - 1
            matrix = [[2 * point[0] / self.a**2, 2 * point[1] / self.b**2], tangent]
            change = np.linalg.solve(matrix, [-residual, length - (point - last) @ tangent])
            point = point + change
            if np.abs(change).max() < 1e-14:
                break
        else:
            raise Unsolvable("no point of the ellipse is near")
        if self.gap[0] < self.angle(point) < self.gap[1]:
            raise Unsolvable("the curve has a gap")
        return StepResult(point, float(np.linalg.norm(point - guess)), float(self.tangent(point) @ tangent))

    def margins_to_curve_end(self, point):
        return np.array([point[0] - self.least])

    def point_at_zero_margin(self, behind, outer, margin):
        length = float((outer - behind[-1]) @ self.tangent(behind[-1]))
        ends = self.margins_to_curve_end(behind[-1])[0], self.margins_to_curve_end(outer)[0]
        at = step_length_to_zero(
            lambda s: self.margins_to_curve_end(self.step(behind, s).solution)[0], ends, length, 1e-13, 1e-14
        )
        return self.step(behind, at).solution

    def is_closed_by(self, behind, there):
        first, last = behind[0], behind[-1]
        step = np.linalg.norm(there - last)
        near = np.linalg.norm(there - first) < step and np.linalg.norm(last - first) < step
        return len(behind) > 3 and bool(near)


@dataclass(frozen=True)
class LocatedOnShortSteps(Ellipse):
    """An ellipse whose point at the margin is found only from a step of at most `longest`."""

    longest: float = 0.0

    def point_at_zero_margin(self, behind, outer, margin):
        if np.linalg.norm(outer - behind[-1]) > self.longest:
            raise Unsolvable("the start is too far")
        return super().point_at_zero_margin(behind, outer, margin)


def followed(curve, control=STEPS, start=0.0):
    return follow_curve(curve, curve.at(start), control, lambda points: None)


@given(st.floats(0.3, 3.0), st.floats(0.3, 3.0), st.floats(-3.0, 3.0))
def test_a_closed_curve_is_followed_once_through_its_folds(a, b, start):
    curve = Ellipse(a, b)
    found = followed(curve, start=start)
    assert found.end_reason is StopReason.closed
    assert found.solutions[0] is found.solutions[-1]
    angles = np.unwrap([curve.angle(point) for point in found.solutions])
    assert angles[-1] - angles[0] == pytest.approx(2 * np.pi, abs=1e-9)
    assert (np.diff(angles) > 0).all()


@given(st.floats(0.3, 3.0), st.floats(-0.95, 0.95))
def test_a_curve_ends_where_its_margin_is_zero(b, share):
    found = followed(Ellipse(1.0, b, least=share), start=np.arccos(share) / 2)
    assert (found.end_reason, found.margin_index) == (StopReason.zero_margin, 0)
    assert found.solutions[-1] == pytest.approx([share, b * np.sqrt(1 - share**2)], abs=1e-12)
    assert (np.array(found.solutions[:-1])[:, 0] > share).all()


def test_a_step_from_which_the_end_is_not_located_is_shortened():
    found = followed(LocatedOnShortSteps(1.0, 1.0, least=0.3, longest=1e-3))
    assert (found.end_reason, found.margin_index) == (StopReason.zero_margin, 0)
    assert found.solutions[-1] == pytest.approx([0.3, np.sqrt(1 - 0.3**2)], abs=1e-12)
    lost = followed(LocatedOnShortSteps(1.0, 1.0, least=0.3))
    assert lost.end_reason is StopReason.no_further_solution
    assert 0.3 < lost.solutions[-1][0] < 0.3 + 2 * STEPS.min_length


def test_a_curve_that_is_lost_ends_at_its_last_solution_beside_the_gap():
    found = followed(Ellipse(1.0, 1.0, gap=(1.0, 1.5)))
    assert found.end_reason is StopReason.no_further_solution
    assert Ellipse(1.0, 1.0).angle(found.solutions[-1]) == pytest.approx(1.0, abs=2e-6)


def test_a_curve_has_no_more_solutions_than_are_kept():
    found = followed(
        Ellipse(1.0, 1.0),
        StepControl(
            first_length=0.01,
            max_length=0.01,
            min_length=1e-6,
            max_angle=0.3,
            max_successive_length_ratio=2.0,
            max_solutions=7,
        ),
    )
    assert (found.end_reason, len(found.solutions)) == (StopReason.max_solutions, 7)


def test_steps_are_as_long_as_turns_and_predictions_allow():
    """On a circle the turn is the length of arc; the prediction of a tangent is off by its square, halved."""
    by_turn = [np.hypot(*np.diff(followed(Ellipse(1.0, 1.0)).solutions, axis=0)[i]) for i in range(10, 20)]
    assert by_turn == pytest.approx([0.1] * 10, rel=1e-2)
    control = StepControl(
        first_length=0.01,
        max_length=1.0,
        min_length=1e-6,
        target_prediction_error=5e-3,
        prediction_order=2,
        max_angle=1.0,
        max_successive_length_ratio=2.0,
        max_solutions=500,
    )
    by_distance = np.diff(followed(Ellipse(1.0, 1.0), control).solutions, axis=0)[10:20]
    assert np.hypot(*by_distance.T) == pytest.approx([0.1] * 10, rel=1e-2)


def test_a_turn_of_0_or_180_degrees_is_one_whatever_rounding_makes_of_its_cosine():
    above = np.nextafter(1.0, 2.0)
    straight, back = (StepResult(None, 0.0, cosine) for cosine in (above, -above))
    assert STEPS.require_same_curve(straight) is straight
    assert STEPS.next_length(0.01, straight, 5) == 0.01 * STEPS.max_successive_length_ratio
    with pytest.raises(Unsolvable, match="too large an angle"):
        STEPS.require_same_curve(back)


def test_every_step_is_reported_with_the_solutions_before_it():
    heard = []
    found = follow_curve(
        Ellipse(1.0, 1.0, least=0.0), np.array([1.0, 0.0]), STEPS, lambda points: heard.append(list(points))
    )
    assert found.end_reason is StopReason.zero_margin
    assert [len(points) for points in heard] == list(range(1, len(found.solutions)))
    assert all(point is kept for point, kept in zip(heard[-1], found.solutions, strict=False))


@pytest.mark.parametrize(
    ("before", "after", "which"),
    [
        ([1.0, 1.0], [0.5, 0.5], -1),
        ([1.0, 1.0], [-1.0, -3.0], 1),
        ([1.0, 0.1], [-1.0, -1e-3], 0),
        ([0.0, 1.0], [-1.0, 1.0], 0),
        ([-0.5, 1.0], [-0.3, 1.0], -1),
        ([-0.5, 1.0], [-0.5, 1.0], -1),
        ([-0.5, 1.0], [-0.6, 1.0], 0),
    ],
)
def test_the_margin_that_is_passed_first_ends_a_curve(before, after, which):
    """One that is negative at the start ends it only when it falls further."""
    assert first_crossed_margin(np.array(before), np.array(after)) == which


def test_a_zero_along_a_step_needs_two_signs_and_no_value_at_the_ends():
    asked = []

    def cube(x):
        asked.append(x)
        return x**3 - 0.2

    assert step_length_to_zero(cube, (-0.2, 0.8), 1.0, 1e-14, 1e-14) == pytest.approx(
        0.2 ** (1 / 3), abs=1e-13
    )
    assert not {0.0, 1.0} & set(asked)
    with pytest.raises(Unsolvable, match="same sign at both ends"):
        step_length_to_zero(cube, (0.1, 0.8), 1.0, 1e-14, 1e-14)


@given(st.floats(-6.0, 3.0), st.floats(0.01, 0.99), st.floats(-12.0, -2.0))
def test_a_zero_along_a_step_of_any_length_is_as_accurate_as_asked_for(decades, share, digits):
    length, relative = 10.0**decades, 10.0**digits
    ends = -(share**3), 1 - share**3
    found = step_length_to_zero(lambda x: (x / length) ** 3 - share**3, ends, length, 0.0, relative)
    assert abs(found - share * length) <= 2 * relative * length


def test_steps_that_never_grow_are_refused():
    """They would end a curve by the number of its solutions, however far its end is."""
    with pytest.raises(ValueError, match="max_successive_length_ratio"):
        StepControl(
            first_length=0.1, max_length=1.0, min_length=1e-6, max_angle=0.3, max_successive_length_ratio=1.0
        )
