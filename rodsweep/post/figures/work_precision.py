"""Errors of methods against their time, as the benchmarks measure them."""

from dataclasses import dataclass
from math import ceil, sqrt
from pathlib import Path
from textwrap import fill

import matplotlib
import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter
from numpy.typing import NDArray

from ...errors import EnvironmentLacks
from .style import FIRST, SECOND, STYLE, THIRD

COLOURS = (FIRST, SECOND, THIRD, "black", "0.55")
"""Of the groups, in the order in which they appear; the first group is drawn thick."""
MARKERS = ("o", "s", "^", "D", "v", "P", "X")
"""Of the methods of one group."""
WIDE = 1e3
"""Ratio of the times from which on only powers of ten have a label."""
LEAST_ERROR = 1e-17
"""Relative errors are drawn from here up: an error of exactly zero has no logarithm."""
SIZE, TITLE_WIDTH = 3.6, 36
"""Of one panel, in inches, and of its title, in characters."""


@dataclass(frozen=True, eq=False)
class Curve:
    """One method: milliseconds and relative errors at its settings, shape (settings,) each."""

    method: str
    group: str
    milliseconds: NDArray[np.float64]
    errors: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Panel:
    """One case, with every method that ran on it."""

    title: str
    curves: tuple[Curve, ...]


def draw_work_precision(panels: list[Panel], xlabel: str, target: float | None, output: Path) -> None:
    """Writes the figure: errors against time, the target as a line, one legend for all panels."""
    curves = [curve for panel in panels for curve in panel.curves]
    looks = _looks(curves)
    times = np.concatenate([curve.milliseconds for curve in curves])
    wide = np.nanmax(times) > WIDE * np.nanmin(times)
    across = ceil(sqrt(len(panels)))
    down = ceil(len(panels) / across)
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(SIZE * across + 3.0, SIZE * down + 0.5), layout="constrained")
        grid = figure.subplots(down, across, sharex=True, sharey=True, squeeze=False)
        for axes, panel in zip(grid.flat, panels, strict=False):
            axes.set(xscale="log", yscale="log")
            axes.set_title(fill(panel.title, TITLE_WIDTH), fontsize=10)
            if target is not None:
                axes.axhline(target, color="0.75", lw=0.8, zorder=0)
            for curve in panel.curves:
                errors = np.maximum(curve.errors, LEAST_ERROR)
                axes.plot(curve.milliseconds, errors, **looks[curve.method])
            axes.xaxis.set_major_locator(LogLocator(subs=(1,) if wide else (1, 2, 5)))
            axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
            axes.xaxis.set_minor_formatter(NullFormatter())
        for axes in grid.flat[len(panels) :]:
            axes.set_axis_off()
        figure.supxlabel(xlabel)
        figure.supylabel("relative error")
        handles = [Line2D([], [], label=method, **look) for method, look in looks.items()]
        figure.legend(handles=handles, loc="outside right center", frameon=False, fontsize=9)
        try:
            figure.savefig(output, dpi=160)
        except OSError as error:
            raise EnvironmentLacks(f"{output} cannot be written: {error.strerror}") from error


def _looks(curves: list[Curve]) -> dict[str, dict]:
    """Colour by group, marker within it, for every method."""
    groups = list(dict.fromkeys(curve.group for curve in curves))
    counts = dict.fromkeys(groups, 0)
    looks: dict[str, dict] = {}
    for curve in curves:
        if curve.method in looks:
            continue
        first = curve.group == groups[0]
        colour = COLOURS[groups.index(curve.group) % len(COLOURS)]
        marker = MARKERS[counts[curve.group] % len(MARKERS)]
        counts[curve.group] += 1
        look = {"color": colour, "marker": marker, "ms": 5, "lw": 2.2 if first else 1.1}
        looks[curve.method] = look | {"mfc": colour if first else "white", "zorder": 3 if first else 2}
    return looks
