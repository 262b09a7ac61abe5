"""The keys that the config of every task has, and those of the options that several tasks have.

Ranges that are physics (F < k1, positive stiffness) are not checked here but where points are made; here is
form only.
"""

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar

from pydantic import Field, model_validator

from ..model.parameters import LINEAR_PARAMETERS, NONLINEAR_PARAMETERS
from .axes import Axes, LinearParameters
from .values import Number, Strict, Text

Modes = Annotated[int, Field(ge=1, le=100)]
Nodes = Annotated[int, Field(ge=3, le=513)]
Crossings = Annotated[int, Field(ge=1, le=1000)]


class Config(Strict):
    """What the config of every task has."""

    title: Annotated[Text, Field(max_length=200)] = ""
    """The name of the run, as `check` and `show` print it."""
    task: str
    parameters: Axes
    accuracy: Annotated[Number, Field(ge=1e-13, le=1e-2)] = 1e-10
    """Relative error of each eigenvalue, threshold and mode."""

    into_crushed: ClassVar[bool] = False
    """Whether a grid may reach into the crushed rods, because they are one of the task's answers."""

    others_may_be_needed: ClassVar[bool] = False
    """Whether its options decide which parameters it needs."""
    of_several_rods: ClassVar[bool] = False
    """Whether a single rod makes nothing of the task."""

    @property
    def names(self) -> tuple[str, ...]:
        """The parameters that make a point of the sweep."""
        return self.taken_of_a_rod({})

    @classmethod
    def taken_of_a_rod(cls, options: Mapping[str, Any]) -> tuple[str, ...]:
        """The parameters that the task, with these options, takes of a rod that has all of them."""
        return NONLINEAR_PARAMETERS

    @property
    def unused(self) -> dict[str, str]:
        """The options that nothing uses in this config, each with the setting that would."""
        return {}

    def refuse_unused(self) -> None:
        """ValueError where an option is given that nothing uses."""
        for option, remedy in self.unused.items():
            if option in getattr(self, self.task).model_fields_set:
                raise ValueError(
                    f"{self.task}.{option} is given but not used; set {self.task}.{remedy} or remove it"
                )

    @property
    def meaning(self) -> dict[str, Any]:
        """What is asked of every point, JSON-compatible: all that changes a number, but for the points.

        `together`, where it is there, changes only what all points together give.
        Two configs with equal meanings and equal points ask for the same, however they are written.
        """
        options = getattr(self, self.task).model_dump(mode="json", exclude=set(self.unused))
        numbers = dict(self.parameters.numbers)
        meant = {"task": self.task, "parameters": numbers, "accuracy": self.accuracy, self.task: options}
        if self.parameters.arm is None:
            return meant
        if self.parameters.over:  # whose axes do not tell what has one value
            given = self.parameters.given_axes
            beside = {name: float(given[name].array()[0]) if name in given else None for name in self.names}
            meant["parameters"] |= {k: v for k, v in beside.items() if k not in self.parameters.over}
        return meant | {"arm": self.parameters.arm.meaning}

    def refuse_found(self, name: str, why: str) -> None:
        """ValueError, which says why, where a parameter is given that the task itself finds."""
        if name in self.parameters.given_axes:
            raise ValueError(f"parameters.{name} is given but the task {self.task} {why}")


class LinearConfig(Config):
    """What the configs of the linear problem share."""

    parameters: LinearParameters

    beyond: ClassVar[tuple[str, ...]] = ()
    """Parameters that only the nonlinear rod has and yet the task can use."""

    @classmethod
    def taken_of_a_rod(cls, options: Mapping[str, Any]) -> tuple[str, ...]:
        return LINEAR_PARAMETERS

    @model_validator(mode="after")
    def _only_parameters_that_are_used(self) -> "LinearConfig":
        for name in self.parameters.numbers:
            if name not in self.beyond:
                raise ValueError(
                    f"parameters.{name} is given but the task {self.task} does not use it; remove it"
                )
        return self
