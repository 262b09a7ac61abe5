"""A result file exchanged for another in one instant, sealed and on the disk proper before anyone sees it."""

import os
from pathlib import Path

from .seal import seal


def replace_whole(copy: Path, path: Path) -> None:
    """Puts `copy`, a closed result file on the same disk, in the place of `path`."""
    seal(copy)
    with copy.open("rb+") as file:
        os.fsync(file.fileno())
    os.replace(copy, path)
    directory = os.open(path.parent, os.O_RDONLY)
    os.fsync(directory)
    os.close(directory)
