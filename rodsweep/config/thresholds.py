"""The keys of the task thresholds."""

from collections.abc import Mapping
from math import inf
from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from ..model.parameters import all_but
from .schema import Crossings, LinearConfig
from .values import Number, Strict


class ThresholdsOptions(Strict):
    """What the task thresholds computes for each rod."""

    F_max: Annotated[Number, Field(gt=0, lt=inf)] = 200.0
    """The search ends here, or just below k1 where that is less."""
    crossings: Crossings = 16
    """The most crossings that are stored."""
    certify: bool = True
    """Confirm by winding numbers between the changes, and certify every spectrum."""


class ThresholdsConfig(LinearConfig):
    """The forces at which the spectrum of every rod changes its kind."""

    task: Literal["thresholds"]
    thresholds: ThresholdsOptions = ThresholdsOptions()

    @classmethod
    def taken_of_a_rod(cls, options: Mapping[str, Any]) -> tuple[str, ...]:
        return all_but("F")

    @model_validator(mode="after")
    def _finds_the_force_itself(self) -> "ThresholdsConfig":
        self.refuse_found("F", f"finds F itself; remove it and set {self.task}.F_max")
        self.parameters.require(self.names)
        return self
