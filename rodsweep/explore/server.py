"""Web server of the page, which only browsers on the same machine can reach."""

import asyncio
import logging
import signal
import socket
import sys
from collections.abc import Awaitable
from http import HTTPStatus
from typing import Any

from bokeh.application import Application
from bokeh.application.handlers import FunctionHandler
from bokeh.document import Document
from bokeh.document.events import DocumentPatchedEvent
from bokeh.server.connection import ServerConnection
from bokeh.server.server import BaseServer
from bokeh.server.tornado import BokehTornado
from bokeh.server.util import check_allowlist
from tornado.httpserver import HTTPServer
from tornado.httputil import HTTPMessageDelegate, HTTPServerRequest
from tornado.ioloop import IOLoop
from tornado.iostream import IOStream
from tornado.netutil import bind_sockets
from tornado.web import ErrorHandler

from ..errors import InputError
from .answers_from_file import AnswersFromFile
from .page import Page
from .page_state import PageState
from .solving.solver_processes import SolverProcesses

LISTEN_ADDRESS = "127.0.0.1"
"""IP address on which the server listens."""
ALLOWED_HOSTS = (LISTEN_ADDRESS, "localhost")
"""Host names under which a browser on this machine may open the page."""
UNUSED_SESSION_MILLISECONDS = 5000
"""Time, in milliseconds, after which the session of a closed page ends; until then a page whose connection
was lost may connect again."""
SESSION_CHECK_MILLISECONDS = 1000
"""Time, in milliseconds, between two searches for sessions of closed pages. The end of such a session also
ends the solves of the closed page, for which the next page may have to wait."""


class TcpNoDelayServer(HTTPServer):
    """HTTP server without Nagle's algorithm, so that small messages are sent at once."""

    def handle_stream(self, stream: IOStream, address: Any) -> None:
        """Accepts a new connection and switches off the delay of small messages (TCP_NODELAY)."""
        stream.set_nodelay(True)
        super().handle_stream(stream, address)


class BatchConnection(ServerConnection):
    """Connection to a page. All changes by one callback are sent in a single message; Bokeh itself sends one
    message per change."""

    def __init__(self, *arguments: Any):
        super().__init__(*arguments)
        self._changes: list[DocumentPatchedEvent] = []

    def send_patch_document(self, event: DocumentPatchedEvent) -> Awaitable[None]:
        """Queues a change of the document and returns a coroutine that sends the queue. Bokeh awaits the
        coroutines of all changes after the callback; the first coroutine sends all changes."""
        self._changes.append(event)
        return self._send_all()

    async def _send_all(self) -> None:
        changes, self._changes = self._changes, []
        if changes:
            await self._socket.send_message(self.protocol.create("PATCH-DOC", changes))


class BatchTornado(BokehTornado):
    """Bokeh's web application, with a `BatchConnection` for each page. It answers only requests to its own
    hosts, which are also the only origins of websockets. A page of another site whose name was bound to this
    machine (DNS rebinding) is refused."""

    def find_handler(self, request: HTTPServerRequest, **options: Any) -> HTTPMessageDelegate:
        """Returns the handler of a request; for a request to another host, a handler that answers with status
        403."""
        if check_allowlist(request.host.lower(), self.websocket_origins):
            return super().find_handler(request, **options)
        return self.get_handler_delegate(request, ErrorHandler, {"status_code": HTTPStatus.FORBIDDEN})

    def new_connection(self, *arguments: Any) -> ServerConnection:
        """Creates and returns the connection for a page that a browser opens."""
        connection = BatchConnection(*arguments)
        self._clients.add(connection)
        return connection


class ExploreServer:
    """Web server of the page, with the solver processes.

    state: state with which a page opens. stored: answers from a result file, or None. port: TCP port; 0 for
    any free port. Raises InputError if the port is in use.
    """

    def __init__(self, state: PageState, stored: AnswersFromFile | None = None, port: int = 0):
        self.state = state
        self.stored = stored
        sockets = _bound_sockets(port)
        self.port: int = sockets[0].getsockname()[1]
        self.solvers = SolverProcesses()
        application = Application(FunctionHandler(self._open))
        tornado = BatchTornado(
            {"/": application},
            extra_websocket_origins=[f"{host}:{self.port}" for host in ALLOWED_HOSTS],
            unused_session_lifetime_milliseconds=UNUSED_SESSION_MILLISECONDS,
            check_unused_sessions_milliseconds=SESSION_CHECK_MILLISECONDS,
        )
        self.http = TcpNoDelayServer(tornado)
        self.http.add_sockets(sockets)
        self.server = BaseServer(IOLoop.current(), tornado, self.http)

    @property
    def url(self) -> str:
        """Address of the page, for a browser."""
        return f"http://{LISTEN_ADDRESS}:{self.port}/"

    def start(self) -> None:
        """Starts the server and the solver processes. The server answers browsers once the event loop
        runs."""
        # A browser that leaves a page while an answer is being sent is no reason for a warning.
        logging.getLogger("bokeh.server.views.ws").setLevel(logging.ERROR)
        self.server.start()
        self.solvers.warm_up()

    def stop(self) -> None:
        """Ends all sessions and all solver processes."""
        self.solvers.close()
        self.server.stop()
        self.http.stop()

    def _open(self, bokeh_document: Document) -> None:
        page = Page(bokeh_document, self.solvers, self.state, self.stored)
        bokeh_document.on_session_destroyed(lambda context: page.close())
        context = bokeh_document.session_context
        arguments = {} if context is None else context.request.arguments
        page.show_address(_page_query_string(arguments))


def _page_query_string(arguments: dict[str, list[bytes]]) -> str:
    """Query string of the page's address, without Bokeh's own arguments."""
    from urllib.parse import urlencode

    values_by_name = {name: values[-1].decode(errors="replace") for name, values in arguments.items()}
    return urlencode({name: text for name, text in values_by_name.items() if not name.startswith("bokeh-")})


def _bound_sockets(port: int) -> list[socket.socket]:
    try:
        return bind_sockets(port, LISTEN_ADDRESS)
    except OSError as error:
        raise InputError(f"--port {port}: {error.strerror}; without --port any free port is taken") from None


async def serve(state: PageState, stored: AnswersFromFile | None, port: int, is_opened: bool) -> None:
    """Serves the page until SIGINT (Ctrl-C) or SIGTERM. state: state with which a page opens. stored: answers
    from a result file, or None. port: TCP port; 0 for any free port. is_opened: whether to open a browser; if
    none can be opened, a line on standard error says so."""
    stopped = asyncio.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        asyncio.get_running_loop().add_signal_handler(number, stopped.set)
    server = ExploreServer(state, stored, port)
    print(f"{server.url} shows the page; Ctrl-C stops the server", flush=True)
    server.start()
    if is_opened:
        import webbrowser

        if not webbrowser.open(server.url):
            print("no browser can be opened here; open the address yourself", file=sys.stderr, flush=True)
    await stopped.wait()
    server.stop()
