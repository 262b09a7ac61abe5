"""Numbers of each task drawn over an arm's quantities, in the units typed by the user."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from ....arrays import Array
from ....results.file.view import View
from .quantities import in_typed_unit

EVENTS = {"hopf": "flutter", "onset": "onset of oscillations", "restabilization": "return"}
"""Words for the kinds of thresholds."""


@dataclass(frozen=True, slots=True)
class Panel:
    """A number at every point, with label and unit.

    lines: lines drawn over a single axis, by legend entry, if there are more than the values. zero_label:
    legend entry of the zero contour of a map; empty for no contour.
    """

    label: str
    values: Array
    lines: Mapping[str, Array] = field(default_factory=dict)
    zero_label: str = ""
    lines_label: str = ""
    """Label of the axis if several lines are drawn."""
    empty_label: str = "nothing computed"
    """Legend entry for arms without a number."""


def _of_thresholds(view: View) -> list[Panel]:
    """Load and frequency at flutter, with the loads at the onset of oscillations and at restabilization."""
    # A threshold pressure is shown in the unit in which the user typed Young's modulus.
    load, si, typed = ("force", "N", "force") if "force" in view.quantities else ("pressure", "Pa", "young")
    lines = {}
    for event in ("hopf", "onset", "restabilization"):
        lines[EVENTS[event]], unit = in_typed_unit(view, typed, view.variables[f"{load}_{event}"], si)
    flutter = lines[EVENTS["hopf"]]
    return [
        Panel(f"{load} at flutter ({unit})", flutter, lines, "", f"{load} ({unit})", "no flutter"),
        Panel("frequency at flutter (Hz)", view.variables["frequency_hopf_hz"], empty_label="no flutter"),
    ]


def _of_modes(view: View) -> list[Panel]:
    """Growth rate and frequency of the leading mode."""
    return [
        Panel("growth rate (1/s)", view.variables["growth_rate_si"][..., 0], zero_label="growth rate 0"),
        Panel("frequency (Hz)", np.abs(view.variables["frequency_hz"][..., 0])),
    ]


def _of_cycles(view: View) -> list[Panel]:
    """Frequency and amplitude of the limit cycle."""
    amplitude, unit = in_typed_unit(view, "length", view.variables["tip_y_max_si"])
    return [
        Panel("frequency (Hz)", view.variables["frequency_hz"], empty_label="no cycle"),
        Panel(f"largest deflection of the tip ({unit})", amplitude, empty_label="no cycle"),
    ]


PANELS: dict[str, Callable[[View], list[Panel]]] = {
    "thresholds": _of_thresholds,
    "spectrum": _of_modes,
    "modes": _of_modes,
    "limit_cycle": _of_cycles,
}
"""Panels of each task; other tasks are drawn as lists of points."""
