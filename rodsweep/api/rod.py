"""`rs.Rod`: one rod in dimensionless units, with every task as a method."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from inspect import Parameter, Signature, signature
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np
from pydantic import ValidationError

from ..config.document.call_argument_errors import refusing_wrong_arguments, unknown_argument_error
from ..config.document.refusals import message_of_problem, similar_keys, unknown_key_hint
from ..config.material import MaterialConfig, with_profile_read
from ..config.parameters_section import DEFAULT_F_MAX, DEFAULT_VALUES_OF_PARAMETERS, REQUIRED_PARAMETERS
from ..config.tasks import CONFIG_CLASSES_BY_TASK
from ..config.values import as_float
from ..errors import InputError, short_repr
from ..model.arm.arm import SlenderArm
from ..model.arm.as_config import material_config_of, rod_parameters_of
from ..model.material.rod_material import DEFAULT_MATERIAL
from ..model.parameters import OPTIONAL_PARAMETER_NAMES, PARAMETERS
from ..sweep.points.points_from_config import refuse_invalid_axes
from ..wording import enumeration
from .answers.answer import Answer
from .argument_hints import rod_argument_hint
from .keyword_arguments import (
    config_tree,
    job_of_tree,
    keyword_value_of_yaml_types,
    value_of_yaml_types,
    with_load_in_si,
)
from .solving_in_process import solve_in_process
from .task_keywords import (
    BranchKeywords,
    CriticalityKeywords,
    LimitCycleKeywords,
    ModesKeywords,
    SpectrumKeywords,
    ThresholdsKeywords,
)

if TYPE_CHECKING:
    from .answers.rod_portrait import RodPortrait

ROD_EXAMPLE = 'rs.Rod(arm=rs.Arm(length="10 cm", radius="5 mm", young="100 kPa", viscosity="1.4 Pa s"))'


class SoftRod:
    """A slender soft rod in a viscous fluid with a follower force at its tip, in units of its length and k3.

    F: follower force, in k3/L^2; not needed for thresholds, criticality and branch, which solve for F or vary
    F. k1, k2: stretch and shear stiffness, in k3/L^2, inf for a rigid rod. gamma3: rotational drag, in gamma2
    L^2. gamma1: axial drag, in gamma2, by default 1. arm: an `rs.Arm`, source of all parameters not given.
    taper: tip radius over base radius of a cone, by default 1. law: "linear" or "neo_hookean". section:
    "fixed" or "swelling". profile: factors along the arm, a CSV file or a mapping of columns to lists.

    Every task is a method with the task's name. It takes the options of the config as keywords, with the same
    defaults, and returns an `Answer`. Raises InputError, with the command line's message, for values outside
    their range.
    """

    __slots__ = ("_material", "_values")

    @refusing_wrong_arguments("rs.Rod(F=30, k1=1e4, k2=100, gamma3=0.01)")
    def __init__(
        self,
        *,
        arm: SlenderArm | None = None,
        law: str | None = None,
        section: str | None = None,
        profile: str | Mapping[str, Any] | None = None,
        **parameters: float | None,
    ):
        arguments: dict[str, Any] = {**parameters, "arm": arm}
        given_values = {name: value for name, value in arguments.items() if value is not None}
        material = {"law": law, "section": section, "profile": profile}
        for name in parameters:
            if name not in PARAMETERS:
                known = (*PARAMETERS, "arm", *material)
                missing = [key for key in known if key not in given_values]
                suggestion = unknown_key_hint(name, missing if similar_keys(name, missing) else known)
                raise InputError(f"a rod has no parameter {name}; {rod_argument_hint(name) or suggestion}")
        if arm is not None:
            if not isinstance(arm, SlenderArm):
                raise InputError(f"arm = {short_repr(arm)} is not an arm; write it as in {ROD_EXAMPLE}")
            given_values = rod_parameters_of(with_load_in_si(arm)) | given_values
            given_material = {name: value for name, value in material.items() if value is not None}
            material = material_config_of(arm) | given_material
        for name in REQUIRED_PARAMETERS:
            if name not in given_values:
                names_text = enumeration(REQUIRED_PARAMETERS, "and")
                raise InputError(f"{name} is missing; give {names_text}, or an arm")
        values = DEFAULT_VALUES_OF_PARAMETERS | given_values
        names = [name for name in PARAMETERS if values.get(name) is not None]
        self._values = {name: _parameter_value(name, values[name]) for name in names}
        self._material = _material_section(material)
        material_of_rod = DEFAULT_MATERIAL if self._material is None else self._material.rod_material
        if arm is not None and material_of_rod.section == "swelling":
            # The replacement refuses a Poisson's ratio that contradicts the section.
            replace(arm, law=material_of_rod.law, section=material_of_rod.section)
        axes = {name: np.array([value]) for name, value in self._values.items()}
        refuse_invalid_axes(axes, material=material_of_rod)

    @property
    def parameters(self) -> dict[str, float]:
        """Values of the parameters by name."""
        return dict(self._values)

    @refusing_wrong_arguments("rod.replace(F=40)")
    def replace(self, **changed: float) -> "SoftRod":
        """A copy of the rod with new values of some parameters, or of law, section or profile."""
        values: dict[str, Any] = self._values | self._nondefault_material_values | changed
        return SoftRod(**values)

    @property
    def _nondefault_material_values(self) -> dict[str, Any]:
        """Values of the keys of the section `material` that differ from their defaults, by key."""
        return {} if self._material is None else self._material.model_dump(exclude_defaults=True)

    @refusing_wrong_arguments("rod.spectrum(modes=4)")
    def spectrum(self, **options: Unpack[SpectrumKeywords]) -> Answer:
        """The `modes` leading eigenvalues (4 by default), growth_rate + i frequency in 1/tau2."""
        return self._answer("spectrum", options)

    @refusing_wrong_arguments("rod.thresholds(F_max=100)")
    def thresholds(self, **options: Unpack[ThresholdsKeywords]) -> Answer:
        """Forces up to `F_max` at which the rod starts to oscillate, flutters, and becomes stable again."""
        return self._answer("thresholds", options)

    @refusing_wrong_arguments("rod.modes(nodes=65)")
    def modes(self, **options: Unpack[ModesKeywords]) -> Answer:
        """The leading modes with adjoint modes, and the transient growth."""
        return self._answer("modes", options)

    @refusing_wrong_arguments("rod.cycle(harmonics=8)")
    def limit_cycle(self, **options: Unpack[LimitCycleKeywords]) -> Answer:
        """The limit cycle of the rod: period, amplitude, energy and Floquet multipliers."""
        return self._answer("limit_cycle", options)

    cycle = limit_cycle

    @refusing_wrong_arguments("rod.criticality(F_max=100)")
    def criticality(self, **options: Unpack[CriticalityKeywords]) -> Answer:
        """Criticality of every Hopf point up to `F_max`, and how its branch of cycles grows."""
        return self._answer("criticality", options)

    @refusing_wrong_arguments('rod.branch(along="F")')
    def branch(self, **options: Unpack[BranchKeywords]) -> Answer:
        """The branches of cycles, stable or not, followed in `along` from every Hopf point to their ends."""
        return self._answer("branch", options)

    @refusing_wrong_arguments("rod.portrait(F_max=100)")
    def portrait(
        self, *, F_max: float = DEFAULT_F_MAX, accuracy: float | None = None, progress: bool | None = None
    ) -> "RodPortrait":
        """All results for the rod up to `F_max`, in a picture and a paragraph.

        Thresholds, criticality, branches of cycles, ranges with two stable states, modes at the thresholds,
        and three cycles. Instead of a result that cannot be solved, the portrait states the reason. accuracy:
        relative accuracy of the cycles, or None for the defaults. progress: whether to display progress;
        None: only in a terminal or a notebook.
        """
        from ..post.rod_portrait.results import DescribedRod
        from ..tasks.rod_portrait import PortraitRequest
        from .answers.rod_portrait import solve_portrait

        description = DescribedRod(parameters=self._values, material=self._nondefault_material_values)
        request = PortraitRequest(rod=description, F_max=F_max, accuracy=accuracy)
        return solve_portrait(repr(self), request, progress)

    if not TYPE_CHECKING:  # hidden from type checkers, which should report a misspelt task

        def __getattr__(self, name: str) -> Callable[..., Answer]:
            """Method for a task that this class does not define; AttributeError if `name` is not a task."""
            if name in PARAMETERS:
                hint = f"rod.parameters[{name!r}] is its value, and rod.replace({name}=...) makes another rod"
                raise AttributeError(f"a rod has no attribute {name!r}; {hint}")
            if name not in CONFIG_CLASSES_BY_TASK:
                tasks = CONFIG_CLASSES_BY_TASK.items()
                names = [task for task, config in tasks if not config.needs_several_rods]
                raise AttributeError(f"a rod has no {name!r}; its tasks are {', '.join(names)}")
            return lambda **options: self._answer(name, options)

    def _answer(self, task: str, options: Mapping[str, Any]) -> Answer:
        if CONFIG_CLASSES_BY_TASK[task].needs_several_rods:
            raise InputError(f"{task} is a task of several rods; use rs.sweep({task!r}, ...) with two axes")
        for name in options:
            if name in PARAMETERS:
                hint = f"rod.replace({name}=...) makes another rod"
                raise InputError(f"{name} is a parameter of the rod, not an option; {hint}")
        section: Any = CONFIG_CLASSES_BY_TASK[task].model_fields[task].annotation
        allowed = [*section.model_fields, "accuracy", "title", "progress"]
        for name in options:
            if name not in allowed and not similar_keys(name, allowed):
                raise unknown_argument_error(name, allowed)
        options = dict(options)
        progress = options.pop("progress", None)
        names = (*CONFIG_CLASSES_BY_TASK[task].rod_parameters_used(options), *OPTIONAL_PARAMETER_NAMES)
        values: dict[str, Any] = {name: self._values[name] for name in names if name in self._values}
        tree = config_tree(task, values | self._nondefault_material_values | options)
        solved = solve_in_process(job_of_tree(tree), progress=progress)
        return Answer(repr(self), solved, solved.messages[0])

    def __repr__(self) -> str:
        values = [f"{name}={value:.15g}" for name, value in self._values.items()]
        material = [f"{name}={short_repr(value)}" for name, value in self._nondefault_material_values.items()]
        return f"Rod({', '.join([*values, *material])})"

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, SoftRod):
            return False
        if self._values != other._values:
            return False
        return self._nondefault_material_values == other._nondefault_material_values

    def __hash__(self) -> int:
        return hash((*self._values.items(), repr(self._nondefault_material_values)))


def _material_section(values: Mapping[str, Any]) -> MaterialConfig | None:
    """The validated section `material` of a rod; None if all values in `values` are None. Raises InputError
    for invalid values."""
    given = {name: value for name, value in values.items() if value is not None}
    tree = {name: keyword_value_of_yaml_types(f"material.{name}", value) for name, value in given.items()}
    if not tree:
        return None
    material = with_profile_read({"material": tree}, Path())["material"]
    try:
        return MaterialConfig.model_validate(material)
    except ValidationError as error:
        problem: dict[str, Any] = dict(error.errors(include_url=False)[0])
        in_config = problem | {"loc": ("material", *problem["loc"])}
        raise InputError(message_of_problem(CONFIG_CLASSES_BY_TASK["spectrum"], in_config)) from None


def _parameter_value(name: str, value: Any) -> float:
    """Value of the parameter `name` as a float; InputError if the value is no number."""
    try:
        return as_float(value_of_yaml_types(value))
    except ValueError as error:
        raise InputError(f"parameters.{name}: {error}") from None


_PARAMETER_KEYWORDS = [
    Parameter(name, Parameter.KEYWORD_ONLY, default=None, annotation=float | None) for name in PARAMETERS
]
_MATERIAL_KEYWORDS = [signature(SoftRod).parameters[name] for name in ("arm", "law", "section", "profile")]
SoftRod.__signature__ = Signature([*_PARAMETER_KEYWORDS, *_MATERIAL_KEYWORDS])  # type: ignore[attr-defined]
