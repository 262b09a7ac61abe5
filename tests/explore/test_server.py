"""The server of `rodsweep explore`: who may connect, what is refused, and that it ends cleanly."""

import asyncio
import os
import re
import signal
import socket
import subprocess
import sys
import time

import pytest
from surveyed import few
from tornado.httpclient import AsyncHTTPClient, HTTPClientError, HTTPRequest
from tornado.web import Application, RequestHandler
from tornado.websocket import websocket_connect

from rodsweep.explore.page_state import PageState
from rodsweep.explore.server import LISTEN_ADDRESS, ExploreServer, TcpNoDelayServer

LONGEST = 60
"""Seconds that a loaded machine may need to start or to end the server."""


async def connected(server: ExploreServer, origin: str) -> str:
    """Opens the websocket of a page from an origin; the first message of the server."""
    page = (await AsyncHTTPClient().fetch(server.url)).body.decode()
    token = re.search(r'"token":"([^"]+)"', page)[1]
    request = HTTPRequest(
        f"ws://{LISTEN_ADDRESS}:{server.port}/ws",
        headers={"Origin": origin, "Sec-WebSocket-Protocol": f"bokeh, {token}"},
    )
    connection = await websocket_connect(request, subprotocols=["bokeh", token])
    message = await connection.read_message()
    connection.close()
    return str(message)


async def status_of_page(server: ExploreServer, host: str) -> int:
    """Status of the answer to a request for the page under a host name."""
    response = await AsyncHTTPClient().fetch(server.url, headers={"Host": host}, raise_error=False)
    return response.code


OWN = ("http://127.0.0.1:{port}", "http://localhost:{port}")
FOREIGN = ("http://evil.example", "http://127.0.0.1:1", "http://evil.example:{port}")
"""Origins, with {port} for the port of the server."""
FOREIGN_HOSTS = ("evil.example", "evil.example:{port}", "localhost.evil.example:{port}", "127.0.0.1:1")
"""Host headers, with {port} for the port of the server."""


@pytest.fixture(scope="module")
def answers() -> dict[str, str | int]:
    """What one server answers to each origin: its first message, or the status of a refusal."""

    async def run() -> dict[str, str | int]:
        server = ExploreServer(PageState(rod=PageState().rod | {"F": ""}))  # nothing is solved
        server.server.start()
        found: dict[str, str | int] = {}
        try:
            for origin in (*OWN, *FOREIGN):
                try:
                    found[origin] = await connected(server, origin.format(port=server.port))
                except HTTPClientError as refusal:
                    found[origin] = refusal.code
            for host in (*OWN, *FOREIGN_HOSTS):
                name = host.format(port=server.port).removeprefix("http://")
                found[f"page at {host}"] = await status_of_page(server, name)
        finally:
            server.stop()
        return found

    return asyncio.run(run())


@pytest.mark.long
@pytest.mark.parametrize("origin", OWN)
def test_the_page_itself_may_connect(answers, origin):
    assert "ACK" in answers[origin]


@pytest.mark.parametrize("origin", FOREIGN)
def test_a_foreign_origin_is_forbidden(answers, origin):
    assert answers[origin] == 403


@pytest.mark.parametrize("host", FOREIGN_HOSTS)
def test_the_page_under_a_foreign_host_name_is_forbidden(answers, host):
    assert answers[f"page at {host}"] == 403


def test_the_page_is_shown_under_each_own_host_name(answers):
    assert [answers[f"page at {origin}"] for origin in OWN] == [200, 200]


def test_no_other_machine_reaches_the_server():
    async def addresses() -> list[str]:
        server = ExploreServer(PageState())
        try:
            return [each.getsockname()[0] for each in server.http._sockets.values()]
        finally:
            server.stop()

    assert asyncio.run(addresses()) == ["127.0.0.1"]


def test_small_changes_are_sent_at_once():
    seen: list[int] = []

    class Seen(RequestHandler):
        def get(self) -> None:
            stream = self.request.connection.stream
            seen.append(stream.socket.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY))

    async def run() -> None:
        server = TcpNoDelayServer(Application([("/", Seen)]))
        server.listen(0, LISTEN_ADDRESS)
        (listening,) = server._sockets.values()
        await AsyncHTTPClient().fetch(f"http://{LISTEN_ADDRESS}:{listening.getsockname()[1]}/")
        server.stop()

    asyncio.run(run())
    assert seen[0] != 0


def started(*words: str) -> tuple[subprocess.Popen, str]:
    """The command in a process of its own, and the address that it prints."""
    argv = [sys.executable, "-m", "rodsweep", "explore", *words]
    process = subprocess.Popen(argv, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert process.stdout is not None
    line = process.stdout.readline()
    return process, re.match(r"(http://127\.0\.0\.1:\d+/) ", line)[1]


def descendants(pid: int) -> list[int]:
    """Processes started by a process, and by these."""
    with open(f"/proc/{pid}/task/{pid}/children") as listed:
        children = list(map(int, listed.read().split()))
    return [*children, *(each for child in children for each in descendants(child))]


@pytest.mark.long
@pytest.mark.parametrize("number", few([signal.SIGINT, signal.SIGTERM], 1))
def test_ctrl_c_ends_the_server_with_all_its_processes(number):
    process, _ = started()
    end = time.monotonic() + LONGEST
    while len(solvers := descendants(process.pid)) < 5:  # solvers, what they are copies of, a tracker
        assert time.monotonic() < end
        time.sleep(0.05)
    process.send_signal(number)
    output, errors = process.communicate(timeout=LONGEST)
    assert (process.returncode, output, errors) == (0, "", "")
    end = time.monotonic() + LONGEST
    while any(os.path.exists(f"/proc/{pid}") for pid in solvers):
        assert time.monotonic() < end
        time.sleep(0.05)


@pytest.mark.long
def test_a_port_in_use_is_refused(command):
    with socket.socket() as other:
        other.bind((LISTEN_ADDRESS, 0))
        other.listen()
        port = other.getsockname()[1]
        done = command.afresh("explore", "--port", port)
    assert done.returncode == 2
    assert done.stderr.startswith(f"rodsweep: --port {port}: ")
    assert len(done.stderr.splitlines()) == 1


def test_without_bokeh_the_extra_is_named():
    lines = ("import sys", "sys.modules['bokeh'] = None", "sys.argv = ['rodsweep', 'explore']")
    argv = [sys.executable, "-c", "; ".join((*lines, "import rodsweep.__main__"))]
    done = subprocess.run(argv, capture_output=True, text=True, timeout=LONGEST, check=False)
    assert (done.returncode, done.stdout) == (2, "")
    assert "rodsweep[explore]" in done.stderr
    assert len(done.stderr.splitlines()) == 1


@pytest.mark.long
@pytest.mark.parametrize(
    ("name", "text"),
    few(
        [
            ("absent.h5", None),
            ("typo.yaml", "task: spectrum\nparameters: {F: 3, k1: 1e4, k2: 1e4, gama3: 0}"),
            ("absent.yaml", None),
            ("text.h5", "no result"),
            ("list.yaml", "- 1"),
        ],
        2,
    ),
)
def test_what_is_neither_result_nor_config_is_refused(command, name, text):
    if text is not None:
        command.write(name, text)
    done = command("explore", name)
    assert done.returncode == 2
    assert name in done.stderr
    assert len(done.stderr.splitlines()) == 1
