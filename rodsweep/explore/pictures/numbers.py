"""The table of numbers: what the solvers found, to eight digits, with units."""

from html import escape
from typing import Any

import numpy as np
from bokeh.models import Div

ROWS = {
    "spectrum": {
        "growth_rate": "growth rate", "growth_rate_si": "growth rate", "frequency": "frequency",
        "frequency_hz": "frequency", "unstable_count": "unstable modes",
    },
    "cycle": {
        "period": "period", "period_si": "period", "tip_y_max": "amplitude",
        "tip_y_max_si": "amplitude", "tip_theta_max": "tip angle", "injection_mean": "power of the force",
        "injection_mean_si": "power of the force", "dissipation_mean": "power lost to the fluid",
        "dissipation_mean_si": "power lost to the fluid", "energy_imbalance": "energy imbalance",
        "multiplier": "largest multiplier", "least_stretch": "least stretch h1",
    },
    "thresholds": {
        "F_onset": "F*", "pressure_onset": "oscillates from", "F_hopf": "F**", "hopf_frequency": "frequency at F**",
        "pressure_hopf": "flutters from", "frequency_hopf_hz": "frequency at flutter",
    },
}  # fmt: skip
"""Rows of the table: meaning by variable, for each kind of question."""
HEADINGS = {"spectrum": "Leading mode", "cycle": "Cycle", "thresholds": "Thresholds"}
DIGITS = 8


class NumbersTable:
    """Numbers of the latest answers."""

    def __init__(self) -> None:
        self.root = Div(name="numbers", sizing_mode="stretch_width", css_classes=["numbers"])
        self.found: dict[str, dict[str, Any]] = {}

    def show(self, kind: str, found: dict[str, Any] | None) -> None:
        """Fills the rows of a kind of question; empties them for None."""
        if kind not in ROWS:
            return
        if found is None:
            self.found.pop(kind, None)
        else:
            self.found[kind] = found
        parts = [_rows(name, self.found[name]) for name in ROWS if name in self.found]
        self.root.text = f"<table>{''.join(parts)}</table>"


def written(value: Any) -> str:
    """A number as the table shows it: the first of an array, "" if it is not finite."""
    first = np.ravel(value)[0]
    if np.issubdtype(np.asarray(first).dtype, np.integer):
        return str(int(first))
    return f"{float(first):.{DIGITS}g}" if np.isfinite(first) else ""


def _rows(kind: str, found: dict[str, Any]) -> str:
    units = found["units"]
    rows = [
        f'<tr data-name="{name}"><td>{escape(meaning)}</td><td>{text}</td>'
        f"<td>{escape(units[name] if units[name] != '1' else '')}</td></tr>"
        for name, meaning in ROWS[kind].items()
        if name in found and (text := written(found[name]))
    ]
    return f'<tr><th colspan="3">{HEADINGS[kind]}</th></tr>{"".join(rows)}'
