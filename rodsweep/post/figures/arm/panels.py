"""Results of each task that are drawn over the quantities of an arm, in the units typed by the user."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from ....arrays import Array
from ....results.file.view import ResultView
from .quantities import values_and_typed_unit

THRESHOLD_KIND_WORDS = {"hopf": "flutter", "onset": "onset of oscillations", "restabilization": "return"}
"""Word for each kind of threshold."""


@dataclass(frozen=True, slots=True)
class Panel:
    """Content of one panel. label: name and unit of the result. values: result at all points of the file, in
    the unit of the label. threshold_lines: several results that are drawn against one quantity in one panel,
    by legend entry; empty if only `values` are drawn. zero_contour_label: legend entry of the contour of zero
    in a map; empty if no contour is drawn."""

    label: str
    values: Array
    threshold_lines: Mapping[str, Array] = field(default_factory=dict)
    zero_contour_label: str = ""
    threshold_axis_label: str = ""
    """Label of the vertical axis if `threshold_lines` are drawn."""
    no_value_label: str = "nothing computed"
    """Legend entry for arms without a value."""


def _threshold_panels(view: ResultView) -> list[Panel]:
    """Panels of the task `thresholds`: load at flutter (as lines, also at onset of oscillation and
    restabilization), and frequency at flutter."""
    # A threshold pressure is shown in the unit in which the user typed Young's modulus.
    load = view.load_kind
    unit_of, si = ("force", "N") if load == "force" else ("young", "Pa")
    loads = {
        word: values_and_typed_unit(view, unit_of, view.variables[f"{load}_{kind}"], si)
        for kind, word in THRESHOLD_KIND_WORDS.items()
    }
    flutter, unit = loads["flutter"]
    lines = {word: values for word, (values, _) in loads.items()}
    label = f"{load} at flutter ({unit})"
    return [
        Panel(label, flutter, lines, threshold_axis_label=f"{load} ({unit})", no_value_label="no flutter"),
        Panel("frequency at flutter (Hz)", view.variables["frequency_hopf_hz"], no_value_label="no flutter"),
    ]


def _mode_panels(view: ResultView) -> list[Panel]:
    """Panels of the tasks `spectrum` and `modes`: growth rate and frequency of the leading mode."""
    rates, frequencies = (view.variables[name][..., 0] for name in ("growth_rate_si", "frequency_hz"))
    return [
        Panel("leading growth rate (1/s)", rates, zero_contour_label="growth rate 0"),
        Panel("leading frequency (Hz)", np.abs(frequencies)),
    ]


def _cycle_panels(view: ResultView) -> list[Panel]:
    """Panels of the task `limit_cycle`: frequency and amplitude of the cycle."""
    amplitude, unit = values_and_typed_unit(view, "length", view.variables["tip_y_max_si"])
    return [
        Panel("frequency of the cycle (Hz)", view.variables["frequency_hz"], no_value_label="no cycle"),
        Panel(f"largest deflection of the tip ({unit})", amplitude, no_value_label="no cycle"),
    ]


PANEL_MAKER_BY_TASK: dict[str, Callable[[ResultView], list[Panel]]] = {
    "thresholds": _threshold_panels,
    "spectrum": _mode_panels,
    "modes": _mode_panels,
    "limit_cycle": _cycle_panels,
}
"""For each task, the function that returns the panels. A task that is not listed has no figure over the
quantities of an arm."""
