"""Samples of the spectrum along a path: leading eigenvalues and their slopes at selected rods, and the smooth
quantities that are interpolated between two samples."""

from dataclasses import dataclass
from functools import cached_property

from ...arrays import Complex, list_of


@dataclass(frozen=True, slots=True, kw_only=True)
class SpectrumSampleSettings:
    """Settings of the samples of the spectrum along a path and of the interpolation between two samples."""

    min_computed_modes: int = 4
    """Minimum number of leading eigenvalues computed for one arm of a path; at least two
    more than the number of unstable modes are computed."""
    arm_eigenvalue_accuracy: float = 1e-6
    """Relative accuracy of the eigenvalues of one arm, before the refinement by Newton's method on D."""
    interpolation_tolerance: float = 0.25
    """Tolerance of the interpolation between two samples. The cubic must stay above this fraction of the
    smaller end value, so that no zero is missed. The difference of the end values must agree, within this
    fraction, with the difference that the slopes give by the trapezoidal rule."""


SPECTRUM_SAMPLE_SETTINGS = SpectrumSampleSettings()


@dataclass(frozen=True)
class SpectrumSample:
    """Spectrum of one rod of a path, at path variable p: leading eigenvalues w, in 1/tau2, and their slopes
    dw/dp, (SAMPLED_MODE_COUNT,) each.

    relaxation_time: a relaxation time tau of the rod, smooth in p. relaxation_time_slope: dtau/dp. The
    product tau w is of order one; w alone grows without bound near crushing for a rod that has neither shear
    nor rotational drag.
    """

    p: float
    w: Complex
    slopes: Complex
    relaxation_time: float = 1.0
    relaxation_time_slope: float = 0.0

    @cached_property
    def oscillates(self) -> bool:
        """Whether the leading eigenvalues are a complex pair."""
        return bool(self.w[0].imag != 0)

    def scaled_squared_difference_and_slope(self) -> tuple[float, float] | None:
        """Returns (tau^2 (w1 - w2)^2, derivative of this product with respect to p), tau: `relaxation_time`,
        for the two leading eigenvalues w1, w2; None if w1 is real and w2 is complex."""
        if self.oscillates:
            gap, slope = self._times_relaxation_time(2 * self.w[0].imag, 2 * self.slopes[0].imag)
            # (w1 - w2)^2 is negative for a pair, positive for two real eigenvalues, and smooth through 0.
            return -(gap**2), -2 * gap * slope
        if self.w[1].imag != 0:
            return None
        gap, slope = self._times_relaxation_time(
            (self.w[0] - self.w[1]).real, (self.slopes[0] - self.slopes[1]).real
        )
        # The derivative of w itself is infinite at a double eigenvalue, that of the square is not.
        return gap**2, 2 * gap * slope

    def scaled_other_type_gap_and_slope(self) -> tuple[float, float] | None:
        """Returns (tau Re(w1 - w), derivative of this product with respect to p), tau: `relaxation_time`. w1:
        leading eigenvalue. w: first complex eigenvalue if w1 is real, first real eigenvalue if w1 is complex;
        None if there is no such w at this sample."""
        for i, w in enumerate(self.w[1:], 1):
            # Eigenvalues are sorted by growth, so the first of the other kind can take the lead first.
            if (w.imag != 0) != self.oscillates:
                return self.scaled_growth_gap_and_slope(0, i)
        return None

    def scaled_mean_and_product_of_next_gaps(self) -> tuple[tuple[float, float], tuple[float, float]] | None:
        """Returns (tau (r - (a + b)/2), tau^2 (r - a) (r - b)), each with its derivative with respect to the
        path variable p, tau: `relaxation_time`. r: real part of the leading eigenvalue. a, b: the two
        eigenvalues after the leading eigenvalue or pair; None unless a and b are both real or a complex pair.

        Both products are positive and smooth where a and b change between real and complex; r - a is not.
        """
        first = 2 if self.oscillates else 1
        a, b = list_of(self.w[first : first + 2])
        # Sum and product of two eigenvalues are smooth even where they become a pair; of one half of a pair
        # they are not.
        if not (a.imag == b.imag == 0 or a.imag * b.imag < 0):
            return None
        slope_a, slope_b = list_of(self.slopes[first : first + 2])
        leading_growth, slope = float(self.w[0].real), float(self.slopes[0].real)
        # For a pair this is the squared distance, for two real ones it is positive while both stay below.
        product = ((leading_growth - a) * (leading_growth - b)).real
        product_slope = (
            (slope - slope_a) * (leading_growth - b) + (leading_growth - a) * (slope - slope_b)
        ).real
        squared_time = self.relaxation_time**2, 2 * self.relaxation_time * self.relaxation_time_slope
        return (
            self._times_relaxation_time(
                leading_growth - (a + b).real / 2, slope - (slope_a + slope_b).real / 2
            ),
            (product * squared_time[0], product_slope * squared_time[0] + product * squared_time[1]),
        )

    def scaled_growth_gap_and_slope(self, i: int, j: int) -> tuple[float, float]:
        """Returns (tau Re(w - v), derivative of this product with respect to p), tau: `relaxation_time`, for
        the eigenvalues w and v with the indices i and j."""
        return self._times_relaxation_time(
            (self.w[i] - self.w[j]).real, (self.slopes[i] - self.slopes[j]).real
        )

    def scaled_pair_growth_gap_and_slope(self) -> tuple[float, float]:
        """Returns (tau Re((w1 + w2)/2 - w3), derivative of this product with respect to p), tau:
        `relaxation_time`, for the first three eigenvalues w1, w2, w3."""
        # Each of the two alone has an infinite slope at the double eigenvalue; their mean has not.
        first_gap, first_slope = self.scaled_growth_gap_and_slope(0, 2)
        second_gap, second_slope = self.scaled_growth_gap_and_slope(1, 2)
        return (first_gap + second_gap) / 2, (first_slope + second_slope) / 2

    def scaled_squared_frequency(self, i: int) -> tuple[float, float]:
        """Returns (tau^2 (Im w)^2, its derivative with respect to p), tau: `relaxation_time`, for w =
        `self.w[i]`."""
        frequency, slope = self._times_relaxation_time(self.w[i].imag, self.slopes[i].imag)
        return frequency**2, 2 * frequency * slope

    def _times_relaxation_time(self, value: float, slope: float) -> tuple[float, float]:
        """Returns (tau value, derivative of this product with respect to p) for a quantity `value` with the
        derivative `slope`; the factor tau, the `relaxation_time`, preserves zeros and signs."""
        return float(value * self.relaxation_time), float(
            slope * self.relaxation_time + value * self.relaxation_time_slope
        )
