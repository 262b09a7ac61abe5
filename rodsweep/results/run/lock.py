"""Lock of a result file for a single run at a time; the system releases the lock of a dead process."""

import fcntl
import os
import time
from contextlib import suppress
from pathlib import Path

from ...errors import InputError

LOCK_PATIENCE = 5.0
"""Seconds to wait for the lock. Ranks of a launcher that was killed live on for a moment."""


class Lock:
    """Lock on a result file, in the journal directory, which the lock creates and removes."""

    def __init__(self, directory: Path, path: Path):
        """Takes the lock; raises InputError if the lock is taken."""
        self.directory = directory
        patience = time.monotonic() + LOCK_PATIENCE
        while True:
            try:
                directory.mkdir(exist_ok=True)
            except FileExistsError:
                if os.path.lexists(directory):
                    raise
                continue  # a run that ended just now has removed the directory
            try:
                self.handle = os.open(directory / "lock", os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o644)
            except FileNotFoundError:  # a run that ended just now has removed the directory
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
                    f"{path} is being written by another run; wait for its end, or choose another file with "
                    "-o (if several ranks print this message, they were started without MPI)"
                ) from None
            os.close(self.handle)  # the run that ended just now has removed this lock file: take a new one

    def release(self) -> None:
        """Releases the lock and removes the directory if it is empty."""
        own = self.directory / "lock"
        with suppress(OSError):  # the lock file was moved or deleted
            if os.path.samestat(os.stat(own), os.fstat(self.handle)):
                own.unlink()
        with suppress(OSError):  # the directory is not empty, or is a link made by the user
            self.directory.rmdir()
        os.close(self.handle)
