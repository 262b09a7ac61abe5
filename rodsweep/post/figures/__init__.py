"""Figures of result files: one module per task, and `draw`, which writes the figure of any of them."""

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import replace
from pathlib import Path
from typing import TypedDict, Unpack

import matplotlib
import matplotlib.style
import numpy as np
from matplotlib import rc_params_from_file
from matplotlib.figure import Figure

from ...errors import EnvironmentIncomplete, InputError
from ...results.file.view import View
from .arm.map import can_draw, draw_arm_map
from .branch import draw_branch
from .criticality import draw_criticality
from .cycle.selection import outcomes
from .limit_cycle import draw_limit_cycle
from .modes import draw_modes
from .phase_diagram import draw_phase_diagram
from .request import FigureRequest, Look, Shapes
from .spectrum import draw_spectrum
from .style import PRINT_STYLE, STYLE
from .thresholds import draw_thresholds

FIGURES: dict[str, Callable[[FigureRequest], str]] = {
    "spectrum": draw_spectrum,
    "thresholds": draw_thresholds,
    "phase_diagram": draw_phase_diagram,
    "modes": draw_modes,
    "limit_cycle": draw_limit_cycle,
    "criticality": draw_criticality,
    "branch": draw_branch,
}
"""How each task draws, which the first file names: writes the figure and returns what it shows."""


PLAIN = Look()
LACKING = {"missing": "are not computed", "failed": "failed"}
"""Statuses of points that no figure shows, and what is said of their number."""


def _styled(look: Look) -> AbstractContextManager[None]:
    """The settings of all figures, and the user's above them; InputError for a style that there is not."""
    ours = STYLE if look.width is None else PRINT_STYLE
    if look.style is None:
        return matplotlib.rc_context(ours)
    try:
        if look.style not in matplotlib.style.library:
            Path(look.style).read_text(encoding="utf-8")  # matplotlib logs what is no text
        own = matplotlib.style.library.get(look.style) or rc_params_from_file(
            look.style, use_default_template=False
        )
    except (OSError, ValueError):  # no such file, or one that is no text
        raise InputError(f"{look.style} is neither a style of matplotlib's nor a style file") from None
    return matplotlib.rc_context(ours | dict(own))


class Choices(TypedDict, total=False):
    """What is drawn of a file: `roots` of spectra, `what` of several figures, `points` numbered from 1."""

    roots: str | None
    what: str | None
    points: Sequence[int]


def _drawn(request: FigureRequest) -> str:
    """Writes the figure and returns what it shows: of an arm over its quantities, or as of a rod."""
    if can_draw(request):
        return draw_arm_map(request)
    listed = replace(request, views=[view.listed for view in request.views])
    return FIGURES[request.views[0].task](listed)


def draw(
    views: View | Sequence[View],
    output: Path,
    *,
    look: Look = PLAIN,
    shapes: Shapes | None = None,
    keep: Callable[[Figure], None] | None = None,
    **choices: Unpack[Choices],
) -> str:
    """Draws the figure of a file, or of several, into `output`; returns a sentence about it.

    shapes: solves cycles whose shapes a file lacks. keep: takes the figure instead of a file. Raises
    InputError where there is nothing that a figure could show.
    """
    views = [views] if isinstance(views, View) else views
    if look.width and choices.get("what") == "animation":
        raise InputError("--width is for figures in print, and an animation is none; leave it out")
    if not look.title:
        views = [replace(view, attributes=view.attributes | {"title": ""}) for view in views]
    taken = output.exists() and (
        not output.is_file() or any(output.samefile(view.path) for view in views if view.path.exists())
    )
    request = FigureRequest(views, output, taken=taken, look=look, shapes=shapes, keep=keep, **choices)
    with _styled(look), np.errstate(all="ignore"):
        try:
            shown = _drawn(request)
        except OSError as error:
            raise EnvironmentIncomplete(f"{output} cannot be written: {error.strerror or error}") from error
        except RuntimeError as error:  # of programs that a style asks for, as LaTeX
            raise EnvironmentIncomplete(
                f"the figure cannot be drawn: {str(error).splitlines()[0]}"
            ) from error
        except (ValueError, ArithmeticError, MemoryError) as error:  # what another program wrote into it
            raise InputError(
                f"{views[0].path} holds numbers that no figure can show ({str(error)[:100]})"
            ) from error
    return f"wrote {output}: {shown}{_lacking(views)}"


def _lacking(views: Sequence[View]) -> str:
    """What is said of points of which there is nothing to draw."""
    words = np.concatenate([outcomes(view) for view in views])
    told = (f"{np.count_nonzero(words == word)} {said}" for word, said in LACKING.items() if word in words)
    lacking = " and ".join(told)
    return f"; of {words.size} points {lacking}" if lacking else ""
