"""The beating arm: shapes over a period, solved once and animated in the browser."""

from typing import Any

import numpy as np
from bokeh.models import CustomJS, Range1d

from ..scales import PictureAxis
from .card import NEUTRAL, POINT, STABLE, Card, empty_source, new_figure, sentence_of

SECONDS = 2.0
"""Duration of one period on the screen."""
ANIMATE = """
const seconds = %s
function draw(now) {
  const {x, y, number} = shapes.data
  const at = arm.data
  if (number.length > 0) {
    const nodes = number[0], times = x.length / nodes
    const phase = (now / 1000 / seconds) %% 1 * times
    const before = Math.floor(phase) %% times, after = (before + 1) %% times, part = phase - Math.floor(phase)
    if (at.x.length !== nodes) { at.x = new Float64Array(nodes); at.y = new Float64Array(nodes) }
    for (let i = 0; i < nodes; i++) {
      at.x[i] = (1 - part) * x[before * nodes + i] + part * x[after * nodes + i]
      at.y[i] = (1 - part) * y[before * nodes + i] + part * y[after * nodes + i]
    }
    arm.change.emit()
  }
  requestAnimationFrame(draw)
}
requestAnimationFrame(draw)
"""


class BeatingPicture:
    """The arm over a period, at a slow pace, and the path of its tip."""

    def __init__(self) -> None:
        figure = new_figure(
            "x (L)", "y (L)", x_range=Range1d(-0.1, 1.1), y_range=Range1d(-0.7, 0.7), match_aspect=True
        )
        self.shapes = empty_source(("x", "y", "number"), "shapes_source")
        self.arm = empty_source(("x", "y"), "arm_source")
        self.path = empty_source(("x", "y"), "path_source")
        figure.line("x", "y", color=NEUTRAL, line_width=1, source=self.path)
        figure.scatter("x", "y", visible=False, source=self.shapes)  # sends the source to the browser
        figure.line("x", "y", color=STABLE, line_width=5, line_cap="round", source=self.arm)
        figure.scatter([0], [0], marker="square", size=12, color=POINT)
        self.card = Card("beating", figure)

    def animation(self) -> CustomJS:
        """Code that the browser runs once when the page is ready."""
        return CustomJS(args={"shapes": self.shapes, "arm": self.arm}, code=ANIMATE % SECONDS)

    def show(self, found: dict[str, Any], length: PictureAxis) -> None:
        """Draws an answer of the task limit_cycle, or shows a sentence if there is no cycle."""
        x, y = (found[name] * length.factor for name in ("shape_x", "shape_y"))
        if not np.isfinite(x).all():
            self.stop()
            self.card.say(sentence_of(found))
            return
        number = np.full(x.size, x.shape[1], dtype=float)
        self.shapes.data = {"x": x.ravel(), "y": y.ravel(), "number": number}
        self.path.data = {"x": np.append(x[:, -1], x[0, -1]), "y": np.append(y[:, -1], y[0, -1])}
        reach = 1.15 * max(0.3 * length.factor, float(np.abs(y).max()))
        self.card.figure.y_range.update(start=-reach, end=reach)
        self.card.figure.x_range.update(
            start=min(0.0, float(x.min())) - 0.1 * length.factor, end=1.1 * length.factor
        )
        self.card.figure.xaxis.axis_label, self.card.figure.yaxis.axis_label = (
            f"{n} ({length.label})" for n in "xy"
        )
        self.card.figure.title.text = "" if found["status"] == "cycle" else found["sentence"]
        self.card.reveal()

    def stop(self) -> None:
        """Ends the motion."""
        self.shapes.data = {"x": [], "y": [], "number": []}
