"""The section `parameters` of a config: axes or a file of points, for the parameters that the model has."""

from typing import Annotated, Any

from pydantic import Field, create_model, model_validator

from ..model.parameters import LINEAR_PARAMETERS, NONLINEAR_PARAMETERS, PARAMETERS
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

    points: Annotated[Text | None, Field(description="the name of a CSV file")] = None
    """A list of points instead of axes; the header names the parameters."""

    @property
    def axes(self) -> dict[str, Axis]:
        """The axes that are given, by name."""
        return {name: value for name, value in self._given.items() if isinstance(value, Axis)}

    @property
    def numbers(self) -> dict[str, float]:
        """The parameters that have no axis but one number for the whole sweep, by name."""
        return {name: value for name, value in self._given.items() if isinstance(value, float)}

    @property
    def _given(self) -> dict[str, Any]:
        return {name: getattr(self, name, None) for name in NONLINEAR_PARAMETERS}

    def require(self, names: tuple[str, ...], or_points: bool = True) -> None:
        """ValueError unless all axes `names` are given or, where that is allowed, a file of points."""
        if self.points is not None and self.axes:
            both = f"parameters.points and parameters.{next(iter(self.axes))}"
            raise ValueError(f"{both} are both given; give the axes or the file, not both")
        missing = [name for name in names if name not in self.axes]
        if missing and self.points is None:
            hint = ", or points: FILE.csv" if or_points else ""
            raise ValueError(f"parameters.{missing[0]} is missing; give {words(names, 'and')}{hint}")


AxesAndNumbers: Any = _section(Axes, BEYOND_LINEAR, Number)
AllAxes: Any = _section(Axes, BEYOND_LINEAR, Values)


class LinearParameters(AxesAndNumbers):
    """The parameters of the linear problem; one that only the nonlinear rod has is one number or none."""


class NonlinearParameters(AllAxes):
    """The parameters of the nonlinear rod."""

    @model_validator(mode="before")
    @classmethod
    def _with_defaults(cls, given: Any) -> Any:
        """A grid need not name what has a default; a file of points has a column for it."""
        if not isinstance(given, dict) or given.get("points") is not None:
            return given
        return DEFAULTS | given


def words(names: tuple[str, ...], last: str) -> str:
    """The names as a list in a sentence."""
    return f"{', '.join(names[:-1])} {last} {names[-1]}"
