"""Film, as a GIF, of the motion of an arm from an initial shape, with the path of the tip."""

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import numpy as np
from matplotlib.animation import PillowWriter
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ....arrays import Array
from ....solve_progress import SolvePosition, report
from ..style import BLUE
from .portrait import SHAPE_MARGIN, WALL_DEPTH, draw_clamp
from .tip_path import SEGMENTS_BETWEEN_SHAPES, smooth_tip_path

FRAME_SIZE = (3.6, 4.0)
"""Width and height of a frame, in inches."""
DPI = 100
"""Resolution of a frame, in pixels per inch."""
FRAME_RATE = 16
"""Frames per second. The 32 shapes between two returns of the tip take 2 s, as on the page of `rodsweep
explore`."""
MAX_FRAMES = 256
"""Largest number of frames: a film of 16 s, whose drawing takes some 10 s."""


class FilmedMotion(NamedTuple):
    """Motion of an arm in the units of the film.

    x, y: shapes, (frames, nodes). step: time between shapes. length: length of the arm. units: names of the
    units of length and time.
    """

    x: Array
    y: Array
    step: float
    length: float
    units: tuple[str, str]


def motion_film(motion: FilmedMotion) -> bytes:
    """The motion as the content of a GIF file, with at most the first MAX_FRAMES shapes."""
    frames = min(len(motion.x), MAX_FRAMES)
    figure = Figure(figsize=FRAME_SIZE, layout="constrained")
    axes = figure.subplots()
    _set_up_axes(axes, motion)
    (path,) = axes.plot([], [], color="0.6", lw=0.8)
    (rod,) = axes.plot([], [], color=BLUE, lw=3.0, solid_capstyle="round", zorder=3)
    tip_path = smooth_tip_path(np.stack([motion.x[:, -1], motion.y[:, -1]], axis=1), is_closed=False)
    with TemporaryDirectory() as directory:
        output = Path(directory) / "film.gif"
        writer = PillowWriter(fps=FRAME_RATE)
        with writer.saving(figure, str(output), dpi=DPI):
            for k in range(frames):
                report(lambda k=k: SolvePosition(f"frame {k + 1} of {frames}", k / frames))  # type: ignore[misc]
                rod.set_data(motion.x[k], motion.y[k])
                path.set_data(*tip_path[: k * SEGMENTS_BETWEEN_SHAPES + 1].T)
                axes.set_title(f"$t$ = {k * motion.step:.3g} {motion.units[1]}")
                writer.grab_frame()
        return output.read_bytes()


def _set_up_axes(axes: Axes, motion: FilmedMotion) -> None:
    """Draws the clamp, and sets the axes so that all shapes fit, with equal scales for x and y."""
    draw_clamp(axes, motion.length)
    margin = SHAPE_MARGIN * motion.length
    x_min = min(float(motion.x.min()), -WALL_DEPTH * motion.length)
    y_max = float(abs(motion.y).max()) + margin
    axes.set(xlim=(x_min - margin, float(motion.x.max()) + margin), ylim=(-y_max, y_max), aspect="equal")
    axes.set(xlabel=f"$x$ ({motion.units[0]})", ylabel=f"$y$ ({motion.units[0]})")
