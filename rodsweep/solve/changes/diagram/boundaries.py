"""Boundaries of a phase diagram: the curves through the crossings of the imaginary axis and the double
eigenvalues found on its rows.

The curves are traced from these thresholds of all rows (`rodsweep.solve.changes.diagram.boundary_curves`).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ....arrays import Array
from ....determinant.parameter_plane import ParameterPlane
from ....determinant.stability_boundary import StabilityBoundary
from ...continuation.curves_through_seeds import TracedCurves, trace_all_curves
from ..threshold_kinds import ThresholdKind
from .boundary_curves import BoundaryCurve, trace_boundary


@dataclass(frozen=True, slots=True, kw_only=True)
class BoundaryAssignmentSettings:
    """Settings for the assignment of the thresholds found on rows to boundary curves."""

    scaled_coordinate_tolerance: float = 1e-12
    """Two scaled coordinates are equal if their difference is smaller than this number."""
    relative_eigenvalue_tolerance: float = 1e-3
    """A threshold lies on a curve only if its eigenvalue and the eigenvalue of the curve at the same value of
    the second parameter differ by less than this number, relatively."""
    max_secant_steps: int = 20
    """Maximum number of secant steps to the point of a curve at a given value of the second parameter."""
    max_distance_of_identical_curve_ends: float = 1e-6
    """Two curves are identical if an end of the first and an end of the second (coordinates and log
    |eigenvalue|) are closer than this number, because curves do not cross."""
    max_distance_of_threshold_on_curve: float = 1e-7
    """A threshold closer to a curve than this lies on the curve; both axes have length 1."""
    max_distance_beyond_chord: float = 0.1
    """A chord of a curve is searched for a threshold only if the threshold lies at most this far beyond the
    chord's ends along the first axis, which has length 1; continuation steps are shorter than this number."""


BOUNDARY_ASSIGNMENT_SETTINGS = BoundaryAssignmentSettings()


@dataclass(frozen=True, slots=True)
class BoundarySeed:
    """A threshold on a row, at which a curve may start: values of both parameters, and the eigenvalue."""

    parameter_values: tuple[float, float]
    double_eigenvalue_sign: float
    """0 for a Hopf point, else the sign of the double eigenvalue."""
    frequency_or_double_eigenvalue: float
    """The frequency of a Hopf point, or the double eigenvalue."""


def seed_of(
    values: tuple[float, float], kind: int, frequency: float, growth_rate: float
) -> BoundarySeed | None:
    """The seed at a threshold with the given `values` of both parameters; None where a real eigenvalue and a
    pair only exchange the lead, because such points form no boundary. kind: value of `ThresholdKind`.
    frequency, growth_rate: Im and Re of the eigenvalue, in 1/tau2."""
    if kind in (ThresholdKind.hopf, ThresholdKind.hopf_reverse, ThresholdKind.restabilization):
        return BoundarySeed(values, 0.0, frequency)
    if kind in (ThresholdKind.onset, ThresholdKind.real_again):
        return BoundarySeed(values, math.copysign(1.0, growth_rate), growth_rate)
    return None


@dataclass(frozen=True, slots=True)
class _BoundaryTracingProblem:
    """The boundary curves through the thresholds of all rows, as a problem for `trace_all_curves`."""

    plane: ParameterPlane
    """Plane of the two parameters in which the curves are traced."""
    seeds: list[BoundarySeed]
    """Thresholds of all rows at which a curve may start."""

    def next_seed(self, untraced: Sequence[int]) -> int:
        """Index of the threshold at which the next curve starts: the first of `untraced`, which lie on no
        curve."""
        return untraced[0]

    def missing_work_items(self, seed: int) -> list[int]:
        """No work items for the threshold with index `seed`: its curve is traced at once, in milliseconds."""
        return []

    def curve(self, seed: int) -> BoundaryCurve | None:
        """The curve through the threshold with index `seed`; None if no curve is found."""
        threshold = self.seeds[seed]
        x, y = (
            a.scaled_coordinate(v) for a, v in zip(self.plane.axes, threshold.parameter_values, strict=True)
        )
        return trace_boundary(
            threshold.double_eigenvalue_sign, self.plane, (x, y), threshold.frequency_or_double_eigenvalue
        )

    def distance_along_row(self, curve: BoundaryCurve, seed: int) -> float:
        """Distance of the threshold with index `seed` from `curve` along the first axis, in the scaled
        coordinate of this axis; inf if no point of the curve near the threshold has nearly the threshold's
        eigenvalue."""
        return _distance_along_first_axis(self.plane, curve, self.seeds[seed])

    def are_identical(self, first: BoundaryCurve, second: BoundaryCurve) -> bool:
        """Whether the curves `first` and `second` are identical: they have the same `double_eigenvalue_sign`
        and share an end. The test is needed near a crushed rod, where a threshold may not be found on its own
        curve."""
        ends = first.scaled_points[[0, -1], None] - second.scaled_points[None, [0, -1]]
        return (
            first.double_eigenvalue_sign == second.double_eigenvalue_sign
            and float(np.abs(ends).max(axis=-1).min())
            < BOUNDARY_ASSIGNMENT_SETTINGS.max_distance_of_identical_curve_ends
        )


