"""Phase diagrams, as in the paper's Fig. 4: stability class of the rod over two parameters, and boundary
curves."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ...arrays import Array
from ...config.parameters_section import DEFAULT_VALUES_OF_PARAMETERS
from ...results.file.view import ResultView
from ...results.layouts import lacks_sweep_wide_variables
from ...results.layouts.variables import stored_number_of_word
from ..crushing import crushing_ratio
from ..plane_curves import PlaneParameters, plane_parameters, points_by_curve
from . import style
from .arm.quantities import set_heading
from .arm.validity_hatches import hatch_compressed
from .grid_slices import infinite_values_clause
from .layout.layout_fitting import MIN_MAP_ASPECT
from .request import FigureRequest
from .stability.class_bars import BAR_ASPECT, CLASS_PALETTE, STABLE_STATE_PALETTE, Palette
from .stability.diagram_curves import (
    draw_boundary_curves,
    draw_cycle_curves,
    mark_special_points_on_rows,
    unstored_crossings_text,
)
from .stability.regions import PIXEL_COUNT, ClassifiedPoints, DrawnPlane, pixel_classes
from .stability.row_classes import classes_between_crossings, pixel_classes_of_row

CURVE_END_CRUSHING_RATIO = 1 - 3e-3
"""Curves of a file may end shortly before the crushing force, at this ratio of force to crushing force. The
strip with larger ratios therefore separates regions of the diagram as curves do."""


def draw_phase_diagram(request: FigureRequest) -> str:
    """Draws the class of the rod, or its stable states if they are stored, as a map over two parameters with
    boundary curves; as one bar per row if fewer than two rows have a finite value of the row parameter.
    Returns a sentence. Raises InputError for options that the task does not have, and if nothing can be
    drawn."""
    view = request.require_single_view()
    parameters = plane_parameters(view)
    line, row = parameters
    palette = STABLE_STATE_PALETTE if STABLE_STATE_PALETTE.variable in view.variables else CLASS_PALETTE
    values = view.variables[palette.variable]
    style.require_content(view, (values >= 0).any(), "computed row")
    x = view.variables[line]
    y = view.parameter_values[row]
    is_finite = np.isfinite(y)
    if is_finite.sum() < 2:
        rows = f", for each {row}" if len(y) > 1 else ""
        caption = f"behaviour of the rod over {line}{rows}"
        return request.write(_bars_of_rows_figure(view, palette, parameters), caption, BAR_ASPECT * len(y))
    table = values.reshape(len(y), len(x))[is_finite]
    y = y[is_finite]
    plane = DrawnPlane(x, y)
    pixel_coordinates = (plane.pixel_centres(x), plane.pixel_centres(y))
    ratio = crushing_ratio(view, parameters, pixel_coordinates[0], pixel_coordinates[1][:, None])
    figure = Figure(figsize=(5.8, 4.6), layout="constrained")
    axes = figure.subplots()
    pixels = _class_of_pixels(view, palette, plane, table, ratio)
    unit: dict[str, Any] = {"extent": (0, 1, 0, 1), "transform": axes.transAxes, "aspect": "auto"}
    axes.imshow(pixels, interpolation="nearest", origin="lower", **unit, **palette.colour_keywords)
    style.scale_axis(axes, "x", x)
    style.scale_axis(axes, "y", y)
    _draw_crushing_line(axes, ratio, *pixel_coordinates)
    areas = [*palette.legend_entries(pixels), *hatch_compressed(axes, view, ratio, *pixel_coordinates)]
    axes.set(
        xlim=(x[0], x[-1]), ylim=(y[0], y[-1]), xlabel=style.AXIS_LABELS[line], ylabel=style.AXIS_LABELS[row]
    )
    _draw_stored_curves(axes, view, palette, parameters)
    style.draw_shared_legend(figure, 2 if "bautin_curve" in view.variables else 3, areas)
    set_heading(figure, view, _constant_parameters_text(view, parameters), unstored_crossings_text(view))
    lacks_curves = lacks_sweep_wide_variables(view.attributes)
    missing_clause = "; curves are missing, the file is not finished" if lacks_curves else ""
    infinite_clause = infinite_values_clause(view.parameter_values, [row])
    return request.write(
        figure, f"behaviour of the rod over {line} and {row}{missing_clause}{infinite_clause}", MIN_MAP_ASPECT
    )


def _draw_stored_curves(axes: Axes, view: ResultView, palette: Palette, parameters: PlaneParameters) -> None:
    """Draws the boundary curves, curves of cycles and special points of rows that a file contains."""
    if "curve_number" in view.variables:
        draw_boundary_curves(axes, view, parameters, hopf_only=palette is STABLE_STATE_PALETTE)
    if "cycle_curve_number" in view.variables:
        draw_cycle_curves(axes, view, parameters)
    if "cycle_special_kind" in view.variables:
        mark_special_points_on_rows(axes, view, parameters)


def _constant_parameters_text(view: ResultView, parameters: PlaneParameters) -> str:
    """Text of the constant parameters. gamma1 is included only if the figure shows cycles or their
    criticality. parameters: parameters on the axes."""
    fixed = {name: values[0] for name, values in view.parameter_values.items() if name not in parameters}
    if "curve_gamma1" in view.variables:
        fixed["gamma1"] = float(view.variables["curve_gamma1"])
    elif "gamma1" in view.attributes or ("stable_states" in view.variables and not view.quantities):
        fixed["gamma1"] = float(view.attributes.get("gamma1", DEFAULT_VALUES_OF_PARAMETERS["gamma1"]))
    return style.parameter_text(fixed)


def _draw_crushing_line(axes: Axes, ratio: Array, x: Array, y: Array) -> None:
    """Draws the line on which the force begins to crush the rod. ratio: force divided by the crushing force
    at x and y, (pixels, pixels). x, y: coordinates, (pixels,)."""
    if ratio.min() < 1 < ratio.max():
        axes.contour(x, y, ratio, levels=[1.0], colors="0.4", linewidths=1.2)
        axes.plot([], [], color="0.4", lw=1.2, label="crushing force")


def _bars_of_rows_figure(view: ResultView, palette: Palette, parameters: PlaneParameters) -> Figure:
    """Figure with a bar for each row of a diagram, used if fewer than two rows have a finite value of the row
    parameter."""
    x = view.variables[parameters.line_parameter]
    y = view.parameter_values[parameters.row_parameter]
    figure = Figure(figsize=(5.8, 1.6 + 0.5 * len(y)), layout="constrained")
    axes = figure.subplots()
    edges = DrawnPlane.coordinates_at_fractions(x, np.linspace(0, 1, PIXEL_COUNT + 1))
    rows = [
        pixel_classes_of_row(view, palette.variable, parameters, row_index, edges)
        for row_index in range(len(y))
    ]
    table: Array = np.array(rows)
    keywords: dict[str, Any] = {"rasterized": True} | palette.colour_keywords
    axes.pcolormesh(edges, np.arange(len(y) + 1) - 0.5, table, **keywords)
    for separator in np.arange(len(y) - 1) + 0.5:
        axes.axhline(separator, color="white", lw=4)
    style.scale_axis(axes, "x", x)
    texts = [f"${style.TEX_SYMBOLS[parameters.row_parameter]} = {style.number_in_tex(value)}$" for value in y]
    axes.set_yticks(np.arange(len(y)), texts)
    axes.tick_params("y", length=0)
    axes.set(xlim=(x[0], x[-1]), xlabel=style.AXIS_LABELS[parameters.line_parameter])
    style.draw_shared_legend(figure, 3, palette.legend_entries(table))
    set_heading(figure, view, _constant_parameters_text(view, parameters))
    return figure


def _class_of_pixels(
    view: ResultView, palette: Palette, plane: DrawnPlane, classes: Array, ratio: Array
) -> Array:
    """Class of every pixel of the plane, (pixels, pixels). The regions of equal class are bounded by the
    curves of the file and by the crushing force. classes: class at each computed point, (rows, columns).
    ratio: force divided by the crushing force, at which the stretch is 0, at every pixel, (pixels,
    pixels)."""
    parameters = plane_parameters(view)
    crushed_class = stored_number_of_word("crushed", palette.words)
    columns, rows = np.meshgrid(plane.x, plane.y)
    is_known = classes != crushed_class
    places = plane.fractions_of_axes(columns[is_known], rows[is_known])
    computed = ClassifiedPoints(places, classes[is_known])
    row_points = ClassifiedPoints(np.zeros((0, 2)), np.zeros(0, int))
    if palette is CLASS_PALETTE:
        x, row_values, row_classes = classes_between_crossings(view, parameters)
        row_points = ClassifiedPoints(plane.fractions_of_axes(x, row_values), row_classes)
    curves = []
    for kind in (kind for kind in ("curve", "cycle_curve") if f"{kind}_number" in view.variables):
        # Double eigenvalues bound no stable state.
        code = 1 if kind == "curve" and palette is not CLASS_PALETTE else None
        paths = points_by_curve(view, parameters, kind, code).values()
        curves += [plane.fractions_of_axes(*path.T) for path in paths]
    undecided = stored_number_of_word("undecided", palette.words)
    pixels = pixel_classes(computed, row_points, curves, ratio > CURVE_END_CRUSHING_RATIO, undecided)
    return np.where(ratio < 1, pixels, crushed_class)
