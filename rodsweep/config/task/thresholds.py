"""Config of the task thresholds: thresholds of the straight rod along F."""

from collections.abc import Mapping
from math import inf
from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from ...model.parameters import parameter_names_except
from ..base_config import CrossingCount, LinearConfig
from ..parameters_section import DEFAULT_F_MAX
from ..values import Number, StrictConfigSection


class ThresholdsOptions(StrictConfigSection):
    """Options of the task thresholds: range of the search for crossings, and number of stored crossings."""

    F_max: Annotated[Number, Field(gt=0, lt=inf)] = DEFAULT_F_MAX
    """Largest force of the search. If the arm is crushed at a smaller force (k1 for a uniform rod of linear
    material), the search ends just below the crushing force."""
    crossings: CrossingCount = 16
    """Maximum number of stored thresholds, that is, crossings."""
    certify: bool = True
    """Confirm by winding numbers that no threshold is missing, and certify every spectrum."""


class ThresholdsConfig(LinearConfig):
    """The task thresholds finds the forces at which the number of unstable eigenvalues of a rod, or the kind
    of its leading eigenvalue, changes."""

    task: Literal["thresholds"]
    thresholds: ThresholdsOptions = ThresholdsOptions()

    @classmethod
    def rod_parameters_used(cls, options: Mapping[str, Any]) -> tuple[str, ...]:
        return parameter_names_except("F")

    @model_validator(mode="after")
    def _refuse_force(self) -> "ThresholdsConfig":
        self.refuse_solved_parameter("F", f"finds F itself; remove it and set {self.task}.F_max")
        self.parameters.require_one_definition_of_points(self.parameter_names)
        return self
