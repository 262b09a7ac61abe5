"""Validity of the model for an arm at its flutter threshold and under its load, and the changes of arm or
fluid with which the model would apply."""

from dataclasses import asdict, dataclass
from functools import cached_property
from itertools import chain
from math import ceil, floor, isnan, log10, nan

from ..model.arm.arm import SlenderArm
from ..model.arm.neglected import (
    Effect,
    Validity,
    angular_frequency_at_smallest_drag,
    base_force_of_largest_compression,
    compression_effect,
    neglected_effects,
    worst_validity,
)
from ..model.arm.quantities import LOAD_NAMES, SECTION_SIZE_NAMES
from ..solve.changes.threshold_kinds import Threshold, ThresholdKind
from ..solve.solve_lock import exclusive_solve
from .flutter_over_drags import ThresholdsOverDrags, thresholds_with_drag

REMEDY_DIGITS = 2
"""Significant digits of the factors in remedies, which are rounded to the safe side."""
MAX_THINNING_ITERATIONS = 20
"""Maximum number of iterations of `thickness_factor_for_small_inertia`. Ten iterations suffice if the inertia
of the arm and of the fluid are comparable."""
TARGET_REQUIRED_TO_ACTUAL_VISCOSITY = 0.995
"""Target of the iterations of `thickness_factor_for_small_inertia` for the ratio of required to actual
viscosity. The target is below 1, so that inertia ends within its limit."""
MIN_REQUIRED_TO_ACTUAL_VISCOSITY = 0.99
"""`thickness_factor_for_small_inertia` stops iterating when the ratio of required to actual viscosity is
between this number and 1. The thickness then has two correct digits."""


@dataclass(frozen=True)
class ValidityAssessment:
    """Neglected effects on an arm, at the flutter threshold and under the load, compared with their limits in
    the model. thresholds: thresholds of the arm for every drag."""

    arm: SlenderArm
    thresholds: ThresholdsOverDrags

    @cached_property
    def neglected_effects_at_flutter(self) -> tuple[Effect, ...]:
        """Neglected effects at the first flutter force for the most likely drag for which the arm flutters.
        The rate of motion is the largest rate over all drags."""
        return effects_at_flutter(self.arm, self.thresholds)

    @cached_property
    def compression_under_load(self) -> tuple[Effect, ...]:
        """Compression by the arm's load, the only neglected effect that the load changes; empty without
        load."""
        if self.arm.load_name is None:
            return ()
        return (compression_effect(self.arm, base_force_of_largest_compression(self.arm, self.arm.F)),)

    @property
    def dimensionless_flutter_force(self) -> float | None:
        """Smallest flutter force, in k3/L^2, for the most likely drag for which the arm flutters; None if the
        arm flutters for no drag."""
        threshold = first_hopf_point_for_likeliest_drag(self.thresholds)
        return None if threshold is None else threshold.value

    @property
    def effects(self) -> tuple[Effect, ...]:
        """Neglected effects at the flutter threshold, then under the load."""
        return *self.neglected_effects_at_flutter, *self.compression_under_load

    @property
    def validity_at_flutter(self) -> Validity:
        """Validity of the model at the flutter threshold."""
        return Validity(int(worst_validity(self.neglected_effects_at_flutter, of_cycles=False)))

    @property
    def validity_at_flutter_and_load(self) -> Validity:
        """Validity of the model at the flutter threshold and under the load: the worse of the two."""
        return Validity(int(worst_validity(self.effects, of_cycles=False)))

    def effects_with(self, validity: Validity) -> list[Effect]:
        """Neglected effects with the given validity, in decreasing order of their ratio to the limit. Effects
        on cycles alone are left out."""
        effects = [e for e in self.effects if e.validity == validity and not e.is_of_cycles_only]
        return sorted(effects, key=lambda effect: -float(effect.value_over_limit))


def first_hopf_point_for_likeliest_drag(thresholds: ThresholdsOverDrags) -> Threshold | None:
    """First Hopf point for the most likely drag for which the arm flutters; None if no drag has one."""
    return next(
        (
            threshold
            for search in thresholds.by_drag
            if (threshold := search.first_threshold(ThresholdKind.hopf))
        ),
        None,
    )


