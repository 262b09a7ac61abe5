"""Figures of result files: one module per task, and `draw`, which writes the figure of any of them."""

from collections.abc import Callable, Sequence
from pathlib import Path

import matplotlib
import numpy as np

from ...errors import EnvironmentLacks, InputError
from ...results.file.view import View
from .limit_cycle import limit_cycle_figure
from .modes import modes_figure
from .phase_diagram import phase_diagram_figure
from .request import Drawing, FigureRequest
from .spectrum import spectrum_figure
from .style import STYLE
from .thresholds import thresholds_figure

FIGURES: dict[str, Callable[[FigureRequest], Drawing]] = {
    "spectrum": spectrum_figure,
    "thresholds": thresholds_figure,
    "phase_diagram": phase_diagram_figure,
    "modes": modes_figure,
    "limit_cycle": limit_cycle_figure,
}
"""What the task of the first file draws."""


def draw(
    views: View | Sequence[View],
    output: Path,
    roots: str = "smallest",
    what: str | None = None,
    points: Sequence[int] = (),
) -> str:
    """Draws the figure of a file, or of several, into `output`; returns a sentence about it.

    `roots`, `what` and `points`: see `FigureRequest`. Raises InputError where there is nothing that a figure
    could show.
    """
    views = [views] if isinstance(views, View) else views
    drawing = FIGURES[views[0].task](FigureRequest(views, output.suffix, roots, what, points))
    if output.suffix not in drawing.suffixes:
        raise InputError(f"--output {output}: the name must end in {', '.join(drawing.suffixes)}")
    taken = output.exists() and any(output.samefile(view.path) for view in views if view.path.exists())
    if taken or (output.exists() and not output.is_file()):
        raise InputError(f"--output {output} is not a name for a figure; choose another")
    with matplotlib.rc_context(STYLE), np.errstate(all="ignore"):
        try:
            return f"wrote {output}: {drawing.write(output)}"
        except OSError as error:
            raise EnvironmentLacks(f"{output} cannot be written: {error.strerror or error}") from error
        except (ValueError, ArithmeticError, MemoryError) as error:  # what another program wrote into it
            raise InputError(
                f"{views[0].path} holds numbers that no figure can show ({str(error)[:100]})"
            ) from error
