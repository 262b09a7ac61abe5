"""Critical forces against the parameters of the rod, as the paper's Fig. 3 draws them."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ...results.file.view import View
from .request import Drawing, FigureRequest, image
from .style import (
    FIRST,
    FORCE_UNIT,
    INVERSE_DRAG,
    LABELS,
    SECOND,
    SYMBOLS,
    THIRD,
    fixed_text,
    heading,
    long_axes,
    need,
    need_grid,
    scale,
)

CRITICAL_FORCES = (
    ("F_onset", r"onset $\tilde F_*$", FIRST, "o"),
    ("F_hopf", r"Hopf $\tilde F_{**}$", SECOND, "s"),
    ("F_restabilization", "restabilization", THIRD, "^"),
)
MOST_VALUES = 3
"""Values of the other parameter for which lines are drawn in one panel."""
STYLES = ("-", "--", ":")


def thresholds_figure(request: FigureRequest) -> Drawing:
    """The figure of the file that is asked for."""
    view = request.only_view()
    return image(lambda: draw_thresholds(view))


def draw_thresholds(view: View) -> tuple[Figure, str]:
    """One panel for each long axis: the first onset, Hopf point and restabilization along it."""
    need_grid(view, "rods")
    long = long_axes(view)
    need(view, any(np.isfinite(view.variables[name]).any() for name, *_ in CRITICAL_FORCES), "threshold")
    figure = Figure(figsize=(4.6 * len(long) + 0.4, 4.0), layout="constrained")
    panels = figure.subplots(1, len(long), sharey=True, squeeze=False)[0]
    for panel, name in zip(panels, long, strict=True):
        _panel(panel, view, name, [other for other in long if other != name])
    panels[0].set_ylabel(rf"critical force ${SYMBOLS['F']}$  {FORCE_UNIT}")
    figure.suptitle(heading(view, fixed_text(view, *long)), fontsize=9)
    left_out = [name for name in long if not np.isfinite(view.axes[name]).all()]
    without = f"; {' and '.join(left_out)} = inf has no place on an axis and is left out" if left_out else ""
    return figure, "critical forces against " + " and ".join(long) + without


def _panel(panel: Axes, view: View, name: str, others: list[str]) -> None:
    """The critical forces against one parameter, for some values of the other one."""
    axes = list(view.axes)
    x, label = view.axes[name], LABELS[name]
    if name == "gamma3":  # as the paper: against 1/gamma3
        with np.errstate(divide="ignore"):
            x, label = 1 / x, INVERSE_DRAG
    place = others[0] if others else None
    chosen = _spread(view.axes[place]) if place else [0]
    labels = {variable: word for variable, word, *_ in CRITICAL_FORCES}
    for line, at in enumerate(chosen):
        index = tuple(slice(None) if n == name else (at if n == place else 0) for n in axes)
        for variable, _, colour, marker in CRITICAL_FORCES:
            values = view.variables[variable][index]
            keep = np.isfinite(x) & np.isfinite(values)
            if keep.any():
                (drawn,) = panel.plot(x[keep], values[keep], STYLES[line], color=colour, marker=marker)
                drawn.set(label=labels.pop(variable, None), markersize=2.5, linewidth=1.2)
    for line, at in enumerate(chosen if place else []):
        text = rf"${SYMBOLS[str(place)]}$ = {view.axes[str(place)][at]:.3g}"
        panel.plot([], [], STYLES[line], color="0.3", label=text)
    scale(panel, "x", np.sort(x[np.isfinite(x)]))
    panel.set_xlabel(label)
    panel.set_ylim(bottom=0)
    panel.legend(frameon=False, fontsize=8)


def _spread(values: np.ndarray) -> list[int]:
    """Places of the first, the middle and the last value, each once."""
    return sorted({0, (len(values) - 1) // 2, len(values) - 1})[:MOST_VALUES]
