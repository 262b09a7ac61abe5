"""Symbols of the curves of a phase diagram: on which part of which curve they stand."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.text import Annotation

from ....arrays import Array

CHORD_ROUNDING = 1e-6
"""Relative tolerance for the rounding error of the position of a vertex on a chord of its curve."""
LABEL_FONTSIZE = 8
"""Font size of a curve's symbol, in points."""
OTHER_LABEL_POSITIONS = (0.5, 0.3, 0.7, 0.9)
"""Fractions of the visible length at which a symbol is placed if it would overlap another symbol at its own
position, in order of preference."""
LABEL_BOX_FACTOR = 1.5
"""Factor by which the boxes of two symbols are enlarged before they are compared."""


def parts_at_lowest_force(paths: list[Array], force: int) -> list[Array]:
    """Parts of the curves `paths`, (n, 2) each, that have the smallest F of all curves. force: index of the
    column with F."""
    starts = np.concatenate([path[:-1] for path in paths])
    ends = np.concatenate([path[1:] for path in paths])
    y0 = starts[:, 1 - force]
    y1 = ends[:, 1 - force]
    parts = []
    for path in paths:
        y = path[:, 1 - force, None]
        edge_fraction = (y - y0) / np.where(y1 == y0, np.inf, y1 - y0)
        crosses = (np.minimum(y0, y1) <= y) & (y <= np.maximum(y0, y1))
        forces = starts[:, force] + edge_fraction * (ends[:, force] - starts[:, force])
        lowest = np.where(crosses, forces, np.inf).min(axis=1, initial=np.inf)
        parts.append(path[path[:, force] <= lowest * (1 + CHORD_ROUNDING)])
    return parts


def label_longest_curve(axes: Axes, paths: list[Array], name: str, length_fraction: float) -> None:
    """Writes the symbol `name` next to the path with the greatest visible length, at the fraction
    `length_fraction` of this length. paths: curves, (points, 2) each."""
    lengths = []
    seen = []
    for path in paths:
        places = axes.transAxes.inverted().transform(axes.transData.transform(path))
        is_inside = ((places >= 0) & (places <= 1)).all(axis=1)
        steps = np.linalg.norm(np.diff(places[is_inside], axis=0), axis=1)
        seen.append(path[is_inside])
        lengths.append(np.append(0.0, np.cumsum(steps)) if is_inside.any() else np.zeros(1))
    longest_index = max(range(len(paths)), key=lambda i: lengths[i][-1])
    if not lengths[longest_index][-1] > 0:
        return
    other_labels = [child for child in axes.get_children() if isinstance(child, Annotation)]
    for fraction in (length_fraction, *OTHER_LABEL_POSITIONS):
        vertex_index = int(np.searchsorted(lengths[longest_index], fraction * lengths[longest_index][-1]))
        place: dict[str, Any] = {"xytext": (4, -2), "textcoords": "offset points"}
        label = axes.annotate(name, seen[longest_index][vertex_index], size=LABEL_FONTSIZE, va="top", **place)
        if not any(_do_overlap(label, other) for other in other_labels):
            return
        label.remove()
    axes.annotate(name, seen[longest_index][0], size=LABEL_FONTSIZE, va="top", **place)


def _do_overlap(label: Annotation, other: Annotation) -> bool:
    """Whether two labels overlap, with a margin of half of their size, because panels shrink later."""
    first_box, second_box = (
        annotation.get_window_extent().expanded(LABEL_BOX_FACTOR, LABEL_BOX_FACTOR)
        for annotation in (label, other)
    )
    return bool(first_box.overlaps(second_box))
