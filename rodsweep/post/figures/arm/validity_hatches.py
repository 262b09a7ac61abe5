"""Hatches where the model does not apply and dots where it is doubtful, with notes, in figures of an arm over
dimensionless parameters."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from ....arrays import Array
from ....model.arm.neglected import COMPRESSION_LIMIT, Validity
from ....results.file.view import ResultView
from ..cells import cell_edges, fill_cells
from ..style import AXIS_LABELS

VALIDITY_HATCHES = {Validity.does_not_apply: "////", Validity.doubtful: "..."}
"""Hatches of points by validity of the model; other points have none."""
COMPRESSION_HATCH = r"\\\\"
"""Hatch of the part of a phase diagram in which the load compresses the arm beyond the limit of the model."""
HATCH_LOOK: dict[str, Any] = {"fc": "none", "ec": "0.6"}
"""Matplotlib style of all hatches."""
VALIDITY_NOTES = {
    Validity.does_not_apply: ("hatched", "the model does not apply"),
    Validity.doubtful: ("dotted", "the model is doubtful"),
}
"""(word for the hatches, sentence) by validity of the model, for the title."""


def hatch_invalid_points(figure: Figure, views: Sequence[ResultView]) -> None:
    """Hatches a figure where the model does not apply to the arm, and dots it where the model is doubtful, if
    the axes are parameters of the file; adds notes to the title. Without such points, the figure is
    unchanged."""
    validities = [view.variables["model_applies"] for view in views if "model_applies" in view.variables]
    notes = [_hatch_and_note(figure, views, validities, validity) for validity in VALIDITY_HATCHES]
    figure.suptitle("\n".join(filter(None, (figure.get_suptitle(), *notes))))


def _hatch_and_note(
    figure: Figure, views: Sequence[ResultView], validities: Sequence[np.ndarray], validity: Validity
) -> str:
    """Hatches the points of a figure at which the model has the validity `validity`, and returns the note for
    the title; empty if there is no such point. views: results in the figure. validities: validity of the
    model at all points of each result."""
    outside = [np.asarray(values == validity) for values in validities]
    number, count = (sum(map(counting, outside)) for counting in (np.count_nonzero, np.size))
    if not number:
        return ""
    is_alone = len(views) == 1 and views[0].is_grid  # not a list, nor the rows of a diagram
    values = views[0].parameter_values
    names = [name for name in views[0].parameters if is_alone and len(values[name]) > 1]
    word, sentence = VALIDITY_NOTES[validity]
    if names and _hatch_points(figure, views[0], names, outside[0], VALIDITY_HATCHES[validity]):
        judged_clause = ", judged at each row's first Hopf point or at rest"
        return f"{word}: {sentence}{judged_clause if 'crossing_at' in views[0].variables else ''}"
    return sentence if number == count else f"{sentence} at {number} of {count} points"


def _hatch_points(
    figure: Figure, view: ResultView, names: list[str], outside: np.ndarray, hatch: str
) -> bool:
    """Hatches the cells of points in the mask `outside`, in all panels whose axes are the one or two
    parameters `names`; returns whether any panel has these axes."""
    labels = [AXIS_LABELS[name] for name in names]
    edges = [cell_edges(view.parameter_values[name]) for name in names]
    cells = np.squeeze(outside)
    is_hatched = False
    for axes in list(figure.axes):
        x_label, y_label = (_axis_label(axes, letter) for letter in "xy")
        look = HATCH_LOOK | {"hatch": hatch}
        if labels == [x_label, y_label]:
            fill_cells(axes, (edges[0], edges[1]), cells.T, zorder=3, **look)
        elif labels == [x_label]:
            fill_cells(axes, (edges[0], np.array(axes.get_ylim())), cells[None], zorder=0, **look)
        elif labels == [y_label]:
            fill_cells(axes, (np.array(axes.get_xlim()), edges[0]), cells[:, None], zorder=3, **look)
        else:
            continue
        is_hatched = True
    return is_hatched


def hatch_compressed(axes: Axes, view: ResultView, ratio: Array, x: Array, y: Array) -> list[Patch]:
    """Hatches the part of a phase diagram of arms in which the load compresses the arm beyond the limit of
    the model; returns a list with the legend entry, empty for rods, for rubber and for smaller loads.

    ratio: force divided by the force that crushes the arm, at x and y, (pixels, pixels); 0 for rubber, whose
    law includes large compression. x, y: coordinates, (pixels,).
    """
    if not view.quantities or not ratio.max() > COMPRESSION_LIMIT:
        return []
    levels = [COMPRESSION_LIMIT, max(float(ratio.max()), 2 * COMPRESSION_LIMIT)]
    hatched = axes.contourf(x, y, ratio, levels=levels, colors="none", hatches=[COMPRESSION_HATCH])
    hatched.set(edgecolor=HATCH_LOOK["ec"], linewidth=0)
    keywords = HATCH_LOOK | {"hatch": COMPRESSION_HATCH}
    return [Patch(label="compression beyond its limit", lw=0, **keywords)]


def _axis_label(axes: Axes, letter: str) -> str:
    """Label of an axis, from the panel itself or from a panel that shares the axis. letter: "x" or "y"."""
    shared_axes = axes.get_shared_x_axes() if letter == "x" else axes.get_shared_y_axes()
    labels = [getattr(panel, f"get_{letter}label")() for panel in (axes, *shared_axes.get_siblings(axes))]
    return next(filter(None, labels), "")
