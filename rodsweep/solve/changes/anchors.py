"""Anchors (rods of a path whose spectra are solved), and interpolation of the leading eigenvalues between two
neighbouring anchors."""

import math
from dataclasses import dataclass
from functools import cached_property

from ...arrays import Complex


@dataclass(frozen=True, slots=True, kw_only=True)
class AnchorSettings:
    """Settings of the anchors of a path of rods and of the interpolation between two anchors."""

    min_known_modes: int = 4
    """Minimum number of leading eigenvalues computed for one arm of a path (`arm.axis_modes`); at least two
    more than the number of unstable modes are computed."""
    place_accuracy: float = 1e-6
    """Relative accuracy of the eigenvalues of one arm of a path, before the refinement by Newton's method on
    D."""
    min_cubic_ratio: float = 0.25
    """Tolerance of the interpolation between two anchors. The cubic must stay above this fraction of the
    smaller end value, so that no zero is missed. The difference of the end values must agree, within this
    fraction, with the difference that the slopes give by the trapezoidal rule."""


ANCHOR_SETTINGS = AnchorSettings()


@dataclass(frozen=True)
class Anchor:
    """A rod of a path, at path variable p, with its leading eigenvalues w and their slopes dw/dp,
    (ANCHOR_MODE_COUNT,) each.

    relaxation_time: a relaxation time of the rod, smooth in p. relaxation_time_slope: d time/dp. The product
    w time is of order one; w alone grows without bound near crushing for a rod that has neither shear nor
    rotational drag."""

    p: float
    w: Complex
    slope: Complex
    relaxation_time: float = 1.0
    relaxation_time_slope: float = 0.0

    @cached_property
    def oscillates(self) -> bool:
        """Whether the leading eigenvalues are a complex pair."""
        return bool(self.w[0].imag != 0)

    def squared_pair_difference(self) -> tuple[float, float] | None:
        """Returns ((w1 - w2)^2 time^2, derivative of this product with respect to p) for the two leading
        eigenvalues w1, w2; None if w1 is real and w2 is complex."""
        if self.oscillates:
            gap, slope = self._in_units_of_time(2 * self.w[0].imag, 2 * self.slope[0].imag)
            # (w1 - w2)^2 is negative for a pair, positive for two real eigenvalues, and smooth through 0.
            return -(gap**2), -2 * gap * slope
        if self.w[1].imag != 0:
            return None
        gap, slope = self._in_units_of_time(
            (self.w[0] - self.w[1]).real, (self.slope[0] - self.slope[1]).real
        )
        return gap**2, 2 * gap * slope

    def leading_growth_gap(self) -> tuple[float, float] | None:
        """Returns (Re(w1 - w) time, derivative of this product with respect to p). w1: leading eigenvalue. w:
        first complex eigenvalue if w1 is real, first real eigenvalue if w1 is complex; None if there is no
        such w at this anchor."""
        for w, slope in zip(self.w[1:], self.slope[1:], strict=True):
            if (w.imag != 0) != self.oscillates:
                return self._in_units_of_time((self.w[0] - w).real, (self.slope[0] - slope).real)
        return None

    def _in_units_of_time(self, value: float, slope: float) -> tuple[float, float]:
        """Returns (value time, derivative of this product with respect to p) for a quantity `value` with
        derivative `slope`; the factor `relaxation_time` preserves zeros and signs."""
        return float(value * self.relaxation_time), float(
            slope * self.relaxation_time + value * self.relaxation_time_slope
        )


def minimum_of_cubic(a: float, b: float, slope_a: float, slope_b: float) -> tuple[float, float]:
    """Returns (minimum on [0, 1], argument of the minimum) for the cubic with values `a`, `b` and slopes
    `slope_a`, `slope_b` at 0 and 1; the argument is 0.5 if the minimum is at an end."""
    # The cubic a + slope_a t + square t^2 + cube t^3 of Hermite interpolation.
    square = 3 * (b - a) - 2 * slope_a - slope_b
    cube = slope_a + slope_b - 2 * (b - a)
    lowest = min(a, b)
    at = 0.5
    spread = square * square - 3 * cube * slope_a
    if spread >= 0 and (square or cube):
        # The root of slope_a + 2 square t + 3 cube t^2 at the minimum, computed without cancellation.
        root = math.sqrt(spread)
        t = 0.5
        if square + root > 0:
            t = -slope_a / (square + root)
        elif cube:
            t = (root - square) / (3 * cube)
        value = a + t * (slope_a + t * (square + t * cube))
        if 0 < t < 1 and value < lowest:
            lowest = value
            at = t
    return lowest, at


def next_anchor(left: Anchor, right: Anchor) -> tuple[float, bool]:
    """Returns (share, hides). share: position of an additional anchor as a fraction of the interval from
    `left` to `right`; 0 if the slopes explain the end values and exclude exchanges of the leading eigenvalue.
    hides: whether two exchanges may lie between the anchors.

    The leading eigenvalue must be real at both anchors, or a pair at both anchors.
    """
    h = right.p - left.p
    for a, b in (
        (left.squared_pair_difference(), right.squared_pair_difference()),
        (left.leading_growth_gap(), right.leading_growth_gap()),
    ):
        if a is None and b is None:
            continue
        if a is None or b is None:
            value, slope = a or b or (0.0, 0.0)
            if abs(value) < 2 * abs(slope) * h:
                return 0.5, False
            continue
        smallest = min(abs(a[0]), abs(b[0]))
        # By the trapezoidal rule smooth slopes explain the change between the anchors.
        missed = abs(b[0] - a[0] - h * (a[1] + b[1]) / 2)
        sign = math.copysign(h, a[0])
        lowest, share = minimum_of_cubic(abs(a[0]), abs(b[0]), sign * a[1], sign * b[1])
        if a[0] * b[0] <= 0 or lowest < ANCHOR_SETTINGS.min_cubic_ratio * smallest:
            return share, True
        if missed > ANCHOR_SETTINGS.min_cubic_ratio * max(smallest, abs(b[0] - a[0])):
            return 0.5, False
    return 0.0, False
