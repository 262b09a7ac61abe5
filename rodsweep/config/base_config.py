"""Config keys common to all tasks, and types of options that several tasks share.

Only types and keys are checked here. Physical ranges (F < k1, positive stiffness) are checked when the points
are computed.
"""

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar

from pydantic import Field, model_validator

from ..model.material.rod_material import DEFAULT_MATERIAL, RodMaterial
from ..model.parameters import (
    NON_OPTIONAL_LINEAR_PARAMETER_NAMES,
    NONLINEAR_ROD_PARAMETER_NAMES,
    OPTIONAL_PARAMETER_NAMES,
)
from .arm.shape import MATERIAL_KEYS, NONUNIFORM_ARM_KEYS, refuse_compressible, refuse_misused_shape
from .material import MaterialConfig
from .parameters_section import LinearParametersSection, ParametersSection
from .values import Number, StrictConfigSection, Text

ModeCount = Annotated[int, Field(ge=1, le=100)]
NodeCount = Annotated[int, Field(ge=3, le=513)]
CrossingCount = Annotated[int, Field(ge=1, le=1000)]
MATERIAL_FIELD = Field(description="a mapping of law, section and profile")


class Config(StrictConfigSection):
    """Keys and properties of the config of every task."""

    title: Annotated[Text, Field(max_length=200)] = ""
    """Name of the run, printed by `check` and `show`."""
    task: str
    """Name of the task."""
    parameters: ParametersSection
    """Axes of the parameters, a file of points, or an arm."""
    accuracy: Annotated[Number, Field(ge=1e-13, le=1e-2)] = 1e-10
    """Relative error of each eigenvalue, threshold and mode. `limit_cycle` and `branch`, whose
    numbers are cycles, have other limits and defaults."""

    material: Annotated[MaterialConfig | None, MATERIAL_FIELD] = None
    """Constitutive law and profile of the arm; by default a linear law and a uniform arm."""

    allows_crushed_rods: ClassVar[bool] = False
    """Whether a grid may contain crushed rods: True for tasks with the state `crushed`."""

    parameters_depend_on_options: ClassVar[bool] = False
    """Whether the names of the needed parameters depend on the task's options."""
    needs_several_rods: ClassVar[bool] = False
    """Whether the task needs a grid of several rods, so that a list of points is refused."""

    @property
    def parameter_names(self) -> tuple[str, ...]:
        """Names of the parameters of a point: the parameters that the task needs, and the optional parameters
        in the config."""
        return (*self.rod_parameters_used({}), *self.optional_parameters_in_use)

    @property
    def optional_parameters_in_use(self) -> tuple[str, ...]:
        """Names of the optional parameters in the config, given by name or implied by the arm's shape."""
        arm = self.parameters.arm
        cone_parameters = () if arm is None else arm.cone_parameter_names
        used_names = {*self.parameters.given_optional_parameters, *cone_parameters}
        return tuple(name for name in OPTIONAL_PARAMETER_NAMES if name in used_names)

    @property
    def stated_rod_material(self) -> RodMaterial | None:
        """Constitutive law and profile in the section `material`; None if the section is not given."""
        return None if self.material is None else self.material.rod_material

    @property
    def rod_material(self) -> RodMaterial:
        """Constitutive law and profile of the rods, from the section `material`, else from the arm, else the
        default."""
        if self.stated_rod_material is not None:
            return self.stated_rod_material
        return DEFAULT_MATERIAL if self.parameters.arm is None else self.parameters.arm.rod_material

    @property
    def is_uniform_and_linear(self) -> bool:
        """Whether all rods are uniform and of linear material; False for a list of points with tapers."""
        if self.parameters.arm is not None and not self.parameters.arm.is_uniform_and_linear:
            return False
        if "taper" in (self.parameters.columns or ()):
            return False
        tapers = self.parameters.given_axes.get("taper")
        return self.rod_material.is_uniform_and_linear and (
            tapers is None or bool((tapers.array() == 1).all())
        )

    @classmethod
    def rod_parameters_used(cls, options: Mapping[str, Any]) -> tuple[str, ...]:
        """Names of the parameters of a rod that the task uses. options: options of the task, not
        validated."""
        return NONLINEAR_ROD_PARAMETER_NAMES

    @property
    def remedies_of_options_without_effect(self) -> dict[str, str]:
        """For each option without effect in this config, by name: the setting with which the option would
        have an effect."""
        return {}

    def refuse_options_without_effect(self) -> None:
        """Raises ValueError if the config gives an option that has no effect."""
        for option, remedy in self.remedies_of_options_without_effect.items():
            if option in getattr(self, self.task).model_fields_set:
                raise ValueError(
                    f"{self.task}.{option} is given but not used; set {self.task}.{remedy} or remove it"
                )

    @property
    def settings_of_results(self) -> dict[str, Any]:
        """All settings on which the results depend, except the points, as JSON-compatible values.

        Settings under the key `together` change only the variables that are computed jointly from all points.
        Two configs with equal settings and equal points give the same results.
        """
        options = getattr(self, self.task).model_dump(
            mode="json", exclude=set(self.remedies_of_options_without_effect)
        )
        constant_values = dict(self.parameters.constant_parameters)
        settings = {
            "task": self.task,
            "parameters": constant_values,
            "accuracy": self.accuracy,
            self.task: options,
        }
        if self.material is not None and not self.rod_material.is_uniform_and_linear:
            settings["material"] = self.material.model_dump(mode="json", exclude_none=True)
        if self.parameters.arm is None:
            return settings
        if arm_axes := self.parameters.arm_axes:  # these axes do not contain parameters with one value
            given_axes = self.parameters.given_axes
            names = [name for name in self.parameter_names if name not in arm_axes]
            first_values = {
                axis_name: float(axis.array()[0])
                for axis_name, axis in given_axes.items()
                if axis_name in names
            }
            settings["parameters"] |= {name: first_values.get(name) for name in names}
        return settings | {"arm": self.parameters.arm.settings_of_results}

    @classmethod
    def refuse_options_of_arm(cls, options: Mapping[str, Any]) -> None:
        """Raises ValueError for options of the task that no arm can have, before a missing load is refused;
        by default there are none. options: options of the task, not validated."""

    def refuse_solved_parameter(self, name: str, reason: str) -> None:
        """Raises ValueError, with the reason `reason`, if the config gives the parameter `name`, for which
        the task solves."""
        if name in self.parameters.given_axes:
            raise ValueError(f"parameters.{name} is given but the task {self.task} {reason}")

    @model_validator(mode="after")
    def _refuse_two_materials(self) -> "Config":
        arm = self.parameters.arm
        if arm is None:
            return self
        key = next(
            (name for name in (*MATERIAL_KEYS, *NONUNIFORM_ARM_KEYS) if getattr(arm, name) is not None), ""
        )
        if self.material is not None and key:
            raise ValueError(
                f"material and parameters.arm.{key} are both given; give law and section in parameters.arm"
            )
        refuse_misused_shape(arm, self.parameters.given_axes)
        refuse_compressible(arm, self.rod_material.section)
        return self


class LinearConfig(Config):
    """Base class of the configs of tasks on the linear problem."""

    parameters: LinearParametersSection
    """Axes of the parameters, a file of points, or an arm."""

    nonlinear_parameters_used: ClassVar[tuple[str, ...]] = ()
    """Names of parameters that the linear problem does not contain, but that some options of this linear task
    use."""

    @classmethod
    def rod_parameters_used(cls, options: Mapping[str, Any]) -> tuple[str, ...]:
        return NON_OPTIONAL_LINEAR_PARAMETER_NAMES

    @model_validator(mode="after")
    def _refuse_unused_parameters(self) -> "LinearConfig":
        for name in self.parameters.constant_parameters:
            if name not in self.nonlinear_parameters_used:
                raise ValueError(
                    f"parameters.{name} is given but the task {self.task} does not use it; remove it"
                )
        return self
