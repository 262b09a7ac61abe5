"""Checks of the effects that the model neglects, for one arm: one sentence or warning per check."""

from dataclasses import dataclass
from math import isnan
from typing import TYPE_CHECKING

from ..model.arm.arm import SlenderArm
from ..model.arm.neglected import SELF_BUCKLING_WEIGHT, Effect, Validity
from ..model.material.laws import LINEAR_CONSTITUTIVE_LAW
from ..wording import two_significant_digits

if TYPE_CHECKING:
    from .validity_assessment import ValidityAssessment  # for annotations only: the module imports solvers

MIN_ACCURATE_SLENDERNESS = 20.0
"""Smallest ratio of length to radius at which slender-body theory is accurate to about ten percent."""
THRESHOLD_DECREASE_PER_INERTIA_PHASE = 0.64
"""Estimated relative decrease of the flutter threshold by inertia, per radian of phase between drag and
velocity caused by inertia."""
SAG_AT_SELF_BUCKLING = SELF_BUCKLING_WEIGHT / 8
"""Sag over length, w L^3/(8 E I), of a horizontal arm whose weight w L just buckles an upright arm."""
MAX_STATED_RELATIVE_SAG = 0.25
"""A check states the ratio of sag to length only below this: beyond, the linear formula is inaccurate."""
USUAL_POISSON_RANGE = (0.3, 0.5)
"""Range of Poisson's ratio of rubbers and gels; a check warns of a Poisson's ratio outside this range."""
NO_COMPRESSION_CHECK_SENTENCE = "no load is given and no flutter was found, so compression is not checked"
"""Result of the check of compression for an arm without load and without flutter."""


@dataclass(frozen=True, slots=True)
class Check:
    """Check of one neglected effect or one assumption of the model. validity: whether the model applies
    despite the effect. sentence: result, without the warning's prefix."""

    validity: Validity
    sentence: str
    can_change_verdict: bool = False
    """Whether the effect can change the verdict. False for effects only on beating of large amplitude, or
    only on the width of the range of drag."""

    @property
    def is_negligible(self) -> bool:
        """Whether the effect is small enough to neglect."""
        return self.validity == Validity.applies

    @property
    def text(self) -> str:
        """The sentence of the check, with the prefix "warning: " if the effect cannot be neglected."""
        return self.sentence if self.is_negligible else f"warning: {self.sentence}"


def checks_of(assessment: "ValidityAssessment") -> list[Check]:
    """Checks of all neglected effects on an arm, in the order of the report."""
    arm = assessment.arm
    effects = {effect.name: effect for effect in assessment.neglected_effects_at_flutter}
    return [
        slenderness_check(arm),
        compression_check(assessment, effects["compression"]),
        *inertia_checks(effects["inertia of the arm"], effects["inertia of the fluid"]),
        *reynolds_checks(effects["Reynolds number"]),
        *tube_flattening_checks(effects.get("flattening of the wall")),
        weight_check(effects.get("weight"), arm),
        poisson_check(arm),
    ]


def slenderness_check(arm: SlenderArm) -> Check:
    """Check of the ratio of the arm's length to its radius against MIN_ACCURATE_SLENDERNESS."""
    ratio = arm.si.length / arm.geometry.largest_drag_radius
    is_slender = ratio >= MIN_ACCURATE_SLENDERNESS
    reason = "slender enough for local drag"
    if not is_slender:
        reason = f"below {MIN_ACCURATE_SLENDERNESS:g} local drag is inaccurate, and the range of drag is wide"
    return Check(_doubtful_if(not is_slender), f"Slenderness: the arm is {ratio:.3g} radii long; {reason}.")


