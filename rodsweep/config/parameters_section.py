"""The section `parameters` of a config: one axis per parameter, an arm, or a file of points."""

import math
from collections.abc import Collection
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import Field, create_model, model_validator

from ..model.parameters import (
    NON_OPTIONAL_LINEAR_PARAMETER_NAMES,
    NONLINEAR_ROD_PARAMETER_NAMES,
    OPTIONAL_PARAMETER_NAMES,
    PARAMETERS,
    TRANSVERSE_PARAMETER_NAMES,
)
from ..wording import enumeration
from .arm.axes import LOAD_KEYS, MAX_ARM_GRID_POINTS, grid_axis_names, parameter_of_axis
from .arm.section import ArmConfig
from .axis import Axis, ParameterAxis
from .values import Number, StrictConfigSection, Text

if TYPE_CHECKING:
    from .arm.section import ArmConfig


def refuse_conflicting_keys(arm: "ArmConfig", needs_force: bool, given_parameters: Collection[str]) -> None:
    """Raises ValueError if the load does not suit the task, or if k2 is given in addition to an axis of
    Poisson's ratio.

    needs_force: whether the task needs a load. given_parameters: names of the parameters that replace the
    arm's values.
    """
    loads = ["parameters.F"] if "F" in given_parameters else []
    loads += [f"parameters.arm.{name}" for name in LOAD_KEYS if getattr(arm, name) is not None]
    if loads[1:]:
        raise ValueError(f"{loads[0]} and {loads[1]} are both given; give one of them")
    if "poisson" in arm.varying_quantities and "k2" in given_parameters:
        raise ValueError(
            "parameters.arm.poisson has several values but changes only k2, and parameters.k2 is given "
            "too; give one of them"
        )
    if arm.load_name and not needs_force:
        unit_clause = "load_kind: force gives the loads in newton, and " if arm.load_name == "force" else ""
        raise ValueError(
            f"parameters.arm.{arm.load_name} is given, but the task solves for the load; remove it; "
            f"{unit_clause}F_max sets the end of the search (for the task branch, branch.stop)"
        )
    if arm.load_name and arm.load_kind:
        raise ValueError(
            f"parameters.arm.load_kind is given, but parameters.arm.{arm.load_name} is given too; remove "
            "load_kind"
        )
    if needs_force and not (arm.load_name or "F" in given_parameters):
        if arm.load_kind:
            raise ValueError(
                f"parameters.arm.load_kind is given, but the task needs a load; give parameters.arm."
                f"{arm.load_kind} instead"
            )
        raise ValueError("parameters.arm.pressure is missing; give the pressure on the tip or a force")


NONLINEAR_ONLY_PARAMETERS = tuple(
    name for name in NONLINEAR_ROD_PARAMETER_NAMES if name not in NON_OPTIONAL_LINEAR_PARAMETER_NAMES
)
"""Names of the parameters on which limit cycles depend but the linear problem does not."""
REQUIRED_PARAMETERS = tuple(p.name for p in PARAMETERS.values() if p.default is None and p.name != "F")
"""Names of the parameters without a default, except F."""
DEFAULT_VALUES_OF_PARAMETERS = {
    p.name: p.default for p in PARAMETERS.values() if p.default is not None and not p.is_optional
}
"""Default value, by name, of each parameter with a default, without the optional parameters."""

DEFAULT_F_MAX = 200.0
"""Default of the largest force of a search for thresholds, in k3/L^2: option F_max."""


def _section_with_keys(base: type[StrictConfigSection], names: tuple[str, ...], kind: Any) -> Any:
    """Subclass of `base` with an additional optional key of the type `kind` for each name in `names`."""
    fields: dict[str, Any] = dict.fromkeys(names, (kind | None, None))
    return create_model("Section", __base__=base, **fields)


LinearAxesSection: Any = _section_with_keys(StrictConfigSection, TRANSVERSE_PARAMETER_NAMES, ParameterAxis)


