"""Effects on an arm that the model neglects, each as a ratio to an effect that the model contains.

For an arm that varies along its length, an effect is evaluated at the section where the effect is largest.
The model does not apply if an effect exceeds its limit, and is doubtful above a tenth of the limit.
Quantities are in SI units. Rates, forces and amplitudes are numbers or NumPy arrays that broadcast. Sentences
about the effects are in `rodsweep.verdict`.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from enum import IntEnum
from math import inf, isnan, nan, pi

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...arrays import Array
from .arm import SlenderArm
from .drag import Drag
from .section import Tube
from .unsteady_drag import drag_phase_lag, frequency_of_phase_lag

GRAVITATIONAL_ACCELERATION = 9.81
"""Acceleration of gravity, in m/s^2."""
DOUBTFUL_RATIO = 0.1
"""Results are doubtful if `value`/`limit` of a neglected effect is larger than this."""
INERTIA_LIMIT = 0.1
"""Limit of the phase lag of the drag caused by inertia, in radians. The lag lowers the flutter threshold of a
filament by 6.5 % at 0.1, as much as the uncertainty of drag; by 0.7 % at 0.01; by 36 % at 1."""
COMPRESSION_LIMIT = 0.1
"""Limit of the relative axial compression. Rubber stiffens by a quarter at 0.1, by 2 % at 0.01."""
WEIGHT_LIMIT = 0.1
"""Limit of the ratio of weight minus buoyancy to the weight that buckles the upright arm. At a ratio of 0.1 a
horizontal arm sags by a tenth of its length, at 0.01 by a hundredth."""
WALL_FLATTENING_LIMIT = 0.1
"""Limit of the fraction of bending stiffness that a tube loses as its section flattens in a large-amplitude
cycle. An infinitely long tube buckles after losing a third of its stiffness."""
CURVATURE_OVER_AMPLITUDE = 6.0
"""Largest curvature of an arm in a limit cycle, in 1/L, divided by the amplitude of the tip, in L. For cycles
from 2 % to 50 % above the flutter force the ratio is 5.8 to 6.7."""
REYNOLDS_LIMIT = 1.0
"""Limit of the Reynolds number of a large-amplitude cycle, at which the flow's inertia equals its drag."""
SELF_BUCKLING_WEIGHT = 7.837
"""Weight in k3/L^2 at which an upright rod buckles under its own weight (Greenhill 1881)."""
FLUTTER_WAVENUMBER = 4.694
"""Wavenumber of the second bending mode of a clamped rod, in 1/L: approximately the shape of flutter."""
LARGE_AMPLITUDE = 0.5
"""Amplitude of the tip in a large-amplitude cycle, in L."""


class Validity(IntEnum):
    """Validity of the rod model, judged by one neglected effect. Result files contain these integers."""

    applies = 0
    doubtful = 1
    does_not_apply = 2


@dataclass(frozen=True, slots=True, kw_only=True)
class Effect:
    """One effect that the model neglects. Arrays have the shape (...,) of rates, forces and amplitudes."""

    name: str
    """Name of the neglected effect in reports."""
    value: Array
    """Ratio of the neglected effect to an effect in the model; nan if unknown, as inertia at rest."""
    limit: float
    """The model does not apply if `value` is larger than this."""
    viscosity_factor_at_limit: Array
    """Factor on the viscosity of the fluid with which `value` would equal `limit`. For an effect that does
    not depend on the viscosity: 0 if `value` is at most `limit`, else inf."""
    is_of_cycles_only: bool = False
    """Whether the effect changes only limit cycles, not the thresholds of the straight arm."""

    @property
    def value_over_limit(self) -> Array:
        """Ratio of `value` to `limit`, (...,). The model does not apply where the ratio is larger than 1."""
        return self.value / self.limit

    @property
    def validity(self) -> NDArray[np.int8]:
        """`Validity` of the model given this effect, integers, (...,); `applies` where `value` is nan."""
        return (self.value_over_limit > DOUBTFUL_RATIO).astype(np.int8) + (self.value_over_limit > 1.0)


