"""Validity of the model at an arm's threshold and under its load, and the changes that restore it."""

from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from math import ceil, floor, isnan, log10, nan

from ..model.arm.arm import SlenderArm
from ..model.arm.neglected import (
    Effect,
    Validity,
    compression,
    effects_of,
    fastest_rate,
    weakest_load,
    worst_validity,
)
from ..model.arm.quantities import LOADS, SECTION_SIDES
from ..solve.changes.unstable_modes import ChangeKind, Crossing
from ..solve.exclusive import solving
from .flutter import FlutterRange, flutter_forces

DIGITS_OF_FACTORS = 2
"""Digits of the factors in remedies, which are rounded conservatively."""
THINNING_STEPS = 20
"""Maximum iterations for a thickness; ten suffice if inertia of arm and fluid are comparable."""
VISCOSITY_TARGET = 0.995
"""Target of the iteration for a thickness: required viscosity over viscosity of the fluid."""
CLOSE_TO_LIMIT = 0.99
"""The iteration for a thickness stops between this ratio of required to actual viscosity and 1, where the
thickness has two correct digits."""


@dataclass(frozen=True)
class Assessment:
    """Neglected effects on an arm, at the flutter threshold and under the load."""

    arm: SlenderArm
    found: FlutterRange

    @cached_property
    def at_flutter(self) -> tuple[Effect, ...]:
        """Effects at the first flutter with the likeliest drag, at the fastest rate over all drags."""
        return effects_at_flutter(self.arm, self.found)

    @cached_property
    def under_load(self) -> tuple[Effect, ...]:
        """Effects of the load itself; empty without a load."""
        return () if self.arm.load is None else (compression(self.arm, weakest_load(self.arm, self.arm.F)),)

    @property
    def force_at_flutter(self) -> float | None:
        """Force of `first_flutter_of`, in k3/L^2; None without flutter."""
        first = first_flutter_of(self.found)
        return None if first is None else first.at

    @property
    def effects(self) -> tuple[Effect, ...]:
        """All effects: at the threshold, then under the load."""
        return *self.at_flutter, *self.under_load

    @property
    def of_thresholds(self) -> Validity:
        """Validity of the model for the thresholds of the arm."""
        return Validity(int(worst_validity(self.at_flutter, of_cycles=False)))

    @property
    def of_verdict(self) -> Validity:
        """Validity of the model for the verdict on the load."""
        return Validity(int(worst_validity(self.effects, of_cycles=False)))

    def effects_with(self, validity: Validity) -> list[Effect]:
        """Effects with the given validity by decreasing excess, without effects on cycles only."""
        counted = [e for e in self.effects if e.validity == validity and not e.of_cycles_only]
        return sorted(counted, key=lambda effect: -float(effect.excess))


def first_flutter_of(found: FlutterRange) -> Crossing | None:
    """The first flutter with the likeliest of all drags that have flutter; None if no drag has flutter."""
    return next((each for c in found.forces if (each := c.first(ChangeKind.hopf))), None)


def effects_at_flutter(arm: SlenderArm, found: FlutterRange) -> tuple[Effect, ...]:
    """Neglected effects at the threshold; inertia and compression are NaN without flutter."""
    first = first_flutter_of(found)
    if first is None:
        return effects_of(arm, nan, nan)
    return effects_of(arm, fastest_rate(arm, abs(first.frequency)), weakest_load(arm, first.at))


def viscosity_factor(effects: tuple[Effect, ...]) -> float:
    """Factor on the viscosity that brings inertia to its limit; NaN without flutter."""
    return max(float(e.viscosity_factor) for e in effects if e.name.startswith("inertia"))


@solving
def thickness_factor(arm: SlenderArm) -> float:
    """Largest factor on all sides of the section for which inertia in the same fluid is within its limit.

    Solves for thresholds of thinner arms. NaN if the arm does not flutter, or if the model does not apply to
    the thinner arm for a further reason, such as weight. NaN also for an arm that varies along its length,
    because each solve would take a second.
    """
    if arm.shape.varies:
        return nan
    factor = 1.0
    for _ in range(THINNING_STEPS):
        thinner = _scaled(arm, factor)
        found = FlutterRange((flutter_forces(thinner, thinner.drags[0]),))
        effects = effects_at_flutter(thinner, found)
        excess = viscosity_factor(effects)
        if CLOSE_TO_LIMIT < excess <= 1.0:
            applies = worst_validity(effects, of_cycles=False) < Validity.does_not_apply
            return factor if applies else nan
        # Mass times rate over drag scales as thickness^6/viscosity^2, hence thickness as viscosity^(1/3).
        factor *= (excess / VISCOSITY_TARGET) ** (-1 / 3)
    return nan


def _scaled(arm: SlenderArm, factor: float) -> SlenderArm:
    """The arm without load, with all sides of the section multiplied by `factor`."""
    given = {name: value for name, value in vars(arm.si).items() if not isnan(value) and name not in LOADS}
    section = {name: factor * given[name] for name in chain(*SECTION_SIDES) if name in given}
    return SlenderArm(**(given | section), poisson=arm.poisson, law=arm.law, section=arm.section)


def rounded_down(value: float) -> float:
    """Rounds a positive number down to DIGITS_OF_FACTORS digits."""
    unit = 10.0 ** (floor(log10(value)) - DIGITS_OF_FACTORS + 1)
    return floor(value / unit) * unit


def rounded_up(value: float) -> float:
    """Rounds a positive number up to DIGITS_OF_FACTORS digits."""
    unit = 10.0 ** (floor(log10(value)) - DIGITS_OF_FACTORS + 1)
    return ceil(value / unit) * unit
