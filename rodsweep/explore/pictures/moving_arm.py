"""Picture of the arm: its limit cycle, its shape while the user drags the tip, and its motion after the
release. The browser animates the solved shapes."""

from collections.abc import Callable
from typing import Any

import numpy as np
from bokeh.events import Pan, PanEnd
from bokeh.models import CustomJS

from ...arrays import Array
from ...post.figures.cycle.tip_path import smooth_tip_path
from ..slider_scales import PictureAxis
from ..solving.dragged_tip import TipPosition
from ..templates_and_texts import template_text
from . import card

SCREEN_SECONDS_PER_PERIOD = 2.0
"""Duration of one period of a cycle on the screen, in seconds."""
REACHED_STATE_CLAUSES = {
    "cycle": "it beats",
    "straight": "it comes to rest",
    "torus": "it beats quasiperiodically (two frequencies)",
}
"""Clause for the state that a released arm reaches, by status. For other statuses the sentence of the status
is used."""
SHAPE_COLUMNS = ("x", "y", "number")
"""Columns of a Bokeh source of shapes: coordinates x, y of all nodes of all shapes, and in each row the
number of nodes per shape."""


class MovingArmPicture:
    """Animated picture of the arm with the path of its tip; one period of a cycle takes
    `SCREEN_SECONDS_PER_PERIOD`. The attributes `..._source` are Bokeh data sources: `shapes` of the cycle,
    `motion` after a release, `reached` shapes of the cycle that the motion approaches, the drawn `arm`, the
    `bent` arm that the user drags, the `path` of the tip, the position of the mouse (`grip`)."""

    def __init__(self) -> None:
        axes = ("x (L)", (-0.1, 1.1)), ("y (L)", (-0.7, 0.7))
        figure = card.new_figure(*axes, match_aspect=True)
        names = ("shapes", "motion", "reached")
        self.shapes_source, self.motion_source, self.reached_source = (
            card.empty_source(SHAPE_COLUMNS, f"{name}_source") for name in names
        )
        names = ("arm", "bent", "path")
        self.arm_source, self.bent_source, self.path_source = (
            card.empty_source(("x", "y"), f"{name}_source") for name in names
        )
        self.grip_source = card.empty_source(("x", "y", "phase"), "grip_source")
        self.length = PictureAxis("L", 1.0)
        figure.line("x", "y", color=card.NEUTRAL_COLOUR, line_width=1, source=self.path_source)
        for source in (
            self.shapes_source,
            self.motion_source,
            self.reached_source,
            self.bent_source,
            self.grip_source,
        ):
            figure.scatter("x", "y", visible=False, source=source)  # sends the source to the browser
        self.arm_line = figure.line(
            "x", "y", color=card.STABLE_COLOUR, line_width=5, line_cap="round", source=self.arm_source,
            visible=False,
        )  # fmt: skip
        figure.scatter([0], [0], marker="square", size=12, color=card.POINT_COLOUR)
        for event, phase in ((Pan, "bent"), (PanEnd, "let go")):
            arguments = {"figure": figure, "grip": self.grip_source, "phase": phase}
            figure.js_on_event(event, CustomJS(args=arguments, code=template_text("grip.js")))
        self.card = card.Card("beating", figure)

    def animation_script(self) -> CustomJS:
        """Browser script that animates the arm; the page runs this script once, when the document is
        ready."""
        names = ("shapes", "motion", "reached", "arm", "bent")
        sources: dict[str, Any] = {name: getattr(self, f"{name}_source") for name in names}
        variables = {
            "period": SCREEN_SECONDS_PER_PERIOD,
            "figure": self.card.figure,
            "colour": card.STABLE_COLOUR,
        }
        return CustomJS(args=sources | variables, code=template_text("beating.js"))

    def on_drag(self, drag: Callable[[str, TipPosition], None]) -> None:
        """Registers the callback `drag(kind, tip)`, called when the user drags or releases the tip. kind:
        "bent" or "motion". tip: position of the tip, in L."""

        def dragged(attribute: str, previous: Any, data: dict[str, list[Any]]) -> None:
            if len(data["x"]) == 1:
                x, y = (float(data[name][0]) / self.length.factor_from_dimensionless for name in "xy")
                drag("motion" if data["phase"][0] == "let go" else "bent", (x, y))

        self.grip_source.on_change("data", dragged)

    def show(self, answer: dict[str, Any], length: PictureAxis) -> None:
        """Draws the cycle in `answer`, an answer of the task `limit_cycle`, with a sentence if the cycle is
        not stable; if there is no cycle, the straight arm and a sentence. length: unit and label of both
        axes."""
        self.length = length
        self.remove_dragged_shape()
        x, y = (answer[name] * length.factor_from_dimensionless for name in ("shape_x", "shape_y"))
        has_cycle = bool(np.isfinite(x).all())
        if not has_cycle:
            x, y = (answer[name][None] * length.factor_from_dimensionless for name in "xy")
        self.shapes_source.data = shape_columns(x, y)
        self._draw_path(x[: len(x) * has_cycle], y[: len(y) * has_cycle], is_closed=True)
        self._fit_axes(x, y)
        is_stable = answer["status"] == "cycle"
        self.card.set_title("" if is_stable or not has_cycle else answer["sentence"])
        if has_cycle:
            self.card.show_figure()
        else:
            self.card.show_sentence_above(card.status_sentence(answer))

    def show_arm_with_held_tip(self, answer: dict[str, Any]) -> None:
        """Draws the equilibrium shape of the arm whose tip the user drags. answer: result of
        `equilibrium_with_held_tip`."""
        self.bent_source.data = {name: answer[name] * self.length.factor_from_dimensionless for name in "xy"}

    def show_motion(self, answer: dict[str, Any]) -> None:
        """Starts the animation of a released arm, and writes the state that the arm reaches into the title.
        answer: result of `released_motion_answer`."""
        factor = self.length.factor_from_dimensionless
        step = answer["shape_interval"]
        x = answer["x"] * factor
        y = answer["y"] * factor
        shape_x = answer["shape_x"] * factor
        shape_y = answer["shape_y"] * factor
        cycle_frames = answer["period"] if len(shape_x) else step * answer["frames"]
        self.motion_source.tags = [SCREEN_SECONDS_PER_PERIOD * step / cycle_frames, SCREEN_SECONDS_PER_PERIOD]
        self.reached_source.data = shape_columns(shape_x, shape_y)
        self.motion_source.data = shape_columns(x, y)
        self._draw_path(x, y, is_closed=False)
        self._fit_axes(np.concatenate([x, shape_x]), np.concatenate([y, shape_y]))
        position = ", ".join(f"{coordinate * factor:.3g}" for coordinate in answer["tip"])
        end = REACHED_STATE_CLAUSES.get(answer["status"], answer["sentence"])
        beginning_text = "" if answer["is_motion_complete"] else "; only the beginning of the motion is shown"
        self.card.set_title(f"Let go at ({position}) {self.length.label}: {end}{beginning_text}")

    def remove_dragged_shape(self) -> None:
        """Removes the shape of a dragged arm and its motion after the release from the picture."""
        for source in (self.motion_source, self.reached_source, self.bent_source):
            if len(source.data["x"]):
                source.data = {name: [] for name in source.data}

    def remove_all_shapes(self) -> None:
        """Removes all shapes from the picture, so that the animation stops."""
        self.remove_dragged_shape()
        self.shapes_source.data = {name: [] for name in SHAPE_COLUMNS}

    def _draw_path(self, x: Array, y: Array, is_closed: bool) -> None:
        """Draws the path of the tip through shapes. x, y: coordinates of the shapes, (shapes, nodes) each, in
        the unit of the axes. is_closed: whether the last shape is followed by the first."""
        path = smooth_tip_path(np.stack([x[:, -1], y[:, -1]], axis=1), is_closed)
        self.path_source.data = card.source_columns(x=path[:, 0], y=path[:, 1])

    def _fit_axes(self, x: Array, y: Array) -> None:
        """Sets the ranges of the axes so that all shapes fit. x, y: coordinates, (shapes, nodes), in the unit
        of the axes."""
        factor = self.length.factor_from_dimensionless
        half_height = 1.15 * max(0.3 * factor, float(np.abs(y).max()))
        x_limits = min(0.0, float(x.min())) - 0.1 * factor, 1.1 * factor
        labels = f"x ({self.length.label})", f"y ({self.length.label})"
        self.card.set_axes(x_limits, (-half_height, half_height), labels)


def shape_columns(x: Array, y: Array) -> dict[str, Any]:
    """Columns of a Bokeh source, see `SHAPE_COLUMNS`, in single precision. x, y: coordinates of the shapes,
    (shapes, nodes)."""
    point_counts = np.full(x.size, x.shape[1], dtype=np.float32)
    return {"x": x.ravel().astype(np.float32), "y": y.ravel().astype(np.float32), "number": point_counts}
