"""Figures of a result file: `draw` finds the task's figure and writes it; one module per kind of figure."""

from collections.abc import Callable, Sequence
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from ...errors import EnvironmentLacks, InputError
from ...results.file.view import View
from .cycle.amplitude import draw_amplitude
from .cycle.animation import FILMS, write_animation
from .cycle.chosen import MOST_CYCLES, SHAPES, outcomes, point_columns
from .cycle.energy import draw_energy
from .cycle.portrait import draw_cycle
from .modes import draw_modes
from .phase_diagram import draw_phase_diagram
from .spectrum import draw_spectrum
from .style import STYLE
from .thresholds import draw_thresholds

FORMATS = (".png", ".pdf", ".svg")
FIGURES: dict[str, Callable[[View, str], tuple[Figure, str]]] = {
    "spectrum": draw_spectrum,
    "thresholds": draw_thresholds,
    "phase_diagram": draw_phase_diagram,
    "modes": draw_modes,
}
"""The figure of every task that has one: from (view, roots) to (figure, what it shows)."""
CYCLE_FIGURES: dict[str, Callable[[View, Sequence[int]], tuple[Figure, str]]] = {
    "cycle": draw_cycle,
    "energy": draw_energy,
}
"""Figures of single points of the task limit_cycle, which has an amplitude and an animation beside."""


def draw(
    views: View | Sequence[View],
    output: Path,
    roots: str = "smallest",
    what: str | None = None,
    points: Sequence[int] = (),
) -> str:
    """Draws the figure of a file, or of several, into `output`; returns a sentence about it.

    `what` and `points`, numbered from 1, choose for the task limit_cycle. Raises InputError where there is
    nothing that a figure could show.
    """
    views = [views] if isinstance(views, View) else views
    what = chosen_figure(views, output, what, points)
    formats = FILMS if what == "animation" else FORMATS
    if output.suffix not in formats:
        raise InputError(f"--output {output}: the name must end in {', '.join(formats)}")
    taken = output.exists() and any(output.samefile(view.path) for view in views if view.path.exists())
    if taken or (output.exists() and not output.is_file()):
        raise InputError(f"--output {output} is not a name for a figure; choose another")
    with matplotlib.rc_context(STYLE), np.errstate(all="ignore"):
        try:
            if what == "animation":
                return f"wrote {output}: {write_animation(views[0], points, output)}"
            figure, shown = _figure(views, roots, what, points)
            figure.savefig(output, dpi=160)
        except OSError as error:
            raise EnvironmentLacks(f"{output} cannot be written: {error.strerror or error}") from error
        except (ValueError, ArithmeticError, MemoryError) as error:  # what another program wrote into it
            raise InputError(
                f"{views[0].path} holds numbers that no figure can show ({str(error)[:100]})"
            ) from error
    return f"wrote {output}: {shown}"


def chosen_figure(views: Sequence[View], output: Path, what: str | None, points: Sequence[int]) -> str | None:
    """Which figure of the task limit_cycle is meant, None for other tasks; InputError if options do not fit.

    What the user names, or else an animation for a film's suffix, shapes where they are stored of few points,
    and amplitudes.
    """
    first, *others = views
    odd = next((view for view in views if view.task != "limit_cycle"), None)
    if odd is not None:
        for word, given in (
            ("--what", what is not None),
            ("--point", bool(points)),
            ("several files", others),
        ):
            if given:
                raise InputError(f"{odd.path}: {word} is for results of limit_cycle, and this is {odd.task}")
        return None
    if what is None and output.suffix in FILMS:
        what = "animation"
    if what is None:
        varies = len(set(map(float, point_columns(first)["F"]))) > 1
        few = len(points) > 0 or (outcomes(first) == "cycle").sum() <= MOST_CYCLES
        shapes = few and not others and SHAPES[0] in first.variables
        what = "amplitude" if others or (varies and not points and not shapes) else "cycle"
    if others and what != "amplitude":
        raise InputError(f"--what {what} draws one file; only amplitudes of several files make one figure")
    if points and what == "amplitude":
        raise InputError("--point is given but amplitudes are drawn of all points; remove it")
    return what


def _figure(views: Sequence[View], roots: str, what: str | None, points: Sequence[int]) -> tuple[Figure, str]:
    """The figure and what it shows."""
    if what is None:
        return FIGURES[views[0].task](views[0], roots)
    if what == "amplitude":
        return draw_amplitude(views)
    return CYCLE_FIGURES[what](views[0], points)
