"""Hopf points in a figure against F: vertical lines, and square-root laws of the amplitudes near Hopf
points."""

from collections.abc import Sequence
from typing import Any

from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from ....located_thresholds import LocatedThreshold
from ....summary.number_texts import rounded_text
from ...style import TEX_SYMBOLS
from .square_root import SquareRootLaw

HOPF_SYMBOL = rf"{TEX_SYMBOLS['F']}_{{**}}"
"""Symbol F** in TeX, without dollar signs."""
HOPF_WORDS = {"hopf": f"${HOPF_SYMBOL}$", "restabilization": "restabilization"}
"""Legend entry of a Hopf point by kind: as F grows, the straight rod becomes unstable, or stable again."""
HOPF_DIGITS = 6
"""Number of significant digits of a Hopf point in a legend."""
HOPF_LINE_LOOK: dict[str, Any] = {"ls": ":", "lw": 1.1}
"""Matplotlib style of a vertical line at a Hopf point."""
SHARED_POINT_COLOUR = "0.3"
"""Colour of a Hopf point that belongs to several lines."""
SQUARE_ROOT_LAW_COLOUR = "0.45"
"""Colour of a square-root law."""
COEFFICIENT_DIGITS = 3
"""Largest number of significant digits of a coefficient in a legend."""
MAX_COEFFICIENTS = 3
"""A legend entry lists up to this number of coefficients; for more coefficients the range is printed."""


def mark_hopf_points(panels: Sequence[Axes], marks: Sequence[tuple[LocatedThreshold, str]]) -> list[Line2D]:
    """Draws a dotted vertical line at each Hopf point; returns legend entries. marks: (Hopf point, colour).

    A Hopf point that belongs to several lines is drawn once, in grey. The legend gives the position of a Hopf
    point that is the only Hopf point of its kind.
    """
    handles = []
    for kind, word in HOPF_WORDS.items():
        marks_of_kind = [mark for mark in marks if mark[0].kind == kind]
        points: list[tuple[LocatedThreshold, set[str]]] = []
        for point, colour in marks_of_kind:
            colours_here = next(
                (colours for known_point, colours in points if known_point.equals_within_errors(point)), None
            )
            if colours_here is None:
                points.append((point, {colour}))
            else:
                colours_here.add(colour)
        for point, colours in points:
            colour = colours.pop() if len(colours) == 1 else SHARED_POINT_COLOUR
            for axes in panels:
                axes.axvline(point.position, color=colour, zorder=0.5, **HOPF_LINE_LOOK)
        if len(points) == 1:
            load_prefix = f"{word} = " if kind == "hopf" else rf"{word} at $\tilde F$ = "
            label = f"{load_prefix}{points[0][0].position:.{HOPF_DIGITS}g}"
            handles.append(Line2D([], [], color=colour, label=label, **HOPF_LINE_LOOK))
        elif points:
            handles.append(Line2D([], [], color=SHARED_POINT_COLOUR, label=word, **HOPF_LINE_LOOK))
    return handles


def draw_square_root_laws(axes: Axes, laws: Sequence[SquareRootLaw], unit: str = "") -> list[Line2D]:
    """Draws square-root laws as dashed curves; returns legend entries with formula and coefficients. unit:
    unit of the amplitude; empty for amplitudes in L."""
    handles = []
    for is_above in (True, False):
        chosen_laws = [law for law in laws if law.is_above == is_above]
        if not chosen_laws:
            continue
        keywords: dict[str, Any] = {"color": SQUARE_ROOT_LAW_COLOUR, "lw": 1.0, "ls": (0, (5, 2.5))}
        for law in chosen_laws:
            axes.plot(*law.curve(), zorder=1.5, **keywords)
        difference_in_tex = rf"\tilde F - {HOPF_SYMBOL}" if is_above else rf"{HOPF_SYMBOL} - \tilde F"
        coefficients = f"$a$ = {_coefficients_text(chosen_laws)} {unit}".rstrip()
        formula_in_tex = rf"$a\sqrt{{({difference_in_tex})/{HOPF_SYMBOL}}}$, {coefficients}"
        handles.append(Line2D([], [], label=formula_in_tex, **keywords))
    return handles


def _coefficients_text(laws: Sequence[SquareRootLaw]) -> str:
    """Distinct coefficients of the laws as text; the range if there are more than MAX_COEFFICIENTS."""
    sorted_laws = sorted(laws, key=lambda law: law.coefficient)
    coefficient_texts = {law: rounded_text(law.coefficient, law.error, COEFFICIENT_DIGITS) for law in laws}
    texts = list(dict.fromkeys(coefficient_texts.values()))
    if len(texts) > MAX_COEFFICIENTS:
        return f"{coefficient_texts[sorted_laws[0]]} to {coefficient_texts[sorted_laws[-1]]}"
    return ", ".join(texts)
