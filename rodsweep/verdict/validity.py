"""Whether the model applies to an arm at its threshold and under its load, and what would have to change."""

from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from math import floor, isnan, log10, nan

import numpy as np

from ..model.arm.arm import SlenderArm
from ..model.arm.neglected import Effect, Validity, compression, effects_of, fastest_rate, worst_validity
from ..model.arm.quantities import LOADS, SECTION_SIDES
from ..solve.changes.unstable_modes import Kind
from ..solve.exclusive import solving
from .flutter import FlutterRange, flutter_forces

DIGITS_OF_FACTORS = 2
"""Digits of what would have to change; it is rounded to the safe side."""
THINNING_STEPS = 20
"""Most solves for a thickness; ten do where fluid and arm share the inertia."""
AIM = 0.995
"""Viscosity that is needed over that of the fluid, for which a thickness is sought."""
CLOSE_TO_LIMIT = 0.99
"""Viscosity that is needed over that of the fluid from which on the thickness is right to two digits."""


@dataclass(frozen=True)
class Assessment:
    """The neglected effects on an arm, at the threshold of its flutter and under its load."""

    arm: SlenderArm
    found: FlutterRange

    @cached_property
    def at_flutter(self) -> tuple[Effect, ...]:
        """Effects at the first flutter with the likeliest drag, as fast as the least drag lets."""
        return effects_at_flutter(self.arm, self.found)

    @cached_property
    def under_load(self) -> tuple[Effect, ...]:
        """Effects of the load itself; none without."""
        return () if self.arm.load is None else (compression(self.arm, np.asarray(self.arm.F)),)

    @property
    def effects(self) -> tuple[Effect, ...]:
        """All of them, those of the threshold first."""
        return *self.at_flutter, *self.under_load

    @property
    def of_thresholds(self) -> Validity:
        """Whether the thresholds are the arm's."""
        return Validity(int(worst_validity(self.at_flutter, of_cycles=False)))

    @property
    def of_verdict(self) -> Validity:
        """Whether the verdict on the load is the arm's."""
        return Validity(int(worst_validity(self.effects, of_cycles=False)))

    def those(self, validity: Validity) -> list[Effect]:
        """The effects of a validity that concern more than cycles, the largest first."""
        counted = [e for e in self.effects if e.validity == validity and not e.of_cycles_only]
        return sorted(counted, key=lambda effect: -float(effect.excess))


def effects_at_flutter(arm: SlenderArm, found: FlutterRange) -> tuple[Effect, ...]:
    """The neglected effects at the threshold; inertia and compression are nan where nothing flutters."""
    first = next((each for c in found.forces if (each := c.first(Kind.hopf))), None)
    if first is None:
        return effects_of(arm, nan, nan)
    return effects_of(arm, fastest_rate(arm, abs(first.frequency)), first.at)


def viscosity_factor(effects: tuple[Effect, ...]) -> float:
    """How many times as viscous a fluid has to be for inertia to be within its limit; nan without motion."""
    return max(float(e.viscosity_factor) for e in effects if e.name.startswith("inertia"))


@solving
def thickness_factor(arm: SlenderArm) -> float:
    """How many times as thick an arm may be at most for inertia to be within its limit in the same fluid.

    All sides of the section are multiplied by it. Thresholds of the thinner arms are solved for; nan where
    these have none, and where the thinner arm would bend too much under its weight.
    """
    factor = 1.0
    for _ in range(THINNING_STEPS):
        thinner = _scaled(arm, factor)
        found = FlutterRange((flutter_forces(thinner, thinner.drags[0]),))
        effects = effects_at_flutter(thinner, found)
        excess = viscosity_factor(effects)
        if CLOSE_TO_LIMIT < excess <= 1.0:
            applies = worst_validity(effects, of_cycles=False) < Validity.does_not_apply
            return factor if applies else nan
        # Mass times rate over drag has the sixth power of the thickness, and the square of the viscosity.
        factor *= (excess / AIM) ** (-1 / 3)
    return nan


def _scaled(arm: SlenderArm, factor: float) -> SlenderArm:
    """The arm without load with a section so many times as large."""
    given = {name: value for name, value in vars(arm.si).items() if not isnan(value) and name not in LOADS}
    section = {name: factor * given[name] for name in chain(*SECTION_SIDES) if name in given}
    return SlenderArm(**(given | section), poisson=arm.poisson)


def rounded_down(value: float) -> float:
    """A positive number down to DIGITS_OF_FACTORS digits."""
    unit = 10.0 ** (floor(log10(value)) - DIGITS_OF_FACTORS + 1)
    return floor(value / unit) * unit


def rounded_up(value: float) -> float:
    """A positive number up to DIGITS_OF_FACTORS digits."""
    unit = 10.0 ** (floor(log10(value)) - DIGITS_OF_FACTORS + 1)
    return -floor(-value / unit) * unit
