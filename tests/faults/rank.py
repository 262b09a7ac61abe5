"""A rank as MPI's launcher starts it, which hands itself over to a child of the loaded process.

It gives its environment, directory, words and streams to the socket named first, and ends as the child does.
The launcher knows this process alone: whoever kills it kills the child.
"""

import json
import os
import socket
import sys


def main() -> None:
    place, *words = sys.argv[1:]
    with socket.socket(socket.AF_UNIX) as server:
        server.connect(place)
        request = {"environment": dict(os.environ), "directory": os.getcwd(), "words": words}
        socket.send_fds(server, [len(data := json.dumps(request).encode()).to_bytes(4, "big")], [0, 1, 2])
        server.sendall(data)
        ended = server.recv(4)
    status = int.from_bytes(ended, "big", signed=True) if ended else 1
    if status < 0:
        os.kill(os.getpid(), -status)
    os._exit(status)


main()
