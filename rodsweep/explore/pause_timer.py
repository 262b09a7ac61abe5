"""Timer that runs a callback once the user has paused: the controls have not changed for some time."""

from collections.abc import Callable

from bokeh.document import Document

PAUSE_MILLISECONDS = 900
"""Questions that take seconds are sent when the controls have not changed for this time, in milliseconds."""


class PauseTimer:
    """Runs `callback` on the event loop of a document, PAUSE_MILLISECONDS after the last `restart`."""

    def __init__(self, document: Document, callback: Callable[[], None]):
        self.document = document
        self.callback = callback
        self._scheduled: Callable[[], None] | None = None

    def restart(self) -> None:
        """Starts the waiting time, again if it has not ended."""
        self.cancel()
        self._scheduled = self.document.add_timeout_callback(self._run, PAUSE_MILLISECONDS)

    def cancel(self) -> None:
        """Ends the waiting time without the callback."""
        if self._scheduled is not None:
            self.document.remove_timeout_callback(self._scheduled)
            self._scheduled = None

    def _run(self) -> None:
        self._scheduled = None
        self.callback()
