"""Lines of spectra of several files, a panel each, as in the whole of the paper's Fig. 2."""

from collections.abc import Sequence
from string import ascii_lowercase

from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ....results.file.view import View
from ..style import fixed_text, heading, legend_below, long_axes
from .line import FOLLOWED_ROOTS, THRESHOLD_LINE, THRESHOLD_LOOKS, draw_roots, mark_thresholds, threshold_text

MAX_PANELS = 12
"""Largest number of panels on a page."""
PANEL_HEIGHT = {1: 2.1, 2: 2.6}
"""Height of a panel, in inches, by the number of columns."""
FIGURE_WIDTH = {1: 3.375, 2: 7.0}
"""Width of the figure, in inches, by the number of columns."""

THRESHOLD_WORDS = {
    "onset": "onset of oscillation",
    "hopf": "change of stability",
    "restabilization": "change of stability",
}
"""Entries of the common legend for lines at thresholds; the panel titles have names and forces."""


def draw_panels(views: Sequence[View], roots: str, narrow: bool) -> Figure:
    """Figure of the followed roots of each file, in one column if narrow, with a common legend."""
    columns = 1 if narrow else 2
    rows = -(-len(views) // columns)
    size = FIGURE_WIDTH[columns], PANEL_HEIGHT[columns] * rows + 0.8
    figure = Figure(figsize=size, layout="constrained")
    panels = figure.subplots(rows, columns, squeeze=False).ravel()
    handles: dict[str, Artist] = {}
    for letter, panel, view in zip(ascii_lowercase, panels, views, strict=False):
        (name,) = long_axes(view)
        draw_roots(panel, view, name, roots)
        thresholds = mark_thresholds(panel, view, name)
        for handle, label in zip(*panel.get_legend_handles_labels(), strict=True):
            handles.setdefault(label, handle)
        for threshold in thresholds:
            handles.pop(threshold_text(threshold), None)
            word = THRESHOLD_WORDS[threshold.kind]
            _, style = THRESHOLD_LOOKS[threshold.kind]
            handles[word] = Line2D([], [], ls=style, label=word, **THRESHOLD_LINE)
        text = heading(view, fixed_text(view, name), ", ".join(map(threshold_text, thresholds)))
        panel.set_title(f"({letter})  {text}", loc="left")
    for panel in panels[len(views) :]:
        panel.remove()
    legend_below(figure, list(handles.values()), 2 if narrow else 3)
    figure.suptitle(FOLLOWED_ROOTS[roots])
    return figure
