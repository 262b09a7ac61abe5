"""Progress display of a long solve in Python: a bar in a terminal or in a notebook."""

import sys

from ...errors import InputError
from ...sweep.listener import NoClaims, RankListener
from ...sweep.progress import ProgressReporter, Silent, in_notebook
from ...sweep.stop import StopRequest

Display = ProgressReporter | Silent


def display(progress: bool | None, total: int | None, title: str) -> Display:
    """Progress display for `total` points, which appears after a second.

    progress: True or False; None displays only in a terminal or a notebook. InputError for any other type.
    """
    if not (progress is None or isinstance(progress, bool)):
        raise InputError(f"progress = {progress!r} is not allowed; it should be True, False or None")
    shown = sys.stderr.isatty() or in_notebook() if progress is None else progress
    return ProgressReporter(total, title, live=True) if shown else Silent()


def listener(shown: Display, name: str) -> RankListener:
    """Listener that displays the position of the solve `name`. No solve is stopped: Ctrl-C raises
    KeyboardInterrupt.
    """
    return RankListener(
        NoClaims(lambda place: shown.place(place.words, place.share or 0.0)), StopRequest(), lambda: name
    )
