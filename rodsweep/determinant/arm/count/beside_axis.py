"""Eigenvalues of an arm beside the imaginary axis, by Newton's method from points on the axis.

Beside the axis, D exp(-Phi) with the dominant wave Phi changes slowly but for the zeros close to it. Newton's
method on this function, without the zeros found before, therefore says at each point of the axis whether a
further zero is close. Nothing proves that all are found.
"""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ....arrays import Array, Complex
from ....model.compiled.compilation import compiled
from ....model.compiled.settings import CompiledSettings
from ..determinant import ArmDeterminant, Level
from ..local_waves import ArmSamples
from ..value import chain_value
from .dominant_wave import slope_of_wave
from .settings import ARM_COUNT


@dataclass(frozen=True, slots=True, kw_only=True)
class BesideAxisSettings(CompiledSettings):
    """Settings for the points on the axis and for Newton's method from them."""

    lowest: float = 0.01
    """Height of the first point, in 1/tau2: crossings of the arms of the surveys lie above 1."""
    ratio: float = 1.25
    """Ratio of the heights of two points."""
    close: float = 0.5
    """Largest first step, and largest distance of a zero from its point, in units of the height."""
    max_steps: int = 12
    """Maximum number of Newton steps from one point."""
    converged: float = 1e-9
    """Relative length of the last step; Newton's method on D refines the eigenvalue further."""
    most: int = 64
    """Maximum number of eigenvalues."""
    ranges: ClassVar = {"ratio": (1.0, math.inf), "close": (0.0, 1.0)}


BESIDE_AXIS = BesideAxisSettings()


def modes_beside_axis(determinant: ArmDeterminant, top: float, known: Complex) -> Complex:
    """Eigenvalues beside the axis with heights up to `top`, (n,), one of each pair, the known ones first.

    Raises FloatingPointError if no elements resolve the arm there.
    """
    found = known[: BESIDE_AXIS.most]
    height = BESIDE_AXIS.lowest
    while height < top:
        W, propagators = determinant.level((1 + BESIDE_AXIS.close) * height, ARM_COUNT.highest)
        heights = [height]
        while heights[-1] * BESIDE_AXIS.ratio < min(top, W / (1 + BESIDE_AXIS.close)):
            heights.append(heights[-1] * BESIDE_AXIS.ratio)
        found = _modes_from(np.array(heights), found, (W, propagators), determinant.gauss_samples)
        height = heights[-1] * BESIDE_AXIS.ratio
    return found


@compiled
def _modes_from(heights: Array, known: Complex, level: Level, samples: ArmSamples) -> Complex:
    """The known eigenvalues, (n,), followed by further ones found by Newton's method from i times each
    height, (k,).
    """
    found = np.empty(BESIDE_AXIS.most, np.complex128)
    n = len(known)
    found[:n] = known
    for height in heights:
        while n < BESIDE_AXIS.most:
            w = _mode_near(complex(0.0, height), found[:n], level, samples)
            if math.isnan(w.real):
                break
            found[n] = w
            n += 1
    return found[:n].copy()


@compiled
def _mode_near(start: complex, known: Complex, level: Level, samples: ArmSamples) -> complex:
    """The eigenvalue near a starting point that is not among the known eigenvalues, (n,); nan if no such
    eigenvalue is close.
    """
    w = start
    for _ in range(BESIDE_AXIS.max_steps):
        value = chain_value(w, level[0], level[1])
        if value.D == 0:
            return w
        slope = value.D_w / value.D - slope_of_wave(w, samples)
        for k in range(len(known)):
            slope -= 1 / (w - known[k]) if w != known[k] else 0j
        if not abs(slope) * BESIDE_AXIS.close * start.imag > 1:
            break
        step = 1 / slope
        w -= step
        if not (w.imag > 0 and abs(w - start) < BESIDE_AXIS.close * start.imag):
            break
        if abs(step) <= BESIDE_AXIS.converged * abs(w):
            return w
    return complex(math.nan, math.nan)
