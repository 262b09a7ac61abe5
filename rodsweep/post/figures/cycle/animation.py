"""Films of a moving arm: the cycles of a file as a GIF, or as an MP4 if ffmpeg is installed; and the motion
of an arm from an initial shape as a GIF."""

from collections.abc import Sequence
from math import floor, log10
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import matplotlib
import numpy as np
from matplotlib.animation import AbstractMovieWriter, FFMpegWriter, PillowWriter
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ....arrays import Array
from ....errors import EnvironmentIncomplete, InputError
from ....results.file.view import ResultView
from ....solve_progress import SolvePosition, report
from ...output_files import temporary_output_path
from ..layout.layout_fitting import fit_layout
from ..style import BLUE, VERMILION
from .selection import SHAPE_VARIABLE_NAMES, CycleSelection, StoredCycle, chosen_cycles
from .shapes_and_tip_motion import (
    SHAPE_MARGIN,
    WALL_DEPTH,
    draw_clamp,
    draw_force_arrow,
    draw_tip_path,
    set_common_limits,
)
from .tip_path import SEGMENTS_BETWEEN_SHAPES, smooth_tip_path

FILM_SUFFIXES = (".gif", ".mp4")
"""Suffixes of animation files."""
FILM_PERIOD_SECONDS = 2.4
"""Duration of one period of the cycle on the screen, in s."""
MIN_SHAPES_PER_PERIOD = 8
"""Smallest number of stored shapes per period; with fewer shapes the motion is not recognisable."""
EARLIER_SHAPE_COUNT = 6
"""Number of earlier shapes drawn in fading colours behind the arm."""
PERIOD_DIGITS = 3
"""Number of significant digits of the period. The running time is printed with as many decimals as the
period."""
RELATIVE_TIME_TEXT_HEIGHT = 0.08
"""Height of the text line with the running time above the moving arm, as a fraction of the panel's height."""
MAX_EARLIER_SHAPE_AGE = 0.2
"""Age of the oldest earlier shape that is drawn, in periods."""
DPI = 100
"""Resolution of a frame, in pixels per inch."""
FRAME_SIZE_IN_INCHES = (3.6, 4.0)
"""Width and height of a frame of a released motion, in inches."""
FRAME_RATE = 16
"""Frames per second of a released motion. The 32 shapes between two returns of the tip take 2 s, as on the
page of `rodsweep explore`."""
MAX_RELEASED_MOTION_FRAMES = 256
"""Largest number of frames of a released motion: a film of 16 s, whose drawing takes some 10 s."""


def write_animation(view: ResultView, points: Sequence[int], output: Path) -> str:
    """Writes an animation of one period of up to three cycles, side by side and with equal durations; returns
    a description. Raises InputError for too few shapes."""
    selection = chosen_cycles(view, points, SHAPE_VARIABLE_NAMES)
    frames = len(selection.cycles[0].values["shape_x"])
    if frames < MIN_SHAPES_PER_PERIOD:
        remedy = "too few for an animation; run with limit_cycle.shapes: 48"
        raise InputError(f"{view.path} holds {frames} shapes of a cycle, {remedy}")
    writer = _film_writer(output, max(1, round(frames / FILM_PERIOD_SECONDS)))
    figure, arms = prepared_animation(selection)
    with temporary_output_path(output) as partial, writer.saving(figure, str(partial), dpi=DPI):
        for frame_index in range(frames):
            for arm in arms:
                arm.show_frame(frame_index)
            writer.grab_frame()
    return f"one period in {frames} frames" + selection.omissions_clause


def prepared_animation(selection: CycleSelection) -> tuple[Figure, list["MovingArm"]]:
    """Returns (figure, arms): the figure in its final layout, and the animated arms in their first shapes."""
    cycles = selection.cycles
    figure = Figure(figsize=(2.7 * len(cycles) + 0.9, 4.4), layout="constrained")
    panels = figure.subplots(1, len(cycles), squeeze=False, sharey=True)[0]
    figure.suptitle(selection.title)
    panels[0].set_ylabel(cycles[0].units.axis_label("y"))
    arms = [MovingArm(axes, cycle) for axes, cycle in zip(panels, cycles, strict=True)]
    set_common_limits(panels, cycles)
    low, high = panels[0].get_ylim()  # shared by all panels
    panels[0].set_ylim(low - RELATIVE_TIME_TEXT_HEIGHT * (high - low), high)
    for arm in arms:
        arm.show_frame(0)
    fit_layout(figure)
    figure.set_layout_engine("none")  # a new layout for each frame would move the panels
    return figure, arms


