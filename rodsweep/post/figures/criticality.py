"""Criticality of the Hopf points of rods, and predicted amplitudes of cycles near Hopf points, as a map or as
lines."""

from math import floor, log10

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from ...arrays import Array
from ...results.file.view import ResultView
from ..summary.selection import varied_parameters_at_points
from . import style
from .arm.quantities import set_heading
from .cells import (
    PointGrid,
    draw_coloured_cells,
    label_maps,
    new_map_panels,
    point_grid,
    varies_two_parameters_on_grid,
)
from .cycle.selection import shared_and_own_texts_of_points
from .grid_slices import infinite_values_clause
from .layout.layout_fitting import MIN_MAP_ASPECT
from .request import FigureRequest

MAX_DRAWN_RELATIVE_HOPF_DISTANCE = 0.1
"""Predicted amplitudes are drawn up to this value of |F/F_H - 1| (F_H: Hopf point). At larger distances
cycles deviate from the leading-order law."""
PREDICTED_CYCLE_LOOKS = {
    -1: ("-", "supercritical"),
    1: ("--", "subcritical"),
    0: (":", "criticality undecided"),
}
"""(line style, legend entry) of the predicted cycles, by sign of Re c: -1 supercritical, 1 subcritical, 0
undecided."""
PREDICTION_POINT_COUNT = 60
"""Number of points of a predicted curve. The points are dense near the Hopf point, where the curve is
steep."""
CRITICALITY_MARKS = {
    -1: ("supercritical", style.BLUE, "o"),
    1: ("subcritical", style.VERMILION, "s"),
    0: ("criticality undecided", "0.3", "x"),
}
"""(legend entry, colour, marker) of a Hopf point, by sign of Re c: -1 supercritical, 1 subcritical, 0
undecided."""
CRITICALITY_CLASSES = (
    ("no Hopf point with a normal form", "#DDDDDD"),
    ("supercritical", "#9CC3E4"),
    ("supercritical, a later Hopf point subcritical", "#4C8FC4"),
    ("subcritical", style.VERMILION),
    ("criticality undecided", "0.4"),
)
"""(legend entry, colour) of the classes of rods on a map, by the criticality of the Hopf points. Colour-blind
readers can distinguish the colours, also in grey prints."""
LINEAR_RANGE_QUANTILE = 0.1
"""A symmetric logarithmic axis of Re c is linear up to this quantile of |Re c|, rounded down to a power of
ten."""


def draw_criticality(request: FigureRequest) -> str:
    """Draws a map of the first Hopf points over two parameters, or the amplitude coefficient a and Re c (c:
    cubic coefficient of the normal form) against one parameter, or else predicted amplitudes against F;
    returns a sentence. Raises InputError for options that the task does not have, and if nothing can be
    drawn."""
    view = request.require_single_view()
    has_normal_form = np.isfinite(view.variables["criticality"]).any()
    style.require_content(view, has_normal_form, "Hopf point with a normal form")
    names = list(varied_parameters_at_points(view))
    if len(names) == 1 and np.isfinite(np.unique(view.point_columns[names[0]])).sum() > 1:
        omissions_clause = infinite_values_clause(view.point_columns, names)
        caption = f"the normal forms of Hopf points along {names[0]}{omissions_clause}"
        return request.write(_coefficient_curves_figure(view, names[0]), caption)
    if not varies_two_parameters_on_grid(view):
        return request.write(*draw_predicted_amplitudes(view))
    points = point_grid(view)
    caption = (
        f"the normal form of the first Hopf point over {' and '.join(points.names)}{points.omissions_clause}"
    )
    return request.write(
        _criticality_maps_figure(view, points, request.look.is_narrow), caption, MIN_MAP_ASPECT
    )


def _coefficient_curves_figure(view: ResultView, name: str) -> Figure:
    """Figure of the amplitude coefficient a (upper panel) and of Re c (lower panel) against the parameter
    `name`. Markers show the criticality. Raises InputError if nothing can be drawn."""
    x = view.point_columns[name]
    is_finite = np.isfinite(x)
    figure = Figure(figsize=(5.6, 5.4), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True)
    keys = ("criticality", "amplitude_coefficient", "landau_real")
    criticality, amplitude_coefficient, landau_real = (
        view.flattened_by_point(key)[is_finite] for key in keys
    )
    style.require_content(view, np.isfinite(landau_real).any(), f"Hopf point with a finite {name}")
    linear_limit = float(np.nanquantile(np.abs(landau_real), LINEAR_RANGE_QUANTILE))
    lower.set_yscale("symlog", linthresh=10.0 ** floor(log10(linear_limit)))
    for axes, values in ((upper, amplitude_coefficient), (lower, landau_real)):
        _draw_hopf_markers(axes, x[is_finite], values, criticality)
        axes.axhline(0, color="0.6", lw=0.8, zorder=0)
        style.scale_axis(axes, "x", np.sort(x[is_finite]))
    upper.set_ylabel("amplitude coefficient $a/L$")
    lower.set(ylabel=r"$\mathrm{Re}\,c$ in $1/(\tau_2 L^2)$", xlabel=style.AXIS_LABELS[name])
    style.draw_shared_legend(figure, column_count=3)
    set_heading(figure, view, style.constant_parameters_text(view, name))
    return figure


def _draw_hopf_markers(axes: Axes, x: Array, values: Array, criticality: Array) -> None:
    """Draws Hopf points with markers by criticality. x: (rods,). values: y, (rods, crossings). criticality:
    signs of Re c, (rods, crossings)."""
    for number, (label, colour, marker) in CRITICALITY_MARKS.items():
        rods, crossings = np.nonzero(criticality == number)
        if rods.size:
            axes.plot(x[rods], values[rods, crossings], marker, color=colour, ms=3.5, label=label)


