"""Drag of a slender arm per length: what the literature gives for gamma1, gamma2, gamma3, and how it differs.

The paper takes the local friction tensor as given (Sec. III). Translation is that of resistive-force theory,
with a logarithm whose argument is known by factors only. eta is the viscosity, a the radius, L the length, in
SI units.
"""

from dataclasses import dataclass
from math import log, pi

LEAST_SLENDERNESS = 10.0
"""Lengths a radius below which the logarithms of slender-body theory mean nothing."""


DRAGS = ("likeliest", "least", "most_rotational", "most_translational", "most")
"""The members of `range_of_drag` by name, in its order: the likeliest, then the corners of the range. `least`
and `most` have the least and the most drag of all kinds, the others the most of one kind and the least of the
other."""
RANGE_OF_DRAG = "range"
"""Word for all members of DRAGS."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Drag:
    """Drag of an arm over its viscosity, in Pa s: along and across the axis without unit, rotational in m^2.

    Their ratios, which are all that a rod feels, are the same bits whatever the viscosity.
    """

    viscosity: float
    axial: float
    across: float
    rotational: float

    @property
    def gamma1(self) -> float:
        """Force per length and velocity along the axis, in Pa s."""
        return self.viscosity * self.axial

    @property
    def gamma2(self) -> float:
        """Force per length and velocity across the axis, in Pa s."""
        return self.viscosity * self.across

    @property
    def gamma3(self) -> float:
        """Torque per length and angular velocity, in Pa s m^2."""
        return self.viscosity * self.rotational


def cox(viscosity: float, slenderness: float) -> tuple[float, float]:
    """(gamma1, gamma2) of a straight rigid cylinder (Cox 1970; Batchelor 1970); slenderness is L/a."""
    logarithm = log(2 * slenderness)
    return 2 * pi * viscosity / (logarithm - 1.5), 4 * pi * viscosity / (logarithm - 0.5)


def gray_hancock(viscosity: float, slenderness: float) -> tuple[float, float]:
    """(gamma1, gamma2) for waves of length 4 L, the longest of a clamped rod (Gray and Hancock 1955)."""
    logarithm = log(8 * slenderness)
    return 2 * pi * viscosity / (logarithm - 0.5), 4 * pi * viscosity / (logarithm + 0.5)


def lighthill(viscosity: float, slenderness: float) -> tuple[float, float]:
    """(gamma1, gamma2) for helical waves of length L, about that of the fluttering mode (Lighthill 1976)."""
    logarithm = log(0.18 * slenderness)
    return 2 * pi * viscosity / logarithm, 4 * pi * viscosity / (logarithm + 0.5)


def least_rotational(viscosity: float, half_height: float) -> float:
    """gamma3 = pi eta a^2: sections of a long cylinder that turn about a diameter.

    The velocity on its surface is axial, -Omega x2, and harmonic outside, where it falls as 1/r; the traction
    eta Omega cos(phi) has this torque. For an ellipse a is half its height.
    """
    return pi * viscosity * half_height**2


def most_rotational(viscosity: float, half_height: float) -> float:
    """gamma3 = 4 pi eta a^2: a cylinder that turns about its axis (Powers 2010), as if all dragged alike."""
    return 4 * pi * viscosity * half_height**2


def range_of_drag(viscosity: float, length: float, radius: float, half_height: float) -> tuple[Drag, ...]:
    """The drags of DRAGS, which are equally good guesses of one arm: the likeliest first."""
    slenderness = length / radius
    least, most = (form(1.0, half_height) for form in (least_rotational, most_rotational))
    translations = (gray_hancock(1.0, slenderness), lighthill(1.0, slenderness))
    members = [(*cox(1.0, slenderness), (least * most) ** 0.5)]
    members += [(*translation, rotational) for translation in translations for rotational in (least, most)]
    return tuple(
        Drag(viscosity=viscosity, axial=axial, across=across, rotational=rotational)
        for axial, across, rotational in members
    )
