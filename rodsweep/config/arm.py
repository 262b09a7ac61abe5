"""The section `parameters.arm` of a config: an arm in SI units, whose axes become those of parameters.

An axis of the load is one of F, an axis of Poisson's ratio one of k2, and a grid of both stays a grid of
parameters. Any other quantity moves several parameters at once, or none: with an axis of these the points
are a grid over the arm's own quantities, on which every parameter has its own value.
"""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from ..arrays import Array
from ..errors import InputError
from ..model.arm import SIGNED, UNITS, NotSlender, NoWall, SlenderArm
from ..model.parameters import NONLINEAR_PARAMETERS
from .quantities import Quantities
from .values import Axis, Strict, Values

LOADS = ("pressure", "force")
AXIS_OF = dict.fromkeys(LOADS, "F") | {"poisson": "k2"}
"""The one parameter that a quantity moves, where it moves one only."""
FLUID = ("viscosity", "fluid_density", "density_difference")
"""What moves no parameter: units of time are proportional to viscosity, densities say whether the model
applies."""
SECTION = ("length", "young", "radius", "inner_radius", "width", "height", "poisson", *FLUID)
"""What makes an arm beside its load."""
SIGNED_IN_SECTION = ("density_difference",)
"""What of it may be negative."""
MOST_POINTS = 1_000_000
"""Points of a grid over an arm's quantities, whose parameters are all in memory."""
SLENDER, NOT_SLENDER, CRUSHED, NO_WALL = 0, 100, 101, 102
"""Whether a rod covers a point: it does; the arm is too short for the drag of slender bodies; F reaches k1;
the bore is as wide as the arm. All but the first are statuses, which no task's own statuses reach."""
UNCOVERED = {NotSlender: NOT_SLENDER, NoWall: NO_WALL}
"""What refusals of an arm mean for a point."""
UNIT_NAMES = ("tau2", "force_scale", "pressure_scale")
"""Units of time, force and pressure that an arm makes."""

Allowed = Field(description="a quantity with its unit, a list or a range of quantities; SI without unit")
RatioAllowed = Field(description="a number above -1 and up to 0.5, a list or a range")


class _Uncovered(ValueError):
    """What is said of an arm that no rod covers; `status` is that of its points."""

    def __init__(self, error: NotSlender | NoWall):
        super().__init__(f"parameters.arm.{error}")
        self.status = UNCOVERED[type(error)]


