"""Pictures over the load: the growth rates of the leading modes with the thresholds of stability, and the
bifurcation diagram, the largest tip deflection of stable and unstable cycles."""

from typing import Any

import numpy as np
from bokeh.models import HoverTool, Span

from ...post.summary.thresholds import oscillation_end_index
from ..slider_scales import PictureAxis
from . import card
from .numbers_table import SI_VARIABLE_BY_DIMENSIONLESS_NAME

TITLE_THRESHOLD_VARIABLES = ("F_onset", "F_hopf", "F_restabilization")
"""Variables of the thresholds in the title."""
ROD_THRESHOLD_FORMATS = ("F* = {:.7g}", "F** = {:.7g}", "stable from {:.7g}")
"""Formats of the values of `TITLE_THRESHOLD_VARIABLES`, in k3/L^2, in the title for a rod."""
ARM_THRESHOLD_FORMATS = ("oscillates from {:.5g} kPa", "flutters from {:.5g} kPa", "stable from {:.5g} kPa")
"""Formats of the values of `TITLE_THRESHOLD_VARIABLES`, as pressures in kPa, in the title for an arm."""
THRESHOLD_LINE_LOOKS = {
    "onset": ("oscillates from F*", card.NEUTRAL_COLOUR),
    "hopf": ("flutters, Hopf point F**", card.UNSTABLE_COLOUR),
    "hopf_reverse": ("a mode becomes stable", card.STABLE_COLOUR),
    "restabilization": ("stable again", card.STABLE_COLOUR),
}
"""(tooltip, colour) of each kind of threshold in the picture."""


class GrowthRatePicture:
    """Growth rates of the leading modes against the load. Dotted vertical lines mark thresholds; the thick
    vertical line marks the load of the page."""

    def __init__(self) -> None:
        figure = card.new_figure(("force F (k3/L^2)", (0, 1)), ("growth rate (1/tau2)", (-1, 1)))
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

    def show_rates(self, answer: dict[str, Any], load: PictureAxis) -> None:
        """Draws the three largest growth rates of the answer `answer` against the load. load: axis of the
        load."""
        first_rate, second_rate, third_rate = answer["growth_rate"][:, :3].T
        F = answer["F"] * load.factor_from_dimensionless
        self.rate_source.data = card.source_columns(
            F=F, first=first_rate, second=second_rate, third=third_rate
        )
        limits = card.axis_limits(np.append(first_rate[np.isfinite(first_rate)], 0.0))
        self.card.set_axes((F[0], F[-1]), limits, (load.label, f"growth rate ({answer['unit']})"))
        self.card.show_figure()

    def show_thresholds(self, answer: dict[str, Any], load: PictureAxis) -> None:
        """Draws the thresholds of the answer `answer`, and writes the first threshold of each kind into the
        title."""
        frequencies = answer.get(
            SI_VARIABLE_BY_DIMENSIONLESS_NAME["crossing_frequency"], answer["crossing_frequency"]
        )
        rows = [
            (F * load.factor_from_dimensionless, *THRESHOLD_LINE_LOOKS[kind], frequency)
            for F, kind, frequency in zip(answer["crossing_F"], answer["kinds"], frequencies, strict=True)
            if kind in THRESHOLD_LINE_LOOKS
        ]
        names = ("F", "kind", "colour", "frequency")
        self.threshold_source.data = {name: [row[i] for row in rows] for i, name in enumerate(names)}
        self.card.set_title(threshold_title(answer, load))


def threshold_title(answer: dict[str, Any], load: PictureAxis) -> str:
    """Title with the first threshold of each kind in the answer `answer`, in the unit of the axis `load`."""
    is_arm = SI_VARIABLE_BY_DIMENSIONLESS_NAME["F_hopf"] in answer
    formats = ARM_THRESHOLD_FORMATS if is_arm else ROD_THRESHOLD_FORMATS
    texts = [
        value_format.format(load.factor_from_dimensionless * float(answer[name]))
        for value_format, name in zip(formats, TITLE_THRESHOLD_VARIABLES, strict=True)
        if np.isfinite(answer[name])
    ]
    if is_arm and (end := oscillation_end_index(answer["kinds"])) is not None:
        texts[0] += f" to {load.factor_from_dimensionless * float(answer['crossing_F'][end]):.5g} kPa"
    proof_text = "certified" if answer["certified"] else "not certified"
    text = f"{', '.join(texts) or 'no threshold'} ({proof_text})"
    return text[0].upper() + text[1:]


