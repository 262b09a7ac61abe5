"""The keys of the task criticality: Hopf points of the straight rod, and the cycles that are born there."""

from collections.abc import Mapping
from math import inf
from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from ..model.parameters import NONLINEAR_PARAMETERS, all_but
from .axes import NonlinearParameters
from .schema import Config, Crossings
from .values import Number, Strict


class CriticalityOptions(Strict):
    """What the task criticality computes for each rod."""

    F_max: Annotated[Number, Field(gt=0, lt=inf)] = 200.0
    """The search for Hopf points ends here, or just below k1 where that is less."""
    crossings: Crossings = 16
    """The most Hopf points that are stored."""
    certify: bool = True
    """Confirm by winding numbers between the Hopf points that none is missing."""


class CriticalityConfig(Config):
    """On which side of every Hopf point of a rod the cycles are that are born there, and how they grow."""

    task: Literal["criticality"]
    parameters: NonlinearParameters
    accuracy: Annotated[Number, Field(ge=1e-13, le=1e-2)] = 1e-10
    """Relative error of each Hopf point, of the slope of its eigenvalue and of its Landau coefficient. The
    amplitude coefficient and the frequency slope follow from them; the file holds estimates of all."""
    criticality: CriticalityOptions = CriticalityOptions()

    @classmethod
    def taken_of_a_rod(cls, options: Mapping[str, Any]) -> tuple[str, ...]:
        return all_but("F", NONLINEAR_PARAMETERS)

    @model_validator(mode="after")
    def _finds_the_force_itself(self) -> "CriticalityConfig":
        self.refuse_found("F", f"finds F itself; remove it and set {self.task}.F_max")
        self.parameters.require(self.names)
        return self
