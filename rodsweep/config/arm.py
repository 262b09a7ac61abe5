"""The section `parameters.arm` of a config: an arm in SI units, whose axes become those of parameters.

An axis of the load is one of F, an axis of Poisson's ratio one of k2, and a grid of both stays a grid.
Length, section and Young's modulus move several parameters at once: with an axis of these, all combinations
are a list of points.
"""

from collections.abc import Iterator, Mapping
from itertools import product
from typing import Annotated, Any

import numpy as np
from pydantic import BeforeValidator, Field, ValidationInfo, WithJsonSchema

from ..arrays import Array
from ..errors import InputError
from ..model.arm import UNITS, SlenderArm
from ..model.parameters import NONLINEAR_PARAMETERS
from ..model.units import in_si
from .values import AXIS_SCHEMA, Axis, Strict, Values, as_axis, as_number

LOADS = ("pressure", "force")
AXIS_OF = dict.fromkeys(LOADS, "F") | {"poisson": "k2"}
"""The one parameter that a quantity moves, where it moves one only."""
UNSWEPT = "viscosity"
"""What moves no parameter: every time is proportional to it."""
SECTION = ("length", "young", "viscosity", "radius", "inner_radius", "width", "height", "poisson")
"""What makes an arm beside its load."""
MOST_LISTED = 1_000_000
"""Points that are made of the axes of an arm, one by one."""


def as_quantities(value: Any, info: ValidationInfo) -> Axis:
    """A quantity, a list or a range of quantities as an Axis in SI units; ValueError otherwise."""
    name = str(info.field_name)
    if isinstance(value, Axis):
        return value
    if isinstance(value, dict):
        ends = {end: _read(name, value[end]) for end in ("start", "stop") if end in value}
        return as_axis(value | ends)
    if isinstance(value, list | tuple):
        return as_axis([_read(name, each) for each in value])
    return as_axis(_read(name, value))


def _read(name: str, value: Any) -> float:
    """A quantity in SI units; ValueError where it is none."""
    if not isinstance(value, str):
        return as_number(value)
    try:
        return in_si(f"parameters.arm.{name}", value, *UNITS[name])
    except InputError as error:
        raise ValueError(str(error)) from None


def _schema() -> dict[str, Any]:
    """What `as_quantities` takes, as a JSON schema: an axis whose numbers may be text with a unit."""
    each: dict[str, Any] = {"anyOf": [{"type": "number"}, {"type": "string"}]}
    *_, values, span = AXIS_SCHEMA["anyOf"]
    ends = {end: {"description": span["properties"][end]["description"], **each} for end in ("start", "stop")}
    return {
        "anyOf": [
            *each["anyOf"],
            values | {"items": each},
            span | {"properties": span["properties"] | ends},
        ]
    }


Quantities = Annotated[Axis, BeforeValidator(as_quantities), WithJsonSchema(_schema())]
Allowed = Field(description="a quantity with its unit, a list or a range of quantities; SI without unit")
RatioAllowed = Field(description="a number above -1 and up to 0.5, a list or a range")