def effects_at_flutter(arm: SlenderArm, thresholds: ThresholdsOverDrags) -> tuple[Effect, ...]:
    """Neglected effects at the first flutter in `thresholds`, for the most likely drag for which the arm
    flutters; the rate of motion is the largest over all drags. Inertia, compression and Reynolds number are
    NaN if the arm does not flutter."""
    threshold = first_hopf_point_for_likeliest_drag(thresholds)
    # Without flutter only the effects of the load and of the section are known; the others become nan.
    if threshold is None:
        return neglected_effects(arm, nan, nan)
    return neglected_effects(
        arm,
        angular_frequency_at_smallest_drag(arm, abs(threshold.frequency)),
        base_force_of_largest_compression(arm, threshold.value),
    )


def viscosity_factor_for_small_inertia(effects: tuple[Effect, ...]) -> float:
    """Factor on the viscosity with which the larger inertia in `effects`, of arm or fluid, just reaches its
    limit; NaN if the arm does not flutter."""
    return max(float(e.viscosity_factor_at_limit) for e in effects if e.name.startswith("inertia"))


@exclusive_solve
def thickness_factor_for_small_inertia(arm: SlenderArm) -> float:
    """Largest factor on the thickness of an arm with which inertia, in the same fluid, is within its limit.

    The factor multiplies all sides of the section; the thresholds of the thinner arms are solved. NaN if an
    arm does not flutter, if another effect, such as weight, exceeds its limit for the thinner arm, or if the
    iteration does not converge. NaN also for an arm that varies along its length, because each solve would
    take a second.
    """
    # Sections of unequal size do not scale with one thickness that the reader could choose.
    if arm.geometry.varies_along_arm:
        return nan
    factor = 1.0
    for _ in range(MAX_THINNING_ITERATIONS):
        scaled_arm = _unloaded_arm_with_scaled_section(arm, factor)
        # The flutter force changes with the thickness, through shear and drag, so each arm is solved anew.
        thresholds = ThresholdsOverDrags(
            (thresholds_with_drag(scaled_arm, scaled_arm.base_drag_estimates[0]),)
        )
        effects = effects_at_flutter(scaled_arm, thresholds)
        required_viscosity_factor = viscosity_factor_for_small_inertia(effects)
        if MIN_REQUIRED_TO_ACTUAL_VISCOSITY < required_viscosity_factor <= 1.0:
            # A thinner arm may still be crushed or bent too much, and is then no remedy.
            is_valid = worst_validity(effects, of_cycles=False) < Validity.does_not_apply
            return factor if is_valid else nan
        # Mass times rate over drag scales as thickness^6/viscosity^2, hence thickness as viscosity^(1/3).
        factor *= (required_viscosity_factor / TARGET_REQUIRED_TO_ACTUAL_VISCOSITY) ** (-1 / 3)
    return nan


def _unloaded_arm_with_scaled_section(arm: SlenderArm, thickness_ratio: float) -> SlenderArm:
    """The uniform arm `arm` without its load, with all sides of the section multiplied by
    `thickness_ratio`."""
    omitted_names = {*LOAD_NAMES, *chain(*SECTION_SIZE_NAMES)}
    other_quantities = {
        name: value for name, value in vars(arm.si).items() if not isnan(value) and name not in omitted_names
    }
    # The sides are those of the section, which a uniform arm of segments has without naming a radius.
    sides = {name: thickness_ratio * side for name, side in asdict(arm.cross_section).items()}
    return SlenderArm(**(other_quantities | sides), poisson=arm.poisson, law=arm.law, section=arm.section)


def rounded_down(value: float) -> float:
    """The positive number `value`, rounded down to REMEDY_DIGITS significant digits."""
    unit = 10.0 ** (floor(log10(value)) - REMEDY_DIGITS + 1)
    # A remedy rounded to the nearest number could lie just beyond the limit.
    return floor(value / unit) * unit


def rounded_up(value: float) -> float:
    """The positive number `value`, rounded up to REMEDY_DIGITS significant digits."""
    unit = 10.0 ** (floor(log10(value)) - REMEDY_DIGITS + 1)
    return ceil(value / unit) * unit
