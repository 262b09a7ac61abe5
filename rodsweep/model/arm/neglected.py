"""What the model leaves out of an arm, as numbers: each neglected effect beside what the model keeps.

Of an arm that varies along its length each effect is that of the section where it is largest.

An effect has a limit beyond which the model does not apply; from a tenth of the limit on it is doubtful.
Quantities are in SI units. Rates, forces and amplitudes are numbers or NumPy arrays that broadcast.
Sentences about the effects belong to `rodsweep.verdict`.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from enum import IntEnum
from math import exp, inf, isnan, log, pi

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...arrays import Array
from .arm import SlenderArm
from .drag import Drag
from .section import Tube

GRAVITY = 9.81
"""Acceleration of gravity, in m/s^2."""
DOUBTFUL_FROM = 0.1
"""Fraction of a limit from which an effect makes numbers doubtful: ten times smaller than where they fail."""
INERTIA_LIMIT = 0.1
"""Phase, in radians, by which inertia may turn the drag. It lowers the flutter threshold of a filament by
6.5 % at 0.1, as much as the range of drag, by 0.7 % at 0.01, and by 36 % at 1."""
COMPRESSION_LIMIT = 0.1
"""Fraction of its length that an arm may lose. Rubber stiffens by a quarter there, by 2 % at a tenth of
it."""
WEIGHT_LIMIT = 0.1
"""Weight less buoyancy over that under which an upright arm buckles. A level arm sags by a tenth of its
length there, by a hundredth of it at a tenth of the weight."""
WALL_LIMIT = 0.1
"""Fraction of its bending stiffness that a tube may lose in wide beating, as its section flattens. A tube of
infinite length buckles from a third of the stiffness lost on."""
WIDE_CURVATURE = 6.0
"""Largest curvature of a beating arm times its length over the tip's amplitude in lengths: 5.8 to 6.7 were
found from 2 % to 50 % above flutter."""
REYNOLDS_LIMIT = 1.0
"""Reynolds number of a wide motion, at which inertia of the flow past the section is as large as its drag."""
SELF_BUCKLING = 7.837
"""Weight in k3/L^2 at which an upright rod buckles under itself (Greenhill 1881)."""
FLUTTER_WAVENUMBER = 4.694
"""Wavenumber times length of the second bending shape of a clamped rod, as which an arm flutters."""
LEAST_S = 1e-6
"""Frequency of the flow, in eta k^2/rho, below which rounding would hide its phase of 1e-6."""
SECTIONS, SECTIONINGS = 64, 10
"""Parts into which an interval of ln s of width 20 to 30 is cut, and how often: 2^60 parts, down to rounding
error, by few calls on arrays."""
HALF_LENGTH = 0.5
"""Amplitude of the tip over the length of the arm in wide beating."""


class Validity(IntEnum):
    """Whether the model applies where an effect is left out; its numbers are stored in result files."""

    applies = 0
    doubtful = 1
    does_not_apply = 2


@dataclass(frozen=True, slots=True, kw_only=True)
class Effect:
    """One neglected effect: `value` beside the `limit` beyond which the model does not apply.

    Arrays have the common shape of the rates, forces and amplitudes that they belong to.
    """

    name: str
    value: Array
    """Ratio to what the model keeps, of the common shape of rates and forces; nan where nothing moves."""
    limit: float
    viscosity_factor: Array
    """How many times as viscous a fluid brings the effect to its limit; inf where viscosity does not."""
    of_cycles_only: bool = False
    """Whether it concerns wide motion only, and no threshold."""

    @property
    def excess(self) -> Array:
        """Value over limit, of any shape; above 1 the model does not apply."""
        return self.value / self.limit

    @property
    def validity(self) -> NDArray[np.int8]:
        """`Validity` of the model under this effect alone, integers of any shape; applies at rest."""
        return (self.excess > DOUBTFUL_FROM).astype(np.int8) + (self.excess > 1.0)


def effects_of(
    arm: SlenderArm,
    rate: ArrayLike,
    F: ArrayLike,
    *,
    drag: Drag | None = None,
    amplitude: ArrayLike = HALF_LENGTH,
) -> tuple[Effect, ...]:
    """All neglected effects on an arm that moves.

    rate: of the motion, in rad/s; nan where nothing moves. F: follower force, in k3/L^2; nan without load.
    drag: with which the arm moves so fast; by default the least of its range, with which effects of inertia
    are largest. amplitude: of the tip, over the length. The effect of weight is left out where no density
    difference is given, that of the wall where the arm has no bore. F is that of `weakest_load`.
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
        effects.append(max(walls, key=lambda effect: float(np.nanmax(effect.value))))
    return tuple(effects)


