"""Cycles predicted by normal forms near the Hopf points of rods: y = |a| sqrt(|F/F_H - 1|)."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ....arrays import Array
from ....results.file.view import View
from .. import style
from ..cycle.selection import shared_and_own_of_points

FARTHEST_DRAWN = 0.1
"""Largest |F/F_H - 1| of a drawn prediction; farther away cycles depart from the leading-order law."""
LINES = {-1: ("-", "supercritical"), 1: ("--", "subcritical"), 0: (":", "side undecided")}
"""Line style and word of the cycles of a Hopf point, by criticality."""
COLOURS = (style.FIRST, style.SECOND, style.THIRD, "#CC79A7", "#56B4E9", "#000000")
"""Colours of the rods, in order."""
PREDICTION_POINTS = 60
"""Number of points of a drawn prediction, dense near the Hopf point, where the curve is steep."""


def draw_predictions(view: View) -> tuple[Figure, str]:
    """Figure of the predicted amplitudes near every Hopf point, for the first rods; and a description."""
    kinds, F, a = map(view.by_point, ("criticality", "crossing_F", "amplitude_coefficient"))
    having = np.flatnonzero((np.isfinite(kinds) & np.isfinite(a)).any(axis=1))
    style.require(view, having.size, "Hopf point with a normal form")
    drawn = having[: len(COLOURS)]
    figure = Figure(figsize=(5.6, 3.8), layout="constrained")
    axes = figure.subplots()
    shared, own = shared_and_own_of_points(view, [int(rod) + 1 for rod in drawn])
    for rod, colour in zip(drawn, COLOURS, strict=False):
        for kind, at, size in zip(kinds[rod], F[rod], a[rod], strict=True):
            if np.isfinite(kind) and np.isfinite(size):
                axes.plot(*_law(at, size), LINES[int(kind)][0], color=colour, lw=1.4)
                axes.plot(at, 0, "o", color=colour, ms=4, clip_on=False, zorder=3)
    axes.axhline(0, color="0.8", lw=0.6, zorder=0)
    axes.set(xlabel=style.LABELS["F"], ylabel="predicted largest $y/L$ of the tip")
    axes.set_ylim(bottom=0)
    seen = {int(kind) for kind in kinds[drawn].ravel() if np.isfinite(kind)}
    handles = [
        Line2D([], [], color="0.3", ls=line, label=word) for k, (line, word) in LINES.items() if k in seen
    ]
    handles.append(Line2D([], [], color="0.3", marker="o", ms=4, ls="", label="Hopf point"))
    pairs = zip(COLOURS, own, strict=False)
    handles += [Line2D([], [], color=colour, lw=2, label=text) for colour, text in pairs if text]
    style.legend_below(figure, handles, columns=3)
    figure.suptitle(style.heading(view, shared))
    left_out = (
        f", of the first {len(drawn)} of {having.size} rods with Hopf points"
        if len(drawn) < having.size
        else ""
    )
    return (
        figure,
        f"the cycles that normal forms predict within {FARTHEST_DRAWN:.0%} of every Hopf point{left_out}",
    )


def _law(at: float, a: float) -> tuple[Array, Array]:
    """(F, largest y) on the side of a Hopf point with cycles: above it for a > 0, below it for a < 0."""
    distance = FARTHEST_DRAWN * np.linspace(0, 1, PREDICTION_POINTS) ** 2
    return at * (1 + np.sign(a) * distance), abs(a) * np.sqrt(distance)