@dataclass(frozen=True, slots=True)
class ArmGrid:
    """The points of a grid over an arm's quantities.

    axes: values of each quantity or parameter that has several, in SI, the last the fastest. All else at
    every point, shape (points,): the parameters, the units of UNIT_NAMES, and whether a rod covers it.
    """

    axes: dict[str, Array]
    parameters: dict[str, Array]
    units: dict[str, Array]
    covered: NDArray[np.int8]


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
    """Of the fluid; it moves no parameter, but times are proportional to it."""
    fluid_density: Annotated[Quantities | None, Allowed] = None
    """Of the fluid, that of water where it is not given; for whether the model applies."""
    density_difference: Annotated[Quantities | None, Allowed] = None
    """The arm's density less the fluid's, for whether the model applies; weight is left out without it."""
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
        return tuple(name for name, axis in self.given.items() if axis.size > 1)

    @property
    def meaning(self) -> dict[str, float | None]:
        """The quantities, and the values of those that the points do not tell, in SI."""
        told = AXIS_OF if self.is_grid else self.several
        return {name: None if name in told else float(axis.array()[0]) for name, axis in self.given.items()}

    @property
    def is_grid(self) -> bool:
        """Whether every axis moves one parameter only, so that the points are a grid of parameters."""
        return all(name in AXIS_OF for name in self.several)

    @property
    def given(self) -> dict[str, Axis]:
        """The quantities that are given, those of the section first."""
        names = (*SECTION, *LOADS)
        return {name: getattr(self, name) for name in names if getattr(self, name) is not None}

    def refuse_unfit(self) -> None:
        """ValueError where a value is not allowed, or a grid of parameters has arms that no rod covers."""
        for name, axis in self.given.items():
            low = float(axis.array()[0])
            if name not in (*SIGNED, "poisson") and not low > 0:
                raise ValueError(f"parameters.arm.{name} = {low:.6g} {UNITS[name][0]} is not above 0")
        if self.is_grid:
            self._made(self._firsts, place=-1)

    def refuse_misuse(self, forced: bool, beside: Collection[str]) -> None:
        """ValueError unless there is one load where the task needs one, and no axis that changes nothing.

        forced: whether F is a parameter of the task; beside: the parameters that stand beside the arm.
        """
        if self.pressure is not None and self.force is not None:
            raise ValueError(
                "parameters.arm.pressure and parameters.arm.force are both given; give one of them"
            )
        if self.load and "F" in beside:
            raise ValueError(f"parameters.F and parameters.arm.{self.load} are both given; give one of them")
        if "poisson" in self.several and "k2" in beside:
            raise ValueError(
                "parameters.arm.poisson has several values, and parameters.k2, which replaces all that it "
                "moves, is given too; give one of them"
            )
        if self.load and not forced:
            raise ValueError(
                f"parameters.arm.{self.load} is given but the task finds the load itself; remove it and set "
                "its option F_max, or stop"
            )
        if forced and not (self.load or "F" in beside):
            raise ValueError("parameters.arm.pressure is missing; give the pressure on the tip or a force")

    def grid_axes(self) -> dict[str, Axis]:
        """The axes of the dimensionless parameters of a grid of these, by name; no F without load.

        ValueError for what is no slender arm, and for a load that crushes it.
        """
        arm = self._made(self._firsts, place=-1)
        axes = {name: Axis(values=(getattr(arm, name),)) for name in NONLINEAR_PARAMETERS if name != "F"}
        if self.poisson is not None:
            axes["k2"] = Axis(values=tuple(sorted(self._made(each).k2 for each in self._sections())))
        if self.load:
            axes = {"F": _scaled(self.given[self.load], self._force_of(arm))} | axes
        return axes

    def grid_quantities(self) -> dict[str, Array]:
        """The quantities and units of a grid of parameters: numbers, shape (), or along their parameter."""
        values = {name: axis.array() for name, axis in self.given.items()}
        if self.poisson is not None:  # k2 falls as it rises
            values["poisson"] = values["poisson"][::-1]
        units = {name: np.array([value]) for name, value in _units_of(self._made(self._firsts)).items()}
        return {name: array[0] if len(array) == 1 else array for name, array in (values | units).items()}

    def own_grid(self, beside: Mapping[str, Array]) -> ArmGrid:
        """The grid over the arm's quantities, and over those parameters of `beside` that have several values.

        beside: values of parameters that replace the arm's, (n,). ValueError where no rod covers any point.
        """
        arms, statuses = zip(*self._arms(), strict=True)
        loads = self.given[self.load].array() if self.load else np.zeros(1)
        crossed = dict(zip(beside, np.meshgrid(*beside.values(), indexing="ij"), strict=True))
        shape = (len(arms), len(loads), next(iter(crossed.values())).size if crossed else 1)
        names = [name for name in NONLINEAR_PARAMETERS if name != "F"]
        of_arms = {name: _along(0, [getattr(arm, name, np.nan) for arm in arms]) for name in names}
        units = {name: _along(0, [_units_of(arm)[name] for arm in arms]) for name in UNIT_NAMES}
        if self.load:
            scale = _along(0, [self._force_of(arm) if arm else np.nan for arm in arms])
            of_arms["F"] = scale * _along(1, loads)
        of_arms |= {name: _along(2, column.ravel()) for name, column in crossed.items()}
        table = {name: np.broadcast_to(column, shape) for name, column in of_arms.items()}
        covered = np.broadcast_to(_along(0, statuses), shape).copy()
        if "F" in table:
            covered[(covered == SLENDER) & (table["F"] >= table["k1"])] = CRUSHED
        if (covered != SLENDER).all():
            self._refuse_all(beside)
        axes = {name: axis.array() for name, axis in self.given.items() if axis.size > 1}
        return ArmGrid(
            axes | {name: column for name, column in beside.items() if len(column) > 1},
            {name: table[name].ravel() for name in NONLINEAR_PARAMETERS if name in table},
            {name: np.broadcast_to(column, shape).ravel() for name, column in units.items()},
            covered.astype(np.int8).ravel(),
        )

    def count(self, beside: int) -> int:
        """Points of a grid, where `beside` the arm so many combinations of parameters are given."""
        return int(np.prod([float(axis.size) for axis in self.given.values()])) * beside

    def _refuse_all(self, beside: Mapping[str, Array]) -> None:
        """ValueError, with what is wrong at the first point."""
        self._made(self._firsts, place=0)
        k1 = float(beside["k1"][0])
        raise ValueError(f"parameters.k1 is {k1:.15g} and every F is above; the rod is crushed where F >= k1")

    @property
    def _firsts(self) -> dict[str, float]:
        """The first value of every quantity."""
        return {name: float(axis.array()[0]) for name, axis in self.given.items()}

    def _sections(self) -> Iterator[dict[str, float]]:
        """The quantities of all sections, in row-major order."""
        names = [name for name in SECTION if name in self.given]
        for values in product(*(self.given[name].array() for name in names)):
            yield dict(zip(names, map(float, values), strict=True))

    def arm_at(self, number: int) -> SlenderArm:
        """The arm of a section without load, numbered in row-major order of the section's axes."""
        axes = {name: axis.array() for name, axis in self.given.items() if name in SECTION}
        places = np.unravel_index(number, [len(column) for column in axes.values()])
        values = {name: float(axes[name][place]) for name, place in zip(axes, places, strict=True)}
        return self._made(values)

    def _arms(self) -> Iterator[tuple[SlenderArm | None, int]]:
        """The arms of all sections without load, None where no rod covers one, each with its status."""
        for values in self._sections():
            try:
                yield self._made(values), SLENDER
            except _Uncovered as error:
                yield None, error.status

    def _made(self, values: Mapping[str, float], place: int | None = None) -> SlenderArm:
        """An arm with the load at a place of its axis, or without; ValueError where it cannot be."""
        section = {name: value for name, value in values.items() if name in SECTION}
        load = {"pressure": 0.0}
        if place is not None and self.load:
            load = {self.load: float(self.given[self.load].array()[place])}
        try:
            return SlenderArm(**{**section, **load})
        except (NotSlender, NoWall) as error:
            raise _Uncovered(error) from None
        except InputError as error:
            raise ValueError(f"parameters.arm.{error}") from None

    def _force_of(self, arm: SlenderArm) -> float:
        """F of a load of 1 in SI on an arm."""
        return 1.0 / (arm.pressure_scale if self.load == "pressure" else arm.force_scale)


