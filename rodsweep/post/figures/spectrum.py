"""Figures of the task `spectrum`: spectra along lines as in the paper's Fig. 2, a map, or single spectra."""

from collections.abc import Sequence
from string import ascii_lowercase

import matplotlib.cm
import matplotlib.colors
import numpy as np
from matplotlib.figure import Figure

from ...errors import InputError
from ...results.file.view import ResultView
from . import style
from .arm.quantities import set_heading
from .grid_slices import infinite_values_clause, slice_at_values, without_infinite_values
from .layout.layout_fitting import MIN_MAP_ASPECT
from .point_lists import as_grid_if_possible
from .request import FigureRequest
from .spectra.eigenvalues import draw_eigenvalues, draw_list_of_spectra
from .spectra.spectra_along_line import (
    ROOT_CHOICE_TEXTS,
    choice_of_followed_roots,
    draw_roots_against_parameter,
    draw_spectra_along_line,
    mark_thresholds,
    threshold_symbol_and_force,
)

MAX_PANELS = 12
"""Largest number of panels in one figure."""
PANEL_HEIGHT_BY_COLUMN_COUNT = {1: 2.1, 2: 2.6}
"""Height of a panel, in inches, by number of columns."""
FIGURE_WIDTH_BY_COLUMN_COUNT = {1: 3.375, 2: 7.0}
"""Width of the figure, in inches, by number of columns."""
MAP_COLOURS = "PuOr_r"
"""Colour map of growth rates, with different colours for negative and positive rates."""
SHADES_PER_SIGN = 40
"""Number of colours of a map for negative growth rates, equal to the number for positive growth rates."""
MAX_LINE_PANELS = 6
"""If a second parameter has at most this number of values, each value has a panel; otherwise a map is
drawn."""
LINEAR_COLOUR_RANGE_FRACTION = 1e-4
"""The colour scale of a map is linear up to this fraction of the largest |growth rate|, at least up to
1/tau2, and logarithmic beyond."""
GROWTH_LABEL = r"largest growth rate $\mathrm{Re}\,\omega_1\,\tau_2$"
"""Label of the colour bar."""


def draw_spectrum(request: FigureRequest) -> str:
    """Draws spectra along lines, a map, or the eigenvalues of single points, depending on the files; returns
    a sentence. Raises InputError for options that the task does not have, and if nothing can be drawn."""
    if len(request.views) > 1:
        return _draw_files(request)
    view = as_grid_if_possible(request.require_single_view())
    style.require_content(view, np.isfinite(view.variables["growth_rate"]).any(), "computed point")
    if view.variables["status"].size == 1 or not view.is_grid:
        _refuse_roots(view, request.roots, "single points, each with all stored eigenvalues", ("all",))
    if view.variables["status"].size == 1:
        return request.write(draw_eigenvalues(view), "the stored eigenvalues in the complex plane")
    if not view.is_grid:
        return request.write(draw_list_of_spectra(view), "the stored eigenvalues of every point")
    varied_names = style.varied_axes(view)
    shortest = min(varied_names, key=lambda name: len(view.parameter_values[name]))
    if len(varied_names) > 1 and len(view.parameter_values[shortest]) <= MAX_LINE_PANELS:
        return _draw_panel_per_value(view, shortest, request)
    omissions_clause = infinite_values_clause(view.parameter_values, varied_names)
    view = without_infinite_values(view)
    varied_names = style.varied_axes(view)
    if len(varied_names) == 1:
        roots = choice_of_followed_roots([view], request.roots)
        return request.write(
            draw_spectra_along_line(view, varied_names[0], roots), ROOT_CHOICE_TEXTS[roots] + omissions_clause
        )
    _refuse_roots(view, request.roots, "a map of the leading growth rate; --at draws one of its lines")
    return request.write(
        _growth_map(view, varied_names), f"the leading growth rate{omissions_clause}", MIN_MAP_ASPECT
    )


def _refuse_roots(view: ResultView, roots: str | None, figure: str, allowed: Sequence[str] = ()) -> None:
    """Raises InputError if `--roots` is given for a figure that ignores this option, because the figure does
    not follow roots along a line. allowed: choices that are accepted. figure: noun for the figure of
    `view`."""
    if roots not in (None, *allowed):
        raise InputError(
            f"{view.path}: --roots {roots} is for spectra along a line of points, and this is {figure}"
        )


def _draw_panel_per_value(view: ResultView, curve_parameter: str, request: FigureRequest) -> str:
    """Draws a panel of spectra for each value of the parameter `curve_parameter`, which has too few values
    for a map; returns a sentence."""
    values = view.parameter_values[curve_parameter].tolist()
    slices = (slice_at_values(view, {curve_parameter: value}) for value in values)
    lines = map(without_infinite_values, slices)
    views = [line for line in lines if np.isfinite(line.variables["growth_rate"]).any()]
    other_names = [name for name in style.varied_axes(view) if name != curve_parameter]
    omissions_clause = infinite_values_clause(view.parameter_values, other_names)
    return _draw_line_panels(views, request, f"{curve_parameter}{omissions_clause}")


def _draw_line_panels(views: Sequence[ResultView], request: FigureRequest, panel_noun: str) -> str:
    """Draws a panel for each view, a line of spectra; returns a sentence. panel_noun: noun for a view, and a
    clause on what is left out."""
    roots = choice_of_followed_roots(views, request.roots)
    figure = draw_root_panels(views, roots, request.look.is_narrow)
    return request.write(figure, f"{ROOT_CHOICE_TEXTS[roots]}, in a panel for each {panel_noun}")


