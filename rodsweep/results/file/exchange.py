"""A result file exchanged for another in one instant, under the lock of one run or merge at a time.

The new file is made beside the journals, is sealed and on the disk proper before it takes the name.
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
"""What changes where a file is exchanged for another of its name, or written to; empty without a file."""


def identity(path: Path) -> Identity:
    """The identity of the file that has a name."""
    try:
        status = path.stat()
    except OSError:
        return ()
    return status.st_dev, status.st_ino, status.st_size, status.st_mtime_ns


@contextmanager
def disk_refusals(path: Path, kept: Callable[[], str] = str) -> Iterator[None]:
    """Raises EnvironmentIncomplete for an error of the disk (HDF5: RuntimeError); `kept` says what is not
    lost.
    """
    try:
        yield
    except (OSError, RuntimeError) as error:
        reason = getattr(error, "strerror", None) or str(error).splitlines()[0]
        raise EnvironmentIncomplete(f"{path} cannot be written: {reason}{kept()}") from error


class Exchange:
    """The right to replace a result file, which need not exist yet, until it is closed."""

    def __init__(self, path: Path):
        """Takes the lock; InputError if another run keeps it."""
        self.path, self.journals = path, journal_directory(path)
        self.copy = self.journals / "next.h5"
        path.parent.mkdir(parents=True, exist_ok=True)
        self.lock = Lock(self.journals, path)
        self.left: Identity = ()
        """The file as it was last checked or written here."""

    @contextmanager
    def replacing(self, source: Path | None) -> Iterator[Path]:
        """The path of a copy of `source`, or of nothing, which becomes the file at the end."""
        self.journals.mkdir(parents=True, exist_ok=True)  # it may have been moved or deleted meanwhile
        self.copy.unlink(missing_ok=True)  # it may be a link
        if source:
            shutil.copyfile(source, self.copy)
        yield self.copy
        seal(self.copy)
        with self.copy.open("rb+") as file:
            os.fsync(file.fileno())
        os.replace(self.copy, self.path)
        self.left = identity(self.path)
        directory = os.open(self.path.parent, os.O_RDONLY)
        os.fsync(directory)
        os.close(directory)

    def close(self) -> None:
        """Gives the lock back and removes the journal directory where nothing is left in it."""
        with suppress(OSError):
            self.copy.unlink()
        self.lock.release()