def names_over(sizes: Mapping[str, int]) -> tuple[str, ...]:
    """The axes of a grid over an arm's quantities; none where the points are a grid of parameters.

    sizes: how many values each quantity and each parameter beside the arm has.
    """
    quantities = [name for name in (*SECTION, *LOADS) if sizes.get(name, 1) > 1]
    if all(name in AXIS_OF for name in quantities):
        return ()
    return (*quantities, *(name for name in NONLINEAR_PARAMETERS if sizes.get(name, 1) > 1))


def moved_by(axis: str) -> str:
    """The one parameter that an axis of an arm's grid moves; empty where it moves several or none."""
    return axis if axis in NONLINEAR_PARAMETERS else AXIS_OF.get(axis, "")


def _units_of(arm: SlenderArm | None) -> dict[str, float]:
    """The units that an arm makes; nan for none."""
    if arm is None:
        return dict.fromkeys(UNIT_NAMES, np.nan)
    return dict(zip(UNIT_NAMES, (arm.tau2, arm.force_scale, arm.pressure_scale), strict=True))


def _along(dimension: int, values: Any) -> Array:
    """Values, (n,), along one of three dimensions."""
    return np.asarray(values).reshape([-1 if i == dimension else 1 for i in range(3)])


def _scaled(axis: Axis, scale: float) -> Axis:
    """An axis with all values multiplied."""
    if axis.values is not None:
        return Axis(values=tuple(scale * value for value in axis.values))
    factor = scale * axis.factor  # kept apart, so that a longer range has the same values
    return axis.model_copy(update={"factor": factor})