def _draw_files(request: FigureRequest) -> str:
    """Draws a panel for each file; returns a sentence. Raises InputError if a file is not a line of
    spectra."""
    request.refuse_points_and_other_kinds(request.views[0])
    request.require_output()
    if len(request.views) > MAX_PANELS:
        room_clause = f"but a figure has room for {MAX_PANELS}; give fewer files"
        raise InputError(f"{len(request.views)} files are given, {room_clause}")
    views = [_view_of_spectra_line(view, request) for view in request.views]
    grids = map(as_grid_if_possible, request.views)
    omissions = [infinite_values_clause(grid.parameter_values, style.varied_axes(grid)) for grid in grids]
    return _draw_line_panels(views, request, f"of {len(views)} files{max(omissions, key=len)}")


def _view_of_spectra_line(view: ResultView, request: FigureRequest) -> ResultView:
    """View of a file as a line of spectra along one parameter, without points at which a parameter is
    infinite. Raises InputError if the file is not a line of spectra."""
    if view.task != request.views[0].task:
        raise InputError(
            f"{view.path} is of the task {view.task}; only lines of spectra can share a figure; plot it by "
            "itself"
        )
    view = as_grid_if_possible(view)
    style.require_content(view, np.isfinite(view.variables["growth_rate"]).any(), "computed point")
    view = without_infinite_values(view) if view.is_grid else view
    if not view.is_grid or sum(len(values) > 1 for values in view.parameter_values.values()) != 1:
        raise InputError(
            f"{view.path} is not a line of spectra, along which one parameter varies; only lines of spectra "
            "can share a figure; plot it by itself, or select a line with --at"
        )
    return view


def _growth_map(view: ResultView, names: list[str]) -> Figure:
    """Map of the largest growth rate over the two parameters `names`."""
    horizontal, vertical = names
    growth = view.variables["growth_rate"][..., 0].squeeze()
    x = view.parameter_values[horizontal]
    y = view.parameter_values[vertical]
    figure = Figure(figsize=(5.6, 4.4), layout="constrained")
    axes = figure.subplots()
    max_rate = float(np.nanmax(np.abs(growth)))
    linear = max(1.0, max_rate * LINEAR_COLOUR_RANGE_FRACTION)
    norm = matplotlib.colors.SymLogNorm(linear, vmin=-max_rate, vmax=max_rate)
    # Zero is a level of the filled contours, so that the line of zero growth and the colours agree.
    shades = norm.inverse(np.linspace(0.0, 1.0, 2 * SHADES_PER_SIGN + 1))
    shades[[0, SHADES_PER_SIGN, -1]] = np.nextafter(-max_rate, -np.inf), 0.0, np.nextafter(max_rate, np.inf)
    masked_growth = np.ma.masked_invalid(growth.T)
    axes.contourf(x, y, masked_growth, shades, norm=norm, cmap=MAP_COLOURS, zorder=-1)
    axes.set_rasterization_zorder(0)
    if np.nanmin(growth) < 0 < np.nanmax(growth):
        axes.contour(x, y, masked_growth, levels=[0.0], colors="k", linewidths=1.2)
    style.scale_axis(axes, "x", x)
    style.scale_axis(axes, "y", y)
    axes.set(xlabel=style.AXIS_LABELS[horizontal], ylabel=style.AXIS_LABELS[vertical])
    colours = matplotlib.cm.ScalarMappable(norm, MAP_COLOURS)
    figure.colorbar(colours, ax=axes, label=GROWTH_LABEL)
    # Invisible points, from which `rodsweep report` reads the values.
    limits = axes.axis()
    x_grid, y_grid = np.meshgrid(x, y, indexing="ij")
    axes.scatter(x_grid.ravel(), y_grid.ravel(), c=growth.ravel(), visible=False, label=GROWTH_LABEL)
    axes.axis(limits)
    note = "black: zero growth, interpolated between the points"
    set_heading(figure, view, style.constant_parameters_text(view, *names), note)
    return figure


def draw_root_panels(views: Sequence[ResultView], roots: str, is_narrow: bool) -> Figure:
    """Figure with a panel of roots for each view. roots: choice of roots. is_narrow: panels in one column."""
    column_count = 1 if is_narrow else 2
    row_count = -(-len(views) // column_count)
    figure_size = (
        FIGURE_WIDTH_BY_COLUMN_COUNT[column_count],
        PANEL_HEIGHT_BY_COLUMN_COUNT[column_count] * row_count + 0.8,
    )
    figure = Figure(figsize=figure_size, layout="constrained")
    panels = figure.subplots(row_count, column_count, squeeze=False).ravel()
    for letter, panel, view in zip(ascii_lowercase, panels, views, strict=False):
        (name,) = style.varied_axes(view)
        draw_roots_against_parameter(panel, view, name, roots)
        thresholds = mark_thresholds(panel, view, name, has_own_legend=False)
        threshold_texts = ", ".join(map(threshold_symbol_and_force, thresholds))
        text = style.heading_text(view, style.constant_parameters_text(view, name), threshold_texts)
        panel.set_title(f"({letter})  {text}", loc="left")
    for panel in panels[len(views) :]:
        panel.remove()
    style.draw_shared_legend(figure, 2 if is_narrow else 3)
    figure.suptitle(ROOT_CHOICE_TEXTS[roots])
    return figure
