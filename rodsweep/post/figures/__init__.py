"""Figures of result files: one module per task, and `draw`, which writes the figure of any task."""

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
from ...results.file.view import ResultView
from .arm.arm_figure import can_draw_arm_figure, draw_arm_figure
from .branch import draw_branch
from .criticality import draw_criticality
from .limit_cycle import draw_limit_cycle
from .modes import draw_modes
from .phase_diagram import draw_phase_diagram
from .request import CycleShapeSolver, FigureLook, FigureRequest
from .spectrum import draw_spectrum
from .style import FIGURE_STYLE, PRINT_STYLE
from .thresholds import draw_thresholds

DRAW_FUNCTION_BY_TASK: dict[str, Callable[[FigureRequest], str]] = {
    "spectrum": draw_spectrum,
    "thresholds": draw_thresholds,
    "phase_diagram": draw_phase_diagram,
    "modes": draw_modes,
    "limit_cycle": draw_limit_cycle,
    "criticality": draw_criticality,
    "branch": draw_branch,
}
"""For each task, the function that writes the figure and returns a description of the figure."""
DEFAULT_LOOK = FigureLook()
"""Appearance of figures without options of the user."""
OMITTED_STATUSES = {"missing": "are not computed", "failed": "failed"}
"""For each status of points that no figure shows, the predicate of a clause about these points."""


def _style_context(look: FigureLook) -> AbstractContextManager[None]:
    """Context in which matplotlib uses the settings for all figures and the style that the user has chosen.
    Raises InputError for an unknown style."""
    package_style = FIGURE_STYLE if look.width is None else PRINT_STYLE
    if look.style is None:
        return matplotlib.rc_context(package_style)
    try:
        if look.style not in matplotlib.style.library:
            Path(look.style).read_text(encoding="utf-8")  # for a file that is no text, matplotlib only logs
        user_style = matplotlib.style.library.get(look.style) or rc_params_from_file(
            look.style, use_default_template=False
        )
    except (OSError, ValueError):  # the file does not exist, or is no text
        raise InputError(f"{look.style} is neither a style of matplotlib nor a style file") from None
    return matplotlib.rc_context(package_style | dict(user_style))


class FigureChoices(TypedDict, total=False):
    """Options that choose the content of a figure.

    roots: choice of roots in a figure of spectra, one of ROOT_CHOICES. what: kind of figure, one of
    FIGURE_KINDS. points: numbers of the drawn points, from 1.
    """

    roots: str | None
    what: str | None
    points: Sequence[int]


def _draw_and_describe(request: FigureRequest) -> str:
    """Writes the figure and returns a description of the figure. If quantities of an arm vary and no other
    kind of figure is requested, the figure shows results over these quantities. InputError if roots are
    requested for another task than spectrum."""
    if can_draw_arm_figure(request):
        return draw_arm_figure(request)
    first = request.views[0]
    if request.roots and DRAW_FUNCTION_BY_TASK[first.task] != draw_spectrum:
        raise InputError(
            f"{first.path}: --roots is for results of spectrum, and this is a result of {first.task}"
        )
    return DRAW_FUNCTION_BY_TASK[first.task](replace(request, views=[view.as_list for view in request.views]))


def draw(
    views: ResultView | Sequence[ResultView],
    output: Path,
    *,
    look: FigureLook = DEFAULT_LOOK,
    shapes: CycleShapeSolver | None = None,
    figure_callback: Callable[[Figure], None] | None = None,
    **choices: Unpack[FigureChoices],
) -> str:
    """Draws the figure of one or several result files to the file `output`; returns a sentence about the
    figure.

    shapes: function that computes the shapes of cycles if the file has no shapes. figure_callback: callback
    for the finished figure; if given, no file is written. choices: see `FigureChoices`. Raises InputError for
    options that do not fit the files and for files without a result that can be drawn, and
    EnvironmentIncomplete if `output` cannot be written or a program of the style, such as LaTeX, fails.
    """
    views = [views] if isinstance(views, ResultView) else views
    if look.width and choices.get("what") == "animation":
        raise InputError("--width is for printed figures, not for an animation; remove --width")
    if not look.title:
        views = [replace(view, attributes=view.attributes | {"title": ""}) for view in views]
    is_protected = output.exists() and (
        not output.is_file() or any(output.samefile(view.path) for view in views if view.path.exists())
    )
    request = FigureRequest(
        views,
        output,
        is_output_protected=is_protected,
        look=look,
        shape_solver=shapes,
        figure_callback=figure_callback,
        **choices,
    )
    with _style_context(look), np.errstate(all="ignore"):  # NaN and inf are ordinary data of a figure
        try:
            caption = _draw_and_describe(request)
        except OSError as error:
            raise EnvironmentIncomplete(f"{output} cannot be written: {error.strerror or error}") from error
        except RuntimeError as error:  # raised by a program that a style uses, such as LaTeX
            raise EnvironmentIncomplete(
                f"the figure cannot be drawn: {str(error).splitlines()[0]}"
            ) from error
        except (ValueError, ArithmeticError, MemoryError) as error:  # numbers that another program wrote
            raise InputError(
                f"{views[0].path} holds numbers that no figure can show ({str(error)[:100]})"
            ) from error
    return f"wrote {output}: {caption}{_omitted_points_clause(views)}"


def _omitted_points_clause(views: Sequence[ResultView]) -> str:
    """Clause on the number of points that the figure omits; empty if the figure shows all points."""
    statuses = np.concatenate([view.status_names for view in views])
    counts = (
        f"{np.count_nonzero(statuses == word)} {text}"
        for word, text in OMITTED_STATUSES.items()
        if word in statuses
    )
    omitted_text = " and ".join(counts)
    return f"; of {statuses.size} points {omitted_text}" if omitted_text else ""