def worst_validity(effects: Iterable[Effect], *, of_cycles: bool) -> NDArray[np.int8]:
    """`Validity` of thresholds and linear motion under all effects, or of cycles; integers of their shape."""
    counted = (effect.validity for effect in effects if of_cycles or not effect.of_cycles_only)
    return np.maximum.reduce(list(counted))


def least_drag(arm: SlenderArm) -> Drag:
    """The drag of the arm's range with the least gamma2, with which it moves fastest."""
    return min(arm.drags, key=lambda drag: drag.gamma2)


def fastest_rate(arm: SlenderArm, frequency: ArrayLike) -> Array:
    """Rate in rad/s of a frequency in rad/tau2 of any shape, with the least drag of the arm's range."""
    return np.asarray(frequency, float) / arm.tau2_with(least_drag(arm))


def inertia_of_arm(arm: SlenderArm, rate: Array, drag: Drag) -> Effect:
    """Phase m omega/gamma2, of the shape of the rate, by which the arm's mass turns its drag."""
    along = zip(arm.shape.stations, arm.drags_along(drag), strict=True)
    value = max(arm.mass_at(station) / own.gamma2 for station, own in along) * rate
    # The rate itself falls with viscosity, and so does its ratio to the drag.
    factor = np.sqrt(value / INERTIA_LIMIT)
    return Effect(name="inertia of the arm", value=value, limit=INERTIA_LIMIT, viscosity_factor=factor)


def inertia_of_fluid(arm: SlenderArm, rate: Array, drag: Drag) -> Effect:
    """Phase, of the shape of the rate, by which the drag lags: the fluid has to be set moving."""
    logarithm = 4 * pi * arm.si.viscosity / max(own.gamma2 for own in arm.drags_along(drag))
    k = FLUTTER_WAVENUMBER / arm.si.length
    s = arm.si.fluid_density * rate / (arm.si.viscosity * k**2)
    return Effect(
        name="inertia of the fluid",
        value=unsteady_phase(s, logarithm),
        limit=INERTIA_LIMIT,
        viscosity_factor=np.sqrt(s / _frequency_of_phase(INERTIA_LIMIT, logarithm)),
    )


def unsteady_phase(s: ArrayLike, logarithm: float) -> Array:
    """Phase by which a line of forces of wavenumber k lags in unsteady Stokes flow; s = rho omega/(eta k^2).

    The mobility across the line is, with two-dimensional wave vectors q,

        int d^2q/(2 pi)^2 (q^2/2 + k^2)/(eta (q^2 + k^2) (q^2 + k^2 + i s k^2))
            = (Lambda - 1/2 - (1 - 1/(i s)) ln(1 + i s)/2)/(4 pi eta)

    where the steady one is Lambda/(4 pi eta), Lambda = 4 pi eta/gamma2 being the logarithm of the drag. The
    phase is 3 s/(4 Lambda) for small s, and has the shape of s.
    """
    z = 1j * np.maximum(np.asarray(s, float), LEAST_S)
    with np.errstate(invalid="ignore"):  # nan where nothing moves
        mobility = logarithm - 0.5 - (1 - 1 / z) * np.log1p(z) / 2
    return np.asarray(-np.angle(mobility))