class ArmSection(Strict):
    """An arm as `rodsweep arm` takes it, each quantity one value or an axis."""

    length: Annotated[Quantities, Allowed]
    """From the clamp to the tip."""
    radius: Annotated[Quantities | None, Allowed] = None
    """Of a circular section; or give width and height."""
    inner_radius: Annotated[Quantities | None, Allowed] = None
    """Of the bore of a tube, which is closed at its tip."""
    width: Annotated[Quantities | None, Allowed] = None
    """Of a rectangular section, across the plane of motion."""
    height: Annotated[Quantities | None, Allowed] = None
    """Of a rectangular section, in the plane of motion."""
    young: Annotated[Quantities, Allowed]
    """Young's modulus."""
    poisson: Annotated[Values | None, RatioAllowed] = None
    """Poisson's ratio, 0.5 where it is not given."""
    viscosity: Annotated[Quantities, Allowed]
    """Of the fluid; one value, because it scales the time only."""
    pressure: Annotated[Quantities | None, Allowed] = None
    """On the tip's cross section; or give force. Not where the task finds F itself."""
    force: Annotated[Quantities | None, Allowed] = None
    """Follower force at the tip."""

    @property
    def load(self) -> str | None:
        """Which of the loads is given, if any is."""
        return next((name for name in LOADS if getattr(self, name) is not None), None)

    @property
    def several(self) -> tuple[str, ...]:
        """The quantities that have more than one value."""
        return tuple(name for name, axis in self._given.items() if axis.size > 1)

    @property
    def meaning(self) -> dict[str, float | None]:
        """The quantities, and the values of those that the points do not tell, in SI."""
        told = AXIS_OF if self.is_grid else self.several
        return {name: None if name in told else float(axis.array()[0]) for name, axis in self._given.items()}

    @property
    def is_grid(self) -> bool:
        """Whether every axis moves one parameter only."""
        return all(name in AXIS_OF for name in self.several)

    @property
    def _given(self) -> dict[str, Axis]:
        names = (*SECTION, *LOADS)
        return {name: getattr(self, name) for name in names if getattr(self, name) is not None}

    def refuse_unfit(self) -> None:
        """ValueError where a quantity is not allowed, or the first of the arms is not slender or crushed."""
        for name, axis in self._given.items():
            low = float(axis.array()[0])
            if name in SECTION and name != "poisson" and not low > 0:
                raise ValueError(f"parameters.arm.{name} = {low:.6g} {UNITS[name][0]} is not above 0")
        next(self._arms())

    def refuse_misuse(self, forced: bool, F_given: bool) -> None:
        """ValueError unless there is one load where the task needs one, and no axis that changes nothing.

        forced: whether F is a parameter of the task; F_given: whether it stands beside the arm.
        """
        if UNSWEPT in self.several:
            raise ValueError(
                f"parameters.arm.{UNSWEPT} has several values, and no dimensionless parameter depends on it; "
                "give one: every time is proportional to it"
            )
        if self.load and F_given:
            raise ValueError(f"parameters.F and parameters.arm.{self.load} are both given; give one of them")
        if self.load and not forced:
            raise ValueError(
                f"parameters.arm.{self.load} is given but the task finds the load itself; remove it and set "
                "its option F_max, or stop"
            )
        if forced and not (self.load or F_given):
            raise ValueError("parameters.arm.pressure is missing; give the pressure on the tip or a force")

    def grid_axes(self) -> dict[str, Axis]:
        """The axes of the dimensionless parameters of a grid, by name; no F without load.

        ValueError for what is no slender arm, and for a load that crushes it.
        """
        arm = self._heaviest({name: float(axis.array()[0]) for name, axis in self._given.items()})
        axes = {name: Axis(values=(getattr(arm, name),)) for name in NONLINEAR_PARAMETERS if name != "F"}
        if self.poisson is not None:
            axes["k2"] = Axis(values=tuple(sorted(arm.k2 for arm in self._arms())))
        if self.load:
            axes = {"F": _scaled(self._given[self.load], self._force_of(arm))} | axes
        return axes

    def listed(self, beside: Mapping[str, Array]) -> dict[str, Array]:
        """The parameters of all combinations, each (points,): of the section, then the load, then `beside`.

        beside: values of parameters that replace the arm's. ValueError as of `grid_axes`.
        """
        inner = {"load": self._loads} | dict(beside)
        table = {name: column.ravel() for name, column in _crossed(inner).items()}
        each = len(table["load"])
        arms = list(self._arms())
        columns = {
            name: np.repeat([getattr(arm, name) for arm in arms], each)
            for name in NONLINEAR_PARAMETERS
            if name != "F"
        }
        if self.load:
            scale = np.repeat([self._force_of(arm) for arm in arms], each)
            columns = {"F": scale * np.tile(table["load"], len(arms))} | columns
        return columns | {name: np.tile(table[name], len(arms)) for name in beside}

    def quantities(self, beside: Mapping[str, Array]) -> dict[str, Array]:
        """The quantities in SI, with the units of time, force and pressure that they make.

        A number, shape (), or where there are several: along its parameter in a grid, shape (values,), in
        the order of `grid_axes`; else along all points of `listed`, shape (points,).
        """
        values = {name: axis.array() for name, axis in self._given.items()}
        arms = list(self._arms())
        units = {
            "tau2": [arm.tau2 for arm in arms],
            "force_scale": [arm.force_scale for arm in arms],
            "pressure_scale": [arm.pressure_scale for arm in arms],
        }
        if self.is_grid:
            if self.poisson is not None:  # k2 falls as it rises
                values["poisson"] = values["poisson"][::-1]
            found = values | {name: np.array(each[:1]) for name, each in units.items()}
            return {name: array[0] if len(array) == 1 else array for name, array in found.items()}
        sections = _crossed({name: values[name] for name in SECTION if name in values})
        each = len(self._loads) * int(np.prod([len(column) for column in beside.values()]))
        found = {name: np.repeat(column.ravel(), each) for name, column in sections.items()}
        found |= {name: np.repeat(column, each) for name, column in units.items()}
        if self.load:
            loads = np.repeat(self._loads, each // len(self._loads))
            found[self.load] = np.tile(loads, len(arms))
        along = (*self.several, *units)
        return {name: column if name in along else column[0] for name, column in found.items()}

    def count(self, beside: int) -> int:
        """Points of a list, where `beside` the arm so many combinations of parameters are given."""
        return int(np.prod([float(axis.size) for axis in self._given.values()])) * beside

    @property
    def _loads(self) -> Array:
        """The values of the load, shape (values,); one nan where there is none."""
        return self._given[self.load].array() if self.load else np.array([np.nan])

    def _arms(self) -> Iterator[SlenderArm]:
        """The arms of all sections, in row-major order, each with the largest load."""
        names = [name for name in SECTION if name in self._given]
        for values in product(*(self._given[name].array() for name in names)):
            yield self._heaviest(dict(zip(names, map(float, values), strict=True)))

    def _heaviest(self, values: Mapping[str, float]) -> SlenderArm:
        """An arm with the largest load, or none; ValueError where it is no slender arm or crushed."""
        loads = {name: float(self._given[name].array()[-1]) for name in LOADS if name in self._given}
        try:
            return SlenderArm(**{**values, **(loads or {"pressure": 0.0})})
        except InputError as error:
            raise ValueError(f"parameters.arm.{error}") from None

    def _force_of(self, arm: SlenderArm) -> float:
        """F of a load of 1 in SI on an arm."""
        return 1.0 / (arm.pressure_scale if self.load == "pressure" else arm.force_scale)


def _scaled(axis: Axis, scale: float) -> Axis:
    """An axis with all values multiplied."""
    if axis.values is not None:
        return Axis(values=tuple(scale * value for value in axis.values))
    factor = scale * axis.factor  # kept apart, so that a longer range has the same values
    return axis.model_copy(update={"factor": factor})


def _crossed(columns: Mapping[str, Array]) -> dict[str, Array]:
    """All combinations of the values, each (n,), as tables of one shape, the last name the fastest."""
    return dict(zip(columns, np.meshgrid(*columns.values(), indexing="ij"), strict=True))
