"""Figures on the HTML page of a result: all figures of `rodsweep plot` that the result file allows."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import count
from pathlib import Path

from matplotlib.figure import Figure

from ...errors import InputError
from ...results.file.view import View
from ..figures import draw
from ..figures.request import KINDS_OF_TASK, Shapes
from .vector_picture import VectorPicture, vector_picture

ANIMATION_KIND = "animation"
"""Kind of figure that is an animation, which a page cannot show as one picture."""
SVG_REQUEST_NAME = Path("figure.svg")
"""Output name that requests a figure in SVG for the page; no file of this name is written."""


@dataclass(frozen=True, slots=True)
class CaptionedPicture:
    """A picture with its caption."""

    caption: str
    picture: VectorPicture


@dataclass(frozen=True, slots=True)
class Pictures:
    """Pictures of a result. refusal: reason why there are none; empty if there are some."""

    shown: tuple[CaptionedPicture, ...]
    refusal: str = ""


def pictures_of(views: Sequence[View], shapes: Shapes | None, numbers: "count[int]") -> Pictures:
    """Every kind of figure of the results, with the default figure of `rodsweep plot` first.

    shapes: function that solves cycles without stored shapes, for the first figure. numbers: counter that
    numbers the pictures of the page.
    """
    # Without its folders, so that no sentence on the page names them.
    views = [replace(view, path=Path(view.path.name)) for view in views]
    kinds = [kind for kind in KINDS_OF_TASK.get(views[0].task, ()) if kind != ANIMATION_KIND]
    found: dict[str, CaptionedPicture] = {}
    refusal = ""
    for kind in (None, *kinds):
        kept: list[Figure] = []
        wanted = shapes if kind is None else None

        def keep(figure: Figure, kept: list[Figure] = kept) -> None:
            kept.append(figure)

        try:
            sentence = draw(views, SVG_REQUEST_NAME, what=kind, shapes=wanted, keep=keep)
        except InputError as error:
            refusal = refusal or str(error)
            continue
        caption = sentence.removeprefix(f"wrote {SVG_REQUEST_NAME}: ")
        if caption not in found:
            found[caption] = CaptionedPicture(caption, vector_picture(kept[0], next(numbers), caption))
    return Pictures(tuple(found.values()), "" if found else refusal)
