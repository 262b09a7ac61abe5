"""`rs.plot`: the figures of `rodsweep plot`, shown in a notebook or written into a file."""

import re
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import wraps
from pathlib import Path
from tempfile import TemporaryDirectory
from types import MappingProxyType
from typing import Any, Literal, ParamSpec, TypedDict, TypeVar, Unpack

import numpy as np
import xarray as xr

from ...config.document.call_argument_errors import refusing_wrong_arguments, unknown_argument_error
from ...errors import InputError, short_repr
from ...post.figures import draw
from ...post.figures.grid_slices import checked_slice_values, slice_at_values
from ...post.figures.request import FIGURE_KINDS, ROOT_CHOICES, CycleShapeSolver, FigureClass, FigureLook
from ...results.file.view import ResultView
from ...solve.solve_lock import one_at_a_time
from ...tasks.cycle_shapes import with_shapes
from ..dataset import require_file_path
from .answer import Answer
from .tabling import view_of_result

P = ParamSpec("P")
"""Parameters of a decorated function."""
R = TypeVar("R")
"""Type of the value returned by a decorated function."""
AT_OPTION_PATTERN = re.compile(r"--at (?:'(\w+)=([^']*)'|(\w+)=(\S*[^\s:;,)]))")
"""Regular expression of the option `--at NAME=VALUE` of `rodsweep plot`, with or without quotes."""
NUMBER_TEXT_PATTERN = re.compile(r"-?(?:\d[\d.]*(?:e[+-]?\d+)?|inf)")
"""Regular expression of a number in a value of `--at`."""
ARGUMENTS_OF_OPTIONS = (
    (re.compile(r"--what (\w+)"), r'what="\1"'),
    (re.compile(r"--point (\d+)"), r"points=\1"),
    (re.compile(r"--point\b"), "points"),
    (re.compile(r"--(at|what|output|roots|width|style|title)\b"), r"\1"),
)
"""Regular expressions of options of `rodsweep plot`, each with the corresponding argument of `rs.plot`."""
SAVE_PICTURE_EXAMPLE = 'picture.save("figure.pdf")'
"""Example of a call of `Picture.save`, for messages."""
PLOT_EXAMPLE = 'rs.plot(data, "figure.pdf", width="single")'


def as_python_arguments(sentence: str) -> str:
    """A sentence in which arguments of `rs.plot` replace options of `rodsweep plot`."""
    sentence = AT_OPTION_PATTERN.sub(_at_argument_text, sentence)
    for option, argument in ARGUMENTS_OF_OPTIONS:
        sentence = option.sub(argument, sentence)
    return sentence


def _at_argument_text(match: re.Match[str]) -> str:
    """The argument `at` of `rs.plot` as Python code, from a match of AT_OPTION_PATTERN. Only values that are
    not numbers are quoted."""
    name, value = (match[1], match[2]) if match[1] else (match[3], match[4])
    return (
        f'at={{"{name}": {value}}}' if NUMBER_TEXT_PATTERN.fullmatch(value) else f'at={{"{name}": "{value}"}}'
    )


def with_python_argument_names(function: Callable[P, R]) -> Callable[P, R]:
    """Decorator that replaces command-line options by arguments of `rs.plot` in the message of an InputError
    that the function raises."""

    @wraps(function)
    def call(*values: P.args, **named: P.kwargs) -> R:
        try:
            return function(*values, **named)
        except InputError as error:
            raise InputError(as_python_arguments(str(error))) from None

    return call


Drawable = xr.Dataset | Answer | str | Path
"""Result that `rs.plot` can draw; text and paths name a result file."""


class FigureOptions(TypedDict, total=False):
    """Appearance of a figure: the options `--title`, `--width` and `--style` of `rodsweep plot`."""

    title: bool
    width: str | None
    style: str | None


def _require_valid_figure_options(look: Mapping[str, object]) -> None:
    """Raises InputError for an unknown option of the appearance, and for a title that is not a bool."""
    for name in look:
        if name not in FigureOptions.__annotations__:
            names = ["output", "roots", "what", "points", "at", *FigureOptions.__annotations__]
            raise unknown_argument_error(name, names)
    if not isinstance(title := look.get("title", False), bool):
        allowed = "True, to draw the title of the config, or False"
        raise InputError(f"title = {short_repr(title)} is not allowed; it should be {allowed}")


@dataclass(frozen=True, slots=True)
class CachedCycleShapeSolver:
    """Function that adds the shapes of cycles to a view; each set of cycles is solved once and cached. solve:
    function that computes the shapes."""

    solve: CycleShapeSolver = with_shapes
    views_by_point_numbers: dict[tuple[int, ...], ResultView] = field(default_factory=dict)
    """Views with shapes, by the numbers of the solved points, which are counted from 1."""

    def __call__(self, view: ResultView, numbers: Sequence[int]) -> ResultView:
        """A copy of the view with the shapes of the cycles at the points `numbers`, counted from 1."""
        key = tuple(numbers)
        if key not in self.views_by_point_numbers:
            self.views_by_point_numbers[key] = self.solve(view, numbers)
        return self.views_by_point_numbers[key]


