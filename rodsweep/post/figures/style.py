"""Common style of figures: symbols, labels, colours and titles, scales of axes, and refusals."""

from collections.abc import Mapping, Sequence
from math import isinf
from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from ...errors import InputError
from ...model.parameters import PARAMETERS
from ...results.file.view import View

SYMBOLS = {name: parameter.symbol for name, parameter in PARAMETERS.items()}
"""Symbols of parameters in TeX."""
LABELS = {name: f"{p.meaning} ${p.symbol}$" for name, p in PARAMETERS.items()}
"""Labels of axes. The tilde marks a dimensionless symbol, which has no unit."""
CRITICAL_FORCE = f"critical force ${SYMBOLS['F']}$"
INVERSE_DRAG = rf"inverse rotational drag $1/{SYMBOLS['gamma3']}$"
FIRST = "#0072B2"
"""Blue of Okabe and Ito's palette, whose colours are distinct for colour-blind readers."""
SECOND = "#D55E00"
"""Vermilion of the same palette."""
THIRD = "#009E73"
"""Green of the same palette."""
DECADE = 10
"""Ratio of the largest to the smallest value of a map above which its colours are logarithmic."""
FEW_DECADES = 50
"""Ratio of the ends of a logarithmic axis below which 1, 2 and 5 of each decade have labels."""
IN_ONE_DECADE = 6
"""Ratio of the ends below which more numbers have labels, because few of 1, 2 and 5 may be visible."""
MIN_POWER = 2
"""Smallest exponent of a power of ten written as a power."""
PLAIN_BELOW = 4
"""Exponent of ten below which numbers are written without a power of ten."""
STYLE = {
    "font.size": 10,
    "axes.titlesize": 9,
    "figure.titlesize": 9,
    "legend.fontsize": 8,
    "axes.grid": False,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "hatch.linewidth": 0.6,
    "savefig.dpi": 300,
    # Journals refuse fonts of Type 3, matplotlib's default.
    "pdf.fonttype": 42,
    "ps.fonttype": 42,
}
"""Settings of matplotlib for all figures."""
FONT_SIZES = ("font.size", "axes.titlesize", "axes.labelsize", "figure.titlesize", "legend.fontsize",
           "xtick.labelsize", "ytick.labelsize")  # fmt: skip
"""Settings of font sizes."""
PRINT_STYLE = STYLE | dict.fromkeys(FONT_SIZES, 8)
"""Settings for a figure in print, all of whose text has 8 points."""


def plain(text: object) -> str:
    """A user's text for matplotlib, in which a dollar does not start mathematics."""
    return str(text).replace("$", r"\$")


def heading(view: View, *lines: str) -> str:
    """Title of the file, given by the user, above further lines."""
    title = " ".join(plain(view.attributes.get("title", "")).split())
    return "\n".join(filter(None, (title, material_text(view), *lines)))


def material_text(view: View) -> str:
    """Law and profile of the arms of a file; empty for arms of linear material without a profile."""
    material = view.config.get("material", {})
    law = material.get("law", "linear")
    words = [] if law == "linear" else [f"neo-Hookean, {material.get('section', 'fixed')} section"]
    return ", ".join([*words, *(["with a profile"] if "profile" in material else [])])


def name_in(view: View, views: Sequence[View]) -> str:
    """Name of a file in a figure of several: its law or title if all differ, else its path."""
    laws = [material_text(each) or "linear" for each in views]
    if len(set(laws)) == len(laws):
        return laws[list(views).index(view)]
    titles = [" ".join(plain(each.attributes.get("title", "")).split()) for each in views]
    distinct = len(set(titles)) == len(titles) and all(titles)
    return titles[list(views).index(view)] if distinct else plain(view.path.stem)


def number(value: float, digits: int = 6) -> str:
    """A number in TeX without dollars: 1e4 is 10^4, 2.5e-4 is 2.5 x 10^-4, and 200 stays 200."""
    if isinf(value):
        return r"\infty" if value > 0 else r"-\infty"
    if value == 0:
        return "0"
    mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
    power = int(exponent)
    factor = float(mantissa)
    if abs(factor) == 1 and abs(power) >= MIN_POWER:
        return f"{'-' * (factor < 0)}10^{{{power}}}"
    if -MIN_POWER <= power < min(PLAIN_BELOW, digits):
        return f"{value:.{digits}g}"
    return rf"{factor:g}\times10^{{{power}}}"


