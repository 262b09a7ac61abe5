"""An arm in SI units as the rod of the paper: dimensionless stiffness, drag and force.

Stiffness follows Sec. III of the paper, the force Sec. IV, scales and dimensionless parameters Sec. VI.
Stiffnesses and drags are values at the base; `material` and `taper` give the variation along the arm.
Quantities are given as text with a unit, or as numbers in SI. The module uses no mesh and no solver.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import isnan
from types import SimpleNamespace

from ...errors import InputError
from ..material.rod_material import DEFAULT_MATERIAL, RodMaterial
from ..parameters import PARAMETERS
from ..units import GivenQuantity, load_over_flutter
from .drag import DRAG_ESTIMATE_NAMES, Drag
from .geometry import ArmGeometry, Station, geometry_of_segments
from .quantities import LOAD_NAMES, UNITS_AND_EXAMPLES, arm_quantity_in_si, quoted_quantity
from .refusals import refuse_crushed, refuse_out_of_range, refuse_wrong_choices, refuse_wrong_combinations
from .section import Circle, Rectangle, Section, Tube
from .segments import ArmSegment, segment_texts, segments_from_texts


@dataclass(frozen=True, kw_only=True)
class SlenderArm:
    """An arm in a viscous fluid, clamped at the base, with a pressure or a follower force on its tip.

    length: clamp to tip; None for an arm of segments. viscosity, fluid_density: of the fluid. poisson:
    Poisson's ratio of the material. Cross-section: a radius, or width and height (the height lies in the
    plane of motion), or segments from the base to the tip, each like "4 cm: radius 6 mm, young 80 kPa".
    `young` is the modulus of the arm and of segments without a modulus. tip_radius: tip radius of a solid
    cone. inner_radius: radius of a tube's bore; the bore is closed at the tip and filled with the surrounding
    fluid at ambient pressure. (law, section): a key of `rodsweep.model.material.laws.LAWS`. Load: pressure,
    force, or no load; positive loads push towards the base; "1.2 of flutter" is a multiple of the flutter
    threshold. density_difference: density of the arm's material minus density of the fluid. drag: name in
    DRAG_ESTIMATE_NAMES of the drag estimate that the rod uses. Raises InputError, naming the quantity.
    """

    length: GivenQuantity | None = None
    young: GivenQuantity | None = None
    viscosity: GivenQuantity
    radius: GivenQuantity | None = None
    inner_radius: GivenQuantity | None = None
    tip_radius: GivenQuantity | None = None
    width: GivenQuantity | None = None
    height: GivenQuantity | None = None
    segments: Sequence[str | Mapping[str, GivenQuantity]] | None = None
    pressure: GivenQuantity | None = None
    force: GivenQuantity | None = None
    poisson: float = 0.5
    law: str = DEFAULT_MATERIAL.law
    section: str = DEFAULT_MATERIAL.section
    fluid_density: GivenQuantity = "1000 kg/m^3"
    density_difference: GivenQuantity | None = None
    drag: str = DRAG_ESTIMATE_NAMES[0]
    si: SimpleNamespace = field(init=False, repr=False, compare=False)
    """Quantities of UNITS_AND_EXAMPLES in SI, or nan. With segments: `length` of all, `young` at the base."""
    si_segments: tuple[ArmSegment, ...] = field(init=False, repr=False, compare=False)
    """The segments of the arm in SI units; empty for an arm without segments."""

    def __post_init__(self) -> None:
        """Converts quantities to SI. Raises InputError for invalid quantities, NotSlender for a short arm."""
        # A NumPy number becomes a plain number, as messages and files show it.
        object.__setattr__(self, "poisson", getattr(self.poisson, "tolist", lambda: self.poisson)())
        si_values = {name: arm_quantity_in_si(name, getattr(self, name)) for name in UNITS_AND_EXAMPLES}
        texts = None if self.segments is None else segment_texts(self.segments)
        object.__setattr__(self, "si", SimpleNamespace(**si_values))
        object.__setattr__(self, "segments", texts)
        object.__setattr__(self, "si_segments", segments_from_texts(texts or ()))
        refuse_wrong_choices(self)
        refuse_wrong_combinations(self)
        # An arm of segments has length and modulus from them; the checks before ensure that a shape exists.
        self.si.length = self.geometry.length
        self.si.young = self.geometry.base.young
        refuse_out_of_range(self)
        refuse_crushed(self)

    def parameter(self, name: str) -> float:
        """Value of the rod parameter `name`; if an arm does not determine this parameter, its default, or its
        value at coordinate 0, for example F = 0 or k1 = inf."""
        return float(getattr(self, name, PARAMETERS[name].neutral_value))

    def quoted_quantity(self, name: str) -> str:
        """Name and value of the quantity `name` for messages, see `quantities.quoted_quantity`."""
        return quoted_quantity(name, getattr(self, name))

    @cached_property
    def geometry(self) -> ArmGeometry:
        """Cross-sections and Young's moduli along the arm."""
        if self.si_segments:
            segments = [(L, section, E or self.si.young) for L, section, E in self.si_segments]
            return geometry_of_segments(segments)
        if self.tip_radius is not None:
            radii = ((0.0, self.si.radius), (1.0, self.si.tip_radius))
            # A cone needs its two ends only, as the parameter taper implies the sections between.
            ends = tuple(Station(u, Circle(radius), self.si.young) for u, radius in radii)
            return ArmGeometry(self.si.length, ends, self.si.tip_radius / self.si.radius)
        section: Section = Tube(self.si.radius, self.si.inner_radius)
        if self.radius is None:
            section = Rectangle(self.si.width, self.si.height)
        elif self.inner_radius is None:
            section = Circle(self.si.radius)
        return ArmGeometry(self.si.length, (Station(1.0, section, self.si.young),))

    @property
    def cross_section(self) -> Section:
        """The cross-section at the base."""
        return self.geometry.base.section

    @property
    def is_equally_stiff_in_all_planes(self) -> bool:
        """Whether the arm is equally stiff in all planes through its axis."""
        return not isinstance(self.cross_section, Rectangle) or self.si.width == self.si.height

    @property
    def taper(self) -> float:
        """Tip radius over base radius of a cone; 1 for other arms."""
        return self.geometry.taper

    def material_with_drag(self, drag: Drag) -> RodMaterial:
        """Law and profile of the arm as a rod, for the drag estimate `drag` in `base_drag_estimates`."""
        profile = self.geometry.profile(self.poisson, self.base_drag_estimates.index(drag))
        return RodMaterial(self.law, self.section, profile)

    @cached_property
    def material(self) -> RodMaterial:
        """Constitutive law and profile of the arm as a rod, for the drag estimate `chosen_drag`."""
        return self.material_with_drag(self.chosen_drag)

    @property
    def is_uniform_and_linear(self) -> bool:
        """Whether the arm is uniform and of linear material."""
        return self.material.is_uniform_and_linear and self.taper == 1

    @property
    def crushing_force(self) -> float:
        """Follower force that crushes the weakest section, in k3/L^2; inf if no force crushes the arm."""
        return self.material.crushing_force_over_k1(self.taper) * self.k1

    @property
    def load_name(self) -> str | None:
        """Name of the given load, "pressure" or "force"; None for an arm without load."""
        return next((name for name in LOAD_NAMES if getattr(self, name) is not None), None)

    @property
    def load_over_flutter(self) -> float | None:
        """Load divided by the flutter load; None for an absolute load and for an arm without load."""
        return None if self.load_name is None else load_over_flutter(getattr(self, self.load_name))

    def mass_per_length_at(self, station: Station) -> float:
        """Mass per length at the cross-section `station`, in kg/m: material plus fluid in the bore. Without a
        `density_difference` the material has the density of the fluid."""
        fluid = self.si.fluid_density
        difference = self.si.density_difference
        # The fluid in the bore moves with the arm and adds to its mass.
        density = fluid + (0.0 if isnan(difference) else difference)
        return density * station.section.area + fluid * station.section.bore_area

    @property
    def tip_force(self) -> float:
        """Follower force at the tip, in N: pressure times face area, p A, or the given force (Sec. IV).
        Raises InputError for an arm without load and for a load relative to flutter."""
        if self.load_name is None:
            raise InputError("pressure is missing; give the pressure on the tip's cross section, or a force")
        if self.load_over_flutter is not None:
            load = self.quoted_quantity(self.load_name)
            raise InputError(f"{load} is relative to flutter; give an absolute load")
        loaded_area = 1.0 if self.load_name == "force" else self.geometry.tip.section.face_area
        return float(getattr(self.si, self.load_name)) * loaded_area

    @property
    def pressure_scale(self) -> float:
        """Pressure on the face of the tip at which F = 1, in Pa."""
        return self.force_scale / self.geometry.tip.section.face_area

    @property
    def load_scale(self) -> float:
        """The load at which F = 1: a force in N for an arm with a force, otherwise a pressure in Pa."""
        return self.force_scale if self.load_name == "force" else self.pressure_scale

    @property
    def bending_stiffness(self) -> float:
        """Bending stiffness k3 = E I at the base, in N m^2 (Sec. III)."""
        return self.si.young * self.cross_section.second_moment

    @property
    def force_scale(self) -> float:
        """Unit k3/L^2 of F, k1 and k2, in N; independent of drag."""
        return self.bending_stiffness / self.si.length**2

    @property
    def k1(self) -> float:
        """Stretch stiffness k1 = E A L^2/k3 = A L^2/I (Sec. III, VI). E cancels before rounding."""
        return self.cross_section.area * self.si.length**2 / self.cross_section.second_moment

    @property
    def k2(self) -> float:
        """Shear stiffness k2 = kappa G A L^2/k3; the paper's G is kappa G (Sec. III, VI; Cowper 1966)."""
        return self.cross_section.shear_coefficient(self.poisson) / (2 * (1 + self.poisson)) * self.k1

    @property
    def F(self) -> float:
        """Force F = p A L^2/k3 (Sec. IV, VI). InputError without load, and for a load relative to flutter."""
        return self.tip_force / self.force_scale

    @cached_property
    def base_drag_estimates(self) -> tuple[Drag, ...]:
        """Estimates of the drag at the base, in the order of DRAG_ESTIMATE_NAMES."""
        return self.geometry.drag_estimates_at(self.geometry.base, self.si.viscosity)

    def drags_along(self, drag: Drag) -> tuple[Drag, ...]:
        """Drag at every station of `geometry`. drag: the estimate at the base, in `base_drag_estimates`."""
        index = self.base_drag_estimates.index(drag)
        stations = self.geometry.stations
        return tuple(self.geometry.drag_estimates_at(place, self.si.viscosity)[index] for place in stations)

    @property
    def chosen_drag(self) -> Drag:
        """Drag of the rod at the base: the drag estimate with the name in the field `drag`."""
        return self.base_drag_estimates[DRAG_ESTIMATE_NAMES.index(self.drag)]

    def gamma3_with(self, drag: Drag) -> float:
        """Dimensionless rotational drag gamma3/(gamma2 L^2) for the drag estimate `drag` (Sec. VI)."""
        return drag.rotational_factor / (drag.normal_factor * self.si.length**2)

    def tau2_with(self, drag: Drag) -> float:
        """Unit of time gamma2 L^4/k3 for the drag estimate `drag`, in s (Sec. VI)."""
        return drag.gamma2 * self.si.length**4 / self.bending_stiffness

    @property
    def gamma3(self) -> float:
        """Dimensionless rotational drag gamma3/(gamma2 L^2) at the base (Sec. VI)."""
        return self.gamma3_with(self.chosen_drag)

    @property
    def gamma1(self) -> float:
        """Dimensionless axial drag gamma1/gamma2 at the base (Sec. VI)."""
        return self.chosen_drag.axial_factor / self.chosen_drag.normal_factor

    @property
    def tau2(self) -> float:
        """Longest time scale of the arm, gamma2 L^4/k3, in s (Sec. VI)."""
        return self.tau2_with(self.chosen_drag)

    @property
    def tau1(self) -> float:
        """Shortest time scale of the arm, gamma3/k2 with both in SI units, in s (Sec. VI)."""
        return self.tau2 * self.gamma3 / self.k2
