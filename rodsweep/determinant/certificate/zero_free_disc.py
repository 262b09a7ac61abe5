"""The zero-free radius of a node: the radius of a disc about a point w within which D is proved to have no
zero.

About a node c the function f(w) = D(w) exp(-L (w - c)), L = D'(c)/D(c), has f'(c) = 0, so Cauchy's estimate
on the disc of radius rho, where |f| <= M, gives

    |f(w) - f(c)| <= M r^2/(rho (rho - r)),   r = |w - c|.

If the bound is below 0.9 |D(c)| minus the rounding error of D, no zero lies within r and the phase of f
changes by less than pi/2. (The remaining tenth allows for the rounding error of L, and therefore of f'(c).)
The largest such r is the zero-free radius. It is 0 if the rounding error of D cannot separate a zero of D
from the node.
"""

import cmath
import math
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

from ...model.compiled.compilation import compiled
from ...model.compiled.kernel_constants import KernelConstants
from ...model.rod import Coefficients
from ..exponents import EXPONENT_SETTINGS
from ..parameter_path import DispersionCoefficientDerivatives
from ..value import exponent_derivatives, scaled_determinant
from .discs import DISC_BOUND_SETTINGS, bidisc_centre, bound_on_bidisc

ZERO_COEFFICIENT_DERIVATIVES = DispersionCoefficientDerivatives(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
"""Derivatives of the coefficients along a path, all 0: bounds then apply to a single rod."""


@dataclass(frozen=True, slots=True, kw_only=True)
class NodeDiscSettings(KernelConstants):
    """Settings for the disc about a node on which D is bounded."""

    min_branch_point_distance_over_radius: float = 3.0
    """Least ratio of the distance of a node from the nearest branch point to the radius of its disc."""
    max_relative_z_change: float = 0.4
    """Largest relative change of z+- over a disc, so that the exponents of D change by order one."""
    min_z_modulus_that_limits_radius: float = 1e-3
    """If |z+-| is below this number, sqrt(z+-) does not limit the radius of the disc."""
    field_ranges: ClassVar = {"min_branch_point_distance_over_radius": (1.0, math.inf)}
    """Exclusive bounds (lower, upper) of fields, by name, that the proofs require; see `KernelConstants`."""


NODE_DISC_SETTINGS = NodeDiscSettings()


class ZeroFreeDiscNode(NamedTuple):
    """A point w with D exp(-S), L = D'/D, and the radius of a disc about w that is proved free of zeros."""

    w: complex
    D: complex
    log_derivative: complex
    zero_free_radius: float
    """Radius of a disc about w that is proved free of zeros of D, in 1/tau2; 0 if |D| is not above its
    rounding error."""


@compiled
def trial_radius(w: complex, coefficients: Coefficients, L: complex, S: float) -> float:
    """Radius of a disc about w that avoids branch points and over which the exponents of D change by order
    one. L: D'/D at w. S: logarithm of the scale of D at w."""
    F, nu, c2, gamma3 = coefficients
    _, P1, P2, plus, minus = exponent_derivatives(w, coefficients)
    stiffness = abs((nu + F * c2) * nu + c2 * gamma3 * w)
    rho = abs(w) / NODE_DISC_SETTINGS.min_branch_point_distance_over_radius
    if c2 * gamma3 > 0:
        rho = min(rho, stiffness / (NODE_DISC_SETTINGS.min_branch_point_distance_over_radius * c2 * gamma3))
    rho = min(rho, (S + 1) / max(abs(L), EXPONENT_SETTINGS.min_divisor))
    # A recessive exponential contributes little to D (large slack), so it may change more over the disc.
    for sign, z in ((1.0, plus), (-1.0, minus)):
        slope = c2 + gamma3 + sign * 2 * P1
        root = cmath.sqrt(z)
        recessive_distance = S - root.real + 1
        rho = min(
            rho,
            NODE_DISC_SETTINGS.max_relative_z_change
            * max(abs(z), 2.0)
            / max(abs(slope), EXPONENT_SETTINGS.min_divisor),
        )
        if abs(z) > NODE_DISC_SETTINGS.min_z_modulus_that_limits_radius:
            rate = slope / (2 * root)
            rho = min(rho, recessive_distance / max(abs(rate - L), EXPONENT_SETTINGS.min_divisor))
            rho = min(rho, math.sqrt(2 * recessive_distance * abs(root) / (abs(P2) + abs(rate) ** 2)))
    return rho


@compiled
def zero_free_disc_at(w: complex, coefficients: Coefficients) -> ZeroFreeDiscNode:
    """The point w with its zero-free radius, for a uniform rod. Within the zero-free radius the phase of D
    exp(-L dw) changes by less than pi/2. The radius and L are 0 if |D| is not above its rounding error."""
    D, D_w, S, rounding_error = scaled_determinant(w, coefficients)
    max_remainder = (
        DISC_BOUND_SETTINGS.max_D_change_ratio * abs(D)
        - DISC_BOUND_SETTINGS.rounding_safety_factor * rounding_error
    )
    # |D| below its rounding error proves nothing; the zero-free radius of 0 ends the walk.
    if not max_remainder > 0:
        return ZeroFreeDiscNode(w, D, 0j, 0.0)
    L = D_w / D
    centre = bidisc_centre(w, coefficients, ZERO_COEFFICIENT_DERIVATIVES, S)
    valid_radius = 0.0
    rho = trial_radius(w, coefficients, L, S)
    # Half the radius may prove more, because the bound M grows exponentially with the radius.
    for _ in range(2):
        M = bound_on_bidisc(centre, (L, 0j), (rho, 0.0))
        q = max_remainder / M
        # The largest r with M r^2/(rho (rho - r)) < max_remainder, Cauchy's estimate on the disc.
        valid_radius = max(valid_radius, rho * (math.sqrt(q * q + 4 * q) - q) / 2)
        rho /= 2
    return ZeroFreeDiscNode(w, D, L, valid_radius)
