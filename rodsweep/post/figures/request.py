"""What a figure is asked for: the common interface of the modules that each draw the figures of a task."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil
from pathlib import Path

from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.text import Text

from ...errors import InputError
from ...results.file.view import View
from .arm_axes import add_si_scales
from .arm_validity import add_validity

WIDTHS = {"single": 3.375, "double": 7.0}
"""Of a journal's columns, in inches."""
ROOTS = ("rightmost", "smallest")
KINDS = ("cycle", "amplitude", "maps", "energy", "transient", "animation")
"""Which two roots a figure of spectra may follow, and which figures of limit cycles there are."""
HEIGHT_POWER = 0.5
"""Of the ratio of the widths, by which a figure gets lower: panels get narrower, their text does not."""
POINTS_OF_TYPE = 8.0
"""Size of all text in a figure of such a width."""
MOST_COLUMNS, ROW = 3, 0.17
"""Of a legend below a figure; the height of its rows, in inches."""


@dataclass(frozen=True, slots=True)
class Look:
    """How a figure looks, whatever it shows.

    title: whether it has that of the config; width: one of WIDTHS, None: what the figure needs; style: a
    style of matplotlib's, by name or file.
    """

    title: bool = False
    width: str | None = None
    style: str | None = None

    @property
    def narrow(self) -> bool:
        """Whether panels have no room beside each other."""
        return self.width == "single"

    def fit(self, figure: Figure) -> None:
        """Gives a figure the width of a column, and its text the size that belongs to it."""
        if self.width is None:
            return
        across, down = figure.get_size_inches()
        width = WIDTHS[self.width]
        figure.set_size_inches(width, down * min(1.0, width / across) ** HEIGHT_POWER)
        for axes in figure.axes:
            axes.tick_params(labelsize=POINTS_OF_TYPE)
        for text in figure.findobj(Text):
            text.set_fontsize(POINTS_OF_TYPE)
        for legend in list(figure.legends):
            narrow(legend, figure)


def narrow(legend: Legend, figure: Figure) -> None:
    """Gives a legend that is wider than its figure fewer columns, and the figure the height of the rows."""
    texts = [text.get_text() for text in legend.get_texts()]
    handles = [handle for handle in legend.legend_handles if handle is not None]
    size = legend.get_texts()[0].get_fontsize() if texts else POINTS_OF_TYPE
    for columns in range(MOST_COLUMNS - 1, 0, -1):
        if legend.get_window_extent().width <= figure.bbox.width:
            return
        legend.remove()
        legend = figure.legend(
            handles, texts, loc="outside lower center", ncols=columns, frameon=False, fontsize=size
        )
        width, height = figure.get_size_inches()
        more = ceil(len(texts) / columns) - ceil(len(texts) / (columns + 1))
        figure.set_size_inches(width, height + ROW * more)


@dataclass(frozen=True, slots=True)
class FigureRequest:
    """The files to draw, the file to write, and what the user chose: the options of `rodsweep plot`."""

    views: Sequence[View]
    output: Path
    roots: str | None = None
    what: str | None = None
    points: Sequence[int] = ()
    taken: bool = False
    """Whether the file to write is there already and is no figure."""
    look: Look = Look()

    def only_view(self) -> View:
        """The file, for tasks that draw one and know neither --what nor --point; else InputError."""
        self.refuse_choices(self.views[0])
        self.check_output()
        return self.views[0]

    def refuse_choices(self, view: View) -> None:
        """InputError if anything is asked for that the task of `view` does not offer."""
        self.refuse_points(view)
        if self.views[1:]:
            raise InputError(
                f"{view.path}: several files are drawn of limit_cycle or of spectrum, and this is {view.task}"
            )

    def refuse_points(self, view: View) -> None:
        """InputError if a figure or points are chosen, which the task of `view` lacks."""
        asked = {"--what": self.what, "--point": self.points}
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
        """Writes the figure, with SI units where the rod is an arm; returns what it shows."""
        add_si_scales(figure, self.views)
        if not any(view.over for view in self.views):  # whose own figures tell it
            add_validity(figure, self.views)
        self.look.fit(figure)
        figure.savefig(self.output)
        return shown
