"""Constitutive laws: the energy of a rod per reference length, its derivatives, and the straight state.

A law is the energy U(h1, h2, kappa) = k1 W(h1) + k2 h2^2/2 + k3 B(h1) kappa^2/2 with the stretch energy W and
the bending factor B. W'(1) = 0 and W''(1) = B(1) = 1, so k1, k2 and k3 are the stiffnesses of the undeformed
rod. The stretch nu of a straight rod under the stress n1 = -F solves k1 W'(nu) = -F. The transverse linear
problem depends on the law only through nu and B(nu): kappa = 0 at rest, so B' enters no linear term.

Incompressible neo-Hookean rubber has two variants: a fixed cross-section, or a cross-section that swells as
the rod shortens, in which a fibre at the distance Y from the axis has the stretch h1 - Y h1^(-1/2) kappa.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

FloatOrArray = Any
"""A float, or an array of floats of any shape."""

LARGEST_RUBBER_LOAD = 1e3
"""Largest load F/k1 of rubber, which compresses rubber to nu = 0.018 of its length. There the rounding error
of 1 - nu is 6e-15 of nu. At F/k1 = 1e9 this error is 6e-12 of nu, and errors of eigenvalues were 400 times
the stated errors."""
LARGEST_SWELLING_PULL = 1e50
"""Largest pull -F/k1 of swelling rubber. The sixth power of nu = 3 |F|/k1, which the law contains, overflows
from 8e50 on."""
MIN_ASYMPTOTIC_PULL = 1e6
"""Pull -F/k1 beyond which nu = 3 |F|/k1 to all digits; the cube of |F|/k1 may overflow."""
SHORTENING_NEWTON_STEPS = 2
"""Newton steps for the shortening e = 1 - nu, which double the correct digits. Cardano's formula gives nu, so
that e = 1 - nu loses digits by cancellation for small loads; the residual of e has no cancellation."""


@dataclass(frozen=True, slots=True)
class Law:
    """A constitutive law, by its stretch energy W and bending factor B as functions of the stretch h1.

    Kernels use the compiled twin of all laws in `rodsweep.model.material.stress_strain`; a change of a law is
    a change in both modules. All functions take and return floats or arrays. energy_over_squared_strain:
    W(h1)/(h1 - 1)^2. stress: W'(h1). stiffness: W''(h1). stiffness_slope, stiffness_second_derivative: W'''
    and W''''. bending_factor: B(h1). bending_factor_slope, bending_factor_second_derivative: B' and B''.
    shortening: 1 - nu at the load x = F/k1, from W'(nu) = -x, without cancellation for small loads.
    crushing_load: the load x that crushes the rod; inf if no force crushes the rod. largest_accurate_load:
    largest load x at which nu = 1 - shortening has nearly all digits; inf if the rod is crushed before.
    largest_pull_without_overflow: largest pull -x at which no function overflows; inf if any pull is
    allowed."""

    law_name: str
    """Name of the stress-strain law, the first part of a key of `LAWS`."""
    section_name: str
    """Behaviour of the section under stretch, "fixed" or "swelling": the second part of a key of `LAWS`."""
    energy_over_squared_strain: Callable[[FloatOrArray], FloatOrArray]
    stress: Callable[[FloatOrArray], FloatOrArray]
    stiffness: Callable[[FloatOrArray], FloatOrArray]
    stiffness_slope: Callable[[FloatOrArray], FloatOrArray]
    stiffness_second_derivative: Callable[[FloatOrArray], FloatOrArray]
    bending_factor: Callable[[FloatOrArray], FloatOrArray]
    bending_factor_slope: Callable[[FloatOrArray], FloatOrArray]
    bending_factor_second_derivative: Callable[[FloatOrArray], FloatOrArray]
    shortening: Callable[[FloatOrArray], FloatOrArray]
    crushing_load: float = np.inf
    largest_accurate_load: float = np.inf
    largest_pull_without_overflow: float = np.inf


def _neo_hookean_shortening(x: FloatOrArray) -> FloatOrArray:
    """Shortening e = 1 - nu of neo-Hookean rubber under the load x = F/k1, (...,); nu^3 + 3 x nu^2 = 1.
    Cardano's formula gives a start for Newton's method for e."""
    pull = np.asarray(x, dtype=float)
    x = np.maximum(pull, -MIN_ASYMPTOTIC_PULL)
    discriminant = 0.25 - x**3
    root = np.cbrt(0.5 + np.sqrt(np.maximum(discriminant, 0.0)))
    nu = root**2 - x + (x / root) ** 2
    if (discriminant < 0).any():  # three real roots; only one root is positive
        load = np.maximum(x, 0.5)
        angle = np.arccos(np.minimum(0.5 / load**1.5, 1.0)) / 3
        nu = np.where(discriminant < 0, 0.5 / (np.sqrt(load) * np.cos(angle)), nu)
    e = 1 - nu
    for _ in range(SHORTENING_NEWTON_STEPS):
        nu = 1 - e
        residual = 3 * x * nu**2 - e * (3 - 3 * e + e**2)
        e = e + residual / (3 * nu * (nu + 2 * x))
    e = np.where(pull < -MIN_ASYMPTOTIC_PULL, 1 + 3 * pull, e)
    return e if e.ndim else float(e)


def _ones(h1: FloatOrArray) -> FloatOrArray:
    return np.ones_like(np.asarray(h1, dtype=float))


def _zeros(h1: FloatOrArray) -> FloatOrArray:
    return np.zeros_like(np.asarray(h1, dtype=float))


LINEAR_CONSTITUTIVE_LAW = Law(
    law_name="linear",
    section_name="fixed",
    energy_over_squared_strain=lambda h: 0.5 * _ones(h),
    stress=lambda h: h - 1,
    stiffness=_ones,
    stiffness_slope=_zeros,
    stiffness_second_derivative=_zeros,
    bending_factor=_ones,
    bending_factor_slope=_zeros,
    bending_factor_second_derivative=_zeros,
    shortening=lambda x: x,
    crushing_load=1.0,
)
NEO_HOOKEAN_CONSTITUTIVE_LAW = Law(
    law_name="neo_hookean",
    section_name="fixed",
    energy_over_squared_strain=lambda h: (h + 2) / (6 * h),
    stress=lambda h: (h - 1 / h**2) / 3,
    stiffness=lambda h: (1 + 2 / h**3) / 3,
    stiffness_slope=lambda h: -2 / h**4,
    stiffness_second_derivative=lambda h: 8 / h**5,
    bending_factor=_ones,
    bending_factor_slope=_zeros,
    bending_factor_second_derivative=_zeros,
    shortening=_neo_hookean_shortening,
    largest_accurate_load=LARGEST_RUBBER_LOAD,
)
SWELLING_CONSTITUTIVE_LAW = replace(
    NEO_HOOKEAN_CONSTITUTIVE_LAW,
    section_name="swelling",
    bending_factor=lambda h: (1 + 2 / h**3) / (3 * h),
    bending_factor_slope=lambda h: -(1 + 8 / h**3) / (3 * h**2),
    bending_factor_second_derivative=lambda h: (2 / h**3 + 40 / h**6) / 3,
    largest_pull_without_overflow=LARGEST_SWELLING_PULL,
)
LAWS = {
    (law.law_name, law.section_name): law
    for law in (LINEAR_CONSTITUTIVE_LAW, NEO_HOOKEAN_CONSTITUTIVE_LAW, SWELLING_CONSTITUTIVE_LAW)
}
"""All constitutive laws by (law name, section name)."""


def law_of(law_name: str, section_name: str) -> Law:
    """The constitutive law with the key (law_name, section_name) in `LAWS`. Raises ValueError for an unknown
    pair."""
    if (law_name, section_name) not in LAWS:
        sections = [key[1] for key in LAWS if key[0] == law_name]
        if not sections:
            allowed = " or ".join(dict.fromkeys(name for name, _ in LAWS))
            raise ValueError(f"law = {law_name} is not known; it must be {allowed}")
        allowed = " or ".join(sections)
        raise ValueError(f"section = {section_name} is not known for law = {law_name}; it must be {allowed}")
    return LAWS[law_name, section_name]
