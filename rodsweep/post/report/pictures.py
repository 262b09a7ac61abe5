"""Figures on the HTML page of a result: all figures of `rodsweep plot` that can be drawn from the result
file."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import count
from pathlib import Path

from matplotlib.figure import Figure

from ...errors import InputError
from ...results.file.view import ResultView
from ..figures import draw
from ..figures.request import FIGURE_KINDS_BY_TASK, CycleShapeSolver
from .vector_picture import VectorPicture, vector_picture

ANIMATION_KIND = "animation"
"""Kind of figure that the page leaves out, because it is an animation."""
SVG_REQUEST_NAME = Path("figure.svg")
"""Output name with which figures for the page are requested; no file with this name is written."""


@dataclass(frozen=True, slots=True)
class CaptionedPicture:
    """A picture with its caption."""

    caption: str
    picture: VectorPicture


@dataclass(frozen=True, slots=True)
class Pictures:
    """Pictures of a result. shown: pictures in their order on the page. refusal: reason for which there is no
    picture; empty if there are pictures."""

    shown: tuple[CaptionedPicture, ...]
    refusal: str = ""


def pictures_of(
    views: Sequence[ResultView], shapes: CycleShapeSolver | None, numbers: "count[int]"
) -> Pictures:
    """Figures of every kind that show all `views`, the default figure of `rodsweep plot` first.

    shapes: function that computes the shapes of cycles for the default figure, if the file has no shapes.
    numbers: counter that numbers the pictures of the page.
    """
    # Remove the folders from the paths, so that no sentence on the page names a folder.
    views = [replace(view, path=Path(view.path.name)) for view in views]
    figure_kinds = [kind for kind in FIGURE_KINDS_BY_TASK.get(views[0].task, ()) if kind != ANIMATION_KIND]
    by_kind: dict[str, CaptionedPicture] = {}
    first_refusal_text = ""
    for kind in (None, *figure_kinds):
        figures: list[Figure] = []
        drawn_shapes = shapes if kind is None else None

        def keep(figure: Figure, figures: list[Figure] = figures) -> None:
            figures.append(figure)

        try:
            sentence = draw(views, SVG_REQUEST_NAME, what=kind, shapes=drawn_shapes, figure_callback=keep)
        except InputError as error:
            first_refusal_text = first_refusal_text or str(error)
            continue
        caption = sentence.removeprefix(f"wrote {SVG_REQUEST_NAME}: ")
        if caption not in by_kind:
            by_kind[caption] = CaptionedPicture(caption, vector_picture(figures[0], next(numbers), caption))
    return Pictures(tuple(by_kind.values()), "" if by_kind else first_refusal_text)
