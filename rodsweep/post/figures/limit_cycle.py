"""Figures of the task `limit_cycle`: the kind chosen by the user, or a default kind that depends on the
file."""

import numpy as np

from ...errors import InputError
from ...results.file.view import ResultView
from ..summary.selection import varied_parameters_at_points
from .cells import point_grid, varies_two_parameters_on_grid
from .cycle.amplitudes.amplitude import SERIES_LOOKS, draw_amplitude
from .cycle.amplitudes.amplitude_series import abscissa_parameter
from .cycle.animation import FILM_SUFFIXES, write_animation
from .cycle.energy import draw_energy
from .cycle.maps import draw_maps
from .cycle.selection import (
    ENERGY_BUDGET_VARIABLE_NAMES,
    MAX_CYCLES,
    SHAPE_VARIABLE_NAMES,
    TRANSIENT_VARIABLE_NAMES,
    chosen_cycles,
)
from .cycle.shapes_and_tip_motion import draw_shapes_and_tip_motion
from .cycle.transient import draw_transients
from .layout.layout_fitting import MIN_MAP_ASPECT, MIN_TIME_PANEL_ASPECT
from .request import FIGURE_KINDS_BY_TASK, FigureRequest

ALL_POINT_FIGURE_NOUNS = {"amplitude": "amplitudes", "maps": "maps"}
"""Kinds of figures that show all points of a file, with the noun for messages."""
NEEDED_VARIABLES = {
    "cycle": SHAPE_VARIABLE_NAMES,
    "animation": SHAPE_VARIABLE_NAMES,
    "energy": ENERGY_BUDGET_VARIABLE_NAMES,
}
"""Variables of a cycle that are necessary for a figure, by kind of figure."""
FEW_POINT_DRAW_FUNCTIONS = {
    "cycle": draw_shapes_and_tip_motion,
    "energy": draw_energy,
    "transient": draw_transients,
}
"""For each kind of figure that shows a few points, the function that draws the figure."""


def draw_limit_cycle(request: FigureRequest) -> str:
    """Draws the figure of one file or the amplitudes of several files, or writes an animation; returns a
    sentence. If the file lacks variables that the figure needs, `request.shape_solver`, if given, solves the
    cycles again. Raises InputError for options that do not match the files, and if nothing can be drawn."""
    points = request.points
    name = chosen_figure_kind(request)
    view = _view_with_needed_variables(request, name)
    if name == "animation":
        request.require_output(*FILM_SUFFIXES)
        if request.figure_callback is not None:
            raise InputError("an animation is not a single figure; save it as a .gif")
        return write_animation(view, points, request.output)
    request.require_output()
    if name == "amplitude":
        return request.write(*draw_amplitude(request.views, request.look.is_narrow))
    if name == "maps":
        return request.write(*draw_maps(view, request.look.is_narrow), MIN_MAP_ASPECT)
    return request.write(
        *FEW_POINT_DRAW_FUNCTIONS[name](view, points, request.look.is_narrow), MIN_TIME_PANEL_ASPECT
    )


def _view_with_needed_variables(request: FigureRequest, name: str) -> ResultView:
    """View of the file with the variables that the figure `name` needs. If variables are missing,
    `request.shape_solver`, if given, computes them for at most MAX_CYCLES points: the requested points, by
    default the first points with a cycle."""
    view = request.views[0]
    if request.shape_solver is None or view.variables.keys() >= set(NEEDED_VARIABLES.get(name, ())):
        return view
    numbers = request.points or [int(index) + 1 for index in np.flatnonzero(view.status_names == "cycle")]
    chosen_cycles(view, request.points, ())  # refuses points without a cycle
    return request.shape_solver(view, numbers[:MAX_CYCLES])


def chosen_figure_kind(request: FigureRequest) -> str:
    """Kind of figure that the user has chosen by --what, or the default kind. Raises InputError for options
    that do not match the files."""
    first_view, *other_views = request.views
    for view in other_views:
        if view.task != first_view.task:
            request.refuse_figure_options(view)
    name = request.what or _default_figure_kind(request)
    if name not in FIGURE_KINDS_BY_TASK["limit_cycle"]:
        request.refuse_points_and_other_kinds(first_view)
    if other_views and name != "amplitude":
        raise InputError(f"--what {name} draws a single file; only amplitudes of several files form a figure")
    if request.points and name in ALL_POINT_FIGURE_NOUNS:
        raise InputError(
            f"--point is given, but {ALL_POINT_FIGURE_NOUNS[name]} show all points; remove --point"
        )
    return name


def _default_figure_kind(request: FigureRequest) -> str:
    """Default kind of figure: animation for an output file with the suffix of an animation; amplitudes for
    several files. For a few points: transients if the file has transients and no drawable shapes, shapes if
    the file has shapes. Otherwise maps for many lines of points, amplitudes for points along F and for many
    points, else shapes."""
    first_view, *other_views = request.views
    if request.output.suffix in FILM_SUFFIXES:
        return "animation"
    if other_views:
        return "amplitude"
    is_cycle = first_view.status_names == "cycle"
    indices = [number - 1 for number in request.points]
    few_cycles = len(indices) > 0 or is_cycle.sum() <= MAX_CYCLES
    few_points = len(indices) > 0 or is_cycle.size <= MAX_CYCLES
    shaped = SHAPE_VARIABLE_NAMES[0] in first_view.variables
    drawable = (
        shaped
        and is_cycle.any()
        and is_cycle[[index for index in indices if 0 <= index < is_cycle.size]].all()
    )
    if few_points and TRANSIENT_VARIABLE_NAMES[0] in first_view.variables and not drawable:
        return "transient"
    if indices or (few_cycles and shaped):
        return "cycle"
    if _has_many_lines(first_view):
        return "maps"
    names = varied_parameters_at_points(first_view)
    return "amplitude" if "F" in names or (names and is_cycle.size > MAX_CYCLES) else "cycle"


def _has_many_lines(view: ResultView) -> bool:
    """Whether the points form a map that has more lines than a figure of amplitudes can show."""
    if not varies_two_parameters_on_grid(view):
        return False
    other_name = next(name for name in point_grid(view).names if name != abscissa_parameter(view))
    return len(np.unique(view.point_columns[other_name])) > len(SERIES_LOOKS)
