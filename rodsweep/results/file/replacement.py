"""Atomic replacement of a result file, under a lock that only one run or merge can take at a time.

The new file is written into the journal directory, and is sealed and synced to disk before it is renamed.
"""

import fcntl
import os
import shutil
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from ...errors import EnvironmentIncomplete, InputError
from ..run.journal import journal_directory
from .seal import seal

LOCK_TIMEOUT = 5.0
"""Seconds to wait for the lock before InputError is raised; ranks end a moment later than a killed
launcher."""
FileIdentity = tuple[int, ...]
"""(device, inode, size, time of change): changes when a file is replaced or written; empty if there is no
file."""


def file_identity(path: Path) -> FileIdentity:
    """Identity of the file at `path`, read from the disk; () if there is no file, or if the status of the
    file cannot be read."""
    try:
        status = path.stat()
    except OSError:
        return ()
    return status.st_dev, status.st_ino, status.st_size, status.st_mtime_ns


@contextmanager
def disk_errors_as_refusals(path: Path, kept_clause: Callable[[], str] = str) -> Iterator[None]:
    """Context that turns disk errors (OSError, or RuntimeError from HDF5) into EnvironmentIncomplete. path:
    the file that is written. kept_clause: function that returns a clause, for the message, on the data that
    are saved.
    """
    try:
        yield
    except (OSError, RuntimeError) as error:
        reason = getattr(error, "strerror", None) or str(error).splitlines()[0]
        if isinstance(error, FileExistsError):  # of the directory of the points
            reason = f"{error.filename} is not a directory; move it away"
        raise EnvironmentIncomplete(f"{path} cannot be written: {reason}{kept_clause()}") from error


class FileReplacement:
    """Exclusive right to replace the result file at `path`, which need not exist yet."""

    def __init__(self, path: Path):
        """Takes the lock; raises InputError if the lock is taken."""
        self.path = path
        self.journal_directory = journal_directory(path)
        self.copy_path = self.journal_directory / "next.h5"
        path.parent.mkdir(parents=True, exist_ok=True)
        self.lock = ResultFileLock(self.journal_directory, path)
        self.last_identity: FileIdentity = ()
        """Identity of the file at the last check or replacement."""

    @contextmanager
    def writing_new_file(self, source: Path | None) -> Iterator[Path]:
        """Context for writing a new result file; at its end the new file is sealed and replaces the old file.

        Yields the path of the new file: a copy of `source`, or a file yet to be created if `source` is None.
        """
        # The directory may have been moved or deleted meanwhile.
        self.journal_directory.mkdir(parents=True, exist_ok=True)
        self.copy_path.unlink(missing_ok=True)  # a link would redirect the writing
        if source:
            shutil.copyfile(source, self.copy_path)
        yield self.copy_path
        seal(self.copy_path)
        # Content must be on disk before the new name: a power failure could otherwise leave an empty file.
        with self.copy_path.open("rb+") as file:
            os.fsync(file.fileno())
        os.replace(self.copy_path, self.path)
        self.last_identity = file_identity(self.path)
        # Without syncing the directory a power failure could undo the rename.
        directory = os.open(self.path.parent, os.O_RDONLY)
        os.fsync(directory)
        os.close(directory)

    def close(self) -> None:
        """Deletes an unfinished new file, releases the lock, and removes the journal directory if it is
        empty."""
        with suppress(OSError):
            self.copy_path.unlink()
        self.lock.release()


class ResultFileLock:
    """Lock on a result file: a file in the journal directory. The lock creates and removes this directory."""

    def __init__(self, directory: Path, path: Path):
        """Takes the lock on the file `path`; raises InputError if another run has the lock. directory:
        journal directory of the file."""
        self.directory = directory
        patience = time.monotonic() + LOCK_TIMEOUT
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
                # A lock on a file that was removed meanwhile protects nothing.
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
        lock_path = self.directory / "lock"
        with suppress(OSError):  # the lock file was moved or deleted
            # Only this lock's own file is removed, not one that another run has made since.
            if os.path.samestat(os.stat(lock_path), os.fstat(self.handle)):
                lock_path.unlink()
        with suppress(OSError):  # the directory is not empty, or is a link made by the user
            self.directory.rmdir()
        os.close(self.handle)
