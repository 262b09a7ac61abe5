"""Config of the task limit_cycle: the nonlinear rod, including its axial drag gamma1."""

from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from ...model.parameters import NONLINEAR_ROD_PARAMETER_NAMES, OPTIONAL_PARAMETER_NAMES
from ...wording import enumeration
from ..arm.axes import SINGLE_PARAMETER_OF
from ..base_config import Config, NodeCount
from ..parameters_section import NonlinearParametersSection
from ..values import Number, StrictConfigSection

LONGEST_AXIS_KEYWORD = "longest"
# Pydantic reads the names at run time, from the table.
ChainParameter = Literal[  # type: ignore[valid-type]
    (*NONLINEAR_ROD_PARAMETER_NAMES, *OPTIONAL_PARAMETER_NAMES, *SINGLE_PARAMETER_OF, LONGEST_AXIS_KEYWORD)
]

MIN_MOST_PERIODS_BY_METHOD = {"collocation": 3, "integration": 16}
"""Smallest allowed `most_periods` by method. Collocation: a shorter motion is not classified. Integration:
two motions are compared for the errors; the first is integrated over at least ten returns and the second over
at least six, so that its returns can be compared (`tests/solve/cycle/test_fewest_returns.py`)."""


class LimitCycleOptions(StrictConfigSection):
    """Options of the task limit_cycle: initial guess, limits of the computation, stored data of a cycle."""

    method: Literal["collocation", "integration"] = "collocation"
    """Method: collocation in time, with Floquet multipliers, or time integration only, without Floquet
    multipliers."""
    amplitude: Annotated[Number, Field(gt=0, le=1, description="a number above 0, at most 1")] = 0.01
    """Tip deflection of the initial guess, which is the leading mode, in L; smaller if another part of the
    rod would deflect more than twice as far."""
    start: Literal["mode", "neighbour", "hopf"] = "mode"
    """Initial guess at each point: the leading mode, the cycle of a neighbouring point, or the cycle near the
    Hopf point."""
    along: ChainParameter = LONGEST_AXIS_KEYWORD
    """Parameter along which the cycle of a point is the initial guess at the next point, or the quantity of
    the arm that changes only this parameter; `longest`: the parameter with the most values."""
    direction: Literal["up", "down"] = "up"
    """Whether the parameter `along` increases or decreases from a point to the next."""
    harmonics: Annotated[int, Field(ge=1, le=100)] = 8
    """Number of stored harmonics of the tip's y."""
    samples: Annotated[int, Field(ge=0, le=100_000)] = 0
    """Number of times per period at which the tip and the energy are stored; 0 stores no samples."""
    shapes: Annotated[int, Field(ge=0, le=10_000)] = 0
    """Number of times per period at which the shape of the rod is stored; 0 stores no shapes."""
    nodes: NodeCount = 33
    """Number of Lobatto nodes of each shape."""
    transient: Annotated[int, Field(ge=0, le=100_000)] = 0
    """Number of times, from the start of the motion until the cycle is reached, at which the tip is stored; 0
    stores no transient."""
    most_periods: Annotated[int, Field(ge=MIN_MOST_PERIODS_BY_METHOD["collocation"], le=1_000_000)] = 400
    """Maximum number of periods of the motion, counted as returns of the tip to theta = 0; at least 16 with
    method: integration, which integrates two motions. The maximum number of time steps is 200 times this
    number, and at least 20000. A motion that has not settled by then is `not_settled`."""
    time: Literal["tau2", "tau1"] = "tau2"
    """Unit of time. tau1 adds the period in units of tau1; all other variables stay in units of tau2."""


