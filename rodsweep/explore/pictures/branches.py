"""Picture of the bifurcation diagram: largest tip deflection of stable and unstable cycles against the
load."""

from math import nan
from typing import Any

import numpy as np
from bokeh.models import HoverTool, Legend, LegendItem, Range1d

from ..slider_scales import PictureAxis
from . import card

STABILITY_COLOURS = {1: card.STABLE_COLOUR, 0: card.UNSTABLE_COLOUR, -1: card.NEUTRAL_COLOUR}
"""Colour of a branch, by stability: 1 stable, 0 unstable, -1 unknown."""
NO_CYCLE_COLUMNS = {"F": np.zeros(0), "y": np.zeros(0), "stable": np.zeros(0, dtype=int)}
"""Columns without values, for an answer that has branches but no separately solved cycles."""
SIDE_MARGIN = 0.03
"""Margin left and right of the dots of separately solved cycles, as a fraction of their range of loads.
Without a margin the outermost dots would be cut off."""
STABILITY_DASHES = {1: "solid", 0: "dashed", -1: "dotted"}
"""Line style of a branch, by stability: 1 stable, 0 unstable, -1 unknown."""


class BranchPicture:
    """Branches of cycles and of the straight rod against the load. Filled marks are Hopf points, folds and
    torus points."""

    def __init__(self) -> None:
        ranges = {"x_range": Range1d(0, 1), "y_range": Range1d(-0.05, 1)}
        figure = card.new_figure("force F (k3/L^2)", "largest tip deflection (L)", **ranges)
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
        legend_items = []
        for text, stability in (("stable", 1), ("unstable", 0)):
            look = {
                "color": STABILITY_COLOURS[stability],
                "line_dash": STABILITY_DASHES[stability],
                "line_width": 2.5,
            }
            legend_items.append(LegendItem(label=text, renderers=[figure.line([nan], [nan], **look)]))
        figure.add_layout(Legend(items=legend_items, location="top_left"))
        self.load_line = card.vertical_line(card.POINT_COLOUR)
        figure.add_layout(self.load_line)
        self.card = card.Card("branches", figure)
        self.card.set_title("")

    def show(self, answer: dict[str, Any], load: PictureAxis, length: PictureAxis) -> None:
        """Draws the branches of the answer `answer`, with separately solved cycles as dots; the title is the
        meaning of the status if the task did not succeed, else the source of the answer."""
        pieces = answer["pieces"]
        self.branch_source.data = {
            "F": [forces * load.factor for forces, _, _ in pieces],
            "y": [y * length.factor for _, y, _ in pieces],
            "colour": [STABILITY_COLOURS[stable] for _, _, stable in pieces],
            "dash": [STABILITY_DASHES[stable] for _, _, stable in pieces],
        }
        cycles = answer.get("cycles", NO_CYCLE_COLUMNS)
        self.cycle_source.data = {
            "F": cycles["F"] * load.factor,
            "y": cycles["y"] * length.factor,
            "colour": [STABILITY_COLOURS[stable] for stable in cycles["stable"]],
        }
        if pieces or len(cycles["F"]):
            lines = [*(piece[:2] for piece in pieces), (cycles["F"], cycles["y"])]
            all_F, all_y = (np.concatenate([line[i] for line in lines]) for i in range(2))
            margin = SIDE_MARGIN if len(cycles["F"]) else 0.0
            card.set_axis_range(self.card.figure.x_range, *card.axis_limits(all_F * load.factor, margin))
            card.set_axis_range(self.card.figure.y_range, *card.axis_limits(all_y * length.factor))
            self.card.figure.xaxis.axis_label = load.label
            self.card.figure.yaxis.axis_label = f"largest tip deflection ({length.label})"
        special_points = [(F * load.factor, y * length.factor, *texts) for F, y, *texts in answer["special"]]
        names = enumerate(("F", "y", "kind", "period"))
        self.special_point_source.data = {name: [row[i] for row in special_points] for i, name in names}
        self.card.set_title(answer["sentence"] if answer["status"] != "ok" else answer.get("source", ""))
        self.card.show_figure()
