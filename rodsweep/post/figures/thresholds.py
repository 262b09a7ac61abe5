"""Figures of the task `thresholds`: curves against parameters, maps over two parameters, or bars for single
rods."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from ...errors import InputError
from ...results.file.view import ResultView
from . import style
from .arm.quantities import set_heading
from .cells import draw_coloured_cells, label_maps, new_map_panels, point_grid
from .layout.layout_fitting import MIN_ASPECT, MIN_MAP_ASPECT
from .point_lists import as_grid_if_possible
from .request import FigureRequest
from .stability.class_bars import BAR_ASPECT, draw_class_bars
from .stability.threshold_lines import (
    CRITICAL_FORCE_LOOKS,
    FILE_COLOURS,
    MAX_COLOURED_LINES,
    draw_lines_of_files,
    draw_lines_of_grid,
    draw_lines_of_three_values,
)

NO_THRESHOLD_COLOUR = "#DDDDDD"
"""Colour of rods without a threshold in a map."""
SEARCHED_FORCE_DIGITS = 4
"""Number of significant digits of the largest searched force in the description of a figure."""


def draw_thresholds(request: FigureRequest) -> str:
    """Draws the first thresholds against one parameter or over two parameters, or a bar of classes for each
    rod; returns a description of the figure. Raises InputError for options that the task does not have, and
    if nothing can be drawn."""
    if request.views[1:]:
        return _draw_files(request)
    view = as_grid_if_possible(request.require_single_view("lines", "map"))
    if not view.is_grid or view.variables["status"].size == 1:
        if request.what:
            reason = "needs one or two varied parameters; remove --what"
            if view.quantities and view.variables["status"].size > 1:
                reason = (
                    "is not for a grid over an arm's quantities; remove --what or draw lines over the other "
                    "quantities with --at, such as --at 'length=12 cm'"
                )
            raise InputError(f"{view.path}: --what {request.what} {reason}")
        min_aspect = BAR_ASPECT if view.variables["status"].size == 1 else MIN_ASPECT
        return request.write(draw_class_bars(view), "behaviour of each rod over F", min_aspect)
    varied_names = style.varied_axes(view)
    drawable_names = [name for name, *_ in CRITICAL_FORCE_LOOKS if np.isfinite(view.variables[name]).any()]
    style.require_content(view, drawable_names, "threshold")
    has_few_lines = min(len(view.parameter_values[name]) for name in varied_names) <= MAX_COLOURED_LINES
    if request.what == "map" or (len(varied_names) == 2 and not has_few_lines and request.what != "lines"):
        figure, omissions = _threshold_maps(view, drawable_names, request.look.is_narrow)
        return request.write(
            figure, f"critical forces over {' and '.join(varied_names)}{omissions}", MIN_MAP_ASPECT
        )
    search_clause = searched_range_clause(view)
    if len(varied_names) == 1 or has_few_lines:
        return request.write(*draw_lines_of_grid(view, varied_names, search_clause))
    return request.write(
        *draw_lines_of_three_values(view, varied_names, request.look.is_narrow, search_clause)
    )


def _draw_files(request: FigureRequest) -> str:
    """Draws the thresholds of several files against the parameter that varies in all files; returns a
    description of the figure. Raises InputError for too many files, for unsuitable options, and unless the
    files have one task and vary in one common parameter only."""
    request.refuse_points_and_other_kinds(request.views[0], ("lines",))
    request.require_output()
    views = request.views
    # A list over an arm's quantities may vary more parameters than `varied_axes` allows.
    names = style.varied_axes(views[0]) if views[0].is_grid else []
    if len(views) > len(FILE_COLOURS):
        raise InputError(
            f"{len(views)} files are given; a figure of thresholds has room for {len(FILE_COLOURS)}; give "
            "fewer files"
        )
    for view in views:
        if view.task != views[0].task:
            raise InputError(
                f"{view.path} is of the task {view.task} and {views[0].path} of the task {views[0].task}; "
                "files of different tasks share no figure; plot each file by itself"
            )
        if not view.is_grid or style.varied_axes(view) != names or names[1:]:
            raise InputError(
                f"{view.path}: files of thresholds share a figure only if all are grids over one parameter, "
                "the same in every file; plot each file by itself"
            )
    return request.write(*draw_lines_of_files(views, names[0], searched_range_clause(*views)))


def searched_range_clause(*views: ResultView) -> str:
    """Clause on the searched range of forces: a threshold that is not shown may lie outside this range."""
    ends = np.concatenate([view.variables["F_end"].ravel() for view in views])
    low, high = (f"{end(ends):.{SEARCHED_FORCE_DIGITS}g}" for end in (np.nanmin, np.nanmax))
    return rf"searched up to $\tilde F = {low}$" + (f" to ${high}$" if low != high else "")


def _threshold_maps(view: ResultView, names: list[str], is_narrow: bool) -> tuple[Figure, str]:
    """Returns (figure, omissions). The figure has a map over two parameters for each kind of threshold in
    `names`. omissions: clause on infinite values of the parameters. is_narrow: whether the maps are stacked.
    Raises InputError if nothing can be drawn."""
    points = point_grid(view)
    figure, panels = new_map_panels(len(names), is_narrow)
    lacking = False
    forces = [force for force in CRITICAL_FORCE_LOOKS if force[0] in names]
    for axes, (name, word, *_) in zip(panels, forces, strict=True):
        values = view.variables[name].ravel()[points.point_indices]
        style.require_content(view, np.isfinite(values).any(), f"{name} of rods with finite parameters")
        draw_coloured_cells(axes, points.edges, values, f"{word} in $k_3/L^2$")
        axes.set_facecolor(NO_THRESHOLD_COLOUR)
        lacking |= bool(np.isnan(values).any())
    label_maps(panels, points)
    if lacking:
        style.draw_shared_legend(figure, 1, [Patch(fc=NO_THRESHOLD_COLOUR, label="none found")])
    constants_text = style.parameter_text(points.shared_parameters)
    set_heading(figure, view, constants_text, searched_range_clause(view))
    return figure, points.omissions_clause
