"""The section `parameters.arm` of a config: an arm in SI units, and the parameter axes computed from it."""

from collections.abc import Iterator, Mapping
from functools import cached_property
from itertools import product
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, model_validator

from ...arrays import Array, list_of
from ...errors import InputError
from ...model.arm.arm import SlenderArm
from ...model.arm.quantities import (
    ARM_SCALES,
    GIVEN_QUANTITIES,
    LOAD_NAME_BY_RELATIVE_LOAD,
    LOAD_NAMES,
    LOAD_SCALE_NAME_BY_LOAD,
    UNITS_AND_EXAMPLES,
)
from ...model.material.rod_material import RodMaterial
from ...model.parameters import NONLINEAR_ROD_PARAMETER_NAMES, parameter_names_except
from ..axis import Axis, ParameterAxis
from ..material import LawName, SectionName
from ..values import StrictConfigSection
from .axes import LOAD_KEYS, NON_LOAD_KEYS, SINGLE_PARAMETER_OF
from .quantities import DragAxis, QuantityAxis, drag_estimate_names_of_indices, with_load_over_flutter
from .shape import (
    ALLOWED_SEGMENTS_TEXT,
    MATERIAL_KEYS,
    Segments,
    material_of,
    materials_of,
    tapers_of,
    with_length,
)
from .status import STATUS_OF_ERROR, ArmOutsideModel

QUANTITY_FIELD = Field(
    description="a quantity with its unit (SI if the unit is omitted), or a list or a range of quantities"
)
RELATIVE_LOAD_FIELD = Field(description="a number from 0 on, a list or a range")
DRAG_FIELD = Field(description="range, the name of a drag, or a list of names")
POISSON_FIELD = Field(description="a number above -1 and up to 0.5, a list or a range")
NO_LOAD = {"pressure": 0.0}


