"""Table of numbers from the latest answers, with eight digits and units."""

from html import escape
from typing import Any

import numpy as np

from ...post.summary.arm.validity_sentences import validity_caveat
from ..templates_and_texts import PageText

ROW_LABELS_BY_KIND = {
    "spectrum": {
        "growth_rate": "growth rate", "growth_rate_si": "growth rate", "frequency": "frequency",
        "frequency_hz": "frequency", "unstable_count": "unstable modes",
    },
    "cycle": {
        "period": "period", "period_si": "period", "tip_y_max": "amplitude",
        "tip_y_max_si": "amplitude", "tip_theta_max": "largest tip angle",
        "injection_mean": "power of the force", "injection_mean_si": "power of the force",
        "dissipation_mean": "power lost to the fluid",
        "dissipation_mean_si": "power lost to the fluid", "energy_imbalance": "energy imbalance",
        "multiplier": "largest |multiplier|", "least_stretch": "smallest stretch h1",
    },
    "thresholds": {
        "F_onset": "oscillates from F*", "pressure_onset": "oscillates from", "F_hopf": "flutters from F**",
        "hopf_frequency": "frequency at F**",
        "F_restabilization": "stable again from", "pressure_restabilization": "stable again from",
        "pressure_hopf": "flutters from", "frequency_hopf_hz": "frequency at flutter",
    },
}  # fmt: skip
"""Rows of the table for each kind of request: label of each variable."""
HEADINGS_BY_KIND = {"spectrum": "Leading mode", "cycle": "Cycle", "thresholds": "Thresholds"}
"""Heading above the rows of each kind of request."""
TABLE_DIGITS = 8
"""Number of significant digits in the table."""
TABLE_UNIT_BY_SI_UNIT = {"m": ("cm", 1e2), "Pa": ("kPa", 1e-3), "W": ("mW", 1e3)}
"""(unit shown in the table, conversion factor), by SI unit."""
SI_VARIABLE_BY_DIMENSIONLESS_NAME = {
    "growth_rate": "growth_rate_si", "frequency": "frequency_hz",
    "crossing_frequency": "crossing_frequency_hz", "F_onset": "pressure_onset",
    "F_hopf": "pressure_hopf",
    "F_restabilization": "pressure_restabilization", "hopf_frequency": "frequency_hopf_hz",
}  # fmt: skip
"""Name of the variable in SI units, by name of the dimensionless variable. For other variables the suffix
`_si` is appended."""


class NumbersTable:
    """Table of numbers from the latest answer to each kind of request, below sentences on the validity of the
    model for an arm, unless the model applies."""

    def __init__(self) -> None:
        self.root = PageText(name="numbers")
        self.answers_by_kind: dict[str, dict[str, Any]] = {}
        """Latest answer to each kind of request in the table."""

    def show(self, kind: str, answer: dict[str, Any] | None) -> None:
        """Replaces the rows for the kind of request `kind` by numbers of the answer `answer`; None removes
        these rows. A kind that is not in ROW_LABELS_BY_KIND has no effect."""
        if kind not in ROW_LABELS_BY_KIND:
            return
        if answer is None:
            self.answers_by_kind.pop(kind, None)
        else:
            self.answers_by_kind[kind] = answer
        tables = [
            _table_rows(name, self.answers_by_kind[name])
            for name in ROW_LABELS_BY_KIND
            if name in self.answers_by_kind
        ]
        caveats = dict.fromkeys(map(validity_caveat, self.answers_by_kind.values()))
        sentences = "".join(f'<p class="caveat">{escape(caveat)}</p>' for caveat in caveats if caveat)
        self.root.text = f"{sentences}<table>{''.join(tables)}</table>"


def first_element_text(value: Any, factor: float = 1.0) -> str:
    """First element of the array `value` as text: a real number times `factor`, or an integer; "" for a
    nonfinite number or a negative integer."""
    number = np.ravel(value)[0]
    if np.issubdtype(np.asarray(number).dtype, np.integer):
        return str(int(number)) if number >= 0 else ""
    return f"{factor * float(number):.{TABLE_DIGITS}g}" if np.isfinite(number) else ""


def _table_rows(kind: str, answer: dict[str, Any]) -> str:
    row_texts = []
    for name, meaning in ROW_LABELS_BY_KIND[kind].items():
        if name not in answer or SI_VARIABLE_BY_DIMENSIONLESS_NAME.get(name, f"{name}_si") in answer:
            continue
        unit, factor = TABLE_UNIT_BY_SI_UNIT.get(answer["units"][name], (answer["units"][name], 1.0))
        if text := first_element_text(answer[name], factor):
            unit_text = "" if unit == "1" else escape(unit)
            row_texts.append(
                f'<tr data-name="{name}"><td>{escape(meaning)}</td><td>{text}</td><td>{unit_text}</td></tr>'
            )
    if not row_texts:
        return ""
    heading = HEADINGS_BY_KIND[kind]
    return f'<tbody class="{kind}"><tr><th colspan="3">{heading}</th></tr>{"".join(row_texts)}</tbody>'
