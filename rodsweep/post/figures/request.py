"""Request for a figure: the common interface of the modules that draw the figures of each task."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from matplotlib import rcParams
from matplotlib.figure import Figure

from ...errors import InputError
from ...model.units import in_si
from ...results.file.view import View
from .arm.axes import add_si_scales
from .arm.validity import add_validity
from .layout.fitting import MIN_ASPECT, fit

Shapes = Callable[[View, Sequence[int]], View]
"""Function from a file and points, numbered from 1, to the file with the shapes of their cycles."""
Drawing = Figure
"""Figure in functions that draw into a figure: matplotlib's own class."""
WIDTHS = {"single": 3.375, "double": 7.0}
"""Widths of the columns of a journal, in inches."""
ROOTS = ("rightmost", "smallest", "all")
"""Choices of the roots in a line of spectra: one of two that are followed, or all stored roots."""
KINDS_OF_TASK = {
    "limit_cycle": ("cycle", "amplitude", "maps", "energy", "transient", "animation"),
    "thresholds": ("lines", "map"),
}
"""Kinds of figures of each task that has several."""
KINDS = tuple(kind for kinds in KINDS_OF_TASK.values() for kind in kinds)
"""Kinds of figures of all tasks."""
HEIGHT_POWER = 0.5
"""Exponent of the ratio of widths by which the height shrinks; below 1, because the text keeps the size."""
INCH = 0.0254
"""Length of an inch, in metres."""
NARROW = 5.0
"""Width, in inches, below which panels are stacked."""
NARROWEST = 2.5
"""Smallest width of a figure, in inches; in a narrower figure labels are wider than panels."""
WIDEST = 20.0
"""Largest width of a figure, in inches."""


@dataclass(frozen=True, slots=True)
class FigureLook:
    """Appearance of a figure, independent of the content.

    title: whether the figure has the title of the config. width: a name from WIDTHS, or a length with a unit;
    None for the natural width of the figure. style: a style of matplotlib, by name or file. Raises InputError
    for any other width.
    """

    title: bool = False
    width: str | None = None
    style: str | None = None
    inches: float | None = field(init=False)
    """The width in inches; None for the natural width of the figure."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "inches", None if self.width is None else _inches(self.width))

    @property
    def narrow(self) -> bool:
        """Whether panels are stacked."""
        return self.inches is not None and self.inches < NARROW

    def fit(self, figure: Figure, min_aspect: float = MIN_ASPECT) -> None:
        """Gives a figure the width, and fits the content."""
        if self.inches is not None:
            across, down = figure.get_size_inches()
            figure.set_size_inches(self.inches, down * min(1.0, self.inches / across) ** HEIGHT_POWER)
        fit(figure, min_aspect)


def _inches(width: str) -> float:
    """A width given by the user, in inches; raises InputError if no page has room for it."""
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
    """Files to draw, the file to write, and the choices of the user: the options of `rodsweep plot`."""

    views: Sequence[View]
    output: Path
    roots: str | None = None
    what: str | None = None
    points: Sequence[int] = ()
    taken: bool = False
    """Whether the output is a file to draw, or exists and is no regular file."""
    look: FigureLook = FigureLook()
    shapes: Shapes | None = None
    """Solves cycles whose shapes a file lacks."""
    keep: Callable[[Figure], None] | None = None
    """Receives the finished figure instead of a file."""

    def only_view(self, *kinds: str) -> View:
        """The single file to draw; InputError for several files, points, or a --what outside `kinds`."""
        self.refuse_choices(self.views[0], kinds)
        self.check_output()
        return self.views[0]

    def refuse_choices(self, view: View, kinds: Sequence[str] = ()) -> None:
        """Raises InputError for any choice that the task of `view` does not offer."""
        self.refuse_points(view, kinds)
        if self.views[1:]:
            raise InputError(
                f"{view.path} is a result of the task {view.task}; only results of limit_cycle, spectrum or "
                "thresholds can share a figure"
            )

    def refuse_points(self, view: View, kinds: Sequence[str] = ()) -> None:
        """Raises InputError for points, or a figure outside `kinds`, which the task of `view` lacks."""
        if self.points:
            raise InputError(
                f"{view.path}: --point is for results of limit_cycle, and this is a result of {view.task}"
            )
        if self.what and self.what not in kinds:
            task = next(task for task, known in KINDS_OF_TASK.items() if self.what in known)
            raise InputError(
                f"{view.path}: --what {self.what} is for results of {task}, and this is a result of "
                f"{view.task}"
            )

    def check_output(self, *suffixes: str) -> None:
        """Raises InputError unless the output has one of the suffixes, by default an image's, and is free."""
        suffixes = suffixes or (".png", ".pdf", ".svg")
        if self.output.suffix not in suffixes:
            raise InputError(f"--output {self.output}: the name must end in {', '.join(suffixes)}")
        if self.taken:
            raise InputError(f"--output {self.output} is not a name for a figure; choose another")

    def write(self, figure: Figure, shown: str, min_aspect: float = MIN_ASPECT) -> str:
        """Writes the figure, with SI scales if the rod is an arm; returns the sentence `shown`.

        min_aspect: smallest height of a panel, in units of the panel's width.
        """
        add_si_scales(figure, self.views)
        # Figures over an arm's quantities show the validity themselves.
        if not any(view.over for view in self.views):
            add_validity(figure, self.views)
        if self.keep is not None:
            self.look.fit(figure, min_aspect)
            self.keep(figure)
            return shown
        if (dpi := rcParams["savefig.dpi"]) != "figure":
            figure.set_dpi(dpi)  # texts are measured as they are saved
        self.look.fit(figure, min_aspect)
        figure.set_layout_engine(None)  # `fit` has laid the figure out; savefig would do it again
        figure.savefig(self.output)
        return shown
