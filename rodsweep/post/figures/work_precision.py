"""Errors of time integrators against their time, as the benchmark of the limit cycle measures them."""

from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import matplotlib
import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter
from numpy.typing import NDArray

from ...errors import EnvironmentLacks
from .style import FIRST, SECOND, STYLE, THIRD

KINDS = (("ARKIMEX", FIRST, "-"), ("BDF", THIRD, "-"), ("ROSW", THIRD, "--"), ("SciPy", SECOND, "-."))
"""How a method's name begins, the colour and the line; others are black and dotted."""
MARKERS = ("o", "s", "^", "D")
"""Of the methods of one kind."""
PANELS = (("period_errors", "period"), ("amplitude_errors", "largest tip $y$"))


@dataclass(frozen=True, eq=False)
class Curve:
    """One method: milliseconds a period and relative errors at its tolerances, each (tolerances,)."""

    COLUMNS: ClassVar[tuple[str, ...]] = ("milliseconds", "period_error", "amplitude_error")

    method: str
    milliseconds: NDArray[np.float64]
    period_errors: NDArray[np.float64]
    amplitude_errors: NDArray[np.float64]


def draw_work_precision(curves: list[Curve], target: float, output: Path) -> None:
    """Writes the figure: a panel for each error, the target as a line, the default's curve thick."""
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(9.6, 4.4), layout="constrained")
        panels = figure.subplots(1, 2, sharex=True, sharey=True)
        handles = []
        for axes, (column, what) in zip(panels, PANELS, strict=True):
            axes.set(xscale="log", yscale="log", xlabel="ms a period", title=f"error of the {what}")
            axes.axhline(target, color="0.75", lw=0.8, zorder=0)
            handles = [
                axes.plot(curve.milliseconds, getattr(curve, column), label=curve.method, **look)[0]
                for curve, look in zip(curves, _looks(curves), strict=True)
            ]
            axes.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
            axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
            axes.xaxis.set_minor_formatter(NullFormatter())
        panels[0].set_ylabel("relative error")
        figure.legend(handles=handles, loc="outside right center", frameon=False, fontsize=9)
        try:
            figure.savefig(output, dpi=160)
        except OSError as error:
            raise EnvironmentLacks(f"{output} cannot be written: {error.strerror}") from error


def _looks(curves: list[Curve]) -> list[dict[str, object]]:
    """Colour by kind, marker within it."""
    seen: dict[str, int] = {}
    looks: list[dict[str, object]] = []
    for curve in curves:
        colour, line = next(((c, s) for k, c, s in KINDS if curve.method.startswith(k)), ("black", ":"))
        marker = MARKERS[seen.setdefault(colour, 0) % len(MARKERS)]
        seen[colour] += 1
        default = "default" in curve.method
        look = {"color": colour, "ls": line, "marker": marker, "ms": 5, "lw": 2.6 if default else 1.2}
        looks.append(look | {"mfc": colour if default else "white", "zorder": 3 if default else 2})
    return looks
