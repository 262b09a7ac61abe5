"""Sentences for an arm to which the model does not apply: violated limit, excess, and remedy."""

from math import isnan

from ..model.arm.arm import SlenderArm
from ..model.arm.neglected import Effect, Validity
from ..model.arm.quantities import UNITS_AND_EXAMPLES
from ..model.units import unit_of, value_in_unit
from ..wording import two_significant_digits
from .load_texts import LoadFormatter
from .validity_assessment import (
    ValidityAssessment,
    rounded_down,
    rounded_up,
    thickness_factor_for_small_inertia,
    viscosity_factor_for_small_inertia,
)

MAX_FOUR_DIGIT_RATIO = 1.1
"""Ratios of an effect to its limit below this number are printed with four digits; with two digits such a
ratio could read 1.0."""


def not_applicable_sentences(arm: SlenderArm, assessment: ValidityAssessment) -> list[str]:
    """One sentence per kind of neglected effect beyond its limit, the largest ratio to the limit first."""
    effects = assessment.effects_with(Validity.does_not_apply)
    # The first effect of each kind stays.
    *others, first = {effect_kind(effect): effect for effect in reversed(effects)}.values()
    remedy = _remedy_clause(first, arm, assessment)
    is_valid = assessment.validity_at_flutter != Validity.does_not_apply
    # At flutter itself the model applies then, so the sentence must say that the load is the reason.
    load_clause = f" at {LoadFormatter(arm).typed_text}" if is_valid else ""
    excess = f"{_effect_name(first, arm, assessment)} is {ratio_to_limit_text(first)} what the model allows"
    sentences = [f"The model does not apply{load_clause}: {excess}; {remedy}."]
    for effect in reversed(others):
        name = _effect_name(effect, arm, assessment).capitalize()
        sentences.append(
            f"{name} is {ratio_to_limit_text(effect)} what the model allows, too; "
            f"{_remedy_clause(effect, arm, assessment)}."
        )
    return sentences


def _effect_name(effect: Effect, arm: SlenderArm, assessment: ValidityAssessment) -> str:
    """Name of a neglected effect on an arm; under a pull the effect of compression is named extension."""
    is_pulled = any(effect is loaded for loaded in assessment.compression_under_load) and arm.F < 0
    return "extension" if is_pulled else effect.name


def effect_kind(effect: Effect) -> str:
    """Kind of a neglected effect: the first word of the effect's name. Inertia of the arm and inertia of the
    fluid therefore have the same kind."""
    return effect.name.split()[0]


def ratio_to_limit_text(effect: Effect) -> str:
    """Ratio of an effect to its limit: "2.5 times", with two digits, or four below MAX_FOUR_DIGIT_RATIO."""
    ratio = float(effect.value_over_limit)
    return f"{two_significant_digits(ratio)} times" if ratio >= MAX_FOUR_DIGIT_RATIO else f"{ratio:.4g} times"


def _remedy_clause(effect: Effect, arm: SlenderArm, assessment: ValidityAssessment) -> str:
    """Clause that names the change of arm, fluid or load by which the effect is reduced to its limit."""
    ratio = float(1 / effect.value_over_limit)
    if effect_kind(effect) == "inertia":
        return _inertia_remedy_clause(arm, assessment)
    if effect_kind(effect) == "weight":
        si_unit = UNITS_AND_EXAMPLES["density_difference"][0]
        unit = unit_of(arm.density_difference, si_unit)  # type: ignore[arg-type]
        limit = rounded_down(value_in_unit(abs(arm.si.density_difference) * ratio, unit, si_unit))
        return f"the model needs an arm whose density is within {limit:g} {unit} of the fluid's"
    # By identity, as the compression at flutter and under the load have the same name.
    if any(effect is weakest for weakest in assessment.compression_under_load):
        noun = "a pull" if arm.F < 0 else "a load"
        return f"the model needs {noun} of at most {LoadFormatter(arm).rounded_down_text(abs(arm.F) * ratio)}"
    return "the model needs a longer or a thinner arm"


def _inertia_remedy_clause(arm: SlenderArm, assessment: ValidityAssessment) -> str:
    """Clause with the two remedies that bring inertia within its limit: the smallest viscosity of the fluid
    and, if known, the largest thickness of the arm."""
    si_unit = UNITS_AND_EXAMPLES["viscosity"][0]
    unit = unit_of(arm.viscosity, si_unit)
    factor = viscosity_factor_for_small_inertia(assessment.neglected_effects_at_flutter)
    viscosity = (
        f"{rounded_up(value_in_unit(arm.si.viscosity * factor, unit, si_unit)):g} {unit.replace('*', ' ')}"
    )
    clause = f"the model needs a fluid at least {rounded_up(factor):g} times as viscous ({viscosity})"
    thickness = thickness_factor_for_small_inertia(arm)
    if isnan(thickness):
        return clause
    return f"{clause}, or an arm at most {rounded_down(thickness):g} times as thick"
