"""The keys of the task limit_cycle: the nonlinear rod, whose axial drag is a parameter like the others."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from ..model.parameters import NONLINEAR_PARAMETERS
from .axes import NonlinearParameters
from .schema import Config, Nodes
from .values import Number, Strict

Along = Literal[NONLINEAR_PARAMETERS]  # type: ignore[valid-type]  # pydantic reads it at run time, from the table


class LimitCycleOptions(Strict):
    """From where each point starts, how long it may take, and what is stored of its cycle."""

    amplitude: Annotated[Number, Field(gt=0, le=1, description="a number above 0, at most 1")] = 0.01
    """Tip deflection of the leading mode from which a point starts, in L."""
    continue_from: Literal["none", "previous"] = "none"
    """Whether each point starts from the cycle of its neighbour."""
    along: Along = "F"
    """The parameter along which neighbours follow each other."""
    direction: Literal["up", "down"] = "up"
    """Whether that parameter grows or falls from a point to the next."""
    harmonics: Annotated[int, Field(ge=1, le=100)] = 8
    """Harmonics of the tip's y that are stored."""
    samples: Annotated[int, Field(ge=0, le=100_000)] = 0
    """Times over a period at which the tip and the energy are stored; 0 stores none."""
    shapes: Annotated[int, Field(ge=0, le=10_000)] = 0
    """Times over a period at which the shape of the rod is stored; 0 stores none."""
    nodes: Nodes = 33
    """Lobatto nodes on which shapes are given."""
    most_periods: Annotated[int, Field(ge=1, le=1_000_000)] = 400
    """Periods after which a point that is not settled is given up."""
    time: Literal["tau2", "tau1"] = "tau2"
    """tau1 adds the period in units of tau1; all else stays in tau2."""


class LimitCycleConfig(Config):
    """The limit cycle of the nonlinear rod at every point, or that there is none."""

    task: Literal["limit_cycle"]
    parameters: NonlinearParameters
    accuracy: Annotated[Number, Field(ge=1e-10, le=1e-2)] = 1e-7
    """Relative error of the period and of the tip's extrema."""
    limit_cycle: LimitCycleOptions = LimitCycleOptions()

    @property
    def names(self) -> tuple[str, ...]:
        return NONLINEAR_PARAMETERS

    @model_validator(mode="after")
    def _only_what_is_used(self) -> "LimitCycleConfig":
        self.parameters.require(self.names)
        if self.limit_cycle.continue_from == "none":
            self.refuse_unused("along", remedy="continue_from: previous")
            self.refuse_unused("direction", remedy="continue_from: previous")
        elif self.parameters.points is not None:
            raise ValueError(
                "limit_cycle.continue_from: previous needs a grid, in which a point has neighbours; remove "
                "it, or give axes instead of parameters.points"
            )
        if not self.limit_cycle.shapes:
            self.refuse_unused("nodes", remedy="shapes")
        return self