def neglected_effects(
    arm: SlenderArm,
    rate: ArrayLike,
    F: ArrayLike,
    *,
    drag: Drag | None = None,
    amplitude: ArrayLike = LARGE_AMPLITUDE,
) -> tuple[Effect, ...]:
    """All neglected effects on a moving arm. rate: angular frequency of the motion, in rad/s; nan for an arm
    at rest. F: `base_force_of_largest_compression` of the follower force, in k3/L^2; nan without load. drag:
    the drag estimate for which `rate` was computed; by default the smallest estimate, for which inertia is
    largest. amplitude: amplitude of the tip divided by L. Weight is included if the arm has a density
    difference, flattening of the wall if the arm has a bore."""
    drag = smallest_drag(arm) if drag is None else drag
    omega, forces, tip_amplitude = np.broadcast_arrays(*(np.asarray(x, float) for x in (rate, F, amplitude)))
    # A rate may come from an eigenvalue of negative imaginary part.
    omega = abs(omega)
    effects = [
        arm_inertia_effect(arm, omega, drag),
        fluid_inertia_effect(arm, omega, drag),
        compression_effect(arm, forces),
        reynolds_number_effect(arm, omega, tip_amplitude),
    ]
    if not isnan(arm.si.density_difference):
        effects.append(weight_effect(arm, forces))
    tubes = [station.section for station in arm.geometry.stations if isinstance(station.section, Tube)]
    if tubes:
        L = arm.si.length
        wall_effects = [
            wall_flattening_effect(L, t.radius, t.inner_radius, arm.poisson, tip_amplitude) for t in tubes
        ]
        # The weakest tube decides; `fmax` ignores amplitudes that are unknown.
        effects.append(max(wall_effects, key=lambda effect: np.fmax.reduce(np.ravel(effect.value))))
    return tuple(effects)


def worst_validity(effects: Iterable[Effect], *, of_cycles: bool) -> NDArray[np.int8]:
    """Worst `Validity` under all effects, integers of the shape (...,) of the effects. of_cycles: whether to
    include effects that change only limit cycles."""
    validities = (effect.validity for effect in effects if of_cycles or not effect.is_of_cycles_only)
    return np.maximum.reduce(list(validities))


def smallest_drag(arm: SlenderArm) -> Drag:
    """The drag estimate with the smallest gamma2, for which the motion of the arm is fastest."""
    # Rates in Hz scale with 1/gamma2, so inertia is judged at its largest.
    return min(arm.base_drag_estimates, key=lambda drag: drag.gamma2)


def angular_frequency_at_smallest_drag(arm: SlenderArm, frequency: ArrayLike) -> Array:
    """Angular frequency in rad/s for the smallest drag of the arm. frequency: in rad/tau2, (...,)."""
    return np.asarray(frequency, float) / arm.tau2_with(smallest_drag(arm))


def arm_inertia_effect(arm: SlenderArm, omega: Array, drag: Drag) -> Effect:
    """Phase lag m omega/gamma2 of the drag, caused by the arm's mass per length m. omega: angular frequency
    in rad/s, (...,)."""
    places = zip(arm.geometry.stations, arm.drags_along(drag), strict=True)
    # The value is taken at the section with the largest ratio of mass to drag.
    value = max(arm.mass_per_length_at(station) / local_drag.gamma2 for station, local_drag in places) * omega
    # omega ~ 1/viscosity and gamma2 ~ viscosity, so the value is proportional to 1/viscosity^2.
    factor = np.sqrt(value / INERTIA_LIMIT)
    return Effect(
        name="inertia of the arm", value=value, limit=INERTIA_LIMIT, viscosity_factor_at_limit=factor
    )


def fluid_inertia_effect(arm: SlenderArm, omega: Array, drag: Drag) -> Effect:
    """Phase lag of the drag, caused by the inertia of the fluid. omega: in rad/s, (...,)."""
    # The largest drag has the smallest logarithm, and with it the largest lag.
    logarithm = 4 * pi * arm.si.viscosity / max(local_drag.gamma2 for local_drag in arm.drags_along(drag))
    # Vorticity diffuses over a wavelength of the bending wave, not over the radius.
    k = FLUTTER_WAVENUMBER / arm.si.length
    relative_frequency = arm.si.fluid_density * omega / (arm.si.viscosity * k**2)
    is_at_rest = np.isnan(relative_frequency).all()
    # The search for this frequency would take half of the time of `rodsweep check` for many arms at rest.
    limit_frequency = nan if is_at_rest else frequency_of_phase_lag(INERTIA_LIMIT, logarithm)
    return Effect(
        name="inertia of the fluid",
        value=drag_phase_lag(relative_frequency, logarithm),
        limit=INERTIA_LIMIT,
        # The relative frequency is proportional to rate over viscosity, thus to 1/viscosity^2.
        viscosity_factor_at_limit=np.sqrt(relative_frequency / limit_frequency),
    )


