"""Which figure of limit cycles is drawn: what the user names, or else what the file's content suggests."""

from ...errors import InputError
from .cycle.amplitude import draw_amplitude
from .cycle.animation import FILMS, write_animation
from .cycle.energy import draw_energy
from .cycle.portrait import draw_portrait
from .cycle.selection import MOST_CYCLES, SHAPES, outcomes
from .request import FigureRequest


def draw_limit_cycle(request: FigureRequest) -> str:
    """Draws one file, or the amplitudes of several; InputError where the choices do not fit."""
    view, points, name = request.views[0], request.points, figure_name(request)
    if name == "animation":
        request.check_output(*FILMS)
        return write_animation(view, points, request.output)
    request.check_output()
    if name == "amplitude":
        return request.write(*draw_amplitude(request.views))
    return request.write(*{"cycle": draw_portrait, "energy": draw_energy}[name](view, points))


def figure_name(request: FigureRequest) -> str:
    """What --what names; else an animation for a film's suffix, shapes if of few points, or amplitudes."""
    first, *others = request.views
    for view in others:
        if view.task != first.task:
            request.refuse_choices(view)
    name, points = request.what, request.points
    if name is None and request.output.suffix in FILMS:
        name = "animation"
    if name is None:
        varies = len(set(map(float, first.point_columns["F"]))) > 1
        few = len(points) > 0 or (outcomes(first) == "cycle").sum() <= MOST_CYCLES
        shapes = few and not others and SHAPES[0] in first.variables
        name = "amplitude" if others or (varies and not points and not shapes) else "cycle"
    if others and name != "amplitude":
        raise InputError(f"--what {name} draws one file; only amplitudes of several files make one figure")
    if points and name == "amplitude":
        raise InputError("--point is given but amplitudes are drawn of all points; remove it")
    return name
