"""Picture of the growth rates of the leading modes against the load, with the thresholds of stability."""

from typing import Any

import numpy as np
from bokeh.models import HoverTool, Range1d, Span

from ..slider_scales import PictureAxis
from . import card
from .numbers import SI_NAME_BY_VARIABLE

NAMED_THRESHOLDS = ("F_onset", "F_hopf", "F_restabilization")
"""Variables of the thresholds in the title."""
ROD_THRESHOLD_FORMATS = ("F* = {:.7g}", "F** = {:.7g}", "stable from {:.7g}")
"""Formats of `NAMED_THRESHOLDS` in the title, for a rod (load F)."""
ARM_THRESHOLD_FORMATS = ("oscillates from {:.5g} kPa", "flutters from {:.5g} kPa", "stable from {:.5g} kPa")
"""Formats of `NAMED_THRESHOLDS` in the title, for an arm (load: pressure)."""
THRESHOLD_LINE_LOOKS = {
    "onset": ("oscillates from F*", card.NEUTRAL_COLOUR),
    "hopf": ("flutters, Hopf point F**", card.UNSTABLE_COLOUR),
    "hopf_reverse": ("a mode becomes stable", card.STABLE_COLOUR),
    "restabilization": ("stable again", card.STABLE_COLOUR),
}
"""(tooltip, colour) of each kind of threshold in the picture."""


class GrowthPicture:
    """Growth rates of the leading modes against the load. Dotted vertical lines mark thresholds; the thick
    vertical line marks the load of the page."""

    def __init__(self) -> None:
        ranges = {"x_range": Range1d(0, 1), "y_range": Range1d(-1, 1)}
        figure = card.new_figure("force F (k3/L^2)", "growth rate (1/tau2)", **ranges)
        self.rate_source = card.empty_source(("F", "first", "second", "third"), "growth_source")
        self.threshold_source = card.empty_source(("F", "kind", "colour", "frequency"), "threshold_source")
        for name in ("third", "second"):
            figure.line("F", name, line_width=1, color=card.NEUTRAL_COLOUR, source=self.rate_source)
        figure.line("F", "first", line_width=2.5, color=card.STABLE_COLOUR, source=self.rate_source)
        look = {"line_color": "colour", "line_width": 2, "line_dash": "dotted"}
        spans = figure.vspan(x="F", **look, source=self.threshold_source)
        tooltips = [("", "@kind"), ("load", "@F{0.0000000}"), ("frequency", "@frequency{0.000000}")]
        figure.add_tools(HoverTool(renderers=[spans], tooltips=tooltips))
        look = {"line_color": card.NEUTRAL_COLOUR, "line_dash": "dashed"}
        figure.add_layout(Span(location=0, dimension="width", **look))
        self.load_line = card.vertical_line(card.POINT_COLOUR)
        self.load_line.line_width = 3
        figure.add_layout(self.load_line)
        self.card = card.Card("growth", figure, title_lines=2)
        self.card.set_title("")

    def show_rates(self, answer: dict[str, Any], load: PictureAxis) -> None:
        """Draws the growth rates of the answer `answer`."""
        first_rate, second_rate, third_rate = answer["growth_rate"][:, :3].T
        F = answer["F"] * load.factor
        self.rate_source.data = card.source_columns(
            F=F, first=first_rate, second=second_rate, third=third_rate
        )
        limits = card.axis_limits(np.append(first_rate[np.isfinite(first_rate)], 0.0))
        card.set_axis_range(self.card.figure.y_range, *limits)
        card.set_axis_range(self.card.figure.x_range, F[0], F[-1])
        self.card.figure.xaxis.axis_label = load.label
        self.card.figure.yaxis.axis_label = f"growth rate ({answer['unit']})"
        self.card.show_figure()

    def show_thresholds(self, answer: dict[str, Any], load: PictureAxis) -> None:
        """Draws the thresholds of the answer `answer`, and writes the first threshold of each kind into the
        title."""
        frequencies = answer.get(SI_NAME_BY_VARIABLE["crossing_frequency"], answer["crossing_frequency"])
        rows = [
            (F * load.factor, *THRESHOLD_LINE_LOOKS[kind], frequency)
            for F, kind, frequency in zip(answer["crossing_F"], answer["kinds"], frequencies, strict=True)
            if kind in THRESHOLD_LINE_LOOKS
        ]
        names = ("F", "kind", "colour", "frequency")
        self.threshold_source.data = {name: [row[i] for row in rows] for i, name in enumerate(names)}
        self.card.set_title(threshold_title(answer, load))


def threshold_title(answer: dict[str, Any], load: PictureAxis) -> str:
    """Title with the first threshold of each kind in the answer `answer`, in the unit of the axis `load`."""
    formats = ARM_THRESHOLD_FORMATS if SI_NAME_BY_VARIABLE["F_hopf"] in answer else ROD_THRESHOLD_FORMATS
    texts = [
        value_format.format(load.factor * float(answer[name]))
        for value_format, name in zip(formats, NAMED_THRESHOLDS, strict=True)
        if np.isfinite(answer[name])
    ]
    proof_text = "certified" if answer["certified"] else "not certified"
    text = f"{', '.join(texts) or 'no threshold'} ({proof_text})"
    return text[0].upper() + text[1:]
