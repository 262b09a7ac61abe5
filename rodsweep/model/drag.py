"""Drag of a slender arm per length: what the literature gives for gamma1, gamma2, gamma3, and how it differs.

The paper takes the local friction tensor as given (Sec. III). Translation is that of resistive-force theory,
with a logarithm whose argument is known by factors only. eta is the viscosity, a the radius, L the length, in
SI units.
"""

from dataclasses import dataclass
from math import log, pi

LEAST_SLENDERNESS = 10.0
"""Lengths a radius below which the logarithms of slender-body theory mean nothing."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Drag:
    """Force per length and velocity, gamma1 along and gamma2 across the axis, in Pa s; gamma3 in Pa s m^2."""

    gamma1: float
    gamma2: float
    gamma3: float


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
    """The likeliest first, then the corners of the range; they are equally good guesses of one arm."""
    slenderness = length / radius
    rotational = [form(viscosity, half_height) for form in (least_rotational, most_rotational)]
    likely = cox(viscosity, slenderness)
    corners = [
        Drag(gamma1=gamma1, gamma2=gamma2, gamma3=gamma3)
        for gamma1, gamma2 in (gray_hancock(viscosity, slenderness), lighthill(viscosity, slenderness))
        for gamma3 in rotational
    ]
    middle = (rotational[0] * rotational[1]) ** 0.5
    return Drag(gamma1=likely[0], gamma2=likely[1], gamma3=middle), *corners
