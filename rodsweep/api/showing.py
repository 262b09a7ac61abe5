"""What Python shows of a solve that takes its time: a bar where a terminal or a notebook is."""

import sys

from ..errors import InputError
from ..sweep.listener import RankListener
from ..sweep.progress import Silent, Teller, in_notebook
from ..sweep.stop import StopRequest
from ..watch import Whereabouts

Display = Teller | Silent


def display(progress: bool | None, total: int | None, title: str, noun: str = "points") -> Display:
    """The display of so many points; it appears after a second.

    progress: whether there is one; None means where a terminal or a notebook is. InputError for others.
    """
    if not (progress is None or isinstance(progress, bool)):
        raise InputError(f"progress = {progress!r} is not allowed; it should be True, False or None")
    shown = sys.stderr.isatty() or in_notebook() if progress is None else progress
    return Teller(total, title, noun, live=True) if shown else Silent()


class _Here:
    """The only rank, with a display."""

    def __init__(self, shown: Display):
        self.shown = shown

    def between_points(self) -> None: ...

    def tell_place(self, place: Whereabouts) -> None:
        self.shown.place(place.words, place.share or 0.0)


def listener(shown: Display, name: str) -> RankListener:
    """What shows where a solve of a name is. It stops nothing: Ctrl-C is an exception of Python's."""
    return RankListener(_Here(shown), StopRequest(), lambda: name)
