"""How far beyond the range branches of cycles are followed, and what is missed, in `rodsweep show`."""

import numpy as np

from ...results.file.view import View
from .number_texts import span_text

MISSED_CYCLES_TEXT = (
    "cycles are missed if their branch comes from farther away, moves away from the range stable or with "
    "several multipliers outside the unit circle and comes back, or is connected to no Hopf point"
)
"""Clause on the cycles within the range that are not found."""


def followed_range_text(view: View, done: np.ndarray, along: str, prefix: str) -> str:
    """Sentence on the range in which branches are followed where they may enter the range of the file, and on
    the branches that are missed. done: mask of the computed points, (...,). along: parameter along which
    branches are followed. prefix: first part of the names of the two variables."""
    places = [view.variables[f"{prefix}{end}"][done] for end in ("from", "to")]
    if not all(np.isfinite(place).any() for place in places):
        return MISSED_CYCLES_TEXT
    low, high = map(span_text, places)
    followed = f"branches that may enter the range are followed down to {along} = {low} and up to {high}"
    return f"{followed}; {MISSED_CYCLES_TEXT}"
