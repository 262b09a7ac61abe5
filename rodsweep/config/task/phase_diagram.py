"""Config of the task phase_diagram: states of the rod over two parameters, and the boundaries between
them."""

from collections.abc import Sequence
from math import inf, isfinite
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field, model_validator

from ...model.arm.quantities import LOAD_NAME_BY_RELATIVE_LOAD
from ...model.parameters import NON_OPTIONAL_LINEAR_PARAMETER_NAMES, PARAMETERS, TRANSVERSE_PARAMETER_NAMES
from ...wording import enumeration
from ..arm.axes import FLUID_QUANTITIES, SINGLE_PARAMETER_OF
from ..axis import Axis
from ..base_config import CrossingCount, LinearConfig
from ..parameters_section import DEFAULT_VALUES_OF_PARAMETERS, DiagramParametersSection, LinearAxesSection
from ..values import Number, StrictConfigSection


class BautinAlong(LinearAxesSection):
    """The option bautin_along: a third parameter and its values, along which generalised Hopf points are
    followed."""


class PhaseDiagramOptions(StrictConfigSection):
    """Options of the task phase_diagram, for the rows of the diagram and for the boundary curves."""

    crossings: CrossingCount = 16
    """Maximum number of thresholds of the straight rod stored for each row of the diagram."""
    certify: bool = True
    """Confirm by winding numbers that no threshold is missing, and certify every spectrum."""
    curves: bool = True
    """Follow the boundaries between the states from row to row, as curves."""
    criticality: bool = False
    """Compute the criticality along Hopf curves, and the points where the criticality changes; needs
    `curves`."""
    cycles: bool = False
    """Follow the cycles of each row, for the stable states and, with `curves`, for the curves of folds of
    cycles."""
    cycle_accuracy: Annotated[Number, Field(ge=1e-11, le=1e-2)] = 1e-6
    """Relative error of the period and of the largest y of each cycle; needs `cycles`. Special points are
    located to the smaller of `cycle_accuracy` and 1e-9. The smaller this number, the fewer states stay
    undecided."""
    bautin_along: Annotated[BautinAlong | None, Field(description="a mapping of one parameter to values")] = (
        None
    )
    """A third parameter and its values, along which curves of generalised Hopf points are followed; needs
    `criticality`."""

    @property
    def bautin_name_and_axis(self) -> tuple[str, Axis] | None:
        """Returns (name, values) of the third parameter, in `bautin_along`; None if `bautin_along` is not
        given."""
        axes = [(name, getattr(self.bautin_along, name, None)) for name in TRANSVERSE_PARAMETER_NAMES]
        return next(((name, axis) for name, axis in axes if axis is not None), None)

    @model_validator(mode="after")
    def _require_valid_bautin_along(self) -> "PhaseDiagramOptions":
        if self.bautin_along is None:
            return self
        names = [name for name in TRANSVERSE_PARAMETER_NAMES if getattr(self.bautin_along, name) is not None]
        if len(names) != 1:
            raise ValueError(f"bautin_along has {len(names)} parameters; give one, with at least two values")
        name = names[0]
        axis = getattr(self.bautin_along, names[0])
        if axis.size < 2:
            raise ValueError(f"bautin_along.{name} has a single value; give at least two")
        _require_finite_values(name, axis.array().tolist())
        if not self.criticality:
            raise ValueError("bautin_along is given but criticality is false; set criticality: true")
        return self


