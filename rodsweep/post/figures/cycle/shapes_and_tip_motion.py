"""Portrait of the beating arm, as in the paper's Fig. 5: shapes over a period, and motion of the tip against
time.

The motion of the tip is drawn from the initial state if the file contains this motion, and otherwise over two
periods.
"""

from collections.abc import Sequence
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.patches import Rectangle
from matplotlib.quiver import Quiver
from matplotlib.ticker import FuncFormatter

from ....arrays import Array
from ....results.file.view import ResultView
from ..style import BLUE, VERMILION, text_colour
from .selection import SHAPE_VARIABLE_NAMES, StoredCycle, chosen_cycles
from .transient import draw_start_of_motion, label_time_axes, label_tip_axes

MAX_SHAPES = 12
"""Largest number of drawn shapes; a reader cannot distinguish more shapes."""
ARROW_LENGTH = 0.14
"""Length of the arrow for the follower force, in L."""
WALL_DEPTH = 0.05
"""Thickness of the drawn wall, in L."""
WALL_HALF_HEIGHT = 0.13
"""Half the height of the drawn wall, in L."""
SHAPE_MARGIN = 0.04
"""Margin around the shapes and arrows, in L."""
DRAWN_TIP_PERIODS = 2
"""Duration of the drawn motion of the tip, in periods of the slowest cycle."""
MAX_MARKED_SAMPLES_PER_PERIOD = 48
"""With fewer samples per period than this, each sample of the tip's motion is marked."""
SHAPE_PANEL_WIDTH = 3.2
"""Width of a panel with shapes, in inches."""
TIP_PANEL_HEIGHT = 1.0
"""Height of a panel with the motion of the tip, in inches."""
PANEL_PADDING = 0.1
"""Space around panels, in inches. Matplotlib's layout misjudges the labels of panels with equal scales by up
to half this space."""
TOTAL_TEXT_HEIGHT = 1.4
"""Height of all labels and headings above and below the panels, in inches."""
TOTAL_TEXT_HEIGHT_ON_NARROW_PAGE = 2.0
"""Height corresponding to `TOTAL_TEXT_HEIGHT` on a narrow page, with the colour bar below the panels."""
UNUSED_COLOUR_FRACTION = 0.14
"""Fraction of the colour map that is not used: the yellow end, which is invisible on white paper."""


def draw_shapes_and_tip_motion(
    view: ResultView, points: Sequence[int], is_narrow: bool = False
) -> tuple[Figure, str]:
    """Returns (figure, description). The figure shows, for each cycle, the shapes over a period, later shapes
    darker, and x and y of the tip against time.

    is_narrow: whether the page is too narrow for panels side by side.
    """
    selection = chosen_cycles(view, points, SHAPE_VARIABLE_NAMES)
    cycles = selection.cycles
    figure, shape_panels, tip_panels = _new_panels(cycles, is_narrow)
    has_transients = all(cycle.has_transient for cycle in cycles)
    end = DRAWN_TIP_PERIODS * max(cycle.period for cycle in cycles)
    shape_indices, step = drawn_shapes_and_time_step(len(cycles[0].values["shape_x"]))
    shades = shades_of_shapes(len(shape_indices))
    for axes, (upper, lower), cycle in zip(shape_panels, tip_panels, cycles, strict=True):
        draw_tip_path(axes, cycle)
        shapes = [cycle.values[name][shape_indices] for name in SHAPE_VARIABLE_NAMES]
        draw_shapes(axes, shapes, shades, cycle.units.length, lw=1.8)
        axes.set_xlabel(cycle.units.axis_label("x"))
        axes.set_title(cycle.heading(cycle.period_text, cycle.period_in_tau1_text))
        if has_transients:
            draw_start_of_motion(upper, lower, cycle)
        else:
            _draw_tip_motion(upper, lower, cycle, end)
    set_common_limits(shape_panels, cycles)
    shape_panels[0].set_ylabel(cycles[0].units.axis_label("y"))
    label_tip_axes(*tip_panels[0], cycles[0].units)
    _draw_colour_bar_of_times(figure, shape_panels, ListedColormap(shades), step, is_narrow)
    figure.suptitle(selection.title)
    tip_text = "the tip from the start on" if has_transients else "the tip in time"
    return figure, f"shapes through the cycle and {tip_text}{selection.omissions_clause}"