def compression_effect(arm: SlenderArm, F: Array) -> Effect:
    """Relative change of the length of the arm, abs(F)/k1, as an array of the shape of F. F: in k3/L^2,
    (...,)."""
    return _effect_independent_of_viscosity("compression", abs(F) / arm.k1, COMPRESSION_LIMIT)


def base_force_of_largest_compression(arm: SlenderArm, F: ArrayLike) -> Array:
    """Force, in k3/L^2 and of the shape of F, that compresses the base as much as F compresses the weakest
    section. F: in k3/L^2, (...,). The result is nan for rubber, whose law includes large compression."""
    # At the base a force F compresses by F/k1, at the weakest section by F over the crushing force.
    crushing_ratio = arm.crushing_force / arm.k1
    return np.asarray(F, float) / crushing_ratio if crushing_ratio < inf else np.full(np.shape(F), np.nan)


def weight_effect(arm: SlenderArm, F: Array) -> Effect:
    """Ratio of weight minus buoyancy to the weight that buckles the upright arm. The ratio does not depend on
    F, (...,), and has the shape of F."""
    # A lighter arm is pulled up as much as a heavier one is pulled down.
    weight_density = abs(arm.si.density_difference) * GRAVITATIONAL_ACCELERATION
    weight = weight_density * arm.cross_section.area * arm.si.length
    # For a uniform arm the closed value is exact, where the quadrature is not.
    ratio_of_uniform_arm = weight / (SELF_BUCKLING_WEIGHT * arm.force_scale)
    varies = arm.geometry.varies_along_arm
    value = arm.geometry.weight_over_buckling_weight(weight_density) if varies else ratio_of_uniform_arm
    return _effect_independent_of_viscosity("weight", np.full(F.shape, value), WEIGHT_LIMIT)


def wall_flattening_effect(
    length: ArrayLike,
    radius: ArrayLike,
    bore: ArrayLike,
    poisson: ArrayLike,
    amplitude: ArrayLike = LARGE_AMPLITUDE,
) -> Effect:
    """Fraction of the bending stiffness that a beating tube loses, in the common shape (...,) of the
    arguments. length, radius (outer) and bore (inner radius): in m. poisson: nu. amplitude: amplitude of the
    tip divided by the length. A tube bent to the radius of curvature R flattens by zeta = (1 - nu^2) (r^2/(R
    t))^2, where r is the radius of the middle of the wall and t the thickness; the remaining fraction of its
    stiffness is 1 - 3 zeta/2 (Brazier 1927)."""
    outer, inner, nu = (np.asarray(x, float) for x in (radius, bore, poisson))
    curvature = CURVATURE_OVER_AMPLITUDE * np.asarray(amplitude, float) / np.asarray(length, float)
    middle_radius = (outer + inner) / 2
    thickness = outer - inner
    value = 1.5 * (1 - nu**2) * (curvature * middle_radius**2 / thickness) ** 2
    return _effect_independent_of_viscosity(
        "flattening of the wall", value, WALL_FLATTENING_LIMIT, is_of_cycles_only=True
    )


def reynolds_number_effect(arm: SlenderArm, omega: Array, amplitude: Array) -> Effect:
    """Reynolds number rho U (2 a)/eta of the tip, which has the speed U = omega * amplitude * L. omega: in
    rad/s, (...,). amplitude: in L. The effect has the shape of `omega`."""
    # The tip is the fastest point of the arm.
    speed = omega * amplitude * arm.si.length
    value = arm.si.fluid_density * speed * 2 * arm.geometry.largest_drag_radius / arm.si.viscosity
    return Effect(
        name="Reynolds number",
        value=value,
        limit=REYNOLDS_LIMIT,
        viscosity_factor_at_limit=np.sqrt(value / REYNOLDS_LIMIT),
        is_of_cycles_only=True,
    )


def _effect_independent_of_viscosity(
    name: str, value: Array, limit: float, is_of_cycles_only: bool = False
) -> Effect:
    """The effect `name`, whose `value` does not depend on the viscosity: its viscosity factor is inf if
    `value` exceeds `limit`, otherwise 0. is_of_cycles_only: whether the effect changes only limit cycles."""
    # No viscosity reduces the effect; below the limit a fluid of any viscosity is allowed.
    viscosity_factor = np.where(value > limit, inf, 0.0)
    return Effect(
        name=name,
        value=value,
        limit=limit,
        viscosity_factor_at_limit=viscosity_factor,
        is_of_cycles_only=is_of_cycles_only,
    )
