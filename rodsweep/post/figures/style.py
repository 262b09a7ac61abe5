"""Common style of all figures: symbols, labels, colours, titles, scales of axes, and error messages."""

from collections.abc import Mapping, Sequence
from math import isinf
from typing import Literal

import numpy as np
from matplotlib import rcParams
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from ...errors import InputError
from ...model.parameters import PARAMETERS
from ...results.file.view import ResultView
from ...results.layouts.variables import MISSING_STATUS
from ..material_texts import material_words
from .layout.layout_fitting import place_legend

TEX_SYMBOLS = {name: parameter.symbol for name, parameter in PARAMETERS.items()}
"""Symbols of the parameters in TeX, by name."""
AXIS_LABELS = {name: f"{p.meaning} ${p.symbol}$" for name, p in PARAMETERS.items()}
"""Labels of axes, by parameter. A tilde marks a dimensionless symbol, which needs no unit."""
CRITICAL_FORCE_LABEL = f"critical force ${TEX_SYMBOLS['F']}$"
"""Label of an axis of critical forces."""
INVERSE_DRAG_LABEL = rf"inverse rotational drag $1/{TEX_SYMBOLS['gamma3']}$"
"""Label of an axis of 1/gamma3."""
BLUE = "#0072B2"
"""Blue of Okabe and Ito's palette, whose colours colour-blind readers can distinguish."""
VERMILION = "#D55E00"
"""Vermilion of Okabe and Ito's palette."""
GREEN = "#009E73"
"""Green of Okabe and Ito's palette."""
PURPLE = "#CC79A7"
"""Reddish purple of Okabe and Ito's palette."""
LINE_COLOURS = (BLUE, VERMILION, GREEN, PURPLE, "#56B4E9", "#000000")
"""Colours of lines for rods, files or branches, in order: Okabe and Ito's palette, with its sky blue and
black."""
FEW_DECADES_RATIO = 50
"""If the ratio of the ends of a logarithmic axis is below this number, 1, 2 and 5 of each decade have tick
labels."""
SHORT_AXIS_RATIO = 6
"""If the ratio of the ends of a logarithmic axis is below this number, further numbers of each decade have
tick labels, because 1, 2 and 5 could all lie outside the axis."""
MIN_ABS_EXPONENT_OF_BARE_POWER = 2
"""Smallest |n| for which a power of ten is written as 10^n."""
MIN_EXPONENT_OF_POWER_NOTATION = 4
"""Numbers from 0.01 to 10 to this power are written without a power of ten; exact powers of ten follow
MIN_ABS_EXPONENT_OF_BARE_POWER."""
FIGURE_STYLE = {
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
FONT_SIZE_SETTINGS = ("font.size", "axes.titlesize", "axes.labelsize", "figure.titlesize", "legend.fontsize",
           "xtick.labelsize", "ytick.labelsize")  # fmt: skip
"""Names of matplotlib's settings of font sizes."""
PRINT_STYLE = FIGURE_STYLE | dict.fromkeys(FONT_SIZE_SETTINGS, 8)
"""Settings of matplotlib for a figure with a given width; all text has a size of 8 points."""


def text_colour() -> str:
    """Colour of texts in the current style of matplotlib. Black lines have this colour, so that they are
    visible on a dark background; lines on maps are black in every style."""
    return str(rcParams["text.color"])


def escape_dollar_signs(text: object) -> str:
    """A text of the user for matplotlib, with escaped dollar signs, which would otherwise start a formula."""
    return str(text).replace("$", r"\$")


def heading_text(view: ResultView, *lines: str) -> str:
    """Text above a figure: title of the result file (if requested), constitutive law, profile and segments
    (if not standard), and `lines`, one below the other."""
    title = " ".join(escape_dollar_signs(view.attributes.get("title", "")).split())
    return "\n".join(filter(None, (title, material_words(view), *lines)))


def file_label(view: ResultView, views: Sequence[ResultView]) -> str:
    """Text that identifies a file in a figure of several files: constitutive law if all laws differ, else
    title if all titles differ, else file name."""
    laws = [material_words(other_view) or "linear" for other_view in views]
    if len(set(laws)) == len(laws):
        return laws[list(views).index(view)]
    titles = [
        " ".join(escape_dollar_signs(other_view.attributes.get("title", "")).split()) for other_view in views
    ]
    are_titles_distinct = len(set(titles)) == len(titles) and all(titles)
    return titles[list(views).index(view)] if are_titles_distinct else escape_dollar_signs(view.path.stem)


def number_in_tex(value: float, digits: int = 6) -> str:
    """The number `value` as TeX without dollar signs: 1e4 gives 10^4, 2.5e-4 gives 2.5 x 10^-4, 200 gives
    200. digits: largest number of significant digits."""
    if isinf(value):
        return r"\infty" if value > 0 else r"-\infty"
    if value == 0:
        return "0"
    mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
    power = int(exponent)
    factor = float(mantissa)
    if abs(factor) == 1 and abs(power) >= MIN_ABS_EXPONENT_OF_BARE_POWER:
        return f"{'-' * (factor < 0)}10^{{{power}}}"
    if -MIN_ABS_EXPONENT_OF_BARE_POWER <= power < min(MIN_EXPONENT_OF_POWER_NOTATION, digits):
        return f"{value:.{digits}g}"
    return rf"{factor:g}\times10^{{{power}}}"


def parameter_text(parameters: Mapping[str, float], digits: int = 6) -> str:
    """Parameters with their symbols and values, as one line of TeX. digits: largest number of significant
    digits."""
    return ", ".join(
        f"${TEX_SYMBOLS[name]} = {number_in_tex(value, digits)}$" for name, value in parameters.items()
    )


def constant_parameters_text(view: ResultView, *axis_names: str) -> str:
    """Constant parameters with their values, as text. axis_names: names of the parameters on axes."""
    return parameter_text(
        {name: values[0] for name, values in view.parameter_values.items() if name not in axis_names}
    )


def varied_axes(view: ResultView) -> list[str]:
    """Names of the one or two parameters of a grid that have several values. Raises InputError if no
    parameter, or more than two, have several values."""
    varied_names = [name for name, values in view.parameter_values.items() if len(values) > 1]
    if not varied_names:
        raise InputError(
            f"{view.path}: every parameter has one value only; the figure needs one or two parameters with "
            "several values"
        )
    if len(varied_names) > 2:
        raise InputError(
            f"{view.path} has {len(varied_names)} axes with more than one value "
            f"({', '.join(varied_names)}); a figure has "
            "one or two; --at, such as --at k1=150, selects one value of an axis"
        )
    return varied_names


def require_content(view: ResultView, available: object, noun: str) -> None:
    """Raises InputError if `available` is false or empty. noun: noun for the missing content."""
    if not available:
        if (view.variables["status"] == MISSING_STATUS).all():
            raise InputError(f"no point of {view.path} is computed yet; `rodsweep run` continues the run")
        raise InputError(
            f"{view.path} holds no {noun} that could be drawn; `rodsweep show` gives the statuses"
        )


def draw_shared_legend(figure: Figure, column_count: int, areas: Sequence[Artist] = ()) -> None:
    """Draws one legend below the panels, with up to `column_count` columns: `areas`, then the labelled areas
    and then the labelled lines of all panels. Of artists with equal labels, the legend shows the first."""
    entries = {str(artist.get_label()): artist for artist in areas}
    for axes in figure.axes:
        for artist, label in zip(*axes.get_legend_handles_labels(), strict=True):
            entries.setdefault(label, artist)
    labels = sorted(entries, key=lambda label: isinstance(entries[label], Line2D))
    if labels:
        place_legend(figure, [entries[label] for label in labels], labels, column_count)


def is_logarithmic(values: np.ndarray) -> bool:
    """Whether an axis with the increasing values `values`, (n,), is logarithmic: the values have equal
    ratios, or span more than a decade without equal steps."""
    if len(values) < 2 or values[0] <= 0 or not np.isfinite(values).all():
        return False
    steps = np.diff(values)
    ratios = values[1:] / values[:-1]
    if len(values) > 2 and np.ptp(steps) <= 1e-6 * values[-1]:
        return False
    is_even = len(values) > 2 and np.ptp(ratios) < 1e-6 * ratios[0]
    return bool(is_even or values[-1] > 10 * values[0])


def scale_axis(axes: Axes, letter: Literal["x", "y"], values: np.ndarray) -> None:
    """Makes the axis `letter` logarithmic, with suitable tick labels, if `is_logarithmic(values)`. values:
    (n,)."""
    if not is_logarithmic(values):
        return
    axes.set(**{f"{letter}scale": "log"})
    label_few_decades(axes.xaxis if letter == "x" else axes.yaxis, values[0], values[-1])


def label_few_decades(axis: Axis, low: float, high: float) -> None:
    """Labels numbers such as 1, 2 and 5 of each decade on a logarithmic axis from `low` to `high`, if the
    axis is short. All labels are numbers, or all are powers of ten."""
    if high < FEW_DECADES_RATIO * low:
        multiples = (1, 2, 5) if high > SHORT_AXIS_RATIO * low else (1, 1.5, 2, 3, 4, 6, 8)
        axis.set_major_locator(LogLocator(subs=multiples))
        is_plain = low >= 10.0**-MIN_ABS_EXPONENT_OF_BARE_POWER and high < 10.0 ** (
            MIN_EXPONENT_OF_POWER_NOTATION + 1
        )
        axis.set_major_formatter(
            FuncFormatter(lambda value, _: f"{value:g}" if is_plain else f"${number_in_tex(value)}$")
        )
        axis.set_minor_formatter(NullFormatter())


def label_outer_panels(axes: Axes, xlabel: str, ylabel: str) -> None:
    """Labels the axes of a panel in a grid of panels that share axes. Only panels at the left and at the
    bottom have labels."""
    grid_cell = axes.get_subplotspec()
    if grid_cell is None or grid_cell.is_last_row():
        axes.set_xlabel(xlabel)
    if grid_cell is None or grid_cell.is_first_col():
        axes.set_ylabel(ylabel)
