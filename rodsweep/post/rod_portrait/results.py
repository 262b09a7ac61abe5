"""What a portrait is drawn from: the results of one rod, and the reasons where a result is missing."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from ...results.file.view import View
from ..branch_curves import RodBranches
from .units import PortraitUnits, units_of


@dataclass(frozen=True, slots=True, kw_only=True)
class DescribedRod:
    """A rod as a user describes it."""

    parameters: Mapping[str, float] = field(default_factory=dict)
    """Values by name; for an arm only values that replace the arm's own."""
    material: Mapping[str, Any] = field(default_factory=dict)
    """Section `material` of a config, empty for a uniform rod of linear material."""
    arm: Mapping[str, Any] = field(default_factory=dict)
    """Section `parameters.arm` of a config without load, empty for a rod."""
    load: str = "pressure"
    """The load of the arm, "pressure" or "force"."""

    @property
    def kind(self) -> str:
        """The word for it in a sentence."""
        return "arm" if self.arm else "rod"

    @property
    def words(self) -> str:
        """The quantities of an arm, the parameters but F, and the material."""
        words = [f"{name.replace('_', ' ')} {_quantity(value)}" for name, value in self.arm.items()]
        words += [f"{name} = {value:g}" for name, value in self.parameters.items() if name != "F"]
        words += [f"{name} {self.material[name]}" for name in ("law", "section") if name in self.material]
        words += ["a profile along its length"] if "profile" in self.material else []
        return ", ".join(words)


@dataclass(frozen=True, slots=True, kw_only=True)
class RodResults:
    """Results of one rod, each a view of a single point."""

    rod: DescribedRod
    F_max: float
    """Largest requested force."""
    views: Mapping[str, View]
    """Thresholds, and criticality and branch unless missing."""
    modes: Mapping[str, tuple[float, View]]
    """(force, modes there) at the first thresholds, by kind."""
    cycles: Sequence[tuple[float, View]]
    """(force, limit cycle there), increasing."""
    missing: Mapping[str, str]
    """Reason, in a sentence, for every task without a result."""

    @property
    def units(self) -> PortraitUnits:
        """Units of the portrait, chosen for the largest force of the search."""
        view = self.views["thresholds"]
        return units_of(view, self.rod.load, float(view.variables["F_end"].ravel()[0]))

    @property
    def branches(self) -> RodBranches | None:
        """Branches of cycles; None if they are missing."""
        return RodBranches(self.views["branch"]) if "branch" in self.views else None


def _quantity(value: Any) -> str:
    """A quantity of an arm as the user wrote it; segments from base to tip."""
    if isinstance(value, str) or not isinstance(value, Sequence):
        return str(value)
    return " | ".join(map(str, value))
