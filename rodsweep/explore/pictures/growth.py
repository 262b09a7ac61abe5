"""Growth rates along the force, with the forces at which stability changes."""

from typing import Any

import numpy as np
from bokeh.models import HoverTool, Range1d, Span

from ..scales import PictureAxis
from .card import (
    NEUTRAL,
    POINT,
    STABLE,
    UNSTABLE,
    Card,
    columns,
    empty_source,
    limits,
    new_figure,
    show_range,
    vertical_line,
)
from .numbers import IN_SI

NAMED_THRESHOLDS = ("F_onset", "F_hopf", "F_restabilization")
"""Thresholds named above the picture."""
OF_ROD = ("F* = {:.7g}", "F** = {:.7g}", "stable from {:.7g}")
OF_ARM = ("oscillates from {:.5g} kPa", "flutters from {:.5g} kPa", "stable from {:.5g} kPa")
"""Words for `NAMED_THRESHOLDS`, of a rod over F and of an arm over the pressure."""
KINDS = {
    "onset": ("oscillates from F*", NEUTRAL),
    "hopf": ("flutters, Hopf point F**", UNSTABLE),
    "hopf_reverse": ("a mode becomes stable", STABLE),
    "restabilization": ("stable again", STABLE),
}
"""(label, colour) of each kind of threshold in the picture."""


class GrowthPicture:
    """Growth rates of the leading modes over F; vertical lines are thresholds, the thick line the point."""

    def __init__(self) -> None:
        figure = new_figure(
            "force F (k3/L^2)", "growth rate (1/tau2)", x_range=Range1d(0, 1), y_range=Range1d(-1, 1)
        )
        self.rates = empty_source(("F", "first", "second", "third"), "growth_source")
        self.lines = empty_source(("F", "kind", "colour", "frequency"), "threshold_source")
        for name, width in (("third", 1), ("second", 1), ("first", 2.5)):
            figure.line(
                "F", name, line_width=width, color=NEUTRAL if width == 1 else STABLE, source=self.rates
            )
        drawn = figure.vspan(x="F", line_color="colour", line_width=2, line_dash="dotted", source=self.lines)
        figure.add_tools(
            HoverTool(
                renderers=[drawn],
                tooltips=[("", "@kind"), ("load", "@F{0.0000000}"), ("frequency", "@frequency{0.000000}")],
            )
        )
        figure.add_layout(Span(location=0, dimension="width", line_color=NEUTRAL, line_dash="dashed"))
        self.point = vertical_line(0, POINT)
        self.point.line_width = 3
        figure.add_layout(self.point)
        self.card = Card("growth", figure, title_lines=2)
        self.card.entitle("")

    def show_rates(self, found: dict[str, Any], load: PictureAxis) -> None:
        """Draws the growth rates."""
        rates = found["growth_rate"]
        names = ("first", "second", "third")
        F = found["F"] * load.factor
        self.rates.data = columns(F=F, **{name: rates[:, i] for i, name in enumerate(names)})
        leading = rates[:, 0]
        show_range(self.card.figure.y_range, *limits(np.append(leading[np.isfinite(leading)], 0.0)))
        show_range(self.card.figure.x_range, F[0], F[-1])
        self.card.figure.xaxis.axis_label = load.label
        self.card.figure.yaxis.axis_label = f"growth rate ({found['unit']})"
        self.card.reveal()

    def show_thresholds(self, found: dict[str, Any], load: PictureAxis) -> None:
        """Draws the thresholds, and names the first of each kind above the picture."""
        own = found.get(IN_SI["crossing_frequency"], found["crossing_frequency"])
        rows = [
            (F * load.factor, *KINDS[kind], frequency)
            for F, kind, frequency in zip(found["crossing_F"], found["kinds"], own, strict=True)
            if kind in KINDS
        ]
        names = ("F", "kind", "colour", "frequency")
        self.lines.data = {name: [row[i] for row in rows] for i, name in enumerate(names)}
        self.card.entitle(named(found, load))

    def move_point(self, F: float) -> None:
        """Moves the thick line that marks the page's force."""
        self.point.location = F


def named(found: dict[str, Any], load: PictureAxis) -> str:
    """Words for the first threshold of each kind that exists, in units of the load."""
    words = OF_ARM if IN_SI["F_hopf"] in found else OF_ROD
    parts = [
        word.format(load.factor * float(found[name]))
        for word, name in zip(words, NAMED_THRESHOLDS, strict=True)
        if np.isfinite(found[name])
    ]
    proved = "certified" if found["certified"] else "not certified"
    text = f"{', '.join(parts) or 'no threshold'} ({proved})"
    return text[0].upper() + text[1:]
