"""What the model leaves out, held against an arm's numbers: plain sentences, some of them warnings."""

from dataclasses import dataclass
from math import isnan
from typing import TYPE_CHECKING

from ..model.arm.arm import SlenderArm
from ..model.arm.neglected import SELF_BUCKLING, Effect, Validity, wall_effect

if TYPE_CHECKING:
    from .validity import Assessment  # which imports solvers

SLENDER = 20.0
"""Lengths a radius from which the logarithms of slender-body theory are good to some ten percent."""
LOWERED_BY_INERTIA = 0.64
"""Relative fall of the flutter threshold over the phase by which inertia turns the drag, for small phases."""
SAG_OF_BUCKLING = SELF_BUCKLING / 8
"""Sag of a level arm over its length, for a weight of 1 of what buckles an upright one: w L^4/(8 E I)."""
LARGEST_SAG = 0.25
"""Sag over length up to which the linear formula is good to some percent."""
USUAL_POISSON = (0.3, 0.5)
"""Poisson's ratios of rubbers and gels."""


@dataclass(frozen=True, slots=True)
class Check:
    """One thing that the model leaves out; `validity` of the model under it."""

    validity: Validity
    sentence: str
    of_verdict: bool = False
    """Whether the verdict depends on it, rather than wide beating or how far the range of drag reaches."""

    @property
    def doubts_the_verdict(self) -> bool:
        """Whether it is said above the verdict; beyond the limit the verdict itself says so."""
        return self.of_verdict and self.validity == Validity.doubtful

    @property
    def fine(self) -> bool:
        """Whether the model leaves it out with reason."""
        return self.validity == Validity.applies

    @property
    def told(self) -> str:
        """The sentence, which begins with the word warning where it is one."""
        return self.sentence if self.fine else f"warning: {self.sentence}"


def checks_of(assessment: "Assessment") -> list[Check]:
    """All of them."""
    arm, effects = assessment.arm, {effect.name: effect for effect in assessment.at_flutter}
    return [
        slenderness(arm),
        compression(assessment, effects["compression"]),
        *inertia(effects["inertia of the arm"], effects["inertia of the fluid"]),
        *reynolds(effects["Reynolds number"]),
        *wall(arm),
        weight(effects.get("weight")),
        poisson(arm),
    ]


def slenderness(arm: SlenderArm) -> Check:
    """Length over radius."""
    ratio = arm.si.length / arm.section.drag_radius
    fine = ratio >= SLENDER
    why = (
        "slender enough for local drag"
        if fine
        else f"below {SLENDER:g} local drag is rough, and the range of drag wide"
    )
    return Check(_doubt(not fine), f"Slenderness: the arm is {ratio:.3g} radii long; {why}.")


def compression(assessment: "Assessment", at_flutter: Effect) -> Check:
    """F/k1, the share of its length that the straight arm loses."""
    says, effects = [], [at_flutter, *assessment.under_load]
    if assessment.under_load:
        verb = "shortens" if assessment.arm.F >= 0 else "lengthens"
        says.append(f"the load {verb} the arm by {_percent(assessment.under_load[0])}")
    if not isnan(at_flutter.value):
        says.append(f"{'that of flutter' if says else 'flutter shortens the arm'} by {_percent(at_flutter)}")
    validity = max(map(_validity, effects))
    largest = max(float(effect.value) for effect in effects if not isnan(effect.value)) if says else 0.0
    ending = (
        "the material is linear there",
        f"rubber is some {100 * stiffening(largest):.1g} % stiffer there",
        "real materials are no longer linear there",
    )[validity]
    shares = " and ".join(says) or "there is no load"
    return Check(validity, f"Compression: {shares} (F/k1); {ending}.", of_verdict=True)


def stiffening(share: float) -> float:
    """Relative rise of the tangent modulus of neo-Hookean rubber, E (1 + 2/stretch^3)/3, by compression."""
    return float(2 * ((1 - share) ** -3 - 1) / 3)


def inertia(of_arm: Effect, of_fluid: Effect) -> list[Check]:
    """Inertia of the arm and of the fluid beside it at the threshold; nothing where nothing flutters."""
    if isnan(of_arm.value):
        return []
    validity = max(map(_validity, (of_arm, of_fluid)))
    lowered = 100 * LOWERED_BY_INERTIA * float(of_arm.value + of_fluid.value)
    ending = (
        "neither matters",
        f"they lower the threshold of flutter by some {lowered:.1g} %",
        f"the model leaves both out, and allows {of_arm.limit:g}",
    )[validity]
    sentence = (
        f"Inertia: at flutter mass times rate over drag is {float(of_arm.value):.2g} for the arm and "
        f"{float(of_fluid.value):.2g} for the fluid beside it; {ending}."
    )
    return [Check(validity, sentence, of_verdict=True)]


def reynolds(number: Effect) -> list[Check]:
    """Reynolds number of beating as wide as half the length, as fast as at the threshold."""
    if isnan(number.value):
        return []
    validity = _validity(number)
    ending = (
        "the drag stays that of slow flow",
        "wide beating meets somewhat more drag than the model's",
        "wide beating meets more drag than the model's, and is slower",
    )[validity]
    value = f"{float(number.value):.2g}"
    return [Check(validity, f"Reynolds number: {value} if the tip moves by half the length; {ending}.")]


def wall(arm: SlenderArm) -> list[Check]:
    """How far the section of a tube flattens in wide beating; nothing of other sections."""
    if arm.inner_radius is None:
        return []
    si = arm.si
    return [wall_check(wall_effect(si.length, si.radius, si.inner_radius, arm.poisson))]


def wall_check(effect: Effect) -> Check:
    """The same from the effect on one tube."""
    lost = float(effect.value)
    loses = f"takes some {100 * lost:.2g} % of its bending stiffness" if lost < 1 else "folds the tube"
    validity = _validity(effect)
    ending = (
        "left out with reason",
        "the model leaves that out",
        "the wall is too thin for the model, which leaves that out",
    )[validity]
    sentence = f"Wall: as the tip moves by half the length, the section flattens, which {loses}; {ending}."
    return Check(validity, sentence)


def weight(effect: Effect | None) -> Check:
    """Weight less buoyancy against bending stiffness."""
    if effect is None:
        says = "Weight: left out, as if the arm floated; give a density difference to have it checked."
        return Check(Validity.applies, says)
    share, validity = float(effect.value), _validity(effect)
    sag = SAG_OF_BUCKLING * share
    level = f"a level arm sags by {sag:.2g} of its length" if sag < LARGEST_SAG else "a level arm hangs down"
    ending = (
        "left out with reason",
        "it bends the arm a little, which the model leaves out",
        "it bends the arm, which the model leaves out",
    )[validity]
    upright = f"weight less buoyancy is {share:.2g} of what buckles an upright arm"
    return Check(validity, f"Weight: {upright}; {level}; {ending}.", of_verdict=True)


def poisson(arm: SlenderArm) -> Check:
    """Poisson's ratio of soft materials."""
    fine = USUAL_POISSON[0] <= arm.poisson <= USUAL_POISSON[1]
    why = "usual for soft materials" if fine else "unusual: rubbers and gels are near 0.5"
    return Check(_doubt(not fine), f"Poisson's ratio: {arm.poisson:g}, {why}; it enters through shear only.")


def _validity(effect: Effect) -> Validity:
    return Validity(int(effect.validity))


def _doubt(doubtful: bool) -> Validity:
    return Validity.doubtful if doubtful else Validity.applies


def _percent(effect: Effect) -> str:
    return f"{100 * float(effect.value):.2g} %"
