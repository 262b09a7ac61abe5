"""Config of the task criticality: Hopf points of the straight rod, and the cycles that bifurcate there."""

from collections.abc import Mapping
from math import inf
from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from ...model.parameters import NONLINEAR_ROD_PARAMETER_NAMES, parameter_names_except
from ..base_config import Config, CrossingCount
from ..parameters_section import DEFAULT_F_MAX, NonlinearParametersSection
from ..values import Number, StrictConfigSection


class CriticalityOptions(StrictConfigSection):
    """Options of the task criticality: range of the search for Hopf points, and number of stored points."""

    F_max: Annotated[Number, Field(gt=0, lt=inf)] = DEFAULT_F_MAX
    """Largest force of the search for Hopf points. If a smaller force crushes the rod, the search ends just
    below that crushing force."""
    crossings: CrossingCount = 16
    """Maximum number of stored Hopf points."""
    certify: bool = True
    """Confirm by winding numbers between the Hopf points that no Hopf point is missing."""


class CriticalityConfig(Config):
    """The task criticality computes the normal form of every Hopf point of a rod: criticality, and
    how amplitude and frequency of the cycles grow.
    """

    task: Literal["criticality"]
    parameters: NonlinearParametersSection
    """Axes of the parameters, a file of points, or an arm."""
    accuracy: Annotated[Number, Field(ge=1e-13, le=1e-2)] = 1e-10
    """Relative error of each Hopf point, of the eigenvalue's slope and of the Landau coefficient. The errors
    of the amplitude coefficient and of the frequency slope follow from these errors; the file has all error
    estimates."""
    criticality: CriticalityOptions = CriticalityOptions()

    @classmethod
    def rod_parameters_used(cls, options: Mapping[str, Any]) -> tuple[str, ...]:
        return parameter_names_except("F", NONLINEAR_ROD_PARAMETER_NAMES)

    @model_validator(mode="after")
    def _refuse_force(self) -> "CriticalityConfig":
        self.refuse_solved_parameter("F", f"finds F itself; remove it and set {self.task}.F_max")
        self.parameters.require_one_definition_of_points(self.parameter_names)
        return self
