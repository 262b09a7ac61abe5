"""Request for a figure: the common argument of the functions that draw the figures of the tasks."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from matplotlib import rcParams
from matplotlib.figure import Figure

from ...errors import InputError, short_repr
from ...model.units import quantity_in_si
from ...results.file.view import ResultView
from ..output_files import save_figure
from .arm.second_axis_scales import add_arm_scales
from .arm.validity_hatches import hatch_invalid_points
from .layout.layout_fitting import MIN_ASPECT, fit_layout

CycleShapeSolver = Callable[[ResultView, Sequence[int]], ResultView]
"""Function that computes the shapes of cycles. Arguments: view of a file, and numbers of points, from 1.
Returns a view with the shapes."""
FigureClass = Figure
"""Class of the figures: matplotlib's `Figure`."""
COLUMN_WIDTHS = {"single": 3.375, "double": 7.0}
"""Widths of a figure over one and over two columns of a journal, in inches, by name."""
ROOT_CHOICES = ("rightmost", "smallest", "all")
"""Choices of the roots in a figure of spectra along a line: the two rightmost, the two smallest, or all
stored roots."""
FIGURE_KINDS_BY_TASK = {
    "limit_cycle": ("cycle", "amplitude", "maps", "energy", "transient", "animation"),
    "thresholds": ("lines", "map"),
}
"""Names of the kinds of figures between which --what chooses, by task; other tasks have a single kind."""
FIGURE_KINDS = tuple(kind for kinds in FIGURE_KINDS_BY_TASK.values() for kind in kinds)
"""Names of the kinds of figures of all tasks."""
HEIGHT_TO_WIDTH_EXPONENT = 0.5
"""The height of a figure scales as the width to this power. The power is below 1, because the size of the
text does not change."""
METRES_PER_INCH = 0.0254
"""Length of an inch, in metres."""
NARROW_WIDTH = 5.0
"""The panels of a figure are stacked if the figure is narrower than this width, in inches."""
MIN_WIDTH_IN_INCHES = 2.5
"""Smallest width of a figure, in inches. In a narrower figure labels would be wider than panels."""
MAX_WIDTH_IN_INCHES = 20.0
"""Largest width of a figure, in inches."""


@dataclass(frozen=True, slots=True)
class FigureLook:
    """Appearance of a figure.

    title: whether the title of the config is shown. width: a name from COLUMN_WIDTHS, or a length with a
    unit; None for the natural width. style: name or file of a matplotlib style. Raises InputError for an
    invalid width."""

    title: bool = False
    width: str | None = None
    style: str | None = None
    width_in_inches: float | None = field(init=False)
    """Width of the figure, in inches; None for the natural width."""

    def __post_init__(self) -> None:
        object.__setattr__(
            self, "width_in_inches", None if self.width is None else _width_in_inches(self.width)
        )

    @property
    def is_narrow(self) -> bool:
        """Whether the figure is so narrow that its panels are stacked."""
        return self.width_in_inches is not None and self.width_in_inches < NARROW_WIDTH

    def fit(self, figure: Figure, min_aspect: float = MIN_ASPECT) -> None:
        """Scales a figure to the width `width_in_inches`, if given, and lays out the figure, see
        `fit_layout`. min_aspect: smallest ratio of height to width of a panel."""
        if self.width_in_inches is not None:
            natural_width, natural_height = figure.get_size_inches()
            shrinkage = min(1.0, self.width_in_inches / natural_width)
            figure.set_size_inches(self.width_in_inches, natural_height * shrinkage**HEIGHT_TO_WIDTH_EXPONENT)
        fit_layout(figure, min_aspect)