def parameter_text(parameters: Mapping[str, float], digits: int = 6) -> str:
    """Parameters with values, as a line of text."""
    return ", ".join(f"${SYMBOLS[name]} = {number(value, digits)}$" for name, value in parameters.items())


def fixed_text(view: View, *drawn: str) -> str:
    """Parameters away from the axes of the figure, with values."""
    return parameter_text({name: values[0] for name, values in view.axes.items() if name not in drawn})


def long_axes(view: View) -> list[str]:
    """Parameters of a grid with several values; raises InputError unless one or two are found."""
    long = [name for name, values in view.axes.items() if len(values) > 1]
    if not 1 <= len(long) <= 2:
        raise InputError(
            f"{view.path} has {len(long)} axes with more than one value ({', '.join(long) or 'none'}); a "
            "figure needs one or two; --at, such as --at k1=150, selects one value of an axis"
        )
    return long


def require(view: View, available: object, what: str) -> None:
    """Raises InputError, naming the missing `what`, unless anything is available to draw."""
    if not available:
        raise InputError(f"{view.path} holds no {what} that could be drawn")


def legend_below(figure: Figure, handles: list[Any], columns: int) -> None:
    """Draws the legend of a whole figure, below its panels."""
    figure.legend(handles=handles, loc="outside lower center", ncols=columns, frameon=False)


def is_logarithmic(values: np.ndarray) -> bool:
    """Whether an axis, shape (n,), has equal ratios without equal steps, or spans more than a decade."""
    if len(values) < 2 or values[0] <= 0 or not np.isfinite(values).all():
        return False
    steps = np.diff(values)
    ratios = values[1:] / values[:-1]
    if len(values) > 2 and np.ptp(steps) <= 1e-6 * values[-1]:
        return False
    even = len(values) > 2 and np.ptp(ratios) < 1e-6 * ratios[0]
    return bool(even or values[-1] > 10 * values[0])


def scale(axes: Axes, which: Literal["x", "y"], values: np.ndarray) -> None:
    """Makes an axis logarithmic for logarithmic values, shape (n,), with labels that do not overlap."""
    if not is_logarithmic(values):
        return
    axes.set(**{f"{which}scale": "log"})
    label_few_decades(axes.xaxis if which == "x" else axes.yaxis, values[0], values[-1])


def label_few_decades(axis: Axis, low: float, high: float) -> None:
    """Labels 1, 2 and 5 of each decade of a short logarithmic axis, all as plain numbers or all as powers."""
    if high < FEW_DECADES * low:
        subs = (1, 2, 5) if high > IN_ONE_DECADE * low else (1, 1.5, 2, 3, 4, 6, 8)
        axis.set_major_locator(LogLocator(subs=subs))
        written_out = low >= 10.0**-MIN_POWER and high < 10.0 ** (PLAIN_BELOW + 1)
        axis.set_major_formatter(
            FuncFormatter(lambda value, _: f"{value:g}" if written_out else f"${number(value)}$")
        )
        axis.set_minor_formatter(NullFormatter())


def label_outer(axes: Axes, xlabel: str, ylabel: str) -> None:
    """Labels the axes of a panel in a grid of panels that share axes; inner panels get no labels."""
    place = axes.get_subplotspec()
    if place is None or place.is_last_row():
        axes.set_xlabel(xlabel)
    if place is None or place.is_first_col():
        axes.set_ylabel(ylabel)


def colour_cells(
    axes: Axes,
    edges: tuple[np.ndarray, np.ndarray],
    values: np.ndarray,
    label: str,
    colours: str = "viridis",
    ratios: bool = True,
) -> None:
    """Draws cells in colours of their values, (ny, nx), NaN for no value, with a labelled colour bar.

    ratios: whether the colours are logarithmic if the values span more than a decade.
    """
    low = float(np.nanmin(values))
    high = float(np.nanmax(values))
    if ratios and high > DECADE * low > 0:
        norm: Normalize = LogNorm(low, high)
    else:
        # Equal zeros would give a scale below zero.
        norm = Normalize(low, high if high != low or low else 1.0)
    mesh = axes.pcolormesh(*edges, np.ma.masked_invalid(values), norm=norm, cmap=colours, rasterized=True)
    bar = axes.figure.colorbar(mesh, ax=axes, label=label)
    if isinstance(norm, LogNorm):
        label_few_decades(bar.ax.yaxis, low, high)