@dataclass(frozen=True, slots=True)
class Picture:
    """A figure. Notebooks display the figure; `save` writes a file in any format of `rodsweep plot`.
    `figure()` returns the matplotlib figure, for adding data to its panels.

    views: results in the figure. choices: keywords of `draw` that choose its content and look.
    """

    views: Sequence[ResultView] = field(repr=False)
    choices: dict[str, Any] = field(repr=False)
    shown: str
    """Description of the figure in one sentence."""
    image: bytes = field(repr=False)
    """The rendered figure, PNG, or GIF for an animation."""

    @one_at_a_time
    @refusing_wrong_arguments(SAVE_PICTURE_EXAMPLE)
    @with_python_argument_names
    def save(self, path: str | Path) -> str:
        """Draws the figure into a file (.png, .pdf, .svg; .gif or .mp4 for an animation) and returns a
        sentence about the figure."""
        return draw(self.views, require_file_path(path, SAVE_PICTURE_EXAMPLE), **self.choices)

    @one_at_a_time
    @refusing_wrong_arguments("picture.figure()")
    def figure(self) -> FigureClass:
        """A new `matplotlib.figure.Figure`, whose axes are ordered row by row; InputError for an
        animation."""
        figures: list[FigureClass] = []
        name = Path("figure.gif" if self.is_film else "figure.png")
        draw(self.views, name, figure_callback=figures.append, **self.choices)
        return figures[0]

    @property
    def is_film(self) -> bool:
        """Whether the figure is an animation."""
        return not self.image.startswith(b"\x89PNG")

    def _repr_mimebundle_(self, include: object = None, exclude: object = None) -> dict[str, Any]:
        kind = "gif" if self.is_film else "png"
        return {f"image/{kind}": self.image, "text/plain": self.shown}


def _is_point_number(value: object) -> bool:
    """Whether a value can be the number of a point, an integer from 1 to the largest integer that an array
    can hold."""
    return isinstance(value, int | np.integer) and value is not True and bool(1 <= value <= sys.maxsize)


@one_at_a_time
@refusing_wrong_arguments(PLOT_EXAMPLE)
@with_python_argument_names
def plot(
    data: Drawable | Sequence[Drawable],
    output: str | Path | None = None,
    *,
    roots: Literal["rightmost", "smallest", "all"] | None = None,
    what: str | None = None,
    points: Sequence[int] | int = (),
    at: Mapping[str, float | str] = MappingProxyType({}),
    **look: Unpack[FigureOptions],
) -> Picture:
    """Draws and returns the figure for the task of `data`: a Dataset, an Answer or a result file. Several
    results of limit_cycle, thresholds or spectrum are drawn into one figure. output: file to write. roots,
    what, points, at, look: the options of `rodsweep plot`; points are numbered from 1. Raises InputError for
    invalid options and if there is nothing to draw."""
    _require_valid_figure_options(look)
    for name, choice, allowed in (("roots", roots, ROOT_CHOICES), ("what", what, FIGURE_KINDS)):
        if choice is not None and not (isinstance(choice, str) and choice in allowed):
            raise InputError(f"{name} = {short_repr(choice)} is not allowed; choose {', '.join(allowed)}")
    point_list = [points] if isinstance(points, int | np.integer) else points
    if not isinstance(point_list, Sequence | np.ndarray) or not all(map(_is_point_number, point_list)):
        raise InputError(f"points = {short_repr(points)} is not allowed; give whole numbers, from 1")
    views_or_answers = [data] if isinstance(data, Drawable) else data
    if not isinstance(views_or_answers, Sequence) or not views_or_answers:
        raise InputError(
            f"{short_repr(data)} has nothing to draw; give a Dataset, an answer or a file, or several"
        )
    values = checked_slice_values(at)
    views = [slice_at_values(view_of_result(item, PLOT_EXAMPLE), values) for item in views_or_answers]
    choices: dict[str, Any] = {"roots": roots, "what": what, "points": tuple(map(int, point_list))}
    choices |= {"look": FigureLook(**look), "shapes": CachedCycleShapeSolver()}
    file = None if output is None else require_file_path(output, PLOT_EXAMPLE)
    suffix = ".gif" if what == "animation" else ".png"
    with TemporaryDirectory(prefix="rodsweep-") as folder:
        # A file in the format of the display is the display: the figure is drawn once.
        path = file if file is not None and file.suffix == suffix else Path(folder, f"figure{suffix}")
        description = draw(views, path, **choices).removeprefix(f"wrote {path}: ")
        picture = Picture(views, choices, as_python_arguments(description), path.read_bytes())
    if file is not None and file != path:
        picture.save(file)
    return picture
