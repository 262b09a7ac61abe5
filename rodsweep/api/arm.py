"""`rs.Arm`: an arm in SI units, which says when it flutters and answers every task of a rod."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import cached_property
from typing import TYPE_CHECKING, Any, Unpack

from ..config.document.call_arguments import in_sentences
from ..config.tasks import CONFIGS
from ..errors import InputError
from ..model.arm.arm import SlenderArm
from ..model.arm.quantities import LOADS, SECTION_SIDES
from ..model.units import Given
from .answers.answer import Answer
from .asking import job_from, known_load, tree_of
from .options import OfBranch, OfCriticality, OfLimitCycle, OfModes, OfSpectrum, OfThresholds
from .solving import solve_here

if TYPE_CHECKING:
    from ..verdict.arm import ArmReport
    from ..verdict.flutter import FlutterRange

EXAMPLE = 'rs.Arm(length="10 cm", radius="5 mm", young="100 kPa", viscosity="1.4 Pa s", pressure="2 kPa")'
EXCLUSIVE = (tuple((load,) for load in LOADS), SECTION_SIDES)
"""Quantities of which one set takes the place of the other."""


@dataclass(frozen=True, kw_only=True, init=False, repr=False)
class Arm(SlenderArm):
    """An arm in a viscous fluid, clamped at one end and pushed at its tip.

    Quantities are text with a unit, pint's, or numbers in SI. Needed: length, young, viscosity, and either
    radius (and inner_radius, for a tube) or width and height. pressure or force, or none: when it flutters
    needs no load, and "1.2 of flutter" is one relative to the threshold with the likeliest drag.

    Every task of a rod is a method of its name, with the options of the config as keywords; its Answer has SI
    units beside the dimensionless ones. Asking starts PETSc; making an arm does not. Raises InputError for
    what is no slender arm.
    """

    __init__ = in_sentences(EXAMPLE)(SlenderArm.__init__)

    @cached_property
    def flutter(self) -> "FlutterRange":
        """Where it flutters and how fast in its plane of motion, over the range of its drag."""
        from ..verdict.flutter import flutter_range

        return flutter_range(self)

    def report(self) -> "ArmReport":
        """Verdict, numbers with formulas and sources, and what the model leaves out."""
        from ..verdict.arm import report_on

        return report_on(self)

    @in_sentences('arm.replace(length="12 cm")')
    def replace(self, **changed: Given | None) -> "Arm":
        """The same arm with other quantities; a force takes the place of a pressure, width and height that
        of a radius."""
        gone: dict[str, None] = {}
        for one, other in EXCLUSIVE:
            for new, old in ((one, other), (other, one)):
                if any(changed.get(name) is not None for name in new):
                    gone |= dict.fromkeys(old)
        return Arm(**(self._given | gone | changed))

    @property
    def turned(self) -> "Arm":
        """The arm that moves in the other plane of its rectangular section; itself where it is round."""
        return self if self.radius is not None else self.replace(width=self.height, height=self.width)

    @cached_property
    def loaded(self) -> "Arm":
        """The arm with its load as a quantity where it is given relative to flutter; itself otherwise."""
        return known_load(self)

    @in_sentences("arm.thresholds(F_max=100)")
    def thresholds(self, **options: Unpack[OfThresholds]) -> Answer:
        """The loads at which the arm starts to oscillate, flutters and is stable again; it needs none."""
        return self._answer("thresholds", options)

    @in_sentences("arm.spectrum(modes=4)")
    def spectrum(self, **options: Unpack[OfSpectrum]) -> Answer:
        """The leading eigenvalues under its load."""
        return self._answer("spectrum", options)

    @in_sentences("arm.modes(nodes=65)")
    def modes(self, **options: Unpack[OfModes]) -> Answer:
        """The leading modes under its load, and the transient growth that they allow."""
        return self._answer("modes", options)

    @in_sentences("arm.cycle(harmonics=8)")
    def limit_cycle(self, **options: Unpack[OfLimitCycle]) -> Answer:
        """How the arm beats under its load: period, amplitude, energy, Floquet multipliers."""
        return self._answer("limit_cycle", options)

    cycle = limit_cycle

    @in_sentences("arm.criticality(F_max=100)")
    def criticality(self, **options: Unpack[OfCriticality]) -> Answer:
        """On which side of every Hopf point its cycles are, and how they grow from there."""
        return self._answer("criticality", options)

    @in_sentences('arm.branch(along="F")')
    def branch(self, **options: Unpack[OfBranch]) -> Answer:
        """Its cycles, stable or not, followed from every Hopf point to the end."""
        return self._answer("branch", options)

    def _answer(self, task: str, options: Mapping[str, Any]) -> Answer:
        for name in options:
            if name in self._names:
                raise InputError(f"{name} belongs to the arm: arm.replace({name}=...) is another one")
        options = dict(options)
        progress = options.pop("progress", None)
        takes_load = "F" in CONFIGS[task].taken_of_a_rod(options)
        if takes_load and self.load is None:
            raise InputError(
                f"{task} needs a load; arm.replace(pressure='2 kPa') has one, or '1.2 of flutter'"
            )
        data, messages = solve_here(job_from(tree_of(task, {"arm": self} | options)), progress=progress)
        return Answer(repr(self), data, "; ".join(filter(None, (messages[0], self._plane))))

    @property
    def _plane(self) -> str:
        """What is said of a rectangle that gives way first in the plane that is not computed; else empty."""
        if not self.si.height > self.si.width:
            return ""
        return (
            "it moves in the plane of its height, and flutters first in the other, at a lower load: "
            "arm.turned"
        )

    @property
    def _names(self) -> list[str]:
        return [each.name for each in fields(self) if each.init]

    @property
    def _given(self) -> dict[str, Any]:
        """The quantities that are given, by name."""
        return {name: getattr(self, name) for name in self._names if getattr(self, name) is not None}

    def __repr__(self) -> str:
        default = {each.name: each.default for each in fields(self)}
        given = (f"{name}={value!r}" for name, value in self._given.items() if value != default[name])
        return f"Arm({', '.join(given)})"
