"""One run at a time on a result file: a lock that the system gives back when its holder dies."""

import fcntl
import os
import time
from contextlib import suppress
from pathlib import Path

from ...errors import InputError

LOCK_PATIENCE = 5.0
"""Seconds to wait for the lock: ranks whose launcher was killed live on for a moment."""


class Lock:
    """The lock on a result file, kept in its journal directory, which it makes and removes again."""

    def __init__(self, directory: Path, path: Path):
        """Takes the lock; InputError if another run keeps it."""
        self.directory = directory
        patience = time.monotonic() + LOCK_PATIENCE
        while True:
            try:
                directory.mkdir(exist_ok=True)
            except FileExistsError:
                if os.path.lexists(directory):
                    raise
                continue  # it was there, and a run that ended just now took it away
            try:
                self.handle = os.open(directory / "lock", os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o644)
            except FileNotFoundError:  # a run that ended just now took the directory away
                continue
            try:
                fcntl.flock(self.handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
                if os.fstat(self.handle).st_nlink:
                    return
            except BlockingIOError:
                os.close(self.handle)
                if time.monotonic() < patience:
                    time.sleep(0.1)
                    continue
                raise InputError(
                    f"{path} is being written by another run; wait for it, or choose another file with "
                    "-o (several ranks that each say this were started without MPI between them)"
                ) from None
            os.close(self.handle)  # the run that ended just now took this lock file away: take a new one

    def release(self) -> None:
        """Gives the lock back and removes the directory where nothing is left in it."""
        own = self.directory / "lock"
        with suppress(OSError):  # it was moved or deleted
            if os.path.samestat(os.stat(own), os.fstat(self.handle)):
                own.unlink()
        with suppress(OSError):  # it is not empty, or a link that the user has made
            self.directory.rmdir()
        os.close(self.handle)
