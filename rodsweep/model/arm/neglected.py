"""Effects on an arm that the model neglects, each as a ratio to an effect that the model keeps.

An effect on an arm that varies along its length is evaluated at the section where the effect is largest.

The model does not apply beyond the limit of an effect, and is doubtful from a tenth of the limit on.
Quantities are in SI units. Rates, forces and amplitudes are numbers or NumPy arrays that broadcast.
Sentences about the effects belong to `rodsweep.verdict`.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from enum import IntEnum
from math import inf, isnan, pi

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...arrays import Array
from .arm import SlenderArm
from .drag import Drag
from .section import Tube
from .unsteady_drag import frequency_of_phase, unsteady_phase

GRAVITY = 9.81
"""Acceleration of gravity, in m/s^2."""
DOUBTFUL_FROM = 0.1
"""Ratio of a neglected effect's `value` to its `limit` above which results are doubtful."""
INERTIA_LIMIT = 0.1
"""Limit of the phase lag of the drag caused by inertia, in radians. Inertia lowers the flutter threshold of a
filament by 6.5 % at a phase of 0.1, as much as the uncertainty of drag; by 0.7 % at 0.01; by 36 % at 1."""
COMPRESSION_LIMIT = 0.1
"""Limit of the relative axial compression. Rubber stiffens by a quarter at 0.1, by 2 % at 0.01."""
WEIGHT_LIMIT = 0.1
"""Limit of the ratio of weight minus buoyancy to the weight that buckles the upright arm. A horizontal arm
sags by a tenth of its length at 0.1, by a hundredth at 0.01."""
WALL_LIMIT = 0.1
"""Limit of the fraction of bending stiffness that a tube loses as its section flattens in a large-amplitude
cycle. A tube of infinite length buckles after losing a third of its stiffness."""
WIDE_CURVATURE = 6.0
"""Largest curvature of an arm in a limit cycle, times L, divided by the tip's amplitude in L. Cycles from 2 %
to 50 % above the flutter force have ratios from 5.8 to 6.7."""
REYNOLDS_LIMIT = 1.0
"""Limit of the Reynolds number of a large-amplitude cycle, at which inertia of the flow past the section
equals viscous drag."""
SELF_BUCKLING = 7.837
"""Weight in k3/L^2 at which an upright rod buckles under its own weight (Greenhill 1881)."""
FLUTTER_WAVENUMBER = 4.694
"""Wavenumber of the second bending mode of a clamped rod, times L; the mode approximates the shape of
flutter."""
HALF_LENGTH = 0.5
"""Amplitude of the tip in a large-amplitude cycle, divided by the length of the arm."""


class Validity(IntEnum):
    """Whether the rod model applies although it neglects an effect. Result files store these integers."""

    applies = 0
    doubtful = 1
    does_not_apply = 2


@dataclass(frozen=True, slots=True, kw_only=True)
class Effect:
    """One effect that the model neglects; arrays have the common shape of rates, forces and amplitudes."""

    name: str
    value: Array
    """Ratio of the neglected effect to an effect of the model; nan for an arm at rest."""
    limit: float
    """`value` above which the model does not apply."""
    viscosity_factor: Array
    """Ratio of the viscosity at which `value` equals `limit` to the viscosity of the fluid; inf if no
    viscosity is high enough."""
    of_cycles_only: bool = False
    """Whether the effect changes limit cycles but not the thresholds of the straight arm."""

    @property
    def excess(self) -> Array:
        """Ratio of `value` to `limit`, of the shape of `value`; the model does not apply above 1."""
        return self.value / self.limit

    @property
    def validity(self) -> NDArray[np.int8]:
        """`Validity` of the model under this effect alone, integers of the shape of `value`.

        `applies` for an arm at rest.
        """
        return (self.excess > DOUBTFUL_FROM).astype(np.int8) + (self.excess > 1.0)


def effects_of(
    arm: SlenderArm,
    rate: ArrayLike,
    F: ArrayLike,
    *,
    drag: Drag | None = None,
    amplitude: ArrayLike = HALF_LENGTH,
) -> tuple[Effect, ...]:
    """All neglected effects on a moving arm.

    rate: angular frequency of the motion, in rad/s; nan for an arm at rest. F: `weakest_load` of the follower
    force, in k3/L^2; nan without load. drag: the drag estimate for which `rate` was computed; by default the
    smallest, for which inertia is largest. amplitude: amplitude of the tip divided by L. Weight is included
    if the arm has a density difference, flattening of the wall if the arm has a bore.
    """
    drag = least_drag(arm) if drag is None else drag
    motion, force, wide = np.broadcast_arrays(*(np.asarray(x, float) for x in (rate, F, amplitude)))
    motion = abs(motion)
    effects = [
        inertia_of_arm(arm, motion, drag),
        inertia_of_fluid(arm, motion, drag),
        compression(arm, force),
        reynolds_number(arm, motion, wide),
    ]
    if not isnan(arm.si.density_difference):
        effects.append(weight(arm, force))
    tubes = [each.section for each in arm.shape.stations if isinstance(each.section, Tube)]
    if tubes:
        walls = [wall_effect(arm.si.length, t.radius, t.inner_radius, arm.poisson, wide) for t in tubes]
        effects.append(max(walls, key=lambda effect: np.fmax.reduce(np.ravel(effect.value))))
    return tuple(effects)


def worst_validity(effects: Iterable[Effect], *, of_cycles: bool) -> NDArray[np.int8]:
    """Worst `Validity` under all effects, integers of the effects' shape.

    of_cycles: whether to include effects that change limit cycles only.
    """
    counted = (effect.validity for effect in effects if of_cycles or not effect.of_cycles_only)
    return np.maximum.reduce(list(counted))


