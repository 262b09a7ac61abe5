"""The numbers of each task that are drawn over an arm's own quantities, in the units that were typed."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from ....arrays import Array
from ....results.file.view import View
from .quantities import in_typed


@dataclass(frozen=True, slots=True)
class Panel:
    """A number at every point in some unit.

    lines: what is drawn of it over one axis, by what the legend says, where that is more than the values.
    turns: what the legend says of the line of a map where the number is 0; empty where it has none.
    """

    label: str
    values: Array
    lines: Mapping[str, Array] = field(default_factory=dict)
    turns: str = ""
    of_lines: str = ""
    """The label where several lines are drawn, if it is another one."""
    without: str = "nothing computed"
    """What the legend says of arms that have no number."""


def _of_thresholds(view: View) -> list[Panel]:
    load, si, typed = ("force", "N", "force") if "force" in view.quantities else ("pressure", "Pa", "young")
    lines = {}
    for event in ("hopf", "onset", "restabilization"):
        lines[EVENTS[event]], unit = in_typed(view, typed, view.variables[f"{load}_{event}"], si)
    flutter = lines[EVENTS["hopf"]]
    return [
        Panel(
            f"{load} at flutter ({unit})", flutter, lines, of_lines=f"{load} ({unit})", without="no flutter"
        ),
        Panel("frequency at flutter (Hz)", view.variables["frequency_hopf_hz"], without="no flutter"),
    ]


EVENTS = {"hopf": "flutter", "onset": "onset of oscillations", "restabilization": "return"}
"""What thresholds are called."""


def _of_modes(view: View) -> list[Panel]:
    return [
        Panel("growth rate (1/s)", view.variables["growth_rate_si"][..., 0], turns="growth rate 0"),
        Panel("frequency (Hz)", np.abs(view.variables["frequency_hz"][..., 0])),
    ]


def _of_cycles(view: View) -> list[Panel]:
    amplitude, unit = in_typed(view, "length", view.variables["tip_y_max_si"])
    return [
        Panel("frequency (Hz)", view.variables["frequency_hz"], without="no cycle"),
        Panel(f"largest deflection of the tip ({unit})", amplitude, without="no cycle"),
    ]


PANELS: dict[str, Callable[[View], list[Panel]]] = {
    "thresholds": _of_thresholds,
    "spectrum": _of_modes,
    "modes": _of_modes,
    "limit_cycle": _of_cycles,
}
"""What is drawn of each task; other tasks are drawn as lists of points."""
