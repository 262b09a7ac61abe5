"""Config of the task branch: branches of cycles followed in one parameter from their Hopf points."""

from collections.abc import Mapping
from math import inf, isfinite
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, model_validator

from ...errors import short_repr
from ...model.parameters import (
    NONLINEAR_ROD_PARAMETER_NAMES,
    PARAMETERS,
    TRANSVERSE_PARAMETER_NAMES,
    parameter_names_except,
)
from ..base_config import Config
from ..parameters_section import DEFAULT_VALUES_OF_PARAMETERS, NonlinearParametersSection
from ..values import Number, StrictConfigSection


class BranchOptions(StrictConfigSection):
    """Options of the task branch: parameter and range of the branches, number of stored cycles."""

    along: Literal[TRANSVERSE_PARAMETER_NAMES] = "F"  # type: ignore[valid-type]  # pydantic reads it at run time
    """Parameter along which branches are followed. All other parameters are axes."""
    start: Annotated[Number, Field(gt=-inf, lt=inf)] = 0.0
    """Smallest value of the parameter `along`; a branch that reaches this value ends."""
    stop: Annotated[Number, Field(gt=-inf, lt=inf)] = 200.0
    """Largest value of the parameter `along`. If a smaller force crushes the rod, branches along F end just
    below that force."""
    cycles: Annotated[int, Field(ge=1, le=100_000)] = 500
    """Maximum number of stored cycles per rod, over all branches."""
    special: Annotated[int, Field(ge=1, le=10_000)] = 64
    """Maximum number of stored special points per rod."""
    work: Annotated[
        Annotated[Number, Field(gt=0, lt=inf)] | None,
        Field(description="a finite number above 0, or null for no limit"),
    ] = None
    """Largest work on the branches of a rod, in 1e9 multiplications of matrix elements; a core does ten to
    twenty of these units a second. A branch that needs more ends there, and a special point that needs more
    has a larger error."""
    certify: bool = True
    """Confirm by winding numbers between the Hopf points that no Hopf point is missing."""

    @model_validator(mode="after")
    def _require_valid_range(self) -> "BranchOptions":
        allowed = PARAMETERS[self.along].allowed_range
        for key, value in (("start", self.start), ("stop", self.stop)):
            if not allowed.contains(value) or not isfinite(value):
                # Stiffnesses may be infinite, the ends of a branch may not.
                raise ValueError(
                    f"{key} = {value:g} is not allowed along {self.along}; it should be "
                    f"{allowed.finite_description_for_rejected(value)}"
                )
        if not self.start < self.stop:
            raise ValueError(f"start = {self.start:g} is not below stop = {self.stop:g}")
        return self


class BranchConfig(Config):
    """The task branch follows limit cycles, stable or not, through folds, from every Hopf point of a rod."""

    task: Literal["branch"]
    parameters: NonlinearParametersSection
    """Axes of the parameters, a file of points, or an arm."""
    accuracy: Annotated[Number, Field(ge=1e-11, le=1e-2)] = 1e-7
    """Relative error of the parameter of each cycle at a given deflection, and of its period and largest y at
    the stored parameter p. Where the largest y is steep, |(p/y) dy/dp| > 100 as near Hopf points and folds,
    the error of the largest y is larger in proportion, and at folds the error of the period too. Special
    points are located to the smaller of `accuracy` and 1e-9. The file has error estimates of all these
    numbers. Cycles without mirror symmetry are solved to 1e-4 at least, cycles of rods close to a generalised
    Hopf point to 5e-7 or less."""
    branch: BranchOptions = BranchOptions()

    parameters_depend_on_options: ClassVar[bool] = True
    """True: the needed parameters depend on the option `along`, because the followed parameter has no
    axis."""

    @property
    def parameter_names(self) -> tuple[str, ...]:
        return (
            *parameter_names_except(self.branch.along, NONLINEAR_ROD_PARAMETER_NAMES),
            *self.optional_parameters_in_use,
        )

    @classmethod
    def rod_parameters_used(cls, options: Mapping[str, Any]) -> tuple[str, ...]:
        along = options.get("along", "F")
        # Options of a Python call may be of any type, as an array, whose comparison is not one truth value.
        return parameter_names_except(along if isinstance(along, str) else "", NONLINEAR_ROD_PARAMETER_NAMES)

    @classmethod
    def refuse_options_of_arm(cls, options: Mapping[str, Any]) -> None:
        along = options.get("along", "F")
        if isinstance(along, str) and along != "F" and along in TRANSVERSE_PARAMETER_NAMES:
            raise ValueError(
                f"branch.along: {along} is not allowed with parameters.arm, which gives {along}; follow F, "
                "or give the parameters without an arm"
            )
        if not isinstance(along, str) or along != "F":
            raise ValueError(
                f"branch.along = {short_repr(along)} is not allowed for an arm; leave along out, and the "
                "branches follow the load of the arm, as F, from start to stop"
            )

    @model_validator(mode="before")
    @classmethod
    def _without_default_of_followed(cls, section: Any) -> Any:
        """Returns the config without the default of the followed parameter, so that only a value given by the
        user is refused."""
        sections = section if isinstance(section, dict) else {}
        options = sections.get("branch")
        parameters = sections.get("parameters")
        parameter = options.get("along") if isinstance(options, dict) else None
        if (
            not isinstance(parameters, dict)
            or not isinstance(parameter, str)
            or parameter not in DEFAULT_VALUES_OF_PARAMETERS
        ):
            return section
        return sections | {"parameters": {parameter: None, **parameters}}

    @model_validator(mode="after")
    def _require_one_followed_parameter(self) -> "BranchConfig":
        parameter = self.branch.along
        reason = (
            f"follows {parameter}; remove it and set branch.start and branch.stop, or another branch.along"
        )
        self.refuse_solved_parameter(parameter, reason)
        if self.parameters.arm is not None:
            self.refuse_options_of_arm({"along": parameter})
        self.parameters.require_one_definition_of_points(self.parameter_names)
        return self