class PhaseDiagramConfig(LinearConfig):
    """The task phase_diagram finds the states of the rod over two parameters, row by row; the first parameter
    varies along a row."""

    task: Literal["phase_diagram"]
    parameters: DiagramParametersSection
    phase_diagram: PhaseDiagramOptions = PhaseDiagramOptions()

    allows_crushed_rods: ClassVar[bool] = True
    """True: a crushed rod is a state of the diagram."""
    needs_several_rods: ClassVar[bool] = True
    """True: a diagram needs a grid of rods."""
    nonlinear_parameters_used: ClassVar[tuple[str, ...]] = ("gamma1",)
    """Parameters of the nonlinear rod that some options of the task use: gamma1, on which the criticality and
    the cycles depend."""

    @property
    def plane_parameters(self) -> tuple[str, ...]:
        """(line parameter, row parameter): the two parameters with several values. The line parameter varies
        along each row of the diagram, the row parameter differs between rows.

        The names are in the order of NON_OPTIONAL_LINEAR_PARAMETER_NAMES and OPTIONAL_PARAMETER_NAMES.
        """
        return tuple(name for name, axis in self.parameters.axes.items() if axis.size > 1)

    @property
    def parameter_names(self) -> tuple[str, ...]:
        return tuple(name for name in super().parameter_names if name != self.plane_parameters[0])

    @property
    def gamma1(self) -> float:
        """Axial drag for criticality and cycles: the given value, else the value of the arm, else the
        default."""
        if "gamma1" in self.parameters.constant_parameters:
            return self.parameters.constant_parameters["gamma1"]
        if self.parameters.arm is not None:
            return float(self.parameters.arm.dimensionless_axes()["gamma1"].array()[0])
        return DEFAULT_VALUES_OF_PARAMETERS["gamma1"]

    @property
    def remedies_of_options_without_effect(self) -> dict[str, str]:
        return {} if self.phase_diagram.cycles else {"cycle_accuracy": "cycles: true"}

    @property
    def settings_of_results(self) -> dict[str, Any]:
        """All settings on which the results depend, as in `Config.settings_of_results`, with the parameter
        values along a row and, for boundary curves, the names of the logarithmic axes."""
        settings = super().settings_of_results
        axes = self.parameters.axes
        line_parameter = self.plane_parameters[0]
        requested: dict[str, Any] = {line_parameter: {"values": axes[line_parameter].array().tolist()}}
        settings |= {"parameters": settings["parameters"] | requested}
        # Criticality changes only the curves, not the rows. Rows depend on gamma1 through their cycles only.
        criticality_requested = settings["phase_diagram"].pop("criticality")
        settings["phase_diagram"].pop("bautin_along", None)
        settings["parameters"].pop("gamma1", None)
        if self.phase_diagram.cycles:
            settings["phase_diagram"]["gamma1"] = self.gamma1
        if self.phase_diagram.curves:
            settings |= {
                "together": {
                    "logarithmic": [name for name in self.plane_parameters if axes[name].is_logarithmic]
                }
            }
        if criticality_requested:
            settings["together"]["criticality"] = {"gamma1": self.gamma1}
        if self.phase_diagram.bautin_name_and_axis is not None:
            name, axis = self.phase_diagram.bautin_name_and_axis
            settings["together"]["bautin_along"] = {name: axis.array().tolist(), "log": axis.is_logarithmic}
        return settings

    @model_validator(mode="after")
    def _refuse_unused_curve_keys(self) -> "PhaseDiagramConfig":
        self.refuse_options_without_effect()
        options = self.phase_diagram
        if options.criticality and not options.curves:
            raise ValueError(
                "phase_diagram.criticality is true but phase_diagram.curves is false; criticality is "
                "computed along the curves: set phase_diagram.curves: true or remove "
                "phase_diagram.criticality"
            )
        if "gamma1" in self.parameters.constant_parameters and not (options.criticality or options.cycles):
            raise ValueError(
                "parameters.gamma1 is given but the task phase_diagram does not use it without "
                "phase_diagram.criticality: true or phase_diagram.cycles: true; remove it or set one of these"
            )
        return self

    @model_validator(mode="after")
    def _require_two_axes(self) -> "PhaseDiagramConfig":
        allowed = enumeration(NON_OPTIONAL_LINEAR_PARAMETER_NAMES, "and")
        if self.parameters.points is not None:
            raise ValueError(
                "parameters.points is given but the task phase_diagram needs axes; remove it and give "
                f"{allowed}"
            )
        self.parameters.require_one_definition_of_points(NON_OPTIONAL_LINEAR_PARAMETER_NAMES, or_points=False)
        if self.parameters.arm_axes:
            allowed_names = (*SINGLE_PARAMETER_OF, "drag")
            varied = next(name for name in self.parameters.arm_axes if name not in allowed_names)
            changed = "no parameter" if varied in FLUID_QUANTITIES else "several parameters at once"
            reason = f"has several values, which change {changed}"
            if varied in LOAD_NAME_BY_RELATIVE_LOAD:
                reason = "is relative to flutter"
            raise ValueError(
                f"parameters.arm.{LOAD_NAME_BY_RELATIVE_LOAD.get(varied, varied)} {reason}; the axes of a "
                f"phase diagram are {enumeration(allowed_names, 'or')}, or parameters given in addition to "
                "the arm"
            )
        varied_names = self.plane_parameters
        if len(varied_names) != 2:
            raise ValueError(_axis_count_refusal(varied_names))
        line_axis = self.parameters.axes[varied_names[0]]
        if inf in (line_axis.values or ()):
            names = NON_OPTIONAL_LINEAR_PARAMETER_NAMES
            stiffnesses = tuple(name for name in names if PARAMETERS[name].rigid_adjective)
            raise ValueError(
                f"parameters.{varied_names[0]} contains inf, which is not allowed on the axis along which a "
                f"phase diagram is searched; remove it (on the other axis, {varied_names[1]}, "
                f"{enumeration(stiffnesses, 'and')} may be inf)"
            )
        return self

    @model_validator(mode="after")
    def _require_single_third_value(self) -> "PhaseDiagramConfig":
        if self.phase_diagram.bautin_name_and_axis is None:
            return self
        name, axis = self.phase_diagram.bautin_name_and_axis
        first_value, last_value = axis.array()[[0, -1]]
        given_axis = self.parameters.axes.get(name)
        given_values = np.array([PARAMETERS[name].default]) if given_axis is None else given_axis.array()
        if name in self.plane_parameters or not first_value <= given_values[0] <= last_value:
            given_text = (
                f"has {len(given_values)} values" if len(given_values) > 1 else f"is {given_values[0]:g}"
            )
            raise ValueError(
                f"parameters.{name} {given_text}; it must have a single value in the range of "
                f"phase_diagram.bautin_along.{name}, from {first_value:g} to {last_value:g}"
            )
        return self


def _require_finite_values(name: str, values: Sequence[float]) -> None:
    """Raises ValueError for the first of the `values` of the parameter `name` in bautin_along that is
    infinite or outside the range of the parameter."""
    allowed = PARAMETERS[name].allowed_range
    invalid_value = next(
        (value for value in values if not allowed.contains(value) or not isfinite(value)), None
    )
    if invalid_value is not None:
        raise ValueError(
            f"bautin_along.{name} = {invalid_value:g} is not allowed; it must be "
            f"{allowed.finite_description_for_rejected(invalid_value)}"
        )


def _axis_count_refusal(varied_names: Sequence[str]) -> str:
    """Message for a config in which not exactly two parameters have several values. varied_names: names of
    the parameters with several values."""
    axis_count_text = f"{len(varied_names)} {'axis' if len(varied_names) == 1 else 'axes'}"
    names_text = f" ({', '.join(varied_names)})" if varied_names else ""
    return (
        f"parameters has {axis_count_text} with more than one value{names_text}; a phase diagram needs "
        f"exactly two of {enumeration(TRANSVERSE_PARAMETER_NAMES, 'and')}"
    )
