"""What the rod does along a row of a phase diagram, bounded by the row's own changes."""

import numpy as np
from numpy.typing import NDArray

from ....arrays import Array
from ....model.parameters import CRUSHING
from ....results.file.view import View
from ....results.layouts.phase_diagram import CLASSES, STABLE_STATES
from ....results.layouts.thresholds import CROSSING_KINDS
from .class_bars import classes_behind_crossings

UNDECIDED = {
    "class": next(number for number, word in CLASSES if word == "undecided"),
    "stable_states": next(number for number, word in STABLE_STATES if word == "undecided"),
}
"""The number of that word in either variable."""
OF_STABILITY = [CROSSING_KINDS.index(kind) for kind in ("hopf", "hopf_reverse", "restabilization")]
"""Crossings at which the straight rod's stability may change."""

SAME_PLACE = 1e-9
"""Relative distance from a change below which a point lies on it, and has the class of neither side."""


def class_along_row(
    view: View, variable: str, line: str, row: str, place: int, edges: Array
) -> NDArray[np.intp]:
    """The class of each pixel of a row, (n,), between the edges, (n + 1,); place: of the row among all.

    variable: `class` or `stable_states`. A pixel has the class of the nearest computed point between the same
    two changes of the row; where none lies between them it is undecided.
    """
    x = view.variables[line]
    classes = view.by_point(variable)[place]
    changes = _changes(view, variable, line, place)
    if variable == "class":
        behind, rows, found = classes_behind_crossings(view, row)
        own = rows == view.axes[row][place]
        x, classes = np.append(x, behind[own]), np.append(classes, found[own])
    decided = np.abs(x[:, None] - changes).min(axis=1, initial=np.inf) > SAME_PLACE * np.abs(x)
    pixels = (edges[1:] + edges[:-1]) / 2
    piece, piece_of_points = np.searchsorted(changes, pixels), np.searchsorted(changes, x)
    told = np.full(len(pixels), UNDECIDED[variable], dtype=np.intp)
    for number in np.unique(piece):
        here, there = piece == number, decided & (piece_of_points == number)
        if there.any():
            nearest = np.abs(x[there] - pixels[here][:, None]).argmin(axis=1)
            told[here] = classes[there][nearest]
    return told


def _changes(view: View, variable: str, line: str, place: int) -> Array:
    """Where the class of a row changes, in increasing order, (m,)."""
    v = {
        name: view.variables[name].reshape(view.variables["status"].size, -1)[place]
        for name in _names(view, line)
    }
    at, kinds = v["crossing_at"], v["crossing_kind"]
    if variable == "class":
        found = [at[kinds > 0]]
    else:
        found = [at[np.isin(kinds, OF_STABILITY)], v[f"cycle_special_{line}"]]
    if line in CRUSHING:
        (other,) = set(CRUSHING) - {line}
        found.append(view.point_columns[other][[place]])
    changes = np.concatenate(found)
    return np.unique(changes[np.isfinite(changes)])


def _names(view: View, line: str) -> list[str]:
    """The variables that say where a row changes."""
    names = ("crossing_at", "crossing_kind", f"cycle_special_{line}")
    return [name for name in names if name in view.variables]
