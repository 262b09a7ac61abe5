"""D(w) of one arm at any w, from elements whose length depends on |w|.

The propagators of an element are polynomials in w/W for |w| <= W. Each level W has its own elements, computed
at first use. Elements are so short that the fastest local exponential grows at most by
exp(`ARM_ELEMENTS.longest`) and that the Gauss points resolve the coefficients; every break of the profile is
an end of an element.
"""

import cmath
import math
from functools import cached_property, lru_cache
from operator import itemgetter
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...model.compiled.compilation import compiled
from ...model.dispersion import PIECE_SAMPLES, sampled
from ...model.material.build import LocalCoefficients
from ...model.rod import Rod
from ..exponents import EXPONENTS
from ..value import DeterminantValue
from .elements.propagators import element_propagators, gauss_method, tail_of
from .elements.settings import ARM_ELEMENTS
from .value import chain_value

Level = tuple[float, Array]
"""W, and propagators for |w| <= W, (elements, terms, 25)."""


class ArmSamples(NamedTuple):
    """Samples along one arm: the force F, `LocalCoefficients` at points, (6, points), and quadrature weights,
    (points,).
    """

    F: float
    local: Array
    weights: Array


class ArmDeterminant:
    """Characteristic determinant D(w) of one arm; propagators are made for |w| <= W and kept.

    known: (W, propagators) made earlier. Methods raise FloatingPointError if `max_elements` do not resolve
    the arm.
    """

    def __init__(self, rod: Rod, known: Level | None = None):
        self.rod = rod
        self._levels: list[Level] = [] if known is None else [known]
        points, weights, local = sampled(rod)
        sampled_coefficients = np.array(local)
        self.samples = ArmSamples(float(rod.F), sampled_coefficients, weights)
        self._samples = Samples(points, weights, LocalCoefficients(*sampled_coefficients[:, None]))

    def value(self, w: complex) -> DeterminantValue:
        """D and D' = dD/dw at w, times exp(-S)."""
        W, polynomials = self.level(abs(w))
        return chain_value(complex(w), W, polynomials)

    def value_at_level(self, w: complex, factor: float) -> DeterminantValue:
        """D and D' at w times exp(-S), with elements that serve |w| times a factor of at least 1."""
        W, polynomials = self.level(factor * abs(w), ARM_ELEMENTS.highest_compared)
        return chain_value(complex(w), W, polynomials)

    def elements(self, size: float) -> int:
        """The number of elements for D at |w| = size."""
        return len(self.level(size)[1])

    def wave_number(self, w: complex) -> float:
        """The mean |q| of the fastest exponential along the arm, in 1/L."""
        return self.scales(w)[0]

    def length(self, w: complex) -> float:
        """Change of w that changes an exponent of D, integrated along the arm, by about one."""
        return self.scales(w)[1]

    def scales(self, w: complex) -> tuple[float, float]:
        """(wave number, length) at w."""
        return scales_at(w, self.samples)

    @cached_property
    def gauss_samples(self) -> ArmSamples:
        """The arm at the Gauss points of each smooth piece."""
        points, _, weights = gauss_method(ARM_ELEMENTS.stages)
        lengths = np.diff(self.rod.build.breaks)[:, None]
        local = self.rod.local((self.rod.build.breaks[:-1, None] + lengths * points).ravel())
        return ArmSamples(float(self.rod.F), np.array(local), (lengths * weights).ravel())

    def level(self, size: float, highest: float | None = None) -> Level:
        """(W >= size, propagators for |w| <= W, (elements, terms, 25)) with the smallest W that exists.

        highest: largest W, in units of the size, that serves; beyond it new elements are made. None:
        `ARM_ELEMENTS.highest`.
        """
        highest = ARM_ELEMENTS.highest if highest is None else highest
        size = max(size, ARM_ELEMENTS.smallest_level)
        for level in self._levels:
            if size <= level[0] <= highest * size:
                return level
        W = ARM_ELEMENTS.headroom * size
        made = W, self._propagators(W)
        self._levels = sorted([*self._levels, made], key=itemgetter(0))
        return made

    def _propagators(self, W: float) -> Array:
        found = elements_for([self.rod], self._samples, W)
        return element_propagators([self.rod.F], found.local, found.lengths, W)[0]


class Samples(NamedTuple):
    """Samples of n arms between the breaks of their profile.

    Points, (points,); the length that each point stands for, (points,); coefficients of each arm, (n,
    points).
    """

    points: Array
    weights: Array
    local: LocalCoefficients


class PropagatorElements(NamedTuple):
    """Lengths of elements, (elements,), and coefficients of n arms at Gauss points, (n, elements, stages)."""

    lengths: Array
    local: LocalCoefficients


def samples_of(rods: list[Rod]) -> Samples:
    """Samples of arms of one build."""
    points, weights, _ = sampled(rods[0])
    return Samples(points, weights, Rod.local_of_all(rods, points))