def _criticality_maps_figure(view: ResultView, points: PointGrid, is_narrow: bool) -> Figure:
    """Figure with two maps: criticality of the first Hopf points, and amplitude coefficient |a|. is_narrow:
    whether the maps are stacked. Raises InputError if nothing can be drawn."""
    criticality = view.flattened_by_point("criticality")[points.point_indices]
    amplitude_coefficient = np.abs(
        view.flattened_by_point("amplitude_coefficient")[:, 0][points.point_indices]
    )
    style.require_content(
        view, np.isfinite(amplitude_coefficient).any(), "first Hopf point with a normal form"
    )
    figure, panels = new_map_panels(2, is_narrow)
    classes = _criticality_class_indices(criticality)
    norm = BoundaryNorm(np.arange(len(CRITICALITY_CLASSES) + 1) - 0.5, len(CRITICALITY_CLASSES))
    colours = ListedColormap([colour for _, colour in CRITICALITY_CLASSES])
    panels[0].pcolormesh(*points.edges, classes, cmap=colours, norm=norm, rasterized=True)
    draw_coloured_cells(panels[1], points.edges, amplitude_coefficient, "amplitude coefficient $|a|/L$")
    panels[1].set_facecolor(CRITICALITY_CLASSES[0][1])
    label_maps(panels, points)
    drawn = (CRITICALITY_CLASSES[int(index)] for index in np.unique(classes))
    style.draw_shared_legend(figure, 3, [Patch(fc=colour, label=label) for label, colour in drawn])
    set_heading(figure, view, style.parameter_text(points.shared_parameters))
    return figure


def _criticality_class_indices(criticality: Array) -> Array:
    """Index in CRITICALITY_CLASSES for each rod, (ny, nx). criticality: signs of Re c at the Hopf points of
    the rods, (ny, nx, crossings); NaN for a missing Hopf point."""
    first = criticality[..., 0]
    has_later_subcritical = (criticality[..., 1:] == 1).any(axis=-1)
    # The numbers are indices in CRITICALITY_CLASSES; a rod without a Hopf point has NaN and the index 0.
    cases = [(first == -1) & has_later_subcritical, first == -1, first == 1, first == 0]
    return np.select(cases, [2.0, 1.0, 3.0, 4.0], 0.0)


def draw_predicted_amplitudes(view: ResultView) -> tuple[Figure, str]:
    """Returns (figure, description). The figure shows predicted amplitudes near all Hopf points of the first
    rods with a normal form, as many as there are line colours. Raises InputError if nothing can be drawn."""
    kinds, F, amplitude_coefficient = map(
        view.flattened_by_point, ("criticality", "crossing_F", "amplitude_coefficient")
    )
    rods_with_prediction = np.flatnonzero(
        (np.isfinite(kinds) & np.isfinite(amplitude_coefficient)).any(axis=1)
    )
    style.require_content(view, rods_with_prediction.size, "Hopf point with a normal form")
    drawn_rods = rods_with_prediction[: len(style.LINE_COLOURS)]
    figure = Figure(figsize=(5.6, 3.8), layout="constrained")
    axes = figure.subplots()
    common_text, rod_texts = shared_and_own_texts_of_points(view, [int(rod) + 1 for rod in drawn_rods])
    distance = MAX_DRAWN_RELATIVE_HOPF_DISTANCE * np.linspace(0, 1, PREDICTION_POINT_COUNT) ** 2
    for rod, colour in zip(drawn_rods, style.LINE_COLOURS, strict=False):
        for kind, hopf_force, size in zip(kinds[rod], F[rod], amplitude_coefficient[rod], strict=True):
            if np.isfinite(kind) and np.isfinite(size):
                # For a > 0 the cycles have a larger F than the Hopf point, for a < 0 a smaller F.
                forces = hopf_force * (1 + np.sign(size) * distance)
                line_style, _ = PREDICTED_CYCLE_LOOKS[int(kind)]
                axes.plot(forces, abs(size) * np.sqrt(distance), line_style, color=colour, lw=1.4)
                axes.plot(hopf_force, 0, "o", color=colour, ms=4, clip_on=False, zorder=3)
    axes.axhline(0, color="0.8", lw=0.6, zorder=0)
    axes.set(xlabel=style.AXIS_LABELS["F"], ylabel="predicted largest $y/L$ of the tip")
    axes.set_ylim(bottom=0)
    for kind, (line_style, label) in PREDICTED_CYCLE_LOOKS.items():
        if (kinds[drawn_rods] == kind).any():
            axes.plot([], [], color="0.3", ls=line_style, label=label)
    axes.plot([], [], "o", color="0.3", ms=4, label="Hopf point")
    for colour, text in zip(style.LINE_COLOURS, rod_texts, strict=False):
        axes.plot([], [], color=colour, lw=2, label=text or None)
    style.draw_shared_legend(figure, column_count=3)
    figure.suptitle(style.heading_text(view, common_text))
    distance_text = f"{MAX_DRAWN_RELATIVE_HOPF_DISTANCE:.0%}"
    caption = f"the cycles that normal forms predict within {distance_text} of every Hopf point"
    if len(drawn_rods) < rods_with_prediction.size:
        caption += f", of the first {len(drawn_rods)} of {rods_with_prediction.size} rods with Hopf points"
    return figure, caption
