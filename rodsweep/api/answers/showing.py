"""What Python shows of a solve that takes its time: a bar where a terminal or a notebook is."""

import sys

from ...errors import InputError
from ...sweep.listener import NoClaims, RankListener
from ...sweep.progress import ProgressReporter, Silent, in_notebook
from ...sweep.stop import StopRequest

Display = ProgressReporter | Silent


def display(progress: bool | None, total: int | None, title: str) -> Display:
    """The display of so many points; it appears after a second.

    progress: whether there is one; None means where a terminal or a notebook is. InputError for others.
    """
    if not (progress is None or isinstance(progress, bool)):
        raise InputError(f"progress = {progress!r} is not allowed; it should be True, False or None")
    shown = sys.stderr.isatty() or in_notebook() if progress is None else progress
    return ProgressReporter(total, title, live=True) if shown else Silent()


def listener(shown: Display, name: str) -> RankListener:
    """What shows where a solve of a name is. It stops nothing: Ctrl-C is an exception of Python's."""
    return RankListener(
        NoClaims(lambda place: shown.place(place.words, place.share or 0.0)), StopRequest(), lambda: name
    )