def elements_for(rods: list[Rod], samples: Samples, W: float) -> PropagatorElements:
    """Elements that resolve every arm of a list, all of one build, for |w| <= W."""
    edges = _edges(rods, samples, W)
    points, _, _ = gauss_method(ARM_ELEMENTS.stages)
    for _ in range(ARM_ELEMENTS.max_halvings):
        if not len(edges) <= ARM_ELEMENTS.max_elements:
            break
        lengths = np.diff(edges)
        local = Rod.local_of_all(rods, edges[:-1, None] + lengths[:, None] * points)
        coarse = tail_of(local).max(axis=0) > ARM_ELEMENTS.largest_tail
        if not coarse.any():
            return PropagatorElements(lengths, local)
        middles = (edges[:-1] + edges[1:])[coarse] / 2
        edges = np.sort(np.append(edges, middles))
    most = ARM_ELEMENTS.max_elements
    raise FloatingPointError(f"{most} elements are too few to resolve this arm at |w| = {W:g}")


def _edges(rods: list[Rod], samples: Samples, W: float) -> Array:
    """Ends of elements for |w| <= W: equal shares of the density that the local exponents ask for."""
    F, tapers = (np.array([getattr(rod, name) for rod in rods]) for name in ("F", "taper"))
    density: Array = bound_of_waves(W, F[:, None], samples.local).max(axis=0) / ARM_ELEMENTS.longest
    for taper in (tapers.min(), tapers.max()):
        if taper != 1:
            apex = 1 / (1 - taper)
            density = np.maximum(density, 1 / (ARM_ELEMENTS.to_apex * np.abs(apex - samples.points)))
    edges = [np.zeros(1)]
    breaks = rods[0].build.breaks
    shares = density.reshape(len(breaks) - 1, -1)
    for start, stop, share in zip(breaks[:-1], breaks[1:], shares, strict=True):
        # The samples are midpoints of equal parts: the sum is the integral at the ends of the parts.
        mass = np.append(0.0, np.cumsum(share)) * (stop - start) / PIECE_SAMPLES
        count = max(1, math.ceil(mass[-1]))
        places = start + (stop - start) * np.arange(PIECE_SAMPLES + 1) / PIECE_SAMPLES
        edges.append(np.interp(mass[-1] * np.arange(1, count + 1) / count, mass, places))
        # Exactly on the break: beyond it the coefficients jump.
        edges[-1][-1] = stop
    return np.concatenate(edges)


def _as_uniform(w: complex, F: Any, local: LocalCoefficients) -> tuple[NDArray, Array, Array, Array]:
    """(w, F, c2, gamma3) of the uniform rods with k3 = gamma2 = 1 that equal the arm at each point."""
    return w * local.gamma2 * local.c3, F * local.c3, local.c2 / local.c3, local.gamma3 / local.gamma2


def bound_of_waves(W: float, F: Any, local: LocalCoefficients) -> Array:
    """An upper bound of |q| for all |w| <= W, at the points of `local`, (..., points); F: (..., 1)."""
    w, force, c2, gamma3 = _as_uniform(W, F, local)
    square = w * (np.abs(local.g) * local.nu + c2 * gamma3 * w)
    return np.sqrt((c2 + gamma3) * w + np.abs(force * local.g) + 2 * np.sqrt(square))


@compiled
def scales_at(w: complex, samples: ArmSamples) -> tuple[float, float]:
    """(mean |q| of both pairs of exponents, 1 / mean of the larger |dq/dw|) along an arm."""
    F, local, weights = samples
    number = 0.0
    rate = 0.0
    for i in range(len(weights)):
        nu, c2, c3, gamma2, gamma3, g = local[:, i]
        v = w * gamma2 * c3
        T = c2 / c3 + gamma3 / gamma2
        X = c2 / c3 * gamma3 / gamma2
        P = cmath.sqrt(v * (g * nu + X * v))
        M = T * v - F * c3 * g
        size = abs(P)
        first = math.sqrt(abs(M + 2 * P))
        second = math.sqrt(abs(M - 2 * P))
        towards = P.conjugate() / size if size > 0 else 1 + 0j
        # Where both squares are close D depends on P^2, which has no branch point, and not on P.
        turn = (g * nu + 2 * X * v) * towards / max(size, 1.0, first, second)
        fast = max(abs(T + turn) / max(1.0, first), abs(T - turn) / max(1.0, second)) / 2
        number += weights[i] * (first + second) / 2
        rate += weights[i] * fast * gamma2 * c3
    return number, 1 / max(rate, EXPONENTS.least_divisor)


@lru_cache(maxsize=ARM_ELEMENTS.arms_kept)
def arm_determinant(rod: Rod) -> ArmDeterminant:
    """D of the arm `rod`, cached."""
    return ArmDeterminant(rod)