class LimitCycleConfig(Config):
    """The task limit_cycle computes the limit cycle of the nonlinear rod, if there is one, at every point."""

    task: Literal["limit_cycle"]
    parameters: NonlinearParametersSection
    """Axes of the parameters, a file of points, or an arm."""
    accuracy: Annotated[Number, Field(ge=1e-11, le=1e-2)] = 1e-7
    """Relative error of the period and of the tip's largest y. Other extrema of the tip may have errors a
    hundred times larger, relative to the largest y. The file has error estimates of all these numbers."""
    limit_cycle: LimitCycleOptions = LimitCycleOptions()

    @property
    def chain_parameter(self) -> str:
        """Parameter along which the cycle of a point is the initial guess for the next point.

        By default the parameter with the most values; the first parameter if several have equally many
        values.
        """
        value_counts = self.parameters.sizes_of_single_parameter_axes
        parameter = self.limit_cycle.along
        if parameter == LONGEST_AXIS_KEYWORD:
            return max(value_counts, key=lambda name: value_counts[name], default=parameter)
        return SINGLE_PARAMETER_OF.get(parameter, parameter)

    @property
    def remedies_of_options_without_effect(self) -> dict[str, str]:
        options = self.limit_cycle
        required_settings: dict[str, str] = {}
        if options.start != "neighbour":
            required_settings |= dict.fromkeys(("along", "direction"), "start: neighbour")
        if options.method == "integration":
            required_settings |= dict.fromkeys(
                ("start", "along", "direction", "transient"), "method: collocation"
            )
        elif options.start == "hopf":
            required_settings |= dict.fromkeys(("amplitude", "most_periods", "transient"), "start: mode")
        if not options.shapes:
            required_settings["nodes"] = "shapes"
        return required_settings

    @property
    def settings_of_results(self) -> dict[str, Any]:
        settings = super().settings_of_results
        options = settings[self.task]
        return settings | {
            self.task: options | ({"along": self.chain_parameter} if "along" in options else {})
        }

    @model_validator(mode="after")
    def _refuse_unused_keys(self) -> "LimitCycleConfig":
        self.parameters.require_one_definition_of_points(self.parameter_names)
        self.refuse_options_without_effect()
        self._require_enough_periods()
        arm = self.parameters.arm
        parameter = self.limit_cycle.along
        if parameter in SINGLE_PARAMETER_OF and (
            arm is None or parameter not in {arm.load_name, *arm.quantity_axes}
        ):
            raise ValueError(
                f"limit_cycle.along is {parameter} but parameters.arm.{parameter} is not given; give it, or "
                f"set along to {enumeration(NONLINEAR_ROD_PARAMETER_NAMES, 'or')}"
            )
        if self.limit_cycle.start == "neighbour" and self.parameters.is_list:
            raise ValueError(
                "limit_cycle.start: neighbour needs a grid, in which a point has neighbours; use start: "
                "mode, or give axes instead of parameters.points"
            )
        if self.limit_cycle.start == "neighbour":
            self._require_chain_parameter()
        return self

    def _require_enough_periods(self) -> None:
        """Raises ValueError if no motion can settle within `most_periods`."""
        options = self.limit_cycle
        least = MIN_MOST_PERIODS_BY_METHOD[options.method]
        if options.most_periods < least:
            raise ValueError(
                f"limit_cycle.most_periods = {options.most_periods} is not allowed with method: "
                f"{options.method}, which needs {least} returns of the tip for a cycle and its errors; "
                f"it should be a whole number from {least} to 1e+06"
            )

    def _require_chain_parameter(self) -> None:
        """Raises ValueError unless an axis changes only the parameter `chain_parameter`, along which the
        cycle of one point is the initial guess for the next."""
        names = self.parameters.sizes_of_single_parameter_axes
        parameter = self.chain_parameter
        if parameter in names:
            return
        if axes := self.parameters.arm_axes:
            raise ValueError(
                f"limit_cycle.start: neighbour needs an axis of a single parameter; those of parameters.arm, "
                f"{' and '.join(axes)}, change several at once. Give several values of "
                f"{enumeration((*SINGLE_PARAMETER_OF, *NONLINEAR_ROD_PARAMETER_NAMES), 'or')}, or start: mode"
            )
        raise ValueError(
            f"limit_cycle.along is {parameter} but parameters.{parameter} is not given; give several values "
            f"of it, or set along to {enumeration(tuple(names), 'or')}"
        )
