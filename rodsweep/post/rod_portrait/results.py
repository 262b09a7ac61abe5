"""Results of one rod for its portrait, and the reasons for missing results."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from ...results.file.view import ResultView
from ..branch_curves import RodBranches
from .portrait_units import PortraitUnits, portrait_units


@dataclass(frozen=True, slots=True, kw_only=True)
class DescribedRod:
    """Description of a rod or an arm by the user."""

    parameters: Mapping[str, float] = field(default_factory=dict)
    """Parameters of the rod by name; for an arm, the parameters that replace parameters computed from the
    arm."""
    material: Mapping[str, Any] = field(default_factory=dict)
    """Section `material` of a config; empty for a uniform rod of linear material."""
    arm: Mapping[str, Any] = field(default_factory=dict)
    """Section `parameters.arm` of a config, without the load; empty for a rod."""
    load_kind: str = "pressure"
    """Kind of load on the arm: "pressure" or "force"."""

    @property
    def kind(self) -> str:
        """The word "rod" or "arm"."""
        return "arm" if self.arm else "rod"

    @property
    def description(self) -> str:
        """Description of the rod as text: quantities of an arm, parameters other than F, and material."""
        # A quantity as the user wrote it, or the values of all segments from base to tip.
        quantity_texts = [
            f"{name.replace('_', ' ')} {' | '.join(map(str, v)) if isinstance(v, list | tuple) else v}"
            for name, v in self.arm.items()
        ]
        quantity_texts += [f"{name} = {value:g}" for name, value in self.parameters.items() if name != "F"]
        quantity_texts += [
            f"{key} {self.material[key]}" for key in ("law", "section") if key in self.material
        ]
        quantity_texts += ["a profile along its length"] if "profile" in self.material else []
        return ", ".join(quantity_texts)


@dataclass(frozen=True, slots=True, kw_only=True)
class RodResults:
    """Results of several tasks for one rod; each view has a single point."""

    rod: DescribedRod
    F_max: float
    """Requested largest force of the searches, in k3/L^2."""
    views: Mapping[str, ResultView]
    """Results by task, for the tasks "thresholds", "criticality" and "branch"; a missing result has no
    entry."""
    modes_at_first_thresholds: Mapping[str, tuple[float, ResultView]]
    """(force, modes at this force) at the first threshold of a kind, by kind of threshold."""
    cycles: Sequence[tuple[float, ResultView]]
    """(force, limit cycle at this force), in increasing order of the force."""
    missing_result_reasons: Mapping[str, str]
    """Reason, as a sentence, for every task of which a result is missing, by task."""

    @property
    def units(self) -> PortraitUnits:
        """Units of the portrait, with prefixes suitable for the largest force of the search."""
        view = self.views["thresholds"]
        return portrait_units(view, self.rod.load_kind, float(view.variables["F_end"].ravel()[0]))

    @property
    def branches(self) -> RodBranches | None:
        """Branches of cycles of the rod; None if the result "branch" is missing."""
        return RodBranches(self.views["branch"]) if "branch" in self.views else None