def _new_panels(
    cycles: Sequence[StoredCycle], is_narrow: bool
) -> tuple[Figure, list[Axes], list[tuple[Axes, Axes]]]:
    """Returns (figure, one panel for the shapes of each cycle, two panels for the tip of each cycle). The
    panels of the tip are to the right of the shapes of a single cycle, and below the shapes of several cycles
    or if `is_narrow`. A panel with shapes has the aspect ratio of its content, so no space is blank."""
    cycle_count = len(cycles)
    (x_min, x_max), (y_min, y_max) = limits_of_shapes(cycles)
    if cycle_count == 1 and not is_narrow:
        figure = Figure(figsize=(8.6, 4.4), layout="constrained")
        panel_names = [["shapes", "x"], ["shapes", "y"]]
        table: dict[str, Axes] = figure.subplot_mosaic(panel_names, width_ratios=(1, 1.25))
        table["x"].sharex(table["y"])
        return figure, [table["shapes"]], [(table["x"], table["y"])]
    shapes_height = SHAPE_PANEL_WIDTH * (y_max - y_min) / (x_max - x_min)
    text_height = TOTAL_TEXT_HEIGHT_ON_NARROW_PAGE if is_narrow else TOTAL_TEXT_HEIGHT
    figure_size = SHAPE_PANEL_WIDTH * cycle_count + 1.2, shapes_height + 2 * TIP_PANEL_HEIGHT + text_height
    figure = Figure(figsize=figure_size, layout=ConstrainedLayoutEngine(w_pad=PANEL_PADDING))
    heights = (shapes_height, TIP_PANEL_HEIGHT, TIP_PANEL_HEIGHT)
    panel_rows = figure.subplots(3, cycle_count, squeeze=False, sharey="row", height_ratios=heights)
    for x, y in panel_rows[1:].T:
        x.sharex(y)
    return figure, list(panel_rows[0]), list(zip(panel_rows[1], panel_rows[2], strict=True))


