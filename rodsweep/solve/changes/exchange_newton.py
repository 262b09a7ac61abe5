"""Location of one exchange of the leading eigenvalue between two samples, by Newton's method on D."""

import math
from dataclasses import dataclass
from typing import NamedTuple

from .path_problem import PathEigenproblem
from .spectrum_samples import SpectrumSample


@dataclass(frozen=True, slots=True, kw_only=True)
class ExchangeNewtonSettings:
    """Settings of Newton's method for an exchange of the leading eigenvalue between two samples."""

    max_newton_steps_to_overtaking: int = 60
    """Maximum number of Newton steps to the point at which a real eigenvalue overtakes a pair in growth rate,
    or a pair a real eigenvalue."""
    following_step_count: int = 8
    """Number of steps in which an eigenvalue is followed from a sample to the middle of the interval."""
    converged_step_in_errors: float = 4.0
    """Newton's method for an overtaking (equal growth rates of a real eigenvalue and a pair) stops when the
    step is smaller than this multiple of the error."""
    relative_rounding_of_path_variable: float = 4e-16
    """Relative rounding error of the path variable: two units in the last place."""
    max_relative_eigenvalue_error: float = 1e-6
    """Newton's method for a point where a real eigenvalue and a pair have equal real parts fails if the error
    of an eigenvalue w exceeds this multiple of |w|: w has not converged, for example near a double
    eigenvalue."""


EXCHANGE_NEWTON_SETTINGS = ExchangeNewtonSettings()


class LeaderExchange(NamedTuple):
    """Exchange of the leading eigenvalue at path variable p: a double real eigenvalue (frequency 0), or a
    real eigenvalue and a pair with equal real parts. error_of_p: error of p. growth_rate: the common real
    part. frequency: Im w of the pair. All in 1/tau2, except for p and its error."""

    p: float
    error_of_p: float
    growth_rate: float
    frequency: float


def double_eigenvalue_between(
    problem: PathEigenproblem, pair: SpectrumSample, real: SpectrumSample
) -> LeaderExchange | None:
    """The double eigenvalue between a sample `pair` with a leading pair and a sample `real`
    with two real leading eigenvalues; None if Newton's method does not find it."""
    pair_difference = pair.scaled_squared_difference_and_slope()
    real_difference = real.scaled_squared_difference_and_slope()
    sample_distance = abs(pair.p - real.p)
    if pair_difference is None or real_difference is None:
        return None
    # (w1 - w2)^2 is smooth through the double root, where w itself has a square root: it is interpolated.
    fraction = real_difference[0] / (real_difference[0] - pair_difference[0])
    p = real.p + fraction * (pair.p - real.p)
    x = (1 - fraction) * float((real.w[0] + real.w[1]).real) / 2 + fraction * float(pair.w[0].real)
    x, p, _, error = problem.double_eigenvalue(x, p, sample_distance)
    return None if math.isnan(p) else LeaderExchange(p, error, x, 0.0)


def overtaking_between(
    problem: PathEigenproblem, pair: SpectrumSample, real: SpectrumSample
) -> LeaderExchange | None:
    """The point between two samples where a real eigenvalue and a pair have equal real parts, by Newton's
    method; None if Newton's method does not find it. pair: sample at which a pair leads. real: sample at
    which a real eigenvalue leads."""
    if all(w.imag != 0 for w in pair.w) or all(w.imag == 0 for w in real.w):
        return None  # no eigenvalue of the other kind is known
    p = (pair.p + real.p) / 2
    ends = sorted((pair.p, real.p))
    # Start each eigenvalue from the sample where it leads and carry it to the middle.
    w_real = _follow_eigenvalue(problem, complex(real.w[0]), real.p, p)
    w_pair = _follow_eigenvalue(problem, complex(pair.w[0]), pair.p, p)
    for _ in range(EXCHANGE_NEWTON_SETTINGS.max_newton_steps_to_overtaking):
        w_real, slope_real, error_real = problem.eigenvalue_with_slope_and_error(w_real, p)
        w_pair, slope_pair, error_pair = problem.eigenvalue_with_slope_and_error(w_pair, p)
        slope = slope_real.real - slope_pair.real
        # Near a double eigenvalue Newton's method for D may stop before it converges.
        accuracy = EXCHANGE_NEWTON_SETTINGS.max_relative_eigenvalue_error
        if not (error_real <= accuracy * abs(w_real) and error_pair <= accuracy * abs(w_pair)):
            return None
        # An eigenvalue that changed between real and complex is not the one that was followed.
        if w_real.imag != 0 or abs(w_pair.imag) <= error_pair or slope == 0 or not math.isfinite(slope):
            return None
        step = -(w_real.real - w_pair.real) / slope
        error = (error_real + error_pair) / abs(
            slope
        ) + EXCHANGE_NEWTON_SETTINGS.relative_rounding_of_path_variable * abs(p)
        p += step
        if not ends[0] <= p <= ends[1]:
            return None
        if abs(step) <= EXCHANGE_NEWTON_SETTINGS.converged_step_in_errors * error:
            return LeaderExchange(p, max(error, abs(step)), w_pair.real, abs(w_pair.imag))
        w_real = w_real + step * slope_real
        w_pair = w_pair + step * slope_pair
        if w_real.imag != 0:
            w_real = complex(w_real.real, 0.0)
    return None


def _follow_eigenvalue(problem: PathEigenproblem, w: complex, start: float, stop: float) -> complex:
    """The eigenvalue at p = `stop` that continues w at p = `start`, by small steps of Newton's method."""
    p = start
    for i in range(1, EXCHANGE_NEWTON_SETTINGS.following_step_count + 1):
        w, slope, _ = problem.eigenvalue_with_slope_and_error(w, p)
        next_p = start + (stop - start) * i / EXCHANGE_NEWTON_SETTINGS.following_step_count
        predicted_w = w + slope * (next_p - p)
        w = complex(predicted_w.real, 0.0) if w.imag == 0 else predicted_w
        p = next_p
    return w
