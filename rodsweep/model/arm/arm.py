"""An arm in SI units as the rod of the paper: stiffness, drag and force without dimension.

Stiffness is of the paper's Sec. III, the force of Sec. IV, scales and dimensionless parameters of Sec. VI.
Knows no mesh and no solver. Quantities are given as text with a unit, or as numbers in SI.
"""

from dataclasses import dataclass, field
from functools import cached_property
from math import inf, isnan
from numbers import Real
from types import SimpleNamespace
from typing import Any

from ...errors import InputError
from ..parameters import PARAMETERS
from ..units import Given, share_of_flutter, unit_of, written_in
from .drag import DRAGS, LEAST_SLENDERNESS, Drag, range_of_drag
from .quantities import LOADS, QUANTITIES, UNITS, number_in_si, told
from .section import Circle, NoWall, Rectangle, Section, Tube

CRUSHED_FROM = 1 - 1e-14
"""Part of k1 from which on F is as large: what conversion of units leaves between them."""


class NotSlender(InputError):
    """The refusal of an arm that is too short for the drag of slender bodies."""


@dataclass(frozen=True, kw_only=True)
class SlenderArm:
    """An arm, clamped at one end, in a viscous fluid, with a pressure on its tip's section or a force there.

    Either a radius, or width and height, of which the height lies in the plane of motion. inner_radius: of
    the bore of a tube, which is closed at the tip and filled with the fluid at the pressure around. A
    pressure on the tip or a force there, of which positive ones push, or no load; "1.2 of flutter" is a load
    that is known once the threshold is. density_difference: of the arm's material over the fluid. drag: which
    member of its range, one of DRAGS, the arm has as a rod. Raises InputError, naming the quantity.
    """

    length: Given
    young: Given
    viscosity: Given
    radius: Given | None = None
    inner_radius: Given | None = None
    width: Given | None = None
    height: Given | None = None
    pressure: Given | None = None
    force: Given | None = None
    poisson: float = 0.5
    fluid_density: Given = "1000 kg/m^3"
    density_difference: Given | None = None
    drag: str = DRAGS[0]
    si: SimpleNamespace = field(init=False, repr=False, compare=False)
    """Each quantity of UNITS as a number in SI; nan where it is not given."""

    def __post_init__(self) -> None:
        """Reads the units, and refuses what is no slender arm."""
        object.__setattr__(
            self, "si", SimpleNamespace(**{name: number_in_si(name, getattr(self, name)) for name in UNITS})
        )
        ratio: Any = self.poisson
        is_number = isinstance(ratio, Real) and not isinstance(ratio, bool)
        if not is_number or not -1 < ratio <= 0.5:
            try:
                text = repr(ratio) if isinstance(ratio, str) else str(ratio)
            except ValueError:  # an integer of thousands of digits
                text = "an integer too large to be shown"
            raise InputError(f"poisson = {text:.60} is not a number above -1 and up to 0.5")
        if self.drag not in DRAGS:
            raise InputError(f"drag = {self.drag!r:.60} is not known; choose one of {', '.join(DRAGS)}")
        self._refuse_other_sets()
        if self.si.density_difference <= -self.si.fluid_density:
            given, least = self._told("density_difference"), f"{-self.si.fluid_density:.4g} kg/m^3"
            raise InputError(f"{given} leaves the arm no mass; it must be above {least}")
        try:
            slenderness = self.si.length / self.section.drag_radius
            fine = all(0 < number < inf for number in (self.k1, self.k2, self.force_scale))
        except ArithmeticError:
            fine = False
        if not fine:
            raise InputError(
                f"{self._told('length')} makes numbers too large or too small with its section and Young's "
                "modulus; check their units"
            )
        if slenderness < LEAST_SLENDERNESS:
            raise NotSlender(
                f"{self._told('length')} is {slenderness:.3g} radii; the drag of a slender arm needs at "
                f"least {LEAST_SLENDERNESS:g}"
            )
        self._refuse_crushed()

    def _refuse_crushed(self) -> None:
        """InputError where F is not below k1."""
        loaded = self.load
        if loaded is None or self.share_of_flutter is not None or CRUSHED_FROM * self.k1 > self.F:
            return
        limit, si = self.si.young * self.section.area / self._loaded_area, UNITS[loaded][0]
        unit = unit_of(getattr(self, loaded), si)
        raise InputError(
            f"{self._told(loaded)} compresses the arm to nothing; it must be below "
            f"{float(f'{written_in(limit, unit, si):.4g}'):g} {unit}, where a linear material is crushed"
        )

    def _refuse_other_sets(self) -> None:
        """InputError unless length, material, fluid and one section are given, and at most one load."""
        for name, quantity in QUANTITIES.items():
            if quantity.needed and getattr(self, name) is None:
                raise InputError(f"{name} is missing; write it as in '{quantity.example}'")
        sides = (self.width, self.height)
        if (self.radius is None) == (sides == (None, None)) or (self.radius is None and None in sides):
            raise InputError("radius: give either a radius, or width and height")
        if self.inner_radius is not None and self.radius is None:
            raise InputError(f"{self._told('inner_radius')} needs a radius; a rectangle has no bore here")
        if self.si.inner_radius >= self.si.radius:
            raise NoWall(f"{self._told('inner_radius')} is not below {self._told('radius')}")
        if self.pressure is not None and self.force is not None:
            raise InputError(
                f"{self._told('pressure')} and {self._told('force')} are both given; give one of them: the "
                "pressure on the tip's cross section, or its resultant"
            )

    def parameter(self, name: str) -> float:
        """A parameter of the arm as a rod; the default of what no arm determines."""
        return float(getattr(self, name, PARAMETERS[name].neutral))

    def _told(self, name: str) -> str:
        """A quantity as it was given, for a sentence."""
        return told(name, getattr(self, name))

    @property
    def section(self) -> Section:
        """The cross section."""
        if self.radius is None:
            return Rectangle(self.si.width, self.si.height)
        if self.inner_radius is None:
            return Circle(self.si.radius)
        return Tube(self.si.radius, self.si.inner_radius)

    @property
    def load(self) -> str | None:
        """Name of the given load, "pressure" or "force"; None for an arm without load."""
        return next((name for name in LOADS if getattr(self, name) is not None), None)

    @property
    def share_of_flutter(self) -> float | None:
        """Load divided by the flutter load, if the load is given in this way."""
        return None if self.load is None else share_of_flutter(getattr(self, self.load))

    @property
    def mass_per_length(self) -> float:
        """Mass of the material and of the fluid in its bore, in kg/m.

        The material is as dense as the fluid where no difference is given.
        """
        difference, fluid = self.si.density_difference, self.si.fluid_density
        density = fluid + (0.0 if isnan(difference) else difference)
        return density * self.section.area + fluid * self.section.bore_area

    @property
    def tip_force(self) -> float:
        """The resultant of the pressure over the tip's face, p A, in N (Sec. IV).

        Raises InputError for an arm without load, or with one relative to flutter, as `F` does.
        """
        if self.load is None:
            raise InputError("pressure is missing; give the pressure on the tip's cross section, or a force")
        if self.share_of_flutter is not None:
            raise InputError(f"{self._told(self.load)} is no number yet; it takes the threshold of flutter")
        return float(getattr(self.si, self.load)) * self._loaded_area

    @property
    def _loaded_area(self) -> float:
        """Resultant over load: the area of the tip's face for a pressure, 1 for a force."""
        return 1.0 if self.load == "force" else self.section.face_area

    @property
    def pressure_scale(self) -> float:
        """Pressure on the tip's face that makes F = 1, in Pa."""
        return self.force_scale / self.section.face_area

    @property
    def load_scale(self) -> float:
        """The load that makes F = 1: in N where the arm has a force, else a pressure, in Pa."""
        return self.force_scale if self.load == "force" else self.pressure_scale

    @property
    def bending_stiffness(self) -> float:
        """k3 = E I, in N m^2 (Sec. III)."""
        return self.si.young * self.section.second_moment

    @property
    def force_scale(self) -> float:
        """k3/L^2, in N: the unit of F, k1 and k2; drag is not in it."""
        return self.bending_stiffness / self.si.length**2

    @property
    def k1(self) -> float:
        """E A L^2/k3 = A L^2/I (Sec. III and VI): the same bits whatever Young's modulus."""
        return self.section.area * self.si.length**2 / self.section.second_moment

    @property
    def k2(self) -> float:
        """kappa G A L^2/k3, kappa G being the paper's effective G (Sec. III and VI; Cowper 1966)."""
        return self.section.shear_coefficient(self.poisson) / (2 * (1 + self.poisson)) * self.k1

    @property
    def F(self) -> float:
        """p A L^2/k3 (Sec. IV and VI); InputError where the load is not known."""
        return self.tip_force / self.force_scale

    @cached_property
    def drags(self) -> tuple[Drag, ...]:
        """The drags of DRAGS: the likeliest, then the corners of the range."""
        section = self.section
        return range_of_drag(self.si.viscosity, self.si.length, section.drag_radius, section.half_height)

    @property
    def own_drag(self) -> Drag:
        """The member of the range that the arm has as a rod."""
        return self.drags[DRAGS.index(self.drag)]

    def gamma3_with(self, drag: Drag) -> float:
        """gamma3/(gamma2 L^2) (Sec. VI)."""
        return drag.rotational / (drag.across * self.si.length**2)

    def tau2_with(self, drag: Drag) -> float:
        """gamma2 L^4/k3, in s (Sec. VI)."""
        return drag.gamma2 * self.si.length**4 / self.bending_stiffness

    @property
    def gamma3(self) -> float:
        """gamma3/(gamma2 L^2) (Sec. VI)."""
        return self.gamma3_with(self.own_drag)

    @property
    def gamma1(self) -> float:
        """gamma1/gamma2 (Sec. VI)."""
        return self.own_drag.axial / self.own_drag.across

    @property
    def tau2(self) -> float:
        """The longest time scale gamma2 L^4/k3, in s (Sec. VI)."""
        return self.tau2_with(self.own_drag)

    @property
    def tau1(self) -> float:
        """The shortest time scale, dimensional gamma3/k2, in s (Sec. VI)."""
        return self.tau2 * self.gamma3 / self.k2