def drawn_shapes_and_time_step(stored: int) -> tuple[range, float]:
    """Returns (indices, step): indices of the drawn shapes, and time between two drawn shapes, in periods.
    stored: number of stored shapes per period."""
    stride = -(-stored // MAX_SHAPES)
    return range(0, stored, stride), stride / stored


def _draw_colour_bar_of_times(
    figure: Figure, panels: list[Axes], colours: ListedColormap, step: float, is_below: bool
) -> None:
    """Draws the colour bar with the times of the shapes. colours: colours of the shapes. step: time between
    two shapes, in periods. is_below: whether the bar is below the panels, not to their right."""
    colour_count = colours.N
    norm = BoundaryNorm((np.arange(colour_count + 1) - 0.5) * step, colour_count)
    ticks = [colour_index * step for colour_index in range(0, colour_count, max(1, colour_count // 4))]
    look: dict[str, Any] = {"location": "bottom" if is_below else "right", "shrink": 0.8, "ticks": ticks}
    look["format"] = FuncFormatter(lambda tick, _: f"{tick:.3g}")
    shades = ScalarMappable(norm, colours)
    colorbar = figure.colorbar(shades, ax=panels, label="time of the shape $t/T$", **look)
    colorbar.ax.minorticks_off()


def shades_of_shapes(count: int) -> Array:
    """Colours of the shapes of a period, (count, 4), from light to dark, so that colour-blind readers see the
    order."""
    return np.asarray(matplotlib.colormaps["viridis_r"](np.linspace(UNUSED_COLOUR_FRACTION, 1, count)))


def draw_shapes(axes: Axes, shapes: Sequence[Array], shades: Array, length: float, lw: float) -> None:
    """Draws the wall, and shapes of the arm with the follower force, later shapes over earlier shapes.
    shapes: x, y and theta of the shapes, (shapes, nodes) each. shades: colours, (shapes, 4). length: L, in
    the unit of the axes. lw: width of the lines."""
    draw_clamp(axes, length)
    for number, (x, y, theta, shade) in enumerate(zip(*shapes, shades, strict=True)):
        axes.plot(x, y, color=shade, lw=lw, solid_capstyle="round", zorder=2 + number / 100)
        draw_force_arrow(axes, x, y, theta, shade, length)


def draw_tip_path(axes: Axes, cycle: StoredCycle) -> None:
    """Draws the closed path of the tip."""
    from ....discretization.elements.trigonometric import interpolate_samples  # compiled code

    phase = np.linspace(0, 1, 401, dtype=np.float64)
    x, y = (interpolate_samples(values, phase) for values in cycle.tip_path)
    axes.plot(x, y, color="0.6", lw=0.8, ls=(0, (4, 2)), zorder=1)


def draw_force_arrow(axes: Axes, x: Array, y: Array, theta: Array, colour: Any, length: float) -> Quiver:
    """Draws the follower force as an arrow of the colour `colour` that ends at the tip, along -(cos theta,
    sin theta) with theta at the tip; returns the arrow. x, y, theta: shape of the arm, (nodes,) each. length:
    L, in the unit of the axes."""
    tangent = np.array([np.cos(theta[-1]), np.sin(theta[-1])])
    arrow = -ARROW_LENGTH * length * tangent
    return axes.quiver(
        x[-1], y[-1], *arrow, angles="xy", scale_units="xy", scale=1, pivot="tip", color=colour,
        width=0.011, headwidth=4, headlength=4.5, headaxislength=4, zorder=4,
    )  # fmt: skip


def draw_clamp(axes: Axes, length: float) -> None:
    """Draws the wall that clamps the rod at u = 0. length: L, in the unit of the axes."""
    depth = WALL_DEPTH * length
    half_height = WALL_HALF_HEIGHT * length
    look: dict[str, Any] = {"fc": "white", "ec": "0.3", "hatch": "/////", "lw": 0}
    axes.add_patch(Rectangle((-depth, -half_height), depth, 2 * half_height, **look))
    axes.plot([0, 0], [-half_height, half_height], color=text_colour(), lw=1.4, zorder=5)


def set_common_limits(panels: Sequence[Axes], cycles: Sequence[StoredCycle]) -> None:
    """Sets the same limits in all panels, with equal scales for x and y, so that all cycles fit."""
    x_limits, y_limits = limits_of_shapes(cycles)
    for axes in panels:
        axes.set_aspect("equal")
        axes.set(xlim=x_limits, ylim=y_limits)


def limits_of_shapes(cycles: Sequence[StoredCycle]) -> tuple[tuple[float, float], tuple[float, float]]:
    """Returns ((left, right), (bottom, top)), the limits of all shapes and arrows, in the cycles' unit of
    length. ValueError if the shapes are too large for floating-point limits."""
    longest_length = max(cycle.units.length for cycle in cycles)
    wall_x = -WALL_DEPTH * longest_length
    margin = SHAPE_MARGIN * longest_length
    x_parts = [np.array([wall_x])]
    y_parts = []
    for cycle in cycles:
        x, y, theta = (cycle.values[name] for name in SHAPE_VARIABLE_NAMES)
        arrow = ARROW_LENGTH * cycle.units.length
        x_parts += [x.ravel(), x[:, -1] + arrow * np.cos(theta[:, -1])]
        y_parts += [y.ravel(), y[:, -1] + arrow * np.sin(theta[:, -1])]
    coordinates = [np.concatenate(values) for values in (x_parts, y_parts)]
    (x_min, x_max), (y_min, y_max) = ((x.min() - margin, x.max() + margin) for x in coordinates)
    if not (x_min < x_max and y_min < y_max):
        raise ValueError("the shapes are too large for axes in floating-point numbers")
    return (x_min, x_max), (y_min, y_max)


def _draw_tip_motion(upper: Axes, lower: Axes, cycle: StoredCycle, end: float) -> None:
    """Draws x and y of the tip against the time from 0 to `end`, with a second time axis in tau1 if the rod
    has this time scale."""
    from ....discretization.elements.trigonometric import interpolate_samples  # compiled code

    time = np.linspace(0, end, 801, dtype=np.float64)
    for axes, values, colour in zip((upper, lower), cycle.tip_path, (BLUE, VERMILION), strict=True):
        axes.plot(time, interpolate_samples(values, time / cycle.period), color=colour, lw=1.4)
        if len(values) < MAX_MARKED_SAMPLES_PER_PERIOD:
            indices = np.arange(int(end / cycle.period * len(values)) + 1)
            sample_times = indices * cycle.period / len(values)
            axes.plot(sample_times, values[indices % len(values)], "o", color=colour, ms=2.5)
        axes.axvline(cycle.period, color="0.7", lw=0.8, ls=":")
        axes.margins(x=0)
    label_time_axes(upper, lower, cycle)
