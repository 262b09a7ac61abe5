"""`rodsweep explore`: a local web page for exploring a rod or an arm interactively.

Texts from the controls, or from the page's address, form a `PageState`. The page checks the state and sends
requests, such as "spectrum", to solver processes, which call `rodsweep.api`; their answers fill the
pictures. The page itself solves nothing. Only this package imports bokeh and tornado.
"""

import asyncio
from pathlib import Path

from ..errors import InputError
from .solving.fork_server import start_fork_server


def serve_page(source: Path | None, port: int, is_opened: bool) -> None:
    """Serves the page until the user presses Ctrl-C.

    source: result file or config whose rod or arm is shown first; None for a default rod. port: TCP port; 0
    for any free port. is_opened: whether to open a browser. Raises InputError if bokeh is missing, the file
    is invalid, or the port is in use.
    """
    try:
        import bokeh  # noqa: F401 - only to check that bokeh is installed
    except ImportError:
        raise InputError(
            "the page needs bokeh, which is not installed; pip install 'rodsweep[explore]' installs it"
        ) from None
    start_fork_server()
    from .page_state import PageState
    from .page_state_from_file import state_and_answers_from_file
    from .server import serve

    state, stored = (PageState(), None) if source is None else state_and_answers_from_file(source)
    asyncio.run(serve(state, stored, port, is_opened))
