"""What a figure is asked for: the common interface of the modules that each draw the figures of a task."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from matplotlib.figure import Figure

from ...errors import InputError
from ...model.units import in_si
from ...results.file.view import View
from .arm.axes import add_si_scales
from .arm.validity import add_validity
from .layout.fitting import LEAST_ASPECT, fit

Shapes = Callable[[View, Sequence[int]], View]
"""A file with the shapes of the cycles of some points, numbered from 1."""
Drawing = Figure
"""What a figure is to those who draw into it: matplotlib's own class."""
WIDTHS = {"single": 3.375, "double": 7.0}
"""Of a journal's columns, in inches."""
ROOTS = ("rightmost", "smallest", "all")
"""Which roots a line of spectra shows: two that are followed, or all that are stored."""
KINDS_OF_TASK = {
    "limit_cycle": ("cycle", "amplitude", "maps", "energy", "transient", "animation"),
    "thresholds": ("lines", "map"),
}
"""Which figures there are of a task that has several."""
KINDS = tuple(kind for kinds in KINDS_OF_TASK.values() for kind in kinds)
HEIGHT_POWER = 0.5
"""Of the ratio of the widths, by which a figure gets lower: panels get narrower, their text does not."""
INCH = 0.0254
"""Metres."""
NARROW = 5.0
"""Inches below which panels have no room beside each other."""
NARROWEST, WIDEST = 2.5, 20.0
"""Inches that a figure may be wide: below, its labels are wider than its panels."""


@dataclass(frozen=True, slots=True)
class Look:
    """How a figure looks, whatever it shows.

    title: whether it has that of the config; width: one of WIDTHS or a length with its unit, None: what the
    figure needs; style: a style of matplotlib's, by name or file. Raises InputError for another width.
    """

    title: bool = False
    width: str | None = None
    style: str | None = None
    inches: float | None = field(init=False)
    """The width, None where it is that which the figure needs."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "inches", None if self.width is None else _inches(self.width))

    @property
    def narrow(self) -> bool:
        """Whether panels have no room beside each other."""
        return self.inches is not None and self.inches < NARROW

    def fit(self, figure: Figure, least_aspect: float = LEAST_ASPECT) -> None:
        """Gives a figure its width, and makes all that is in it fit."""
        if self.inches is not None:
            across, down = figure.get_size_inches()
            figure.set_size_inches(self.inches, down * min(1.0, self.inches / across) ** HEIGHT_POWER)
        fit(figure, least_aspect)


def _inches(width: str) -> float:
    """A width as `--width` takes it, in inches; InputError for what no page has room for."""
    if width in WIDTHS:
        return WIDTHS[width]
    refusal = f"width = {width!r} is not allowed; choose {', '.join(WIDTHS)}, or a length as '89 mm'"
    try:
        inches = in_si("width", width, "m", "89 mm") / INCH
    except InputError:
        raise InputError(refusal) from None
    if not NARROWEST <= inches <= WIDEST:
        raise InputError(f"{refusal}, from {NARROWEST * INCH * 1e3:.0f} to {WIDEST * INCH * 1e3:.0f} mm")
    return inches


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
    shapes: Shapes | None = None
    """Solves cycles whose shapes a file lacks."""
    keep: Callable[[Figure], None] | None = None
    """Takes the figure, laid out, instead of a file."""

    def only_view(self, *kinds: str) -> View:
        """The file, for tasks that draw one, know no --point, and of --what the kinds; else InputError."""
        self.refuse_choices(self.views[0], kinds)
        self.check_output()
        return self.views[0]

    def refuse_choices(self, view: View, kinds: Sequence[str] = ()) -> None:
        """InputError if anything is asked for that the task of `view` does not offer."""
        self.refuse_points(view, kinds)
        if self.views[1:]:
            raise InputError(
                f"{view.path}: several files are drawn of limit_cycle or of spectrum, and this is {view.task}"
            )

    def refuse_points(self, view: View, kinds: Sequence[str] = ()) -> None:
        """InputError for points, or a figure that is none of the kinds, which the task of `view` lacks."""
        if self.points:
            raise InputError(f"{view.path}: --point is for results of limit_cycle, and this is {view.task}")
        if self.what and self.what not in kinds:
            task = next(task for task, known in KINDS_OF_TASK.items() if self.what in known)
            raise InputError(
                f"{view.path}: --what {self.what} is for results of {task}, and this is {view.task}"
            )

    def check_output(self, *suffixes: str) -> None:
        """InputError unless a figure with one of the suffixes, by default an image's, can have the name."""
        suffixes = suffixes or (".png", ".pdf", ".svg")
        if self.output.suffix not in suffixes:
            raise InputError(f"--output {self.output}: the name must end in {', '.join(suffixes)}")
        if self.taken:
            raise InputError(f"--output {self.output} is not a name for a figure; choose another")

    def write(self, figure: Figure, shown: str, least_aspect: float = LEAST_ASPECT) -> str:
        """Writes the figure, with SI units where the rod is an arm; returns what it shows.

        least_aspect: height of its panels in units of their width, below which it grows.
        """
        add_si_scales(figure, self.views)
        if not any(view.over for view in self.views):  # whose own figures tell it
            add_validity(figure, self.views)
        self.look.fit(figure, least_aspect)
        if self.keep is None:
            figure.savefig(self.output)
        else:
            self.keep(figure)
        return shown
