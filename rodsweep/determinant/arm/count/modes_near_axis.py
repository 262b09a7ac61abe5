"""Eigenvalues of an arm close to the imaginary axis, by Newton's method from points on the axis.

With the dominant wave Phi (`dominant_wave`), D exp(-Phi) varies slowly on the axis, except near its zeros.
Newton's method for this function, divided by w - w_k for every zero w_k found before, converges to a further
zero if a zero is close to the starting point. It is not proved that all zeros close to the axis are found.
"""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ....arrays import Array, Complex
from ....model.compiled.compilation import compiled
from ....model.compiled.kernel_constants import KernelConstants
from ..determinant import ArmDeterminant, PropagatorsUpToW
from ..local_waves import ExponentSamples
from ..value import determinant_from_propagators
from .dominant_wave import dominant_exponent_slope
from .settings import CONTOUR_SETTINGS


@dataclass(frozen=True, slots=True, kw_only=True)
class NearAxisSettings(KernelConstants):
    """Settings for the starting points on the imaginary axis, and for Newton's method from them."""

    first_start_frequency: float = 0.01
    """Im w of the first starting point, in 1/tau2. The crossings of all arms that were tried lie above 1."""
    start_frequency_ratio: float = 1.25
    """Ratio of Im w of a starting point to Im w of the previous starting point."""
    max_distance_from_start_over_frequency: float = 0.5
    """Newton's method stops if a step, or the distance of w from the starting point, exceeds this number
    times Im w of the starting point."""
    max_steps: int = 12
    """Maximum number of Newton steps from one starting point."""
    converged_step_over_w: float = 1e-9
    """Newton's method has converged if |step| <= this number times |w|; eigenvalues are refined later."""
    max_modes: int = 64
    """Maximum number of eigenvalues, including the known eigenvalues."""
    field_ranges: ClassVar = {
        "start_frequency_ratio": (1.0, math.inf),
        "max_distance_from_start_over_frequency": (0.0, 1.0),
    }
    """Exclusive bounds (lower, upper) of fields, by name; see `KernelConstants`."""


NEAR_AXIS_SETTINGS = NearAxisSettings()


def modes_near_axis(determinant: ArmDeterminant, max_frequency: float, known_w: Complex) -> Complex:
    """The known eigenvalues `known_w`, (m,), followed by the eigenvalues found close to the imaginary axis
    with 0 < Im w <= `max_frequency`, in 1/tau2, one of each conjugate pair: (n,), n at most
    `NEAR_AXIS_SETTINGS.max_modes`. Raises FloatingPointError if no elements resolve the arm."""
    eigenvalues = known_w[: NEAR_AXIS_SETTINGS.max_modes]
    height = NEAR_AXIS_SETTINGS.first_start_frequency
    while height < max_frequency:
        # Newton's iterates move up by at most this ratio, so all of them stay within the propagators' W.
        W, propagators = determinant.propagators_for(
            (1 + NEAR_AXIS_SETTINGS.max_distance_from_start_over_frequency) * height,
            CONTOUR_SETTINGS.max_reused_W_over_w,
        )
        heights = [height]
        while heights[-1] * NEAR_AXIS_SETTINGS.start_frequency_ratio < min(
            max_frequency, W / (1 + NEAR_AXIS_SETTINGS.max_distance_from_start_over_frequency)
        ):
            heights.append(heights[-1] * NEAR_AXIS_SETTINGS.start_frequency_ratio)
        eigenvalues = _known_and_found_modes(
            np.array(heights), eigenvalues, (W, propagators), determinant.exponent_samples_at_gauss_points
        )
        height = heights[-1] * NEAR_AXIS_SETTINGS.start_frequency_ratio
    return eigenvalues


@compiled
def _known_and_found_modes(
    heights: Array, known_w: Complex, propagator_set: PropagatorsUpToW, samples: ExponentSamples
) -> Complex:
    """The known eigenvalues, (n,), followed by the eigenvalues that Newton's method finds from w = i height,
    for each of `heights`, (k,). propagator_set: (W, propagators)."""
    eigenvalues = np.empty(NEAR_AXIS_SETTINGS.max_modes, np.complex128)
    n = len(known_w)
    eigenvalues[:n] = known_w
    for height in heights:
        while n < NEAR_AXIS_SETTINGS.max_modes:
            w = _mode_near(complex(0.0, height), eigenvalues[:n], propagator_set, samples)
            if math.isnan(w.real):
                break
            eigenvalues[n] = w
            n += 1
    return eigenvalues[:n].copy()


@compiled
def _mode_near(
    guess: complex, known_w: Complex, propagator_set: PropagatorsUpToW, samples: ExponentSamples
) -> complex:
    """The eigenvalue close to `guess` that is not in `known_w`, (n,); nan if no other eigenvalue is close."""
    w = guess
    for _ in range(NEAR_AXIS_SETTINGS.max_steps):
        value = determinant_from_propagators(w, propagator_set[0], propagator_set[1])
        if value.D == 0:
            return w
        slope = value.D_w / value.D - dominant_exponent_slope(w, samples)
        for k in range(len(known_w)):
            slope -= 1 / (w - known_w[k]) if w != known_w[k] else 0j
        # The step, 1/slope, would leave the neighbourhood of the starting point. Negated, to end at nan too.
        if not abs(slope) * NEAR_AXIS_SETTINGS.max_distance_from_start_over_frequency * guess.imag > 1:
            break
        step = 1 / slope
        w -= step
        if not (
            w.imag > 0
            and abs(w - guess) < NEAR_AXIS_SETTINGS.max_distance_from_start_over_frequency * guess.imag
        ):
            break
        if abs(step) <= NEAR_AXIS_SETTINGS.converged_step_over_w * abs(w):
            return w
    return complex(math.nan, math.nan)
