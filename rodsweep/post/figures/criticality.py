"""On which side of its Hopf points a rod's cycles are born, and how fast they grow: a map, or a line."""

from math import floor, log10

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from ...arrays import Array
from ...results.file.view import View
from . import style
from .cycle.maps import label_maps, map_panels
from .cycle.point_map import PointMap, cell_edges, is_map, point_map, varied_parameters
from .layout.fitting import MAP_ASPECT
from .request import FigureRequest
from .stability.normal_forms import draw_predictions

MARKS = {
    -1: ("supercritical", style.FIRST, "o"),
    1: ("subcritical", style.SECOND, "s"),
    0: ("undecided", "0.3", "x"),
}
"""Word, colour and marker of a Hopf point, by its criticality."""
CLASSES = (
    ("no Hopf point with a normal form", "#DDDDDD"),
    ("supercritical", "#9CC3E4"),
    ("supercritical, a later one subcritical", "#4C8FC4"),
    ("subcritical", style.SECOND),
    ("undecided", "0.4"),
)
"""What a rod's first Hopf point is, and its colour: told apart by all, and in grey."""
FEW = 0.1
"""Share of the Hopf points whose |Re c| is on the linear part of an axis that has both signs."""


def draw_criticality(request: FigureRequest) -> str:
    """First Hopf points over two parameters; a and Re c of all over one; else the cycles predicted."""
    view = request.only_view()
    style.need(view, np.isfinite(view.variables["criticality"]).any(), "Hopf point with a normal form")
    varied = varied_parameters(view)
    if len(varied) == 1 and np.isfinite(np.unique(view.point_columns[varied[0]])).sum() > 1:
        return request.write(_along(view, varied[0]), f"the normal forms of Hopf points along {varied[0]}")
    if not is_map(view):
        return request.write(*draw_predictions(view))
    points = point_map(view)
    shown = f"the normal form of the first Hopf point over {' and '.join(points.names)}{points.left_out}"
    return request.write(_map(view, points, request.look.narrow), shown, MAP_ASPECT)


def _along(view: View, name: str) -> Figure:
    """a above Re c against one parameter, each Hopf point marked by its criticality."""
    x = view.point_columns[name]
    keep = np.isfinite(x)
    figure = Figure(figsize=(5.6, 5.4), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True)
    side, a, c = (view.by_point(key)[keep] for key in ("criticality", "amplitude_coefficient", "landau_real"))
    style.need(view, np.isfinite(c).any(), f"Hopf point with a finite {name}")
    lower.set_yscale("symlog", linthresh=10.0 ** floor(log10(float(np.nanquantile(np.abs(c), FEW)))))
    for axes, values in ((upper, a), (lower, c)):
        handles = _mark(axes, x[keep], values, side)
        axes.axhline(0, color="0.6", lw=0.8, zorder=0)
        style.scale(axes, "x", np.sort(x[keep]))
    upper.set_ylabel("amplitude coefficient $a/L$")
    lower.set(ylabel=r"$\mathrm{Re}\,c$ in $1/(\tau_2 L^2)$", xlabel=style.LABELS[name])
    style.legend_below(figure, handles, columns=3)
    figure.suptitle(style.heading(view, style.fixed_text(view, name)))
    return figure


def _mark(axes: Axes, x: Array, values: Array, side: Array) -> list[Line2D]:
    """Marks every Hopf point, x of the shape (rods,), the others (rods, crossings); what the legend says."""
    across = np.broadcast_to(x[:, None], values.shape)
    handles = []
    for number, (word, colour, marker) in MARKS.items():
        there = side == number
        if there.any():
            (drawn,) = axes.plot(across[there], values[there], marker, color=colour, ms=3.5, label=word)
            handles.append(drawn)
    return handles


def _map(view: View, points: PointMap, narrow: bool) -> Figure:
    """The criticality of the first Hopf points, and how fast their cycles grow.

    narrow: whether the two maps have no room beside each other.
    """
    side = view.by_point("criticality")[points.at]
    a = np.abs(view.by_point("amplitude_coefficient")[:, 0][points.at])
    style.need(view, np.isfinite(a).any(), "first Hopf point with a normal form")
    figure, panels = map_panels(2, narrow)
    edges = cell_edges(points.x), cell_edges(points.y)
    classes = _classes(side)
    norm = BoundaryNorm(np.arange(len(CLASSES) + 1) - 0.5, len(CLASSES))
    colours = ListedColormap([colour for _, colour in CLASSES])
    panels[0].pcolormesh(*edges, classes, cmap=colours, norm=norm, rasterized=True)
    style.colour_cells(panels[1], edges, a, "amplitude coefficient $|a|/L$")
    panels[1].set_facecolor(CLASSES[0][1])
    label_maps(panels, points)
    there = [Patch(facecolor=c, label=word) for i, (word, c) in enumerate(CLASSES) if (classes == i).any()]
    style.legend_below(figure, there, columns=3)
    figure.suptitle(style.heading(view, style.parameter_text(points.shared)))
    return figure


def _classes(side: Array) -> Array:
    """The place in CLASSES of every rod from the criticality of its Hopf points, (ny, nx, crossings)."""
    first, later = side[..., 0], (side[..., 1:] == 1).any(axis=-1)
    classes = np.select([first == -1, first == 1, first == 0], [1.0, 3.0, 4.0], 0.0)
    return np.where((first == -1) & later, 2.0, classes)
