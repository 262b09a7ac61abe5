"""`rs.Arm`: an arm in SI units, with its range of flutter thresholds and all tasks of a rod."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import cached_property
from typing import TYPE_CHECKING, Any, Unpack

from ..config.document.call_argument_errors import refusing_wrong_arguments
from ..config.parameters_section import DEFAULT_F_MAX
from ..config.tasks import CONFIG_CLASSES_BY_TASK
from ..errors import InputError
from ..model.arm.arm import SlenderArm
from ..model.arm.quantities import LOAD_NAMES, SECTION_SIZE_NAMES
from ..model.units import GivenQuantity
from .answers.answer import Answer
from .argument_hints import unknown_arm_argument_hint
from .keyword_arguments import config_tree, job_of_tree, with_load_in_si
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
    from ..verdict.arm import ArmReport
    from ..verdict.flutter_over_drags import ThresholdsOverDrags
    from .answers.rod_portrait import RodPortrait

ARM_EXAMPLE = 'rs.Arm(length="10 cm", radius="5 mm", young="100 kPa", viscosity="1.4 Pa s", pressure="2 kPa")'
EXCLUSIVE_QUANTITIES = (
    tuple((load,) for load in LOAD_NAMES),
    SECTION_SIZE_NAMES,
    (("segments",), (*SECTION_SIZE_NAMES[0], *SECTION_SIZE_NAMES[1])),
    (("inner_radius",), ("tip_radius",)),
)
"""Pairs of mutually exclusive sets of quantities. If `Arm.replace` is called with a quantity of either set,
all quantities of the other set are removed."""


@dataclass(frozen=True, kw_only=True, init=False, repr=False)
class Arm(SlenderArm):
    """An arm in a viscous fluid, clamped at one end and pushed at its tip.

    A quantity is text with a unit, a pint quantity, or a number in SI units. Required are viscosity, length,
    young and radius (with inner_radius for a tube, tip_radius for a cone) or width and height; or viscosity
    and segments, from the base to the tip, each as "4 cm: radius 6 mm, young 80 kPa" or a mapping. law:
    "linear" or "neo_hookean". section: "fixed" or "swelling". The load is pressure or force. `flutter` needs
    no load; "1.2 of flutter" is a load relative to the flutter threshold at the likeliest drag.

    Every task of a rod is a method with the task's name and the options of the config as keywords. The Answer
    has variables in SI units and in dimensionless units. Calling a task starts PETSc; creating an arm does
    not. Raises InputError if the quantities describe no slender arm.
    """

    __init__ = refusing_wrong_arguments(ARM_EXAMPLE, unknown_arm_argument_hint)(SlenderArm.__init__)

    @cached_property
    @refusing_wrong_arguments("arm.flutter()")
    def flutter(self) -> "ThresholdsOverDrags":
        """Flutter threshold and frequency for each estimate of the drag, for motion in the plane of the
        section's `height`.

        An arm with a rectangular section may flutter earlier in the plane of its `width`, the motion of
        `turned`; `report` compares both.
        """
        from ..verdict.flutter_over_drags import thresholds_over_drags

        return thresholds_over_drags(self)

    @refusing_wrong_arguments("arm.report()")
    def report(self) -> "ArmReport":
        """Report on the arm: verdict, numbers with formulas and sources, and effects that the model
        neglects."""
        from ..verdict.arm import arm_report

        return arm_report(self)

    @refusing_wrong_arguments('arm.replace(length="12 cm")')
    def replace(self, **changed: GivenQuantity | None) -> "Arm":
        """A copy of the arm with changed quantities.

        None removes a quantity. A new quantity removes those that exclude it: force and pressure; width or
        height and any radius; inner_radius and tip_radius; segments and all these sizes, and also length.
        """
        removed: dict[str, None] = {}
        for first, second in EXCLUSIVE_QUANTITIES:
            for given, replaced in ((first, second), (second, first)):
                if any(changed.get(name) is not None for name in given):
                    removed |= dict.fromkeys(replaced)
        if changed.get("segments") is not None:
            removed["length"] = None
        return Arm(**(self._given_quantities | removed | changed))

    @property
    def turned(self) -> "Arm":
        """The arm with width and height exchanged, which moves in the second plane of its rectangular
        section.

        A round arm is returned unchanged.
        """
        return self if self.radius or self.segments else self.replace(width=self.height, height=self.width)

    @cached_property
    def loaded(self) -> "Arm":
        """The arm with its load as a pressure or force in SI units.

        For a load relative to flutter, the flutter threshold is solved first.
        """
        return with_load_in_si(self)

    @refusing_wrong_arguments("arm.thresholds(F_max=100)")
    def thresholds(self, **options: Unpack[ThresholdsKeywords]) -> Answer:
        """Loads at which the arm starts to oscillate, flutters, and becomes stable again. The arm needs no
        load."""
        return self._answer("thresholds", options)

    @refusing_wrong_arguments("arm.spectrum(modes=4)")
    def spectrum(self, **options: Unpack[SpectrumKeywords]) -> Answer:
        """The leading eigenvalues under the arm's load."""
        return self._answer("spectrum", options)

    @refusing_wrong_arguments("arm.modes(nodes=65)")
    def modes(self, **options: Unpack[ModesKeywords]) -> Answer:
        """The leading modes under the arm's load, and their transient growth."""
        return self._answer("modes", options)

    @refusing_wrong_arguments("arm.cycle(harmonics=8)")
    def limit_cycle(self, **options: Unpack[LimitCycleKeywords]) -> Answer:
        """The limit cycle under the arm's load: period, amplitude, energy, Floquet multipliers."""
        return self._answer("limit_cycle", options)

    cycle = limit_cycle

    @refusing_wrong_arguments("arm.criticality(F_max=100)")
    def criticality(self, **options: Unpack[CriticalityKeywords]) -> Answer:
        """Criticality of every Hopf point, and how its branch of cycles grows."""
        return self._answer("criticality", options)

    @refusing_wrong_arguments('arm.branch(along="F")')
    def branch(self, **options: Unpack[BranchKeywords]) -> Answer:
        """The branches of cycles, stable or not, followed from every Hopf point to their ends."""
        return self._answer("branch", options)

    @refusing_wrong_arguments("arm.portrait(F_max=100)")
    def portrait(
        self, *, F_max: float = DEFAULT_F_MAX, accuracy: float | None = None, progress: bool | None = None
    ) -> "RodPortrait":
        """All results for the arm up to `F_max`, in a picture and a paragraph, in SI units.

        Thresholds, criticality, branches of cycles, loads with two stable states, modes at the thresholds,
        and three cycles. The arm needs no load; the kind of a given load, pressure or force, is used for all
        loads in the portrait. F_max: largest dimensionless load, that is, the load divided by the arm's
        `load_scale`. accuracy and progress are as for `SoftRod.portrait`.
        """
        from ..post.rod_portrait.results import DescribedRod
        from ..tasks.rod_portrait import PortraitRequest
        from .answers.rod_portrait import solve_portrait

        default = {field.name: field.default for field in fields(self)}
        section = config_tree("thresholds", {"arm": self})["parameters"]["arm"]
        # `load_kind` is no quantity of the arm; the kind of the loads is given to the portrait as `load`.
        quantities = {name: value for name, value in section.items() if value != default.get(name, value)}
        description = DescribedRod(arm=quantities, load_kind=self.load_name or LOAD_NAMES[0])
        request = PortraitRequest(rod=description, F_max=F_max, accuracy=accuracy)
        return solve_portrait(repr(self), request, progress)

    def _answer(self, task: str, options: Mapping[str, Any]) -> Answer:
        for name in options:
            if name in self._quantity_names:
                raise InputError(
                    f"{name} is a quantity of the arm, not an option; "
                    f"arm.replace({name}=...) makes another arm"
                )
        options = dict(options)
        progress = options.pop("progress", None)
        try:
            CONFIG_CLASSES_BY_TASK[task].refuse_options_of_arm(options)
        except ValueError as error:
            raise InputError(str(error)) from None
        needs_load = "F" in CONFIG_CLASSES_BY_TASK[task].rod_parameters_used(options)
        if needs_load and self.load_name is None:
            raise InputError(
                f"{task} needs a load; give one, such as arm.replace(pressure='2 kPa') or "
                "arm.replace(pressure='1.2 of flutter')"
            )
        solved = solve_in_process(job_of_tree(config_tree(task, {"arm": self} | options)), progress=progress)
        return Answer(repr(self), solved, "; ".join(filter(None, (solved.messages[0], self._plane_warning))))

    @property
    def _plane_warning(self) -> str:
        """Warning for a rectangular section that bends more easily out of the plane of motion; else ""."""
        if not self.si.height > self.si.width:
            return ""
        return (
            "the arm moves in the plane of its height, but flutters first in the plane of its width, at a "
            "lower load; arm.turned moves in the plane of the width"
        )

    @property
    def _quantity_names(self) -> list[str]:
        return [field.name for field in fields(self) if field.init]

    @property
    def _given_quantities(self) -> dict[str, Any]:
        """The quantities of the arm that are not None, by name."""
        values = {name: getattr(self, name) for name in self._quantity_names}
        return {name: value for name, value in values.items() if value is not None}

    def __repr__(self) -> str:
        default = {field.name: field.default for field in fields(self)}
        given = {name: value for name, value in self._given_quantities.items() if value != default[name]}
        return f"Arm({', '.join(f'{name}={value!r}' for name, value in given.items())})"
