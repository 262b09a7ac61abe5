"""Atomic exchange of a result file, under a lock for a single run or merge at a time.

The new file is written beside the journals, and sealed and synced to disk before the rename.
"""

import os
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from ...errors import EnvironmentIncomplete
from ..run.journal import journal_directory
from ..run.lock import Lock
from .seal import seal

Identity = tuple[int, ...]
"""Numbers that change when a file is replaced or written to; empty without a file."""


def identity(path: Path) -> Identity:
    """Identity of the file at a path."""
    try:
        status = path.stat()
    except OSError:
        return ()
    return status.st_dev, status.st_ino, status.st_size, status.st_mtime_ns


@contextmanager
def disk_refusals(path: Path, kept: Callable[[], str] = str) -> Iterator[None]:
    """Turns errors of the disk (RuntimeError from HDF5) into EnvironmentIncomplete; kept: saved work."""
    try:
        yield
    except (OSError, RuntimeError) as error:
        reason = getattr(error, "strerror", None) or str(error).splitlines()[0]
        raise EnvironmentIncomplete(f"{path} cannot be written: {reason}{kept()}") from error


class Exchange:
    """Exclusive right to replace a result file, which need not exist yet."""

    def __init__(self, path: Path):
        """Takes the lock; raises InputError if the lock is taken."""
        self.path = path
        self.journals = journal_directory(path)
        self.copy = self.journals / "next.h5"
        path.parent.mkdir(parents=True, exist_ok=True)
        self.lock = Lock(self.journals, path)
        self.left: Identity = ()
        """Identity of the file at the last check or exchange."""

    @contextmanager
    def replacing(self, source: Path | None) -> Iterator[Path]:
        """Yields the path of a copy of `source`, or of no file, which replaces the file at the end."""
        self.journals.mkdir(
            parents=True, exist_ok=True
        )  # the directory may have been moved or deleted meanwhile
        self.copy.unlink(missing_ok=True)  # a link would redirect the writing
        if source:
            shutil.copyfile(source, self.copy)
        yield self.copy
        seal(self.copy)
        with self.copy.open("rb+") as file:
            os.fsync(file.fileno())
        os.replace(self.copy, self.path)
        self.left = identity(self.path)
        # Without syncing the directory a power failure could undo the rename.
        directory = os.open(self.path.parent, os.O_RDONLY)
        os.fsync(directory)
        os.close(directory)

    def close(self) -> None:
        """Releases the lock and removes the journal directory if it is empty."""
        with suppress(OSError):
            self.copy.unlink()
        self.lock.release()