STABILITY_LOOKS = {
    1: ("stable", card.STABLE_COLOUR, "solid"),
    0: ("unstable", card.UNSTABLE_COLOUR, "dashed"),
    -1: ("", card.NEUTRAL_COLOUR, "dotted"),
}
"""(legend entry, colour, line style) of a branch, by stability: 1 stable, 0 unstable, -1 unknown."""
EMPTY_CYCLE_COLUMNS = {"F": np.zeros(0), "y": np.zeros(0), "stable": np.zeros(0, dtype=int)}
"""Columns without values, for an answer that has branches but no separately solved cycles."""
LOAD_AXIS_MARGIN_FRACTION = 0.03
"""Margin left and right of the dots of separately solved cycles, as a fraction of their range of loads.
Without a margin the outermost dots would be cut off."""


class BranchPicture:
    """Branches of cycles and of the straight rod against the load. Filled marks are Hopf points, folds and
    torus points."""

    def __init__(self) -> None:
        axes = ("force F (k3/L^2)", (0, 1)), ("largest tip deflection (L)", (-0.05, 1))
        figure = card.new_figure(*axes)
        self.branch_source = card.empty_source(("F", "y", "colour", "dash"), "branch_source")
        self.cycle_source = card.empty_source(("F", "y", "colour"), "stored_cycle_source")
        self.special_point_source = card.empty_source(("F", "y", "kind", "period"), "special_source")
        figure.multi_line(
            "F", "y", color="colour", line_dash="dash", line_width=2.5, source=self.branch_source
        )
        figure.scatter("F", "y", size=5, color="colour", source=self.cycle_source)
        colours = {"color": card.NEUTRAL_COLOUR, "line_color": card.POINT_COLOUR}
        special_glyphs = figure.scatter("F", "y", size=9, **colours, source=self.special_point_source)
        tooltips = [("", "@kind"), ("load", "@F{0.0000000}"), ("period", "@period{0.00000000}")]
        figure.add_tools(HoverTool(renderers=[special_glyphs], tooltips=tooltips))
        card.add_line_legend(figure, [STABILITY_LOOKS[1], STABILITY_LOOKS[0]], 2.5)
        self.load_line = card.vertical_line(card.POINT_COLOUR)
        figure.add_layout(self.load_line)
        self.card = card.Card("branches", figure)

    def show(self, answer: dict[str, Any], load: PictureAxis, length: PictureAxis) -> None:
        """Draws the branches of the answer `answer`, with separately solved cycles as dots; the title is the
        meaning of the status if the task did not succeed, else the source of the answer."""
        pieces = answer["pieces"]
        self.branch_source.data = {
            "F": [forces * load.factor_from_dimensionless for forces, _, _ in pieces],
            "y": [y * length.factor_from_dimensionless for _, y, _ in pieces],
            "colour": [STABILITY_LOOKS[stable][1] for _, _, stable in pieces],
            "dash": [STABILITY_LOOKS[stable][2] for _, _, stable in pieces],
        }
        cycles = answer.get("cycles", EMPTY_CYCLE_COLUMNS)
        self.cycle_source.data = {
            "F": cycles["F"] * load.factor_from_dimensionless,
            "y": cycles["y"] * length.factor_from_dimensionless,
            "colour": [STABILITY_LOOKS[stable][1] for stable in cycles["stable"]],
        }
        if pieces or len(cycles["F"]):
            lines = [*(piece[:2] for piece in pieces), (cycles["F"], cycles["y"])]
            all_F, all_y = (np.concatenate([line[i] for line in lines]) for i in range(2))
            margin = LOAD_AXIS_MARGIN_FRACTION if len(cycles["F"]) else 0.0
            limits = (
                card.axis_limits(all_F * load.factor_from_dimensionless, margin),
                card.axis_limits(all_y * length.factor_from_dimensionless),
            )
            self.card.set_axes(*limits, (load.label, f"largest tip deflection ({length.label})"))
        special_points = [
            (F * load.factor_from_dimensionless, y * length.factor_from_dimensionless, *texts)
            for F, y, *texts in answer["special"]
        ]
        names = enumerate(("F", "y", "kind", "period"))
        self.special_point_source.data = {name: [row[i] for row in special_points] for i, name in names}
        self.card.set_title(answer["sentence"] if answer["status"] != "ok" else answer.get("source", ""))
        self.card.show_figure()
