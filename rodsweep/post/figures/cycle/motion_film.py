"""Film of an arm that moves from a given shape: a GIF, with the path of its tip."""

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

from matplotlib.animation import PillowWriter
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ....arrays import Array
from ....watch import SolvePosition, report
from ..style import FIRST
from .portrait import MARGIN, WALL_DEPTH, draw_clamp

SIZE = (3.6, 4.0)
"""Width and height of a frame, in inches."""
DPI = 100
RATE = 16
"""Frames per second: a return of the tip in 32 shapes takes 2 s, as on the page of `explore`."""
MAX_FRAMES = 256
"""Largest number of frames: 16 s, which take some 10 s to draw."""


class FilmedMotion(NamedTuple):
    """x, y: shapes, (frames, nodes). step: time between shapes. length: of the arm, in the unit of x and y.

    units: names of the units of length and time.
    """

    x: Array
    y: Array
    step: float
    length: float
    units: tuple[str, str]


def motion_film(motion: FilmedMotion) -> bytes:
    """The film as a GIF; of a longer motion the first `MAX_FRAMES` shapes."""
    frames = min(len(motion.x), MAX_FRAMES)
    figure = Figure(figsize=SIZE, layout="constrained")
    axes = figure.subplots()
    _frame(axes, motion)
    (path,) = axes.plot([], [], color="0.6", lw=0.8)
    (rod,) = axes.plot([], [], color=FIRST, lw=3.0, solid_capstyle="round", zorder=3)
    with TemporaryDirectory() as directory:
        output = Path(directory) / "film.gif"
        writer = PillowWriter(fps=RATE)
        with writer.saving(figure, str(output), dpi=DPI):
            for k in range(frames):
                report(lambda k=k: SolvePosition(f"frame {k + 1} of {frames}", k / frames))  # type: ignore[misc]
                rod.set_data(motion.x[k], motion.y[k])
                path.set_data(motion.x[: k + 1, -1], motion.y[: k + 1, -1])
                axes.set_title(f"$t$ = {k * motion.step:.3g} {motion.units[1]}")
                writer.grab_frame()
        return output.read_bytes()


def _frame(axes: Axes, motion: FilmedMotion) -> None:
    """The clamp, and axes of equal scales around all shapes."""
    draw_clamp(axes, motion.length)
    margin = MARGIN * motion.length
    left = min(float(motion.x.min()), -WALL_DEPTH * motion.length)
    reach = float(abs(motion.y).max()) + margin
    axes.set(xlim=(left - margin, float(motion.x.max()) + margin), ylim=(-reach, reach), aspect="equal")
    axes.set(xlabel=f"$x$ ({motion.units[0]})", ylabel=f"$y$ ({motion.units[0]})")