def compression_check(assessment: "ValidityAssessment", at_flutter: Effect) -> Check:
    """Check of F/k1, the compressive strain of the straight arm's weakest section, at flutter and under the
    load. at_flutter: the effect "compression" at the flutter threshold."""
    # The limit of linear elasticity means nothing for a law that holds at large strain.
    if assessment.arm.law != LINEAR_CONSTITUTIVE_LAW.law_name:
        return _rubber_compression_check(assessment)
    texts = []
    effects = [at_flutter, *assessment.compression_under_load]
    is_pulled = False
    for effect in assessment.compression_under_load:
        is_pulled = assessment.arm.F < 0 and not effect.value <= at_flutter.value
        signed = -effect.value if assessment.arm.F < 0 else effect.value
        texts.append(_strain_text("the load", "the arm", float(signed)))
    if not isnan(at_flutter.value):
        texts.append(_strain_text("the flutter load", "it" if texts else "the arm", float(at_flutter.value)))
    validity = max(map(_validity_of_effect, effects))
    strain = max(float(effect.value) for effect in effects if not isnan(effect.value)) if texts else 0.0
    noun, change = ("extension", "softer") if is_pulled else ("compression", "stiffer")
    stiffening = abs(relative_rubber_stiffening(-strain if is_pulled else strain))
    remark = (
        "a linear law of the material is accurate",
        f"rubber is some {_one_digit_text(100 * stiffening)} % {change} at this {noun}",
        f"real materials are no longer linear at this {noun}",
    )[validity]
    shortening = " and ".join(texts) or NO_COMPRESSION_CHECK_SENTENCE
    place_clause = " at the weakest section" if assessment.arm.geometry.varies_along_arm else ""
    sentence = f"Compression: {shortening} (F/k1){place_clause}; {remark}."
    return Check(validity, sentence, can_change_verdict=True)


def _rubber_compression_check(assessment: "ValidityAssessment") -> Check:
    """Check of the compressive strain of a rubber arm. The check always passes, because the law of rubber is
    valid for large strains."""
    arm = assessment.arm
    texts = []
    flutter = assessment.dimensionless_flutter_force
    if arm.load_name is not None:
        texts.append(_strain_text("the load", "the arm", _weakest_section_shortening(arm, arm.F)))
    if flutter is not None:
        flutter_compression = _weakest_section_shortening(arm, flutter)
        texts.append(_strain_text("the flutter load", "it" if texts else "the arm", flutter_compression))
    shortening = " and ".join(texts) or NO_COMPRESSION_CHECK_SENTENCE
    place_clause = " at the weakest section" if arm.geometry.varies_along_arm else ""
    sentence = f"Compression: {shortening}{place_clause}; the law of rubber includes large compression."
    return Check(Validity.applies, sentence)


def _strain_text(load_name: str, arm_name: str, strain: float) -> str:
    """Clause on the compressive strain of an arm under a load; a negative strain lengthens the arm.
    load_name, arm_name: names of load and arm in the clause."""
    verb = "shortens" if strain >= 0 else "lengthens"
    return f"{load_name} {verb} {arm_name} by {two_significant_digits(100 * abs(strain))} %"


def _weakest_section_shortening(arm: SlenderArm, F: float) -> float:
    """Compressive strain of the arm's weakest section under the force F. F: in k3/L^2."""
    smallest_stiffness = min(station.young * station.section.area for station in arm.geometry.stations)
    base_stiffness = arm.geometry.base.young * arm.cross_section.area
    return float(arm.material.constitutive_law.shortening(F / (arm.k1 * smallest_stiffness / base_stiffness)))


def relative_rubber_stiffening(strain: float) -> float:
    """Relative increase of the tangent modulus E (1 + 2/h^3)/3 of neo-Hookean rubber over E, at the stretch
    ratio h = 1 - `strain`."""
    return float(2 * ((1 - strain) ** -3 - 1) / 3)


def _one_digit_text(value: float) -> str:
    """The positive number `value` as text with one significant digit; no exponent from 1e-4 to 1e5."""
    return f"{float(f'{value:.1g}'):g}"


