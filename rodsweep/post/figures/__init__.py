"""Figures of a result file: `draw` finds the task's figure and writes it; one module per task."""

from collections.abc import Callable
from pathlib import Path

import matplotlib
from matplotlib.figure import Figure

from ...errors import EnvironmentLacks, InputError
from ...results.view import View
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
"""The figure of every task: from (view, roots) to (figure, what it shows)."""


def draw(view: View, output: Path, roots: str) -> str:
    """Draws the file's figure into `output`; returns a sentence about it.

    Raises InputError where there is nothing that a figure could show.
    """
    if output.suffix not in FORMATS:
        raise InputError(f"--output {output}: the name must end in {', '.join(FORMATS)}")
    if output.is_dir() or (output.exists() and output.samefile(view.path)):
        raise InputError(f"--output {output} is not a name for a figure; choose another")
    with matplotlib.rc_context(STYLE):
        figure, what = FIGURES[view.task](view, roots)
        try:
            figure.savefig(output, dpi=160)
        except OSError as error:
            raise EnvironmentLacks(f"{output} cannot be written: {error.strerror}") from error
    return f"wrote {output}: {what}"
