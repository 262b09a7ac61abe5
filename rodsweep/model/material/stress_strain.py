"""Compiled stress-strain relation of every law: n1 and m3 from unknowns that are regular at c1 = 0. The same
laws as functions of the stretch, for Python code, are in `rodsweep.model.material.laws`.

The unknowns q1, q2, q3 are the stresses, minus the stresses at rest, of a linear rod with the same strain: h1
= nu + c1 q1, h2 = c2 q2, kappa = c3 q3. The true stresses, minus the stresses at rest, are

    N(q1, q3) = q1 [W'(h1) - W'(nu)]/(h1 - nu) + B'(h1) c3 q3^2/2,     q2,     M(q1, q3) = B(h1) q3

with the stretch energy W and the bending factor B of `laws`. No formula divides by a compliance, so c1 = 0 is
allowed. A linear rod has N = q1 and M = q3.
"""

import math
from typing import NamedTuple

from ..compiled.compilation import compiled
from .laws import LAWS, MIN_ASYMPTOTIC_PULL, SHORTENING_NEWTON_STEPS

LINEAR_LAW_NUMBER, FIXED_SECTION_LAW_NUMBER, SWELLING_SECTION_LAW_NUMBER = range(len(LAWS))
"""Numbers of the constitutive laws in compiled code, in the order of `LAWS`."""


class LocalSection(NamedTuple):
    """Stretch nu at rest, and compliances c1 of stretching and c3 of bending, at one point of a rod."""

    nu: float
    c1: float
    c3: float


class StressMinusRestStress(NamedTuple):
    """Axial force N and bending moment M, minus their values at rest."""

    N: float
    M: float


class TangentMatrix(NamedTuple):
    """Derivatives of axial force N and moment M: N1 = dN/dq1, N3 = dN/dq3, M1 = dM/dq1, M3 = dM/dq3."""

    N1: float
    N3: float
    M1: float
    M3: float


@compiled
def bending_factor_and_derivatives(law: int, h: float) -> tuple[float, float, float]:
    """Returns (B, B', B''): bending factor B of the law at the stretch h, and its derivatives by h; the
    bending moment is B(h) q3. law: number of the law."""
    if law == SWELLING_SECTION_LAW_NUMBER:
        # The law is that of an incompressible rubber whose section shrinks as the rod is stretched.
        a = 1 / h
        b = 1 / h**4
        return (a + 2 * b) / 3, -(a + 8 * b) / (3 * h), (2 * a + 40 * b) / (3 * h * h)
    return 1.0, 0.0, 0.0


@compiled
def shortening(law: int, x: float) -> float:
    """Shortening 1 - nu at the load x = F/k1, for the law with the number `law`, see `Law.shortening`."""
    if law == LINEAR_LAW_NUMBER:
        return x
    if x < -MIN_ASYMPTOTIC_PULL:
        return 1 + 3 * x
    discriminant = 0.25 - x * x * x
    if discriminant < 0:
        nu = 0.5 / (math.sqrt(x) * math.cos(math.acos(min(0.5 / x**1.5, 1.0)) / 3))
    else:
        root = (0.5 + math.sqrt(discriminant)) ** (1 / 3)
        nu = root * root - x + (x / root) * (x / root)
    e = 1 - nu
    for _ in range(SHORTENING_NEWTON_STEPS):
        nu = 1 - e
        residual = 3 * x * nu * nu - e * (3 - 3 * e + e * e)
        e += residual / (3 * nu * (nu + 2 * x))
    return e


@compiled
def _neo_hookean_secant(nu: float, h: float) -> float:
    """[W'(h) - W'(nu)]/(h - nu) of the neo-Hookean law, without cancellation for h close to nu. W: stretch
    energy. h, nu: stretch, and stretch at rest."""
    a = 1 / nu
    b = 1 / h
    return (1 + a * b * (a + b)) / 3


@compiled
def stress_minus_rest_stress(law: int, material: LocalSection, q1: float, q3: float) -> StressMinusRestStress:
    """Stresses N and M at one point, minus their values at rest, for the unknowns q1 and q3. law: number of
    the law. material: stretch at rest and compliances at the point."""
    if law == LINEAR_LAW_NUMBER:
        return StressMinusRestStress(q1, q3)
    h = material.nu + material.c1 * q1
    # The energy of bending depends on the stretch, so a bent rod has an axial force from it.
    B, B1, _ = bending_factor_and_derivatives(law, h)
    return StressMinusRestStress(
        q1 * _neo_hookean_secant(material.nu, h) + B1 * material.c3 * q3 * q3 / 2, B * q3
    )


@compiled
def stress_tangent(law: int, material: LocalSection, q1: float, q3: float) -> TangentMatrix:
    """Derivatives of the stresses N and M at one point with respect to the unknowns q1 and q3. law: number of
    the law. material: stretch at rest and compliances at the point."""
    if law == LINEAR_LAW_NUMBER:
        return TangentMatrix(1.0, 0.0, 0.0, 1.0)
    h = material.nu + material.c1 * q1
    B, B1, B2 = bending_factor_and_derivatives(law, h)
    stiffness = (1 + 2 / h**3) / 3  # W''(h)
    coupling = B1 * q3
    return TangentMatrix(
        stiffness + material.c1 * B2 * material.c3 * q3 * q3 / 2,
        coupling * material.c3,
        coupling * material.c1,
        B,
    )


@compiled
def stress_parameter_derivative(
    law: int, material: LocalSection, change: LocalSection, q1: float, q3: float
) -> StressMinusRestStress:
    """Derivatives of the stresses N and M with respect to a parameter, at fixed unknowns q1 and q3. change:
    derivatives of the fields of `material` with respect to the parameter. law: number of the law."""
    if law == LINEAR_LAW_NUMBER:
        return StressMinusRestStress(0.0, 0.0)
    h = material.nu + material.c1 * q1
    h_derivative = change.nu + change.c1 * q1
    a = 1 / material.nu
    b = 1 / h
    # Derivatives of the secant [W'(h) - W'(nu)]/(h - nu) with respect to nu and h.
    secant_nu = -a * a * b * (2 * a + b) / 3
    secant_h = -a * b * b * (a + 2 * b) / 3
    _, B1, B2 = bending_factor_and_derivatives(law, h)
    bending_part = q3 * q3 / 2 * (B2 * h_derivative * material.c3 + B1 * change.c3)
    return StressMinusRestStress(
        q1 * (secant_nu * change.nu + secant_h * h_derivative) + bending_part, B1 * h_derivative * q3
    )
