"""Colours and legend entries of the stability classes of the straight rod, and of the stable states."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.patches import Patch

from ....arrays import Array
from ....results.layouts.phase_diagram import STABILITY_CLASSES, STABLE_STATES

CLASS_COLOURS = {
    "missing": "white",
    "monotone": "#DCE9F5",
    "oscillatory": "#9CC3E4",
    "flutter": "#F2B28A",
    "undecided": "#666666",
    "crushed": "#BBBBBB",
    "not stored": "#F3F3F3",
}
"""Colours of the classes: blue for stable rods, orange for unstable rods. The colours also differ in grey
prints. Bars of single rods are "not stored" beyond a full list of crossings."""
STATE_COLOURS = {
    "missing": "white",
    "neither_known": "#F6E3A1",
    "straight": CLASS_COLOURS["oscillatory"],
    "cycle": CLASS_COLOURS["flutter"],
    "both": "#8E6BB0",
    "undecided": CLASS_COLOURS["undecided"],
    "crushed": CLASS_COLOURS["crushed"],
}
"""Colours of the words of `stable_states`. The colour of "both" lies between the colours of the two
states."""
LEGEND_ENTRIES = {
    "missing": "not computed",
    "monotone": "monotone decay",
    "oscillatory": "oscillatory decay",
    "straight": "only straight rod stable",
    "cycle": "only cycle stable",
    "both": "rod and cycle stable",
    "neither_known": "no stable state known",
}
"""Legend entries for the words of `stable_states` and `class`. A word that is not listed is its own legend
entry."""


def class_legend_entries(drawn_classes: set[str]) -> list[Patch]:
    """Legend entries for the classes in `drawn_classes`."""
    return _legend_entries([word for word in CLASS_COLOURS if word in drawn_classes], CLASS_COLOURS)


def _legend_entries(words: Sequence[str], colours: Mapping[str, str]) -> list[Patch]:
    look: dict[str, Any] = {"edgecolor": "0.5", "lw": 0.5}
    return [Patch(facecolor=colours[word], label=LEGEND_ENTRIES.get(word, word), **look) for word in words]


@dataclass(frozen=True, slots=True)
class Palette:
    """Colours for a map of an integer variable. variable: name of the variable. words: (integer, word) of
    each value. colours: colour of each word."""

    variable: str
    words: tuple[tuple[int, str], ...]
    colours: dict[str, str]

    @property
    def colour_keywords(self) -> dict[str, Any]:
        """Keywords for matplotlib with which an array of the integers is drawn in the colours."""
        numbers = [number for number, _ in self.words]
        return {
            "cmap": ListedColormap([self.colours[word] for _, word in self.words]),
            "norm": BoundaryNorm(
                [*(number_of_word - 0.5 for number_of_word in numbers), numbers[-1] + 0.5], len(numbers)
            ),
        }

    def legend_entries(self, table: Array) -> list[Patch]:
        """Legend entries for the words whose integers occur in `table`, (rows, columns)."""
        return _legend_entries(
            [class_word for number, class_word in self.words if (table == number).any()], self.colours
        )


CLASS_PALETTE = Palette("class", STABILITY_CLASSES, CLASS_COLOURS)
"""Palette for the stability class of the straight rod."""
STATE_PALETTE = Palette("stable_states", STABLE_STATES, STATE_COLOURS)
"""Palette for the stable states listed in STABLE_STATES."""