def _film_writer(output: Path, rate: int) -> AbstractMovieWriter:
    """Matplotlib writer for the suffix of `output`, with `rate` frames per second. Raises
    EnvironmentIncomplete for an MP4 without ffmpeg."""
    if output.suffix == ".gif":
        return PillowWriter(fps=rate)
    if not matplotlib.animation.writers.is_available("ffmpeg"):
        problem = "an .mp4 needs ffmpeg, which is not installed; a .gif does not"
        raise EnvironmentIncomplete(f"{output}: {problem}")
    return FFMpegWriter(fps=rate)


class MovingArm:
    """Animated arm in one panel, with the follower force, earlier shapes in grey, and the running time."""

    def __init__(self, axes: Axes, cycle: StoredCycle) -> None:
        self.axes = axes
        self.cycle = cycle
        self.frames = len(cycle.values["shape_x"])
        draw_tip_path(axes, cycle)
        draw_clamp(axes, cycle.units.length)
        grey_levels = np.linspace(0.85, 0.45, EARLIER_SHAPE_COUNT)
        self.ghosts = [axes.plot([], [], color=str(grey), lw=1.2, zorder=1.5)[0] for grey in grey_levels]
        (self.rod,) = axes.plot([], [], color=BLUE, lw=3.0, solid_capstyle="round", zorder=3)
        self.arrow = draw_force_arrow(
            axes, np.zeros(1), np.zeros(1), np.zeros(1), VERMILION, cycle.units.length
        )
        self.text = axes.text(0.02, 0.02, "", transform=axes.transAxes, size=9)
        axes.set_xlabel(cycle.units.axis_label("x"))
        axes.set_title(cycle.heading(cycle.period_text))

    def show_frame(self, frame_index: int) -> None:
        """Moves the arm to the shape with index `frame_index`."""
        shapes = [self.cycle.values[name] for name in SHAPE_VARIABLE_NAMES]
        ages = np.linspace(MAX_EARLIER_SHAPE_AGE * self.frames, 0, EARLIER_SHAPE_COUNT, endpoint=False)
        for ghost, steps in zip(self.ghosts, ages.round().astype(int), strict=True):
            ghost.set_data(shapes[0][frame_index - steps], shapes[1][frame_index - steps])
        x, y, theta = (values[frame_index] for values in shapes)
        self.rod.set_data(x, y)
        self.arrow.remove()
        self.arrow = draw_force_arrow(self.axes, x, y, theta, VERMILION, self.cycle.units.length)
        time = self.cycle.period * frame_index / self.frames
        decimals = max(0, PERIOD_DIGITS - 1 - floor(log10(self.cycle.period)))
        time_unit = self.cycle.units.names[1]
        self.text.set_text(f"$t$ = {time:.{decimals}f} {time_unit} = {frame_index / self.frames:.2f} $T$")


class FilmedMotion(NamedTuple):
    """Motion of an arm in the units of the film.

    x, y: shapes, (frames, nodes). shape_interval: time between shapes. length: length of the arm. units:
    names of the units of length and time.
    """

    x: Array
    y: Array
    shape_interval: float
    length: float
    units: tuple[str, str]


def motion_film(motion: FilmedMotion) -> bytes:
    """The motion as the content of a GIF file, with at most the first MAX_RELEASED_MOTION_FRAMES shapes."""
    frames = min(len(motion.x), MAX_RELEASED_MOTION_FRAMES)
    figure = Figure(figsize=FRAME_SIZE_IN_INCHES, layout="constrained")
    axes = figure.subplots()
    draw_clamp(axes, motion.length)
    margin = SHAPE_MARGIN * motion.length
    x_min = min(float(motion.x.min()), -WALL_DEPTH * motion.length)
    y_max = float(abs(motion.y).max()) + margin
    axes.set(xlim=(x_min - margin, float(motion.x.max()) + margin), ylim=(-y_max, y_max), aspect="equal")
    axes.set(xlabel=f"$x$ ({motion.units[0]})", ylabel=f"$y$ ({motion.units[0]})")
    (path,) = axes.plot([], [], color="0.6", lw=0.8)
    (rod,) = axes.plot([], [], color=BLUE, lw=3.0, solid_capstyle="round", zorder=3)
    tip_path = smooth_tip_path(np.stack([motion.x[:, -1], motion.y[:, -1]], axis=1), is_closed=False)
    with TemporaryDirectory() as directory:
        output = Path(directory) / "film.gif"
        writer = PillowWriter(fps=FRAME_RATE)
        with writer.saving(figure, str(output), dpi=DPI):
            for k in range(frames):
                position = SolvePosition(f"frame {k + 1} of {frames}", k / frames)
                report(lambda position=position: position)  # type: ignore[misc]
                rod.set_data(motion.x[k], motion.y[k])
                path.set_data(*tip_path[: k * SEGMENTS_BETWEEN_SHAPES + 1].T)
                axes.set_title(f"$t$ = {k * motion.shape_interval:.3g} {motion.units[1]}")
                writer.grab_frame()
        return output.read_bytes()
