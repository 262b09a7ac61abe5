"""Drag of a slender arm per length: estimates of gamma1, gamma2, gamma3 from the literature, and their range.

The paper takes the local friction tensor as given (Sec. III). Drag of translation is computed by
resistive-force theory; the argument of its logarithm is known only up to a factor. Symbols: viscosity eta,
radius a, length L, in SI units.
"""

from dataclasses import dataclass
from math import log, pi

MIN_FORMULA_SLENDERNESS = 10.0
"""Smallest length of an arm divided by its radius. Less slender arms are refused, because the logarithms of
slender-body theory are then meaningless."""


DRAG_ESTIMATE_NAMES = ("likeliest", "least", "most_rotational", "most_translational", "most")

"""Names of the drag estimates in the order of `drag_estimates`: the likeliest, then the corners of the range.
`least` has the smallest translational and rotational drag, `most` the largest; `most_rotational` combines the
largest rotational with the smallest translational drag, `most_translational` the reverse."""

ALL_DRAG_ESTIMATES_NAME = "range"
"""Value of the config key `drag` for a sweep over all estimates in DRAG_ESTIMATE_NAMES."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Drag:
    """Drag coefficients of an arm per length, stored as viscosity times geometric factors.

    viscosity: in Pa s. axial_factor, normal_factor: dimensionless factors of the drag along and across the
    axis of the arm. rotational_factor: factor of the rotational drag, in m^2. A rod depends only on ratios of
    drags, so the viscosity cancels exactly.
    """

    viscosity: float
    axial_factor: float
    normal_factor: float
    rotational_factor: float

    @property
    def gamma1(self) -> float:
        """Axial drag force per length and per axial velocity, in Pa s."""
        return self.viscosity * self.axial_factor

    @property
    def gamma2(self) -> float:
        """Normal drag force per length and per normal velocity, in Pa s."""
        return self.viscosity * self.normal_factor

    @property
    def gamma3(self) -> float:
        """Drag torque per length and per angular velocity, in Pa s m^2."""
        return self.viscosity * self.rotational_factor


def cox_drag_over_viscosity(slenderness: float) -> tuple[float, float]:
    """(gamma1, gamma2)/viscosity of a straight rigid cylinder (Cox 1970; Batchelor 1970). slenderness:
    L/a."""
    logarithm = log(2 * slenderness)
    return 2 * pi / (logarithm - 1.5), 4 * pi / (logarithm - 0.5)


def gray_hancock_drag_over_viscosity(slenderness: float) -> tuple[float, float]:
    """(gamma1, gamma2)/viscosity for waves of length 4 L, the longest waves of a clamped rod (Gray and
    Hancock 1955). slenderness: L/a."""
    logarithm = log(8 * slenderness)
    return 2 * pi / (logarithm - 0.5), 4 * pi / (logarithm + 0.5)


def lighthill_drag_over_viscosity(slenderness: float) -> tuple[float, float]:
    """(gamma1, gamma2)/viscosity for helical waves of length L, which is near the wavelength of flutter
    (Lighthill 1976). slenderness: L/a."""
    logarithm = log(0.18 * slenderness)
    return 2 * pi / logarithm, 4 * pi / (logarithm + 0.5)


def drag_estimates(viscosity: float, length: float, radius: float, half_height: float) -> tuple[Drag, ...]:
    """Drag estimates of one arm, in the order of DRAG_ESTIMATE_NAMES. viscosity: in Pa s. length, radius: in
    m, for gamma1 and gamma2. half_height: a in gamma3, in m, also for an ellipse.

    gamma3 is from pi eta a^2 to 4 pi eta a^2; the likeliest estimate has the geometric mean. The smallest is
    for sections that turn about a diameter: the surface velocity -Omega x2 of a long cylinder is axial, and
    the flow outside is harmonic and decays like 1/r; its traction eta Omega cos(phi) has the torque gamma3
    Omega. The largest gamma3 is the drag of rotation about the axis of the cylinder (Powers 2010).
    """
    slenderness = length / radius
    min_rotational = pi * half_height**2
    max_rotational = 4 * pi * half_height**2
    translational_drags = (
        gray_hancock_drag_over_viscosity(slenderness),
        lighthill_drag_over_viscosity(slenderness),
    )
    # The geometric mean, because the rotational drag is known only up to a factor, from pi to 4 pi.
    drag_factors = [(*cox_drag_over_viscosity(slenderness), (min_rotational * max_rotational) ** 0.5)]
    drag_factors += [
        (*translation, rotational)
        for translation in translational_drags
        for rotational in (min_rotational, max_rotational)
    ]
    return tuple(
        Drag(viscosity=viscosity, axial_factor=axial, normal_factor=across, rotational_factor=rotational)
        for axial, across, rotational in drag_factors
    )
