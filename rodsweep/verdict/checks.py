"""What the model leaves out, held against an arm's numbers: plain sentences, some of them warnings."""

from dataclasses import dataclass
from math import isnan, pi

from ..model.arm import SlenderArm
from ..solve.changes.unstable_modes import Kind
from .flutter import FlutterRange
from .sentences import rounded

GRAVITY = 9.81
"""In m/s^2."""
SMALL = 0.1
"""Ratios below it are left out by the model with reason."""
LARGE_COMPRESSION = 0.1
"""Share of its length that a rubber may lose before a linear material misleads."""
SLENDER = 20.0
"""Lengths a radius from which the logarithms of slender-body theory are good to some ten percent."""
SELF_BUCKLING = 7.837
"""Weight in k3/L^2 at which an upright rod buckles under itself (Greenhill 1881)."""


@dataclass(frozen=True, slots=True)
class Check:
    """One thing that the model leaves out; `fine` where it may."""

    fine: bool
    sentence: str

    @property
    def told(self) -> str:
        """The sentence, which begins with the word warning where it is one."""
        return self.sentence if self.fine else f"warning: {self.sentence}"


def checks_of(arm: SlenderArm, found: FlutterRange) -> list[Check]:
    """All of them."""
    return [slenderness(arm), compression(arm), *motion(arm, found), weight(arm), poisson(arm), *plane(arm)]


def slenderness(arm: SlenderArm) -> Check:
    """Length over radius."""
    ratio = arm.si.length / arm.section.drag_radius
    fine = ratio >= SLENDER
    why = (
        "slender enough for local drag"
        if fine
        else f"below {SLENDER:g} local drag is rough, and the range of drag wide"
    )
    return Check(fine, f"Slenderness: the arm is {ratio:.3g} radii long; {why}.")


def compression(arm: SlenderArm) -> Check:
    """F/k1, the share of its length that the straight arm loses."""
    share = arm.F / arm.k1
    fine = abs(share) <= LARGE_COMPRESSION
    why = "a linear material will do" if fine else "real materials are no longer linear there"
    verb = "shortens" if share >= 0 else "lengthens"
    return Check(fine, f"Compression: the load {verb} the arm by {abs(share):.2%} (F/k1); {why}.")


def motion(arm: SlenderArm, found: FlutterRange) -> list[Check]:
    """Inertia of arm and fluid at the threshold, and of the fluid in a motion as wide as half the arm."""
    rate = found.frequency(Kind.hopf)
    if rate is None:
        return []
    si, radius = arm.si, arm.section.drag_radius
    own = si.fluid_density + (0.0 if isnan(si.density_difference) else si.density_difference)
    fastest = 2 * pi * rate.high
    inertia = own * arm.section.area * fastest / min(drag.gamma2 for drag in arm.drags)
    unsteady = si.fluid_density * fastest * radius**2 / si.viscosity
    reynolds = si.fluid_density * fastest * (si.length / 2) * 2 * radius / si.viscosity
    slow = max(inertia, unsteady) <= SMALL
    calm = reynolds <= 1
    at = f"at {rounded(rate.high, rate.high)} Hz"
    says = (
        "so neither inertia matters" if slow else "inertia, which the model has not, may shift the thresholds"
    )
    wide = (
        "the drag stays that of slow flow"
        if calm
        else "wide beating meets more drag than the model's, and is slower"
    )
    return [
        Check(
            slow,
            f"Inertia: {at}, the fastest of the range, mass times rate over drag is {inertia:.2g} for the "
            f"arm and {unsteady:.2g} for the fluid beside it; {says}.",
        ),
        Check(calm, f"Reynolds number: {reynolds:.2g} {at} if the tip moves by half the length; {wide}."),
    ]


def weight(arm: SlenderArm) -> Check:
    """Weight less buoyancy against bending stiffness."""
    difference = arm.si.density_difference
    if isnan(difference):
        return Check(
            True, "Weight: left out, as if the arm floated; give a density difference to have it checked."
        )
    heavy = abs(difference) * GRAVITY * arm.section.area * arm.si.length / arm.force_scale
    fine = heavy <= SMALL * SELF_BUCKLING
    why = "left out with reason" if fine else "it bends the arm, which the model leaves out"
    sag = f"a level arm sags by {heavy / 8:.2g} of its length" if heavy < 2 else "a level arm hangs down"
    return Check(
        fine,
        f"Weight: weight less buoyancy is {heavy:.2g} k3/L^2, {heavy / SELF_BUCKLING:.2g} of what buckles an "
        f"upright arm; {sag}; {why}.",
    )


def poisson(arm: SlenderArm) -> Check:
    """Poisson's ratio of soft materials."""
    fine = 0.3 <= arm.poisson <= 0.5
    why = "usual for soft materials" if fine else "unusual: rubbers and gels are near 0.5"
    return Check(fine, f"Poisson's ratio: {arm.poisson:g}, {why}; it enters through shear only.")


def plane(arm: SlenderArm) -> list[Check]:
    """Whether a rectangle bends more easily across the plane of motion."""
    if arm.radius is not None or not arm.si.height > arm.si.width:
        return []
    return [
        Check(
            False,
            "Plane: the height exceeds the width, so that the arm bends first out of the plane computed.",
        )
    ]
