"""The keys of the task branch: cycles followed in one parameter from the Hopf points where they are born."""

from collections.abc import Mapping
from math import inf, isfinite
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, model_validator

from ..model.parameters import LINEAR_PARAMETERS, NONLINEAR_PARAMETERS, PARAMETERS, all_but
from .axes import DEFAULTS, NonlinearParameters
from .schema import Config
from .values import Number, Strict

FOLLOWED = LINEAR_PARAMETERS
"""Parameters along which branches are followed: Hopf points do not feel gamma1."""


class BranchOptions(Strict):
    """Along which parameter the cycles of each rod are followed, how far, and what is kept."""

    along: Literal[FOLLOWED] = "F"  # type: ignore[valid-type]  # pydantic reads it at run time
    """The parameter that is followed; the others are axes."""
    start: Annotated[Number, Field(gt=-inf, lt=inf)] = 0.0
    """Least value of that parameter; a branch that reaches it ends there."""
    stop: Annotated[Number, Field(gt=-inf, lt=inf)] = 200.0
    """Largest value; F ends just below k1 where that is less."""
    cycles: Annotated[int, Field(ge=1, le=100_000)] = 500
    """The most cycles that are stored for a rod, of all its branches."""
    special: Annotated[int, Field(ge=1, le=10_000)] = 64
    """The most special points that are stored for a rod."""
    certify: bool = True
    """Confirm by winding numbers between the Hopf points that none is missing."""

    @model_validator(mode="after")
    def _range_of_the_parameter(self) -> "BranchOptions":
        allowed = PARAMETERS[self.along].allowed
        for key, value in (("start", self.start), ("stop", self.stop)):
            if not allowed.contains(value) or not isfinite(value):
                raise ValueError(
                    f"{key} = {value:g} is not allowed along {self.along}; allowed: {allowed.phrase}"
                    + " (not inf: a branch has finite ends)" * bool(PARAMETERS[self.along].rigid)
                )
        if not self.start < self.stop:
            raise ValueError(f"start = {self.start:g} is not below stop = {self.stop:g}")
        return self


class BranchConfig(Config):
    """Cycles followed through folds, stable or not, from every Hopf point of a rod to where they end."""

    task: Literal["branch"]
    parameters: NonlinearParameters
    accuracy: Annotated[Number, Field(ge=1e-11, le=1e-2)] = 1e-7
    """Relative error of each cycle's period and largest y. Special points are located to it or to 1e-9,
    whichever is less; the file holds estimates of all."""
    branch: BranchOptions = BranchOptions()

    others_may_be_needed: ClassVar[bool] = True

    @property
    def names(self) -> tuple[str, ...]:
        return all_but(self.branch.along, NONLINEAR_PARAMETERS)

    @classmethod
    def taken_of_a_rod(cls, options: Mapping[str, Any]) -> tuple[str, ...]:
        return all_but(options.get("along", "F"), NONLINEAR_PARAMETERS)

    @model_validator(mode="before")
    @classmethod
    def _followed_has_no_default(cls, given: Any) -> Any:
        """The parameter that is followed has no value, unless one is given, which is refused."""
        sections = given if isinstance(given, dict) else {}
        options, parameters = sections.get("branch"), sections.get("parameters")
        along = options.get("along") if isinstance(options, dict) else None
        if not isinstance(parameters, dict) or not isinstance(along, str) or along not in DEFAULTS:
            return given
        return sections | {"parameters": {along: None, **parameters}}

    @model_validator(mode="after")
    def _follows_one_parameter(self) -> "BranchConfig":
        along = self.branch.along
        why = f"follows {along}; remove it and set branch.start and branch.stop, or another branch.along"
        self.refuse_found(along, why)
        if self.parameters.arm is not None and along != "F":
            raise ValueError(
                f"branch.along: {along} is not allowed with parameters.arm, which gives {along}; follow F, "
                "or give the parameters without an arm"
            )
        self.parameters.require(self.names)
        return self
