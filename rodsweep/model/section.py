"""Cross sections of an arm: area, second moment, shear coefficient, and radii for its drag. SI units."""

from dataclasses import dataclass
from math import pi
from typing import ClassVar


@dataclass(frozen=True, slots=True)
class Circle:
    """A circular section of radius a, in m."""

    radius: float
    formula: ClassVar[str] = "A = pi a^2, I = pi a^4/4"
    shear_formula: ClassVar[str] = "kappa = 6 (1 + nu)/(7 + 6 nu)"

    @property
    def area(self) -> float:
        """A = pi a^2, in m^2."""
        return pi * self.radius**2

    @property
    def second_moment(self) -> float:
        """I = pi a^4/4, in m^4."""
        return pi * self.radius**4 / 4

    @property
    def half_height(self) -> float:
        """Half the extent in the plane of motion, in m."""
        return self.radius

    @property
    def drag_radius(self) -> float:
        """Radius of the circular cylinder of equal drag, in m."""
        return self.radius

    def shear_coefficient(self, poisson: float) -> float:
        """kappa = 6 (1 + nu)/(7 + 6 nu) (Cowper 1966)."""
        return 6 * (1 + poisson) / (7 + 6 * poisson)


@dataclass(frozen=True, slots=True)
class Rectangle:
    """A rectangular section, in m: height in the plane of motion, width across it."""

    width: float
    height: float
    formula: ClassVar[str] = "A = w h, I = w h^3/12"
    shear_formula: ClassVar[str] = "kappa = 10 (1 + nu)/(12 + 11 nu)"

    @property
    def area(self) -> float:
        """A = w h, in m^2."""
        return self.width * self.height

    @property
    def second_moment(self) -> float:
        """I = w h^3/12, in m^4."""
        return self.width * self.height**3 / 12

    @property
    def half_height(self) -> float:
        """Half the extent in the plane of motion, in m."""
        return self.height / 2

    @property
    def drag_radius(self) -> float:
        """(w + h)/4, in m: that of the ellipse of the same sides in axial motion (Batchelor 1970)."""
        return (self.width + self.height) / 4

    def shear_coefficient(self, poisson: float) -> float:
        """kappa = 10 (1 + nu)/(12 + 11 nu) (Cowper 1966)."""
        return 10 * (1 + poisson) / (12 + 11 * poisson)


Section = Circle | Rectangle
