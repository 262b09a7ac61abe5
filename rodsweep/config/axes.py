"""The section `parameters` of a config: axes, an arm or a file of points, for the parameters of the model."""

import math
from typing import Annotated, Any, ClassVar

from pydantic import Field, create_model, model_validator

from ..model.parameters import LINEAR_PARAMETERS, NONLINEAR_PARAMETERS, PARAMETERS
from .arm.axes import MOST_POINTS, moved_by, names_over
from .arm.section import ArmSection
from .values import Axis, Number, Strict, Text, Values

BEYOND_LINEAR = tuple(name for name in NONLINEAR_PARAMETERS if name not in LINEAR_PARAMETERS)
DEFAULTS = {p.name: p.default for p in PARAMETERS.values() if p.default is not None}


def _section(base: type[Strict], names: tuple[str, ...], kind: Any) -> Any:
    """The section `base` with a key for each of the names, none of which need be given."""
    fields: dict[str, Any] = dict.fromkeys(names, (kind | None, None))
    return create_model("Section", __base__=base, **fields)


LinearAxes: Any = _section(Strict, LINEAR_PARAMETERS, Values)


class Axes(LinearAxes):
    """Axes, one for each parameter of a grid, or the name of a CSV file that lists points."""

    points: Annotated[Text | None, Field(min_length=1, description="the name of a CSV file")] = None
    """A list of points instead of axes; the header names the parameters."""
    arm: Annotated[ArmSection | None, Field(description="a mapping of an arm's quantities to values")] = None
    """An arm in SI units; a parameter that is given beside it replaces the arm's."""

    of_arm: ClassVar[tuple[str, ...]] = LINEAR_PARAMETERS
    """The parameters for which the arm gives values."""
    in_diagram: ClassVar[bool] = False
    """Whether the points are rows of a phase diagram, which need a grid of parameters."""

    @model_validator(mode="before")
    @classmethod
    def _with_defaults(cls, given: Any) -> Any:
        """A grid need not name what has a default; a file of points has a column for it, an arm its own."""
        if not isinstance(given, dict) or given.get("points") is not None or given.get("arm") is not None:
            return given
        return {name: DEFAULTS[name] for name in cls.of_arm if name in DEFAULTS} | given

    @property
    def axes(self) -> dict[str, Axis]:
        """The axes of a grid of parameters, by name, those of the arm among them; of others the given."""
        if self.arm is None or self.over:
            return self.given_axes
        axes = self.arm.grid_axes() | self.given_axes
        return {name: axes[name] for name in self.of_arm if name in axes}

    @property
    def given_axes(self) -> dict[str, Axis]:
        """The axes that are given by name."""
        return {name: value for name, value in self._given.items() if isinstance(value, Axis)}

    @property
    def is_list(self) -> bool:
        """Whether the points are a list from a file."""
        return self.points is not None

    @property
    def over(self) -> tuple[str, ...]:
        """The axes of a grid over an arm's own quantities; none where the points are of another kind."""
        if self.arm is None:
            return ()
        given = self.arm.given | self.given_axes
        return names_over({name: axis.size for name, axis in given.items()}, self.in_diagram)

    @property
    def alone(self) -> dict[str, int]:
        """How many values each parameter has along an axis that moves no other."""
        if self.arm is None or not self.over:
            return {name: axis.size for name, axis in self.axes.items()}
        given = self.arm.given | self.given_axes
        return {name: given[axis].size for axis in self.over if (name := moved_by(axis))}

    @property
    def numbers(self) -> dict[str, float]:
        """The parameters that have no axis but one number for the whole sweep, by name."""
        return {name: value for name, value in self._given.items() if isinstance(value, float)}

    @property
    def _given(self) -> dict[str, Any]:
        return {name: getattr(self, name, None) for name in NONLINEAR_PARAMETERS}

    def require(self, names: tuple[str, ...], or_points: bool = True) -> None:
        """ValueError unless all axes `names` are given or, where that is allowed, a file of points."""
        if self.points is not None and self.arm is not None:
            raise ValueError("parameters.points and parameters.arm are both given; give one of them")
        if self.points is not None and self.axes:
            both = f"parameters.points and parameters.{next(iter(self.axes))}"
            raise ValueError(f"{both} are both given; give the axes or the file, not both")
        if self.arm is not None:
            self._require_arm(self.arm, "F" in names)
            return
        missing = [name for name in names if name not in self.axes]
        if missing and self.points is None:
            hint = ", or points: FILE.csv" if or_points else ""
            raise ValueError(f"parameters.{missing[0]} is missing; give {words(names, 'and')}{hint}")

    def _require_arm(self, arm: ArmSection, forced: bool) -> None:
        """ValueError unless the arm, with what is given beside it, makes points."""
        arm.refuse_unfit()
        arm.refuse_misuse(forced, self.given_axes)
        beside = {name: axis for name, axis in self.given_axes.items() if axis.size > 1}
        count = arm.count(math.prod(axis.size for axis in beside.values()))
        if self.over and count > MOST_POINTS:
            raise ValueError(f"parameters.arm makes a grid of {count} points; it may have {MOST_POINTS}")
        if not self.over:
            arm.grid_axes()


AxesAndNumbers: Any = _section(Axes, BEYOND_LINEAR, Number)
AllAxes: Any = _section(Axes, BEYOND_LINEAR, Values)


class LinearParameters(AxesAndNumbers):
    """The parameters of the linear problem; one that only the nonlinear rod has is one number or none."""


class DiagramParameters(LinearParameters):
    """The parameters of a phase diagram."""

    in_diagram: ClassVar[bool] = True


class NonlinearParameters(AllAxes):
    """The parameters of the nonlinear rod."""

    of_arm: ClassVar[tuple[str, ...]] = NONLINEAR_PARAMETERS


def words(names: tuple[str, ...], last: str) -> str:
    """The names, one or more, as a list in a sentence."""
    return f"{', '.join(names[:-1])} {last} {names[-1]}" if names[1:] else names[0]
