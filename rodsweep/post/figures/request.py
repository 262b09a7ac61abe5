"""What a figure is asked for, and what the module of a task answers with: how the figure is written."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from matplotlib.figure import Figure

from ...errors import InputError
from ...results.file.view import View

IMAGES = (".png", ".pdf", ".svg")
"""Suffixes of a figure that does not move."""


@dataclass(frozen=True, slots=True)
class FigureRequest:
    """The files to draw, all read, and what the user chose; the task of the first file finds the figure."""

    views: Sequence[View]
    suffix: str
    """Of the file that is to hold the figure."""
    roots: str = "smallest"
    """--roots: which roots are followed."""
    what: str | None = None
    """--what: the name of a figure where a task has several."""
    points: Sequence[int] = ()
    """--point: numbers of points, from 1."""

    def only_view(self) -> View:
        """The file, for tasks that draw one and know neither --what nor --point; else InputError."""
        self.refuse_choices(self.views[0])
        return self.views[0]

    def refuse_choices(self, view: View) -> None:
        """InputError if anything is asked for that the task of `view` does not offer."""
        asked = {
            "--what": self.what is not None,
            "--point": bool(self.points),
            "several files": len(self.views) > 1,
        }
        word = next((word for word, is_asked in asked.items() if is_asked), None)
        if word:
            raise InputError(f"{view.path}: {word} is for results of limit_cycle, and this is {view.task}")


@dataclass(frozen=True, slots=True)
class Drawing:
    """A figure that can be drawn: `write` makes the file and returns what the figure shows."""

    write: Callable[[Path], str]
    suffixes: tuple[str, ...] = IMAGES


def image(draw: Callable[[], tuple[Figure, str]]) -> Drawing:
    """The drawing of a figure that does not move; `draw` gives it, and what it shows."""

    def write(output: Path) -> str:
        figure, shown = draw()
        figure.savefig(output, dpi=160)
        return shown

    return Drawing(write)