def boundary_curves_through(plane: ParameterPlane, seeds: list[BoundarySeed]) -> TracedCurves[BoundaryCurve]:
    """Boundary curves in `plane` through all thresholds `seeds`; a threshold that lies on a curve already
    traced starts no further curve."""
    problem = _BoundaryTracingProblem(plane, seeds)
    return trace_all_curves(
        problem, range(len(seeds)), BOUNDARY_ASSIGNMENT_SETTINGS.max_distance_of_threshold_on_curve
    ).traced_curves


def _distance_along_first_axis(plane: ParameterPlane, curve: BoundaryCurve, seed: BoundarySeed) -> float:
    """Distance of the threshold `seed` from the curve along the first axis of `plane`, at the threshold's
    value on the second axis, in the scaled coordinate of the first axis; inf if the curve has another
    `double_eigenvalue_sign`, or no point at this value with nearly the eigenvalue of the threshold."""
    settings = BOUNDARY_ASSIGNMENT_SETTINGS
    if curve.double_eigenvalue_sign != seed.double_eigenvalue_sign:
        return math.inf
    x, y = (a.scaled_coordinate(v) for a, v in zip(plane.axes, seed.parameter_values, strict=True))
    points = curve.scaled_points
    distances_in_y = points[:, 1] - y
    # A threshold on a point of the curve must not fall between two chords by rounding.
    distances_in_y[np.abs(distances_in_y) < settings.scaled_coordinate_tolerance] = 0.0
    if len(points) == 1:
        return (
            float(abs(points[0, 0] - x))
            if abs(distances_in_y[0]) < settings.max_distance_of_threshold_on_curve
            else math.inf
        )
    distance = math.inf
    for i in np.flatnonzero(distances_in_y[:-1] * distances_in_y[1:] <= 0):
        a = points[i]
        b = points[i + 1]
        chord_distance = max(min(a[0], b[0]) - x, x - max(a[0], b[0]))
        if chord_distance > settings.max_distance_beyond_chord:
            continue
        point = _point_at_second_coordinate(StabilityBoundary(plane, curve.double_eigenvalue_sign), a, b, y)
        if (
            point is not None
            and abs(point[2] - math.log(abs(seed.frequency_or_double_eigenvalue)))
            < settings.relative_eigenvalue_tolerance
        ):
            distance = min(distance, float(abs(point[0] - x)))
    return distance


def _point_at_second_coordinate(boundary: StabilityBoundary, a: Array, b: Array, y: float) -> Array | None:
    """The point (x, y, log |eigenvalue|) at the given y of a curve of `boundary`, between the points a and b
    of the curve, (3,) each; None if not found. x, y: scaled coordinates of the first and second parameter.
    Newton's method starts from the chord. If this guess is too far from the curve, secant steps along the
    curve follow."""
    for _ in range(BOUNDARY_ASSIGNMENT_SETTINGS.max_secant_steps):
        fraction = (y - a[1]) / (b[1] - a[1]) if a[1] != b[1] else 0.0
        guess = a + fraction * (b - a)
        guess_at_y = guess.copy()
        guess_at_y[1] = y
        point = boundary.point_near(guess_at_y, np.eye(3)[1])
        if point is not None:
            return point.v
        point = boundary.point_near(guess, (b - a) / np.linalg.norm(b - a))
        if point is None:
            return None
        # The new point replaces the end on its own side of y, as in the rule of false position.
        if (point.v[1] - y) * (b[1] - y) <= 0:
            a = point.v
        else:
            b = point.v
    return None