class ArmConfig(StrictConfigSection):
    """The arm in the quantities of `rodsweep arm`; each quantity is a value or an axis."""

    length: Annotated[QuantityAxis | None, QUANTITY_FIELD] = None
    """Length from the clamp to the tip; for an arm in segments, the sum of their lengths."""
    radius: Annotated[QuantityAxis | None, QUANTITY_FIELD] = None
    """Radius of a circular section. Alternatives: width and height, or segments."""
    inner_radius: Annotated[QuantityAxis | None, QUANTITY_FIELD] = None
    """Radius of the bore of a tube, which is closed at its tip."""
    tip_radius: Annotated[QuantityAxis | None, QUANTITY_FIELD] = None
    """Radius at the tip of a solid cone, which has `radius` at its base."""
    segments: Annotated[Segments, Field(description=ALLOWED_SEGMENTS_TEXT)] = None
    """Segments from the base to the tip, each with length, radius, and optionally inner_radius and young."""
    width: Annotated[QuantityAxis | None, QUANTITY_FIELD] = None
    """Width of a rectangular section, across the plane of motion."""
    height: Annotated[QuantityAxis | None, QUANTITY_FIELD] = None
    """Height of a rectangular section, in the plane of motion."""
    young: Annotated[QuantityAxis | None, QUANTITY_FIELD] = None
    """Young's modulus at small strain; in an arm with segments, the modulus of every segment without a
    modulus of its own."""
    poisson: Annotated[ParameterAxis | None, POISSON_FIELD] = None
    """Poisson's ratio, by default 0.5."""
    law: Annotated[LawName | None, Field(description="linear or neo_hookean")] = None
    """Constitutive law, by default linear. For an arm, this key replaces `material.law`."""
    section: Annotated[SectionName | None, Field(description="fixed or swelling")] = None
    """Whether the cross-section is fixed (the default) or swelling. For an arm, this key replaces
    `material.section`."""
    viscosity: Annotated[QuantityAxis, QUANTITY_FIELD]
    """Viscosity of the fluid. The parameters do not depend on the viscosity; times are proportional to the
    viscosity."""
    fluid_density: Annotated[QuantityAxis | None, QUANTITY_FIELD] = None
    """Density of the fluid, by default the density of water; used only to test whether the model applies."""
    density_difference: Annotated[QuantityAxis | None, QUANTITY_FIELD] = None
    """Density of the arm minus density of the fluid; used only to test whether the neglected weight is small.
    If this key is missing, the weight is not tested."""
    drag: Annotated[DragAxis | None, DRAG_FIELD] = None
    """Drag estimates from the range in the literature, by name; by default the likeliest estimate."""
    pressure: Annotated[QuantityAxis | None, QUANTITY_FIELD] = None
    """Pressure on the tip's cross section; alternative: force. Omit the load if the task solves for F."""
    force: Annotated[QuantityAxis | None, QUANTITY_FIELD] = None
    """Follower force at the tip."""
    pressure_over_flutter: Annotated[ParameterAxis | None, RELATIVE_LOAD_FIELD] = None
    """Pressure over the flutter pressure at the likeliest drag: 1.2 means `pressure: 1.2 of flutter`."""
    force_over_flutter: Annotated[ParameterAxis | None, RELATIVE_LOAD_FIELD] = None
    """Force over the flutter force at the likeliest drag: 1.2 means `force: 1.2 of flutter`."""

    load_kind: Annotated[Literal["pressure", "force"] | None, Field(description="pressure or force")] = None
    """Kind of the loads in the results of an arm without a load, by default pressure: thresholds are stored
    in Pa, with force in N."""

    @model_validator(mode="before")
    @classmethod
    def _with_relative_load_and_length(cls, section: Any) -> Any:
        """Moves a load relative to flutter to its own key, and adds the length of an arm with segments."""
        return with_length(with_load_over_flutter(section)) if isinstance(section, dict) else section

    @model_validator(mode="after")
    def _require_length_and_modulus(self) -> "ArmConfig":
        for name in ("length", "young"):
            if getattr(self, name) is None and self.segments is None:
                raise ValueError(f"parameters.arm.{name} is missing; give it, or give segments")
        return self

    @cached_property
    def rod_material(self) -> RodMaterial:
        """Law and profile of all arms; ValueError if the profiles of a grid of parameters differ."""
        return material_of(self)

    @property
    def given_material_values(self) -> dict[str, Any]:
        """Values of the given keys among segments, law and section, by key."""
        return {name: getattr(self, name) for name in MATERIAL_KEYS if getattr(self, name) is not None}

    @property
    def is_nonuniform(self) -> bool:
        """Whether any key makes the arms nonuniform: `tip_radius` or `segments`."""
        return self.tip_radius is not None or self.segments is not None

    @property
    def is_uniform_and_linear(self) -> bool:
        """Whether all arms are uniform and of linear material."""
        if self.segments is None:
            return self.rod_material.is_uniform_and_linear and tapers_of(self) == {1.0}
        return all(rod_material.is_uniform_and_linear for rod_material in materials_of(self))

    @property
    def load_key(self) -> str | None:
        """Key of the given load, absolute or relative to flutter; None if no load is given."""
        return next((name for name in LOAD_KEYS if getattr(self, name) is not None), None)

    @property
    def load_name(self) -> str | None:
        """Name of the given load, "pressure" or "force", absolute or relative; None if no load is given."""
        return LOAD_NAME_BY_RELATIVE_LOAD.get(str(self.load_key), self.load_key)

    @property
    def varying_quantities(self) -> tuple[str, ...]:
        """Names of the quantities that have several values or are relative to flutter."""
        axes = self.quantity_axes.items()
        return tuple(name for name, axis in axes if axis.size > 1 or name in LOAD_NAME_BY_RELATIVE_LOAD)

    @property
    def settings_of_results(self) -> dict[str, Any]:
        """Data of the arm on which the results depend, except the points: quantities in SI units and material
        keys, by name; None for a quantity whose values belong to the points."""
        grid_names = SINGLE_PARAMETER_OF if self.is_parameter_grid else self.varying_quantities
        si_values = self.first_si_values | {name: None for name in self.first_si_values if name in grid_names}
        load_kind = {} if self.load_kind is None else {"load_kind": self.load_kind}
        segments = {} if self.segments is None else {"segments": list(self.segments)}
        return si_values | self.given_material_values | segments | load_kind

    @property
    def is_parameter_grid(self) -> bool:
        """Whether the points form a grid of parameters, that is, every axis changes exactly one parameter."""
        return all(name in SINGLE_PARAMETER_OF for name in self.varying_quantities)

    @property
    def quantity_axes(self) -> dict[str, Axis]:
        """Axes of the given quantities by name, the load last."""
        names = (*NON_LOAD_KEYS, *LOAD_KEYS)
        return {name: getattr(self, name) for name in names if getattr(self, name) is not None}

    def require_allowed_values(self) -> None:
        """Raises ValueError for a value out of range, or if the model does not cover a grid's first arm."""
        for name, axis in self.quantity_axes.items():
            smallest_value = float(axis.array()[0])
            if name in LOAD_NAME_BY_RELATIVE_LOAD and smallest_value < 0:
                raise ValueError(f"parameters.arm.{name} = {smallest_value:.6g} is below 0")
            if smallest_value > 0 or name not in UNITS_AND_EXAMPLES:
                continue
            if not GIVEN_QUANTITIES[name].may_be_nonpositive:
                value_text = f"{smallest_value:.6g} {UNITS_AND_EXAMPLES[name][0]}"
                is_solid = name == "inner_radius" and smallest_value == 0
                hint = "; leave it out for a solid arm" if is_solid else ""
                raise ValueError(f"parameters.arm.{name} = {value_text} is not above 0{hint}")
        if self.is_parameter_grid:
            self.arm_of(self.first_si_values, with_load=True)

    def dimensionless_axes(self) -> dict[str, Axis]:
        """Axes of the dimensionless parameters of a grid of parameters, by name; without F if the arm has no
        load.

        Raises ValueError if the arm is not slender, or if the smallest load crushes the arm.
        """
        arm = self.arm_of(self.first_si_values, with_load=True)
        names = (*parameter_names_except("F", NONLINEAR_ROD_PARAMETER_NAMES), *self.cone_parameter_names)
        axes = {name: Axis(values=(arm.parameter(name),)) for name in names}
        for name in ("k2", "gamma3"):
            distinct = {getattr(self.arm_of(values), name) for values in self.values_of_arms()}
            axes[name] = Axis(values=tuple(sorted(distinct)))
        if self.load_name:
            load_scale = getattr(arm, LOAD_SCALE_NAME_BY_LOAD[self.load_name])
            axes = {"F": self.quantity_axes[self.load_name].scaled(1 / load_scale)} | axes
        return axes

    def quantity_values_on_grid(self) -> dict[str, Array]:
        """Values of the arm's quantities and units by name: a number, (), or the values, (n,), along the axis
        of the parameter that the quantity determines."""
        values = {name: axis.array() for name, axis in self.quantity_axes.items()}
        if self.poisson is not None:  # k2 decreases with Poisson's ratio, and axes must increase
            values["poisson"] = values["poisson"][::-1]
        arm = self.arm_of(self.first_si_values)
        units = {name: np.array([getattr(arm, name)]) for name in ARM_SCALES}
        if len(values.get("drag", ())) > 1:
            drags = list_of(values["drag"])
            arms = {drag: self.arm_of(self.first_si_values | {"drag": drag}) for drag in drags}
            values["drag"] = np.array(sorted(arms, key=lambda drag: arms[drag].gamma3))
            units["tau2"] = np.array([arms[drag].tau2 for drag in list_of(values["drag"])])
        return {name: array[0] if len(array) == 1 else array for name, array in (values | units).items()}

    @property
    def cone_parameter_names(self) -> tuple[str, ...]:
        """Names of parameters that only cones have: ("taper",) for cones, else ()."""
        return () if self.tip_radius is None else ("taper",)

    @property
    def first_si_values(self) -> dict[str, float]:
        """First value of every given quantity, in SI units, by name."""
        return {name: float(axis.array()[0]) for name, axis in self.quantity_axes.items()}

    def values_of_arms(self) -> Iterator[dict[str, float]]:
        """Yields all quantities of every arm except the load, in SI units by name, in row-major order."""
        names = [name for name in NON_LOAD_KEYS if name in self.quantity_axes]
        for values in product(*(self.quantity_axes[name].array() for name in names)):
            yield dict(zip(names, map(float, values), strict=True))

    def arm_of(self, values: Mapping[str, float], with_load: bool = False) -> SlenderArm:
        """The arm with the given quantities; ValueError for invalid values.

        values: quantities in SI units, by name. with_load: whether the load is included; a load relative to
        flutter is always left out. Raises ArmOutsideModel if the rod model does not apply to the arm.
        """
        section: dict[str, Any] = {name: value for name, value in values.items() if name in NON_LOAD_KEYS}
        has_load = with_load and self.load_key in LOAD_NAMES
        section |= {str(self.load_key): values[str(self.load_key)]} if has_load else NO_LOAD
        (drag,) = drag_estimate_names_of_indices([section.pop("drag", 0.0)])
        try:
            return SlenderArm(**section, **self.given_material_values, drag=drag)
        except InputError as error:
            if type(error) in STATUS_OF_ERROR:
                raise ArmOutsideModel(error) from None
            raise ValueError(f"parameters.arm.{error}") from None
