"""Which figure of limit cycles is drawn: what the user names, or else what the file's content suggests."""

from collections.abc import Callable, Sequence
from pathlib import Path

from matplotlib.figure import Figure

from ...errors import InputError
from ...results.file.view import View
from .cycle.amplitude import draw_amplitude
from .cycle.animation import FILMS, write_animation
from .cycle.energy import draw_energy
from .cycle.portrait import draw_portrait
from .cycle.selection import MOST_CYCLES, SHAPES, outcomes
from .request import Drawing, FigureRequest, image

OF_POINTS: dict[str, Callable[[View, Sequence[int]], tuple[Figure, str]]] = {
    "cycle": draw_portrait,
    "energy": draw_energy,
}
"""Figures of single points, by the name that --what gives them."""


def limit_cycle_figure(request: FigureRequest) -> Drawing:
    """The figure of one file, or of the amplitudes of several; InputError where the choices do not fit."""
    view, what = request.views[0], figure_name(request)
    if what == "amplitude":
        return image(lambda: draw_amplitude(request.views))
    if what == "animation":

        def write(output: Path) -> str:
            return write_animation(view, request.points, output)

        return Drawing(write, FILMS)
    return image(lambda: OF_POINTS[what](view, request.points))


def figure_name(request: FigureRequest) -> str:
    """The figure as --what names it: what the user says; else an animation for a film's suffix, shapes where
    they are stored of few points, and amplitudes.
    """
    first, *others = request.views
    for view in others:
        if view.task != first.task:
            request.refuse_choices(view)
    what, points = request.what, request.points
    if what is None and request.suffix in FILMS:
        what = "animation"
    if what is None:
        varies = len(set(map(float, first.point_columns["F"]))) > 1
        few = len(points) > 0 or (outcomes(first) == "cycle").sum() <= MOST_CYCLES
        shapes = few and not others and SHAPES[0] in first.variables
        what = "amplitude" if others or (varies and not points and not shapes) else "cycle"
    if others and what != "amplitude":
        raise InputError(f"--what {what} draws one file; only amplitudes of several files make one figure")
    if points and what == "amplitude":
        raise InputError("--point is given but amplitudes are drawn of all points; remove it")
    return what
