"""Drag of a slender arm per length: estimates of gamma1, gamma2, gamma3 from the literature, and their range.

The paper takes the local friction tensor as given (Sec. III). Drag of translation is computed by
resistive-force theory; the argument of its logarithm is known only up to a factor. Symbols: viscosity eta,
radius a, length L, in SI units.
"""

from dataclasses import dataclass
from math import log, pi

LEAST_SLENDERNESS = 10.0
"""Smallest length of an arm divided by its radius. Less slender arms are refused, because the logarithms of
slender-body theory are then meaningless."""


DRAG_NAMES = ("likeliest", "least", "most_rotational", "most_translational", "most")

"""Names of the drag estimates in the order of `drag_estimates`: the likeliest, then the corners of the range.
`least` has the smallest translational and rotational drag, `most` the largest; `most_rotational` combines the
largest rotational with the smallest translational drag, `most_translational` the reverse."""

DRAG_RANGE_NAME = "range"
"""Value of the config key `drag` for a sweep over all estimates in DRAG_NAMES."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Drag:
    """Drag coefficients of an arm per length, stored as viscosity times geometric factors.

    viscosity: in Pa s. axial, across: dimensionless factors of the drag along and across the axis of the arm.
    rotational: factor of the rotational drag, in m^2. A rod depends only on ratios of drags, so the viscosity
    cancels exactly.
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


def cox_drag(viscosity: float, slenderness: float) -> tuple[float, float]:
    """Returns (gamma1, gamma2), in Pa s, of a straight rigid cylinder (Cox 1970; Batchelor 1970). viscosity:
    in Pa s. slenderness: L/a."""
    logarithm = log(2 * slenderness)
    return 2 * pi * viscosity / (logarithm - 1.5), 4 * pi * viscosity / (logarithm - 0.5)


def gray_hancock_drag(viscosity: float, slenderness: float) -> tuple[float, float]:
    """Returns (gamma1, gamma2), in Pa s, for waves of length 4 L, the longest waves of a clamped rod. Gray
    and Hancock (1955). viscosity: in Pa s. slenderness: L/a."""
    logarithm = log(8 * slenderness)
    return 2 * pi * viscosity / (logarithm - 0.5), 4 * pi * viscosity / (logarithm + 0.5)


def lighthill_drag(viscosity: float, slenderness: float) -> tuple[float, float]:
    """Returns (gamma1, gamma2), in Pa s, for helical waves of length L, which is near the wavelength of
    flutter. Lighthill (1976). viscosity: in Pa s. slenderness: L/a."""
    logarithm = log(0.18 * slenderness)
    return 2 * pi * viscosity / logarithm, 4 * pi * viscosity / (logarithm + 0.5)


def min_rotational_drag(viscosity: float, half_height: float) -> float:
    """Smallest estimate of rotational drag, gamma3 = pi eta a^2, in Pa s m^2, for sections that turn about a
    diameter.

    viscosity: eta, in Pa s. half_height: a, in m, also for an ellipse. The surface velocity -Omega x2 of a
    long cylinder is axial. The flow outside is harmonic and decays like 1/r; its traction eta Omega cos(phi)
    has the torque gamma3 Omega.
    """
    return pi * viscosity * half_height**2


def max_rotational_drag(viscosity: float, half_height: float) -> float:
    """Largest estimate of rotational drag, gamma3 = 4 pi eta a^2, in Pa s m^2. viscosity: eta, in Pa s.
    half_height: a, in m. The value for rotation about the axis of the cylinder (Powers 2010) is used for
    rotation about a diameter."""
    return 4 * pi * viscosity * half_height**2


def drag_estimates(viscosity: float, length: float, radius: float, half_height: float) -> tuple[Drag, ...]:
    """Drag estimates of one arm, in the order of DRAG_NAMES. The likeliest estimate has the geometric mean of
    the smallest and largest gamma3. viscosity: in Pa s. length, radius, half_height: in m."""
    slenderness = length / radius
    min_rotational = min_rotational_drag(1.0, half_height)
    max_rotational = max_rotational_drag(1.0, half_height)
    translations = (gray_hancock_drag(1.0, slenderness), lighthill_drag(1.0, slenderness))
    # All estimates are for viscosity 1, because drag is proportional to the viscosity.
    members = [(*cox_drag(1.0, slenderness), (min_rotational * max_rotational) ** 0.5)]
    members += [
        (*translation, rotational)
        for translation in translations
        for rotational in (min_rotational, max_rotational)
    ]
    return tuple(
        Drag(viscosity=viscosity, axial=axial, across=across, rotational=rotational)
        for axial, across, rotational in members
    )