def _width_in_inches(width: str) -> float:
    """Width in inches, from a name in COLUMN_WIDTHS or a length with a unit. Raises InputError for another
    text, and for a width outside MIN_WIDTH_IN_INCHES to MAX_WIDTH_IN_INCHES."""
    if isinstance(width, str) and width in COLUMN_WIDTHS:
        return COLUMN_WIDTHS[width]
    message = (
        f"width = {short_repr(width)} is not allowed; choose {', '.join(COLUMN_WIDTHS)}, "
        "or a length such as '89 mm'"
    )
    try:
        inches = quantity_in_si("width", width, "m", "89 mm") / METRES_PER_INCH
    except InputError:
        raise InputError(message) from None
    if not MIN_WIDTH_IN_INCHES <= inches <= MAX_WIDTH_IN_INCHES:
        low, high = (1e3 * METRES_PER_INCH * limit for limit in (MIN_WIDTH_IN_INCHES, MAX_WIDTH_IN_INCHES))
        raise InputError(f"{message}, from {low:.0f} to {high:.0f} mm")
    return inches


@dataclass(frozen=True, slots=True)
class FigureRequest:
    """Result files `views` to draw, output file, and options of `rodsweep plot` (roots, what, points: see
    `FigureChoices`; look: appearance)."""

    views: Sequence[ResultView]
    output: Path
    roots: str | None = None
    what: str | None = None
    points: Sequence[int] = ()
    is_output_protected: bool = False
    """Whether `output` is one of the files to draw, or exists and is not a regular file."""
    look: FigureLook = FigureLook()
    shape_solver: CycleShapeSolver | None = None
    """Function that computes the shapes of cycles if the file has no shapes."""
    figure_callback: Callable[[Figure], None] | None = None
    """Callback for the finished figure; if given, no file is written."""

    def require_single_view(self, *kinds: str) -> ResultView:
        """The only result to draw. Raises InputError if there are several files, or for options that do not
        fit: chosen points, a value of --what that is not in `kinds`, or an invalid output name."""
        self.refuse_figure_options(self.views[0], kinds)
        self.require_output()
        return self.views[0]

    def refuse_figure_options(self, view: ResultView, kinds: Sequence[str] = ()) -> None:
        """Raises InputError for options that the task of `view` does not have, and for several files. kinds:
        allowed values of --what."""
        self.refuse_points_and_other_kinds(view, kinds)
        if self.views[1:]:
            raise InputError(
                f"{view.path} is a result of the task {view.task}; only results of limit_cycle, spectrum or "
                "thresholds can share a figure"
            )

    def refuse_points_and_other_kinds(self, view: ResultView, kinds: Sequence[str] = ()) -> None:
        """Raises InputError for chosen points, and for a value of --what that is not in `kinds`."""
        if self.points:
            raise InputError(
                f"{view.path}: --point is for results of limit_cycle, and this is a result of {view.task}"
            )
        if self.what and self.what not in kinds:
            task = next(task for task, own_kinds in FIGURE_KINDS_BY_TASK.items() if self.what in own_kinds)
            option = f"--what {self.what}"
            raise InputError(
                f"{view.path}: {option} is for results of {task}, and this is a result of {view.task}"
            )

    def require_output(self, *suffixes: str) -> None:
        """Raises InputError if the name of the output file has none of the suffixes (by default suffixes of
        images), or if `is_output_protected` is true."""
        suffixes = suffixes or (".png", ".pdf", ".svg")
        if self.output.suffix not in suffixes:
            raise InputError(f"--output {self.output}: the name must end in {', '.join(suffixes)}")
        if self.is_output_protected:
            raise InputError(
                f"--output {self.output} is one of the results of this figure, or not a regular file, so it "
                "is not overwritten; choose another name"
            )

    def write(self, figure: Figure, caption: str, min_aspect: float = MIN_ASPECT) -> str:
        """Writes the figure, with second scales and hatches for an arm; returns `caption`, the description of
        the figure. min_aspect: smallest ratio of height to width of a panel."""
        add_arm_scales(figure, self.views)
        # Figures over an arm's quantities show the validity themselves.
        if not any(view.arm_axes for view in self.views):
            hatch_invalid_points(figure, self.views)
        if self.figure_callback is not None:
            self.look.fit(figure, min_aspect)
            self.figure_callback(figure)
            return caption
        if (dpi := rcParams["savefig.dpi"]) != "figure":
            figure.set_dpi(dpi)  # texts are measured as they are saved
        self.look.fit(figure, min_aspect)
        figure.set_layout_engine(None)  # savefig would repeat the layout of `fit_layout`
        save_figure(figure, self.output)
        return caption
