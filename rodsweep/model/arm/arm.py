"""An arm in SI units as the rod of the paper: stiffness, drag and force without dimension.

Stiffness is of the paper's Sec. III, the force of Sec. IV, scales and dimensionless parameters of Sec. VI.
Stiffnesses and drags are those of the base; `build` and `taper` say how they go on along the arm. Knows no
mesh and no solver. Quantities are given as text with a unit, or as numbers in SI.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import isnan
from types import SimpleNamespace

from ...errors import InputError
from ..material.build import STANDARD, Build
from ..parameters import PARAMETERS
from ..units import Given, share_of_flutter
from .drag import DRAGS, Drag
from .quantities import LOADS, UNITS, number_in_si, quoted
from .refusals import refuse_crushed, refuse_misfits, refuse_other_sets, refuse_words
from .section import Circle, Rectangle, Section, Tube
from .segments import ArmSegment, segment_texts, segments_of
from .shape import Shape, Station, cone, in_segments


@dataclass(frozen=True, kw_only=True)
class SlenderArm:
    """An arm, clamped at one end, in a viscous fluid, with a pressure on its tip's section or a force there.

    Either a radius, or width and height, of which the height lies in the plane of motion, or segments, each
    as "4 cm: radius 6 mm, young 80 kPa" from the base to the tip; young is then that of segments without one.
    tip_radius: of a solid cone. inner_radius: of the bore of a tube, which is closed at the tip and filled
    with the fluid at the pressure around. law, section: of the material, keys of
    `rodsweep.model.material.laws.LAWS`. A pressure on the tip or a force there, of which positive ones push,
    or no load; "1.2 of flutter" is a load that is known once the threshold is. density_difference: of the
    arm's material over the fluid. drag: which member of its range, one of DRAGS, the arm has as a rod. Raises
    InputError, naming the quantity.
    """

    length: Given | None = None
    young: Given | None = None
    viscosity: Given
    radius: Given | None = None
    inner_radius: Given | None = None
    tip_radius: Given | None = None
    width: Given | None = None
    height: Given | None = None
    segments: Sequence[str | Mapping[str, Given]] | None = None
    pressure: Given | None = None
    force: Given | None = None
    poisson: float = 0.5
    law: str = STANDARD.law
    section: str = STANDARD.section
    fluid_density: Given = "1000 kg/m^3"
    density_difference: Given | None = None
    drag: str = DRAGS[0]
    si: SimpleNamespace = field(init=False, repr=False, compare=False)
    """Each quantity of UNITS as a number in SI; nan where it is not given."""
    pieces: tuple[ArmSegment, ...] = field(init=False, repr=False, compare=False)
    """The segments in SI units; empty without."""

    def __post_init__(self) -> None:
        """Reads the units, and refuses what is no slender arm."""
        numbers = {name: number_in_si(name, getattr(self, name)) for name in UNITS}
        texts = None if self.segments is None else segment_texts(self.segments)
        object.__setattr__(self, "si", SimpleNamespace(**numbers))
        object.__setattr__(self, "segments", texts)
        object.__setattr__(self, "pieces", segments_of(texts or ()))
        refuse_words(self)
        refuse_other_sets(self)
        self.si.length, self.si.young = self.shape.length, self.shape.base.young
        refuse_misfits(self)
        refuse_crushed(self)

    def parameter(self, name: str) -> float:
        """A parameter of the arm as a rod; the default of what no arm determines."""
        return float(getattr(self, name, PARAMETERS[name].neutral))

    def quoted(self, name: str) -> str:
        """A quantity as it was given, for a sentence."""
        return quoted(name, getattr(self, name))

    @cached_property
    def shape(self) -> Shape:
        """The sections along the arm."""
        if self.pieces:
            own = self.si.young
            return in_segments([(L, each, own if E is None else E) for L, each, E in self.pieces])
        if self.tip_radius is not None:
            return cone(self.si.length, self.si.radius, self.si.tip_radius, self.si.young)
        return Shape(self.si.length, (Station(1.0, self._uniform_section, self.si.young),))

    @property
    def _uniform_section(self) -> Section:
        if self.radius is None:
            return Rectangle(self.si.width, self.si.height)
        if self.inner_radius is None:
            return Circle(self.si.radius)
        return Tube(self.si.radius, self.si.inner_radius)

    @property
    def cross_section(self) -> Section:
        """The cross section at the base."""
        return self.shape.base.section

    @property
    def isotropic(self) -> bool:
        """Whether the arm moves alike in all planes."""
        return not isinstance(self.cross_section, Rectangle) or self.si.width == self.si.height

    @property
    def taper(self) -> float:
        """Tip radius over base radius."""
        return self.shape.taper

    def build_with(self, drag: Drag) -> Build:
        """Law and profile of the arm, with one of `drags`."""
        return Build(self.law, self.section, self.shape.profile(self.poisson, self.drags.index(drag)))

    @cached_property
    def build(self) -> Build:
        """Law and profile of the arm as a rod."""
        return self.build_with(self.own_drag)

    @property
    def standard(self) -> bool:
        """Whether the arm is uniform and of linear material."""
        return self.build.standard and self.taper == 1

    @property
    def crushing_force(self) -> float:
        """The force that crushes the weakest section, in k3/L^2; inf where no force does."""
        return self.build.crushing_share(self.taper) * self.k1

    @property
    def load(self) -> str | None:
        """Name of the given load, "pressure" or "force"; None for an arm without load."""
        return next((name for name in LOADS if getattr(self, name) is not None), None)

    @property
    def share_of_flutter(self) -> float | None:
        """Load divided by the flutter load, if the load is given in this way."""
        return None if self.load is None else share_of_flutter(getattr(self, self.load))

    def mass_at(self, station: Station) -> float:
        """Mass per length at a station, of the material and of the fluid in its bore, in kg/m.

        The material is as dense as the fluid where no difference is given.
        """
        difference, fluid = self.si.density_difference, self.si.fluid_density
        density = fluid + (0.0 if isnan(difference) else difference)
        return density * station.section.area + fluid * station.section.bore_area

    @property
    def tip_force(self) -> float:
        """The resultant of the pressure over the tip's face, p A, in N (Sec. IV).

        Raises InputError for an arm without load, or with one relative to flutter, as `F` does.
        """
        if self.load is None:
            raise InputError("pressure is missing; give the pressure on the tip's cross section, or a force")
        if self.share_of_flutter is not None:
            raise InputError(f"{self.quoted(self.load)} is no number yet; it takes the threshold of flutter")
        return float(getattr(self.si, self.load)) * self._loaded_area

    @property
    def _loaded_area(self) -> float:
        """Resultant over load: the area of the tip's face for a pressure, 1 for a force."""
        return 1.0 if self.load == "force" else self.shape.tip.section.face_area

    @property
    def pressure_scale(self) -> float:
        """Pressure on the tip's face that makes F = 1, in Pa."""
        return self.force_scale / self.shape.tip.section.face_area

    @property
    def load_scale(self) -> float:
        """The load that makes F = 1: in N where the arm has a force, else a pressure, in Pa."""
        return self.force_scale if self.load == "force" else self.pressure_scale

    @property
    def bending_stiffness(self) -> float:
        """k3 = E I at the base, in N m^2 (Sec. III)."""
        return self.si.young * self.cross_section.second_moment

    @property
    def force_scale(self) -> float:
        """k3/L^2, in N: the unit of F, k1 and k2; drag is not in it."""
        return self.bending_stiffness / self.si.length**2

    @property
    def k1(self) -> float:
        """E A L^2/k3 = A L^2/I (Sec. III and VI): the same bits whatever Young's modulus."""
        return self.cross_section.area * self.si.length**2 / self.cross_section.second_moment

    @property
    def k2(self) -> float:
        """kappa G A L^2/k3, kappa G being the paper's effective G (Sec. III and VI; Cowper 1966)."""
        return self.cross_section.shear_coefficient(self.poisson) / (2 * (1 + self.poisson)) * self.k1

    @property
    def F(self) -> float:
        """p A L^2/k3 (Sec. IV and VI); InputError where the load is not known."""
        return self.tip_force / self.force_scale

    @cached_property
    def drags(self) -> tuple[Drag, ...]:
        """The drags of DRAGS at the base: the likeliest, then the corners of the range."""
        return self.shape.drags(self.shape.base, self.si.viscosity)

    def drags_along(self, drag: Drag) -> tuple[Drag, ...]:
        """The drag at every station of the shape; drag: that at the base, one of `drags`."""
        place = self.drags.index(drag)
        return tuple(self.shape.drags(each, self.si.viscosity)[place] for each in self.shape.stations)

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
