"""What a figure is asked for: the common interface of the modules that each draw the figures of a task."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from matplotlib.figure import Figure

from ...errors import InputError
from ...results.file.view import View


@dataclass(frozen=True, slots=True)
class FigureRequest:
    """The files to draw, the file to write, and what the user chose: the options of `rodsweep plot`."""

    views: Sequence[View]
    output: Path
    roots: str = "smallest"
    what: str | None = None
    points: Sequence[int] = ()
    taken: bool = False
    """Whether the file to write is there already and is no figure."""

    def only_view(self) -> View:
        """The file, for tasks that draw one and know neither --what nor --point; else InputError."""
        self.refuse_choices(self.views[0])
        self.check_output()
        return self.views[0]

    def refuse_choices(self, view: View) -> None:
        """InputError if anything is asked for that the task of `view` does not offer."""
        asked = {"--what": self.what, "--point": self.points, "several files": self.views[1:]}
        if word := next((word for word, given in asked.items() if given), ""):
            raise InputError(f"{view.path}: {word} is for results of limit_cycle, and this is {view.task}")

    def check_output(self, *suffixes: str) -> None:
        """InputError unless a figure with one of the suffixes, by default an image's, can have the name."""
        suffixes = suffixes or (".png", ".pdf", ".svg")
        if self.output.suffix not in suffixes:
            raise InputError(f"--output {self.output}: the name must end in {', '.join(suffixes)}")
        if self.taken:
            raise InputError(f"--output {self.output} is not a name for a figure; choose another")

    def write(self, figure: Figure, shown: str) -> str:
        """Writes the figure; returns what it shows."""
        figure.savefig(self.output)
        return shown
