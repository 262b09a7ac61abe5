"""Cross-sections of an arm in SI units: area, second moment, shear coefficient, and radii for the drag."""

from dataclasses import dataclass
from math import pi
from typing import ClassVar

from ...errors import InputError


class BoreTooWide(InputError):
    """The bore of a tube is at least as wide as the tube."""


@dataclass(frozen=True, slots=True)
class Circle:
    """A solid circular cross-section of radius a, in m. area_and_moment_formula, shear_coefficient_formula,
    pressure_force_formula: texts for reports, with the formulas of area and second moment, of the shear
    coefficient, and of the tip force under a pressure p."""

    radius: float
    area_and_moment_formula: ClassVar[str] = "A = pi a^2, I = pi a^4/4"
    shear_coefficient_formula: ClassVar[str] = "kappa = 6 (1 + nu)/(7 + 6 nu)"
    pressure_force_formula: ClassVar[str] = "p A"

    @property
    def area(self) -> float:
        """Area A = pi a^2, in m^2."""
        return pi * self.radius**2

    @property
    def second_moment(self) -> float:
        """Second moment of area I = pi a^4/4, in m^4."""
        return pi * self.radius**4 / 4

    @property
    def face_area(self) -> float:
        """Area A of the face of the tip, on which a pressure acts, in m^2."""
        return self.area

    @property
    def bore_area(self) -> float:
        """Area of the fluid in the bore, in m^2: 0, because the section is solid."""
        return 0.0

    @property
    def half_height(self) -> float:
        """Half the extent in the plane of motion, in m."""
        return self.radius

    @property
    def drag_radius(self) -> float:
        """Radius of the circular cylinder with the same drag, in m."""
        return self.radius

    def shear_coefficient(self, poisson: float) -> float:
        """Shear coefficient kappa = 6 (1 + nu)/(7 + 6 nu), nu = poisson (Cowper 1966)."""
        return 6 * (1 + poisson) / (7 + 6 * poisson)


@dataclass(frozen=True, slots=True)
class Tube:
    """A circular cross-section of radius a with a bore of radius b, in m. The bore is closed at the tip.
    area_and_moment_formula, shear_coefficient_formula, pressure_force_formula: texts for reports, with the
    formulas of area and second moment, of the shear coefficient, and of the tip force under a pressure p."""

    radius: float
    inner_radius: float
    """Radius b of the bore, in m."""
    area_and_moment_formula: ClassVar[str] = "A = pi (a^2 - b^2), I = pi (a^4 - b^4)/4"
    shear_coefficient_formula: ClassVar[str] = (
        "kappa = 6 (1 + nu) (1 + m^2)^2/((7 + 6 nu) (1 + m^2)^2 + (20 + 12 nu) m^2), m = b/a"
    )
    pressure_force_formula: ClassVar[str] = "p pi a^2 on the face of the closed tip"

    @property
    def area(self) -> float:
        """Area of the material, A = pi (a^2 - b^2), in m^2."""
        # As a product, because the difference of the squares would lose digits for a thin wall.
        return pi * (self.radius - self.inner_radius) * (self.radius + self.inner_radius)

    @property
    def second_moment(self) -> float:
        """Second moment of area I = pi (a^4 - b^4)/4, in m^4."""
        # Through the area, which keeps its digits for a thin wall.
        return self.area * (self.radius**2 + self.inner_radius**2) / 4

    @property
    def face_area(self) -> float:
        """Area of the face of the tip, on which a pressure acts: pi a^2, in m^2, as the tip is closed."""
        return pi * self.radius**2

    @property
    def bore_area(self) -> float:
        """Area of the fluid in the bore, pi b^2, in m^2."""
        return pi * self.inner_radius**2

    @property
    def half_height(self) -> float:
        """Half the extent in the plane of motion, in m."""
        return self.radius

    @property
    def drag_radius(self) -> float:
        """Radius of the circular cylinder with the same drag, in m."""
        return self.radius

    def shear_coefficient(self, poisson: float) -> float:
        """Shear coefficient kappa of a hollow circle, see `shear_coefficient_formula` (Cowper 1966); nu =
        poisson. For a thin wall kappa = 2 (1 + nu)/(4 + 3 nu)."""
        squared = (self.inner_radius / self.radius) ** 2
        solid = (7 + 6 * poisson) * (1 + squared) ** 2
        return 6 * (1 + poisson) * (1 + squared) ** 2 / (solid + (20 + 12 * poisson) * squared)


@dataclass(frozen=True, slots=True)
class Rectangle:
    """A solid rectangular cross-section, in m: height in the plane of motion, width across this plane.
    area_and_moment_formula, shear_coefficient_formula, pressure_force_formula: texts for reports, with the
    formulas of area and second moment, of the shear coefficient, and of the tip force under a pressure p."""

    width: float
    height: float
    area_and_moment_formula: ClassVar[str] = "A = w h, I = w h^3/12"
    shear_coefficient_formula: ClassVar[str] = "kappa = 10 (1 + nu)/(12 + 11 nu)"
    pressure_force_formula: ClassVar[str] = "p A"

    @property
    def area(self) -> float:
        """Area A = w h, in m^2."""
        return self.width * self.height

    @property
    def second_moment(self) -> float:
        """Second moment of area I = w h^3/12, in m^4."""
        return self.width * self.height**3 / 12

    @property
    def face_area(self) -> float:
        """Area A of the face of the tip, on which a pressure acts, in m^2."""
        return self.area

    @property
    def bore_area(self) -> float:
        """Area of the fluid in the bore, in m^2: 0, because the section is solid."""
        return 0.0

    @property
    def half_height(self) -> float:
        """Half the extent in the plane of motion, in m."""
        return self.height / 2

    @property
    def drag_radius(self) -> float:
        """(w + h)/4, in m: drag radius of an ellipse with axes w and h in axial motion (Batchelor 1970)."""
        return (self.width + self.height) / 4

    def shear_coefficient(self, poisson: float) -> float:
        """Shear coefficient kappa = 10 (1 + nu)/(12 + 11 nu), nu = poisson (Cowper 1966)."""
        return 10 * (1 + poisson) / (12 + 11 * poisson)


Section = Circle | Tube | Rectangle
