"""Class of the rod along a row of a phase diagram, between the changes of the row."""

import numpy as np
from numpy.typing import NDArray

from ....arrays import Array
from ....model.parameters import CRUSHING
from ....results.file.view import View
from ....results.layouts.phase_diagram import CLASSES, STABLE_STATES
from ....results.layouts.thresholds import CROSSING_KINDS
from ....results.layouts.variables import has_covering
from .class_bars import classes_between_crossings

UNDECIDED = {
    "class": next(number for number, word in CLASSES if word == "undecided"),
    "stable_states": next(number for number, word in STABLE_STATES if word == "undecided"),
}
"""Number of the word `undecided` in each variable."""
STABILITY_CROSSINGS = [CROSSING_KINDS.index(kind) for kind in ("hopf", "hopf_reverse", "restabilization")]
"""Kinds of crossings at which the stability of the straight rod may change."""

ON_A_CHANGE = 1e-9
"""Relative distance from a change below which a point lies on the change and belongs to neither side."""


def class_along_row(
    view: View, variable: str, line: str, row: str, place: int, edges: Array
) -> NDArray[np.intp]:
    """Class of each pixel of a row, (n,), between the edges, (n + 1,); place: number of the row.

    variable: `class` or `stable_states`. A pixel takes the class of the nearest computed point between the
    same two changes of the row; without a point between the changes it is undecided.
    """
    x = view.variables[line]
    classes = view.by_point(variable)[place]
    changes = _changes(view, variable, line, place)
    if variable == "class":
        between, rows, found = classes_between_crossings(view, row)
        own = rows == view.axes[row][place]
        x = np.append(x, between[own])
        classes = np.append(classes, found[own])
    decided = np.abs(x[:, None] - changes).min(axis=1, initial=np.inf) > ON_A_CHANGE * np.abs(x)
    pixels = (edges[1:] + edges[:-1]) / 2
    piece_of_pixels = np.searchsorted(changes, pixels)
    piece_of_points = np.searchsorted(changes, x)
    found = np.full(len(pixels), UNDECIDED[variable], dtype=np.intp)
    for piece in np.unique(piece_of_pixels):
        own_pixels = piece_of_pixels == piece
        own_points = decided & (piece_of_points == piece)
        if own_points.any():
            nearest = np.abs(x[own_points] - pixels[own_pixels][:, None]).argmin(axis=1)
            found[own_pixels] = classes[own_points][nearest]
    return found


def _changes(view: View, variable: str, line: str, place: int) -> Array:
    """Positions of the changes of a row, increasing, (m,)."""
    v = {
        name: view.variables[name].reshape(view.variables["status"].size, -1)[place]
        for name in _names(view, line)
    }
    at = v["crossing_at"]
    kinds = v["crossing_kind"]
    if variable == "class":
        found = [at[kinds > 0]]
    else:
        found = [at[np.isin(kinds, STABILITY_CROSSINGS)], v[f"cycle_special_{line}"]]
    if line in CRUSHING and has_covering(view.config):  # elsewhere, or never, where arms vary
        (other,) = set(CRUSHING) - {line}
        found.append(view.point_columns[other][[place]])
    changes = np.concatenate(found)
    return np.unique(changes[np.isfinite(changes)])


def _names(view: View, line: str) -> list[str]:
    """Variables with the changes of a row."""
    names = ("crossing_at", "crossing_kind", f"cycle_special_{line}")
    return [name for name in names if name in view.variables]
