"""Drag of a slender arm per length: estimates of gamma1, gamma2, gamma3 from the literature, and their range.

The paper takes the local friction tensor as given (Sec. III). Drag of translation is from resistive-force
theory; the argument of its logarithm is known only up to a factor. Symbols: viscosity eta, radius a,
length L, in SI units.
"""

from dataclasses import dataclass
from math import log, pi

LEAST_SLENDERNESS = 10.0
"""Minimum ratio of length to radius. Slender-body theory is meaningless for shorter arms, which are refused.
"""


DRAGS = ("likeliest", "least", "most_rotational", "most_translational", "most")
"""Names of the estimates in `range_of_drag`, in order: the likeliest, then the corners of the range. `least`
has the least translational and rotational drag, `most` the most; `most_rotational` combines the most
rotational with the least translational drag, `most_translational` the reverse."""
RANGE_OF_DRAG = "range"
"""Value of the config key `drag` that stands for all estimates in DRAGS."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Drag:
    """Drag of an arm per length, stored as viscosity times geometric factors.

    viscosity: in Pa s. axial, across: factors along and across the axis, dimensionless. rotational: factor in
    m^2. A rod depends only on ratios of drags; the viscosity cancels in these before rounding.
    """

    viscosity: float
    axial: float
    across: float
    rotational: float

    @property
    def gamma1(self) -> float:
        """Axial drag force per length and per axial velocity, in Pa s."""
        return self.viscosity * self.axial

    @property
    def gamma2(self) -> float:
        """Normal drag force per length and per normal velocity, in Pa s."""
        return self.viscosity * self.across

    @property
    def gamma3(self) -> float:
        """Drag torque per length and per angular velocity, in Pa s m^2."""
        return self.viscosity * self.rotational


def cox(viscosity: float, slenderness: float) -> tuple[float, float]:
    """Drags (gamma1, gamma2) of a straight rigid cylinder (Cox 1970; Batchelor 1970); slenderness is L/a."""
    logarithm = log(2 * slenderness)
    return 2 * pi * viscosity / (logarithm - 1.5), 4 * pi * viscosity / (logarithm - 0.5)


def gray_hancock(viscosity: float, slenderness: float) -> tuple[float, float]:
    """Drags (gamma1, gamma2) for waves of length 4 L, the longest of a clamped rod (Gray, Hancock 1955)."""
    logarithm = log(8 * slenderness)
    return 2 * pi * viscosity / (logarithm - 0.5), 4 * pi * viscosity / (logarithm + 0.5)


def lighthill(viscosity: float, slenderness: float) -> tuple[float, float]:
    """Drags (gamma1, gamma2) for helical waves of length L, about as in flutter (Lighthill 1976)."""
    logarithm = log(0.18 * slenderness)
    return 2 * pi * viscosity / logarithm, 4 * pi * viscosity / (logarithm + 0.5)


def least_rotational(viscosity: float, half_height: float) -> float:
    """Lowest estimate of rotational drag: gamma3 = pi eta a^2 of sections turning about a diameter.

    The surface velocity -Omega x2 is axial; the flow outside is harmonic and decays like 1/r, and its
    traction eta Omega cos(phi) has the torque gamma3 Omega. For an ellipse, a is half the height.
    """
    return pi * viscosity * half_height**2


def most_rotational(viscosity: float, half_height: float) -> float:
    """Highest estimate of rotational drag: gamma3 = 4 pi eta a^2 of rotation about the axis (Powers 2010)."""
    return 4 * pi * viscosity * half_height**2


def range_of_drag(viscosity: float, length: float, radius: float, half_height: float) -> tuple[Drag, ...]:
    """Estimates of the drag of one arm, in the order of DRAGS; the first has the geometric mean gamma3."""
    slenderness = length / radius
    least = least_rotational(1.0, half_height)
    most = most_rotational(1.0, half_height)
    translations = (gray_hancock(1.0, slenderness), lighthill(1.0, slenderness))
    # All estimates are for viscosity 1: drag is proportional to it.
    members = [(*cox(1.0, slenderness), (least * most) ** 0.5)]
    members += [(*translation, rotational) for translation in translations for rotational in (least, most)]
    return tuple(
        Drag(viscosity=viscosity, axial=axial, across=across, rotational=rotational)
        for axial, across, rotational in members
    )