def _frequency_of_phase(phase: float, logarithm: float) -> float:
    """The s at which `unsteady_phase` is as large as `phase`, below pi/2, by sections of ln s."""
    low, high = log(LEAST_S), 2 * logarithm  # there the real part of the mobility is -1/2
    for _ in range(SECTIONINGS):
        edges = np.linspace(low, high, SECTIONS + 1)
        below = np.count_nonzero(unsteady_phase(np.exp(edges[1:-1]), logarithm) < phase)  # the phase rises
        low, high = float(edges[below]), float(edges[below + 1])
    return exp(high)


def compression(arm: SlenderArm, F: Array) -> Effect:
    """F/k1 of the shape of F, the fraction of its length that the arm loses, or gains where it is pulled."""
    return _whatever_the_fluid("compression", abs(F) / arm.k1, COMPRESSION_LIMIT)


def weakest_load(arm: SlenderArm, F: ArrayLike) -> Array:
    """The force that would compress the base as F does the weakest section, of the shape of F.

    nan for rubber: its own law says how it is compressed.
    """
    share = arm.crushing_force / arm.k1
    return np.asarray(F, float) / share if share < inf else np.full(np.shape(F), np.nan)


def weight(arm: SlenderArm, F: Array) -> Effect:
    """Weight less buoyancy over that under which an upright arm buckles, of the shape of F."""
    heaviness = abs(arm.si.density_difference) * GRAVITY
    load = heaviness * arm.cross_section.area * arm.si.length
    uniform = load / (SELF_BUCKLING * arm.force_scale)
    value = arm.shape.buckling_share(heaviness) if arm.shape.varies else uniform
    return _whatever_the_fluid("weight", np.full(F.shape, value), WEIGHT_LIMIT)


def wall_effect(
    length: ArrayLike,
    radius: ArrayLike,
    bore: ArrayLike,
    poisson: ArrayLike,
    amplitude: ArrayLike = HALF_LENGTH,
) -> Effect:
    """Fraction of its bending stiffness that a beating tube loses, of the common shape of the quantities.

    amplitude: of the tip, over the length.
    A bent tube flattens by zeta = (1 - nu^2) (r^2/(R t))^2, R being the radius of curvature, r that of the
    middle of the wall and t its thickness, and has 1 - 3 zeta/2 of its stiffness then (Brazier 1927).
    """
    outer, inner, ratio = (np.asarray(x, float) for x in (radius, bore, poisson))
    curvature = WIDE_CURVATURE * np.asarray(amplitude, float) / np.asarray(length, float)
    middle, thickness = (outer + inner) / 2, outer - inner
    value = 1.5 * (1 - ratio**2) * (curvature * middle**2 / thickness) ** 2
    return _whatever_the_fluid("flattening of the wall", value, WALL_LIMIT, of_cycles_only=True)


def reynolds_number(arm: SlenderArm, rate: Array, amplitude: Array) -> Effect:
    """rho U (2 a)/eta of a tip that moves by amplitude times L at the rate, of their shape."""
    speed = rate * amplitude * arm.si.length
    value = arm.si.fluid_density * speed * 2 * arm.shape.drag_radius / arm.si.viscosity
    return Effect(
        name="Reynolds number",
        value=value,
        limit=REYNOLDS_LIMIT,
        viscosity_factor=np.sqrt(value / REYNOLDS_LIMIT),
        of_cycles_only=True,
    )


def _whatever_the_fluid(name: str, value: Array, limit: float, of_cycles_only: bool = False) -> Effect:
    """An effect on which viscosity has no influence."""
    factor = np.where(value > limit, inf, 0.0)
    return Effect(name=name, value=value, limit=limit, viscosity_factor=factor, of_cycles_only=of_cycles_only)
