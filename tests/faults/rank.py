"""A run, or a rank as MPI's launcher starts it, that hands itself over to a child of the loaded process.

It gives its environment, directory, words and streams to the socket named first, and ends as the child does.
Others know this process alone: it passes signals on, and whoever kills it kills the child.
"""

import json
import os
import signal
import socket
import sys
from contextlib import suppress

RUN_ENDING_EXCEPTIONS = (signal.SIGINT, signal.SIGTERM, signal.SIGUSR1, signal.SIGUSR2, signal.SIGHUP)


def pass_on(child: int) -> None:
    """Gives signals to the child from now on; one that has just ended needs none."""

    def give(number: int, _: object) -> None:
        with suppress(ProcessLookupError):
            os.kill(child, number)

    for number in RUN_ENDING_EXCEPTIONS:
        signal.signal(number, give)


def main() -> None:
    place, *words = sys.argv[1:]
    with socket.socket(socket.AF_UNIX) as server:
        server.connect(place)
        request = {"environment": dict(os.environ), "directory": os.getcwd(), "words": words}
        socket.send_fds(server, [len(data := json.dumps(request).encode()).to_bytes(4, "big")], [0, 1, 2])
        server.sendall(data)
        pass_on(int.from_bytes(server.recv(4), "big"))
        ended = server.recv(4)
    status = int.from_bytes(ended, "big", signed=True) if ended else 1
    if status < 0:
        if -status in RUN_ENDING_EXCEPTIONS:
            signal.signal(-status, signal.SIG_DFL)
        os.kill(os.getpid(), -status)
    os._exit(status)


main()