def inertia_checks(arm_inertia: Effect, fluid_inertia: Effect) -> list[Check]:
    """Check of the inertia of the arm and of the fluid at the flutter threshold; an empty list without
    flutter."""
    if isnan(arm_inertia.value):
        return []
    validity = max(map(_validity_of_effect, (arm_inertia, fluid_inertia)))
    # To first order the two phase lags add, so one factor serves both.
    percent = 100 * THRESHOLD_DECREASE_PER_INERTIA_PHASE * float(arm_inertia.value + fluid_inertia.value)
    remark = (
        "neither matters",
        f"they lower the threshold of flutter by some {_one_digit_text(percent)} %",
        f"the model neglects both and applies only up to {arm_inertia.limit:g}",
    )[validity]
    arm_text, fluid_text = (
        two_significant_digits(float(effect.value)) for effect in (arm_inertia, fluid_inertia)
    )
    sentence = (
        f"Inertia: at flutter mass times rate over drag is {arm_text} for the arm and {fluid_text} for the "
        f"fluid beside it; {remark}."
    )
    return [Check(validity, sentence, can_change_verdict=True)]


def reynolds_checks(reynolds_number: Effect) -> list[Check]:
    """Check of the Reynolds number of beating with amplitude L/2 at the frequency of flutter; an empty list
    if the arm does not flutter. reynolds_number: the effect "Reynolds number"."""
    if isnan(reynolds_number.value):
        return []
    validity = _validity_of_effect(reynolds_number)
    remark = (
        "the drag law of slow flow applies",
        "at large amplitude the drag is somewhat larger than in the model",
        "at large amplitude the drag is larger than in the model, and the motion slower",
    )[validity]
    value = two_significant_digits(float(reynolds_number.value))
    return [Check(validity, f"Reynolds number: {value} if the tip moves by half the length; {remark}.")]


def tube_flattening_checks(effect: Effect | None) -> list[Check]:
    """Check of the flattening of a tube's section in beating of large amplitude; an empty list if the section
    is not a tube (`effect` is None)."""
    return [] if effect is None else [tube_flattening_check(effect)]


def tube_flattening_check(effect: Effect) -> Check:
    """Check of a tube's wall. effect: relative loss of bending stiffness by flattening of the section, if the
    tip moves by L/2."""
    loss = float(effect.value)
    loss_text = f"takes some {two_significant_digits(100 * loss)} % of its bending stiffness"
    result = loss_text if loss < 1 else "folds the tube"
    validity = _validity_of_effect(effect)
    remark = (
        "negligible",
        "the model neglects this",
        "the wall is too thin for the model, which neglects this",
    )[validity]
    sentence = f"Wall: as the tip moves by half the length, the section flattens, which {result}; {remark}."
    return Check(validity, sentence)


def weight_check(effect: Effect | None, arm: SlenderArm) -> Check:
    """Check of weight minus buoyancy against bending stiffness. effect: None without a density difference."""
    if effect is None:
        text = "Weight: left out, as if the arm floated; give a density difference to have it checked."
        return Check(Validity.applies, text)
    ratio = float(effect.value)
    validity = _validity_of_effect(effect)
    sag = SAG_AT_SELF_BUCKLING * ratio
    sag_text = (
        f"sags by {two_significant_digits(sag)} of its length"
        if sag < MAX_STATED_RELATIVE_SAG
        else "hangs down"
    )
    remark = (
        "negligible",
        "weight bends the arm a little, which the model neglects",
        "weight bends the arm, which the model neglects",
    )[validity]
    # The formula of the sag is valid for uniform arms.
    sag_clause = "" if arm.geometry.varies_along_arm else f"; a horizontal arm {sag_text}"
    sentence = (
        f"Weight: weight less buoyancy is {two_significant_digits(ratio)} of the weight that buckles an "
        f"upright arm{sag_clause}; {remark}."
    )
    return Check(validity, sentence, can_change_verdict=True)


def poisson_check(arm: SlenderArm) -> Check:
    """Check of Poisson's ratio against USUAL_POISSON_RANGE."""
    usual = USUAL_POISSON_RANGE[0] <= arm.poisson <= USUAL_POISSON_RANGE[1]
    reason = "usual for soft materials" if usual else "unusual: rubbers and gels are near 0.5"
    return Check(
        _doubtful_if(not usual), f"Poisson's ratio: {arm.poisson:g}, {reason}; it enters through shear only."
    )


def _validity_of_effect(effect: Effect) -> Validity:
    return Validity(int(effect.validity))


def _doubtful_if(condition: bool) -> Validity:
    return Validity.doubtful if condition else Validity.applies
