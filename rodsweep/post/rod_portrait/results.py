"""What a portrait is drawn from: the results of one rod, and the reasons where a result is missing."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from ...results.file.view import View


@dataclass(frozen=True, slots=True, kw_only=True)
class DescribedRod:
    """A rod as a user describes it.

    parameters: values by name. material: section `material` of a config, empty for a uniform rod of linear
    material. scales: SI values of the units of the rod, `ARM_UNITS`, by name; empty for a rod without.
    """

    parameters: Mapping[str, float]
    material: Mapping[str, Any] = field(default_factory=dict)
    scales: Mapping[str, float] = field(default_factory=dict)

    @property
    def words(self) -> str:
        """The parameters but F, and the material."""
        words = [f"{name} = {value:g}" for name, value in self.parameters.items() if name != "F"]
        words += [f"{name} {self.material[name]}" for name in ("law", "section") if name in self.material]
        words += ["a profile along its length"] if "profile" in self.material else []
        return ", ".join(words)


@dataclass(frozen=True, slots=True, kw_only=True)
class RodResults:
    """Results of one rod, each a view of a single point.

    F_max: largest requested force. views: thresholds, and criticality and branch unless missing. modes:
    (force, modes there) at the first thresholds, by kind. cycles: (force, limit cycle there), increasing.
    missing: for every task without a result, the reason in a sentence.
    """

    rod: DescribedRod
    F_max: float
    views: Mapping[str, View]
    modes: Mapping[str, tuple[float, View]]
    cycles: Sequence[tuple[float, View]]
    missing: Mapping[str, str]

    @property
    def branch(self) -> View | None:
        """Branches of cycles; None if they are missing."""
        return self.views.get("branch")