class ParametersSection(LinearAxesSection):
    """The section `parameters`: axes of a grid of parameters, the name of a CSV file of points, or an arm."""

    points: Annotated[Text | None, Field(min_length=1, description="the name of a CSV file")] = None
    """CSV file with a list of points, instead of axes. Its header names the parameters."""
    columns: Annotated[
        list[Literal[OPTIONAL_PARAMETER_NAMES]] | None,  # type: ignore[valid-type]  # read at run time, from the table
        Field(description=f"a list with names of optional parameters: {', '.join(OPTIONAL_PARAMETER_NAMES)}"),
    ] = None
    """Optional parameters among the columns of `points`; by default the optional parameters in the header of
    the file."""
    arm: Annotated[ArmConfig | None, Field(description="a mapping of an arm's quantities to values")] = None
    """An arm in SI units. A parameter given in addition to the arm replaces the arm's value."""

    parameters_taken_from_arm: ClassVar[tuple[str, ...]] = TRANSVERSE_PARAMETER_NAMES
    """Names of the parameters that the task takes from an arm, or from axes given in addition to the arm."""
    in_diagram: ClassVar[bool] = False
    """Whether the points are the rows of a phase diagram, which needs a grid of parameters."""

    @model_validator(mode="before")
    @classmethod
    def _with_defaults(cls, given: Any) -> Any:
        """Returns the section with the defaults of missing parameters added, unless a file of points or an
        arm is given."""
        if not isinstance(given, dict) or given.get("points") is not None or given.get("arm") is not None:
            return given
        return {
            name: DEFAULT_VALUES_OF_PARAMETERS[name]
            for name in cls.parameters_taken_from_arm
            if name in DEFAULT_VALUES_OF_PARAMETERS
        } | given

    @model_validator(mode="after")
    def _require_points_for_columns(self) -> "ParametersSection":
        if self.columns is not None and self.points is None:
            raise ValueError("parameters.columns is given but parameters.points is not; remove it")
        return self

    @property
    def given_optional_parameters(self) -> tuple[str, ...]:
        """Names of the optional parameters that are given as an axis or as a column of the file of points."""
        names = (*self.given_axes, *(self.columns or ()))
        return tuple(name for name in OPTIONAL_PARAMETER_NAMES if name in names)

    @property
    def axes(self) -> dict[str, Axis]:
        """Axes of the swept parameters, by name: the given axes and, for a grid of parameters, axes computed
        from the arm's quantities."""
        if self.arm is None or self.arm_axes:
            return self.given_axes
        axes = self.arm.dimensionless_axes() | self.given_axes
        return {name: axes[name] for name in self.parameters_taken_from_arm if name in axes}

    @cached_property
    def given_axes(self) -> dict[str, Axis]:
        """Axes of the parameters that the config names directly, by name of the parameter."""
        return {name: value for name, value in self._given_values.items() if isinstance(value, Axis)}

    @property
    def is_list(self) -> bool:
        """Whether the points are listed in a file."""
        return self.points is not None

    @property
    def arm_axes(self) -> tuple[str, ...]:
        """Names of the axes of a grid over an arm's quantities; empty for a grid of parameters or a list."""
        if self.arm is None:
            return ()
        axes = self.arm.quantity_axes | self.given_axes
        return grid_axis_names({name: axis.size for name, axis in axes.items()}, self.in_diagram)

    @property
    def sizes_of_single_parameter_axes(self) -> dict[str, int]:
        """Number of values on each axis along which a single parameter changes, by name of the parameter. An
        axis of an arm that changes several parameters, such as its length, is left out."""
        if self.arm is None or not self.arm_axes:
            return {name: axis.size for name, axis in self.axes.items()}
        axes = self.arm.quantity_axes | self.given_axes
        return {name: axes[axis].size for axis in self.arm_axes if (name := parameter_of_axis(axis))}

    @property
    def constant_parameters(self) -> dict[str, float]:
        """Values of the parameters that are given as a number, not as an axis, by name."""
        return {name: value for name, value in self._given_values.items() if isinstance(value, float)}

    @property
    def _given_values(self) -> dict[str, Any]:
        return {name: getattr(self, name, None) for name in PARAMETERS}

    def require_one_definition_of_points(self, names: tuple[str, ...], or_points: bool = True) -> None:
        """Raises ValueError unless the section defines points in exactly one way: by axes of all `names`, by
        an arm, or by a file of points. Also raises ValueError for an invalid arm or a grid that is too large.

        or_points: whether the message suggests a file of points.
        """
        if self.points is not None and self.arm is not None:
            raise ValueError("parameters.points and parameters.arm are both given; give one of them")
        if self.points is not None and self.axes:
            keys_text = f"parameters.points and parameters.{next(iter(self.axes))}"
            raise ValueError(f"{keys_text} are both given; give the axes or the file, not both")
        if self.arm is not None:
            self._require_arm_that_defines_points(self.arm, "F" in names)
            return
        missing = [name for name in names if name not in self.axes]
        if missing and self.points is None:
            points_hint = ", or points: FILE.csv" if or_points else ""
            raise ValueError(
                f"parameters.{missing[0]} is missing; give {enumeration(names, 'and')}{points_hint}"
            )

    def _require_arm_that_defines_points(self, arm: ArmConfig, needs_force: bool) -> None:
        """Raises ValueError unless the arm and the further parameters of the section define points.
        needs_force: whether the task needs a load."""
        arm.require_allowed_values()
        refuse_conflicting_keys(arm, needs_force, self.given_axes)
        varied_axes = {name: axis for name, axis in self.given_axes.items() if axis.size > 1}
        point_count = math.prod(axis.size for axis in (*arm.quantity_axes.values(), *varied_axes.values()))
        if self.arm_axes and point_count > MAX_ARM_GRID_POINTS:
            raise ValueError(
                f"parameters.arm makes a grid of {point_count} points, more than the {MAX_ARM_GRID_POINTS} "
                "allowed; use fewer values"
            )
        if not self.arm_axes:
            arm.dimensionless_axes()


AxesAndNumbersSection: Any = _section_with_keys(ParametersSection, NONLINEAR_ONLY_PARAMETERS, Number)
AllAxesSection: Any = _section_with_keys(ParametersSection, NONLINEAR_ONLY_PARAMETERS, ParameterAxis)


class LinearParametersSection(AxesAndNumbersSection):
    """Section `parameters` of a task on the linear problem, whose parameters are axes.

    A parameter on which only limit cycles depend may be given as a single number.
    """


class DiagramParametersSection(LinearParametersSection):
    """Section `parameters` of the task phase_diagram."""

    in_diagram: ClassVar[bool] = True
    """True: the points are the rows of a phase diagram."""


class NonlinearParametersSection(AllAxesSection):
    """Section `parameters` of a task on the nonlinear rod, all of whose parameters may be axes."""

    parameters_taken_from_arm: ClassVar[tuple[str, ...]] = tuple(PARAMETERS)
    """All parameters, including those of the nonlinear rod only."""
