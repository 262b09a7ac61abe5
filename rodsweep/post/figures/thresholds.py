"""Critical forces against the parameters of the rod, as the paper's Fig. 3 draws them."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ...results.file.view import View
from . import style
from .request import FigureRequest

CRITICAL_FORCES = (
    ("F_onset", r"onset $\tilde F_*$", style.FIRST, "o"),
    ("F_hopf", r"Hopf $\tilde F_{**}$", style.SECOND, "s"),
    ("F_restabilization", "restabilization", style.THIRD, "^"),
)
LINE_STYLES = ("-", "--", ":")
"""For the values of the other parameter for which lines are drawn in one panel."""


def draw_thresholds(request: FigureRequest) -> str:
    """One panel for each long axis: the first onset, Hopf point and restabilization along it."""
    view = request.only_view()
    style.need_grid(view, "rods")
    long = style.long_axes(view)
    style.need(
        view, any(np.isfinite(view.variables[name]).any() for name, *_ in CRITICAL_FORCES), "threshold"
    )
    figure = Figure(figsize=(4.6 * len(long) + 0.4, 4.0), layout="constrained")
    panels = figure.subplots(1, len(long), sharey=True, squeeze=False)[0]
    for panel, name in zip(panels, long, strict=True):
        _panel(panel, view, name, [other for other in long if other != name])
    panels[0].set_ylabel(f"critical force ${style.SYMBOLS['F']}$")
    figure.suptitle(style.heading(view, style.fixed_text(view, *long)), fontsize=9)
    left_out = [name for name in long if not np.isfinite(view.axes[name]).all()]
    without = f"; {' and '.join(left_out)} = inf has no place on an axis and is left out" if left_out else ""
    return request.write(figure, "critical forces against " + " and ".join(long) + without)


def _panel(panel: Axes, view: View, name: str, others: list[str]) -> None:
    """The critical forces against one parameter, for some values of the other one."""
    axes = list(view.axes)
    x, label = view.axes[name], style.LABELS[name]
    if name == "gamma3":  # as the paper: against 1/gamma3
        x, label = 1 / x, style.INVERSE_DRAG
    place = others[0] if others else None
    last = len(view.axes[place]) - 1 if place else 0
    chosen = sorted({0, last // 2, last})
    labels = {variable: word for variable, word, *_ in CRITICAL_FORCES}
    for line, at in enumerate(chosen):
        index = tuple(slice(None) if n == name else (at if n == place else 0) for n in axes)
        for variable, _, colour, marker in CRITICAL_FORCES:
            values = view.variables[variable][index]
            keep = np.isfinite(x) & np.isfinite(values)
            if keep.any():
                (drawn,) = panel.plot(x[keep], values[keep], LINE_STYLES[line], color=colour, marker=marker)
                drawn.set(label=labels.pop(variable, None), markersize=2.5, linewidth=1.2)
    for line, at in enumerate(chosen if place else []):
        text = style.parameter_text({str(place): float(view.axes[str(place)][at])}, digits=3)
        panel.plot([], [], LINE_STYLES[line], color="0.3", label=text)
    style.scale(panel, "x", np.sort(x[np.isfinite(x)]))
    panel.set_xlabel(label)
    panel.set_ylim(bottom=0)
    panel.legend(frameon=False, fontsize=8)