def least_drag(arm: SlenderArm) -> Drag:
    """The drag estimate of the arm with the smallest gamma2, for which its motion is fastest."""
    return min(arm.drags, key=lambda drag: drag.gamma2)


def fastest_rate(arm: SlenderArm, frequency: ArrayLike) -> Array:
    """Angular frequency in rad/s of a `frequency` in rad/tau2, of any shape, for the arm's smallest drag."""
    return np.asarray(frequency, float) / arm.tau2_with(least_drag(arm))


def inertia_of_arm(arm: SlenderArm, rate: Array, drag: Drag) -> Effect:
    """Phase lag m omega/gamma2 of the drag, caused by the arm's mass, of the shape of `rate`."""
    along = zip(arm.shape.stations, arm.drags_along(drag), strict=True)
    # The section with the largest ratio of mass to drag decides.
    value = max(arm.mass_at(station) / own.gamma2 for station, own in along) * rate
    # omega falls like 1/viscosity and gamma2 grows like it, so the value falls like 1/viscosity^2.
    factor = np.sqrt(value / INERTIA_LIMIT)
    return Effect(name="inertia of the arm", value=value, limit=INERTIA_LIMIT, viscosity_factor=factor)


def inertia_of_fluid(arm: SlenderArm, rate: Array, drag: Drag) -> Effect:
    """Phase lag of the drag, caused by inertia of the fluid, of the shape of `rate`."""
    logarithm = 4 * pi * arm.si.viscosity / max(own.gamma2 for own in arm.drags_along(drag))
    # Vorticity diffuses over a wavelength of the bending wave, not over the radius.
    k = FLUTTER_WAVENUMBER / arm.si.length
    s = arm.si.fluid_density * rate / (arm.si.viscosity * k**2)
    return Effect(
        name="inertia of the fluid",
        value=unsteady_phase(s, logarithm),
        limit=INERTIA_LIMIT,
        viscosity_factor=np.sqrt(s / frequency_of_phase(INERTIA_LIMIT, logarithm)),
    )


def compression(arm: SlenderArm, F: Array) -> Effect:
    """Relative change of the arm's length by compression or tension, abs(F)/k1, of the shape of F."""
    return _independent_of_viscosity("compression", abs(F) / arm.k1, COMPRESSION_LIMIT)


def weakest_load(arm: SlenderArm, F: ArrayLike) -> Array:
    """Force that compresses the base as much as F compresses the weakest section, of the shape of F.

    F: in k3/L^2. The result is nan for rubber, whose constitutive law includes large compression.
    """
    share = arm.crushing_force / arm.k1
    return np.asarray(F, float) / share if share < inf else np.full(np.shape(F), np.nan)


def weight(arm: SlenderArm, F: Array) -> Effect:
    """Ratio of weight minus buoyancy to the weight that buckles the upright arm, of the shape of F."""
    heaviness = abs(arm.si.density_difference) * GRAVITY
    load = heaviness * arm.cross_section.area * arm.si.length
    uniform = load / (SELF_BUCKLING * arm.force_scale)
    value = arm.shape.relative_weight(heaviness) if arm.shape.varies else uniform
    return _independent_of_viscosity("weight", np.full(F.shape, value), WEIGHT_LIMIT)


def wall_effect(
    length: ArrayLike,
    radius: ArrayLike,
    bore: ArrayLike,
    poisson: ArrayLike,
    amplitude: ArrayLike = HALF_LENGTH,
) -> Effect:
    """Fraction of the bending stiffness that a beating tube loses, of the common shape of the arguments.

    length, radius, bore: in m. amplitude: amplitude of the tip over the length.
    A tube bent to the radius of curvature R flattens by zeta = (1 - nu^2) (r^2/(R t))^2, with the radius r of
    the middle of the wall and the thickness t, and keeps 1 - 3 zeta/2 of its stiffness (Brazier 1927).
    """
    outer, inner, ratio = (np.asarray(x, float) for x in (radius, bore, poisson))
    curvature = WIDE_CURVATURE * np.asarray(amplitude, float) / np.asarray(length, float)
    middle = (outer + inner) / 2
    thickness = outer - inner
    value = 1.5 * (1 - ratio**2) * (curvature * middle**2 / thickness) ** 2
    return _independent_of_viscosity("flattening of the wall", value, WALL_LIMIT, of_cycles_only=True)


def reynolds_number(arm: SlenderArm, rate: Array, amplitude: Array) -> Effect:
    """Reynolds number rho U (2 a)/eta of the tip, whose speed U is rate * amplitude * L.

    rate: in rad/s; amplitude: in L. The effect has the shape of `rate`.
    """
    # The tip is the fastest point of the arm.
    speed = rate * amplitude * arm.si.length
    value = arm.si.fluid_density * speed * 2 * arm.shape.drag_radius / arm.si.viscosity
    return Effect(
        name="Reynolds number",
        value=value,
        limit=REYNOLDS_LIMIT,
        viscosity_factor=np.sqrt(value / REYNOLDS_LIMIT),
        of_cycles_only=True,
    )


def _independent_of_viscosity(name: str, value: Array, limit: float, of_cycles_only: bool = False) -> Effect:
    """An effect whose value does not depend on the viscosity of the fluid."""
    # No viscosity reduces the effect below its limit, and none is needed where the effect is below.
    factor = np.where(value > limit, inf, 0.0)
    return Effect(name=name, value=value, limit=limit, viscosity_factor=factor, of_cycles_only=of_cycles_only)
