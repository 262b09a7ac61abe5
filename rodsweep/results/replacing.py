"""A file exchanged for another in one instant, on the disk proper before anyone sees it."""

import os
from pathlib import Path


def replace_whole(copy: Path, path: Path) -> None:
    """Puts `copy`, which is closed and on the same disk, in the place of `path`."""
    with copy.open("rb+") as file:
        os.fsync(file.fileno())
    os.replace(copy, path)
    directory = os.open(path.parent, os.O_RDONLY)
    os.fsync(directory)
    os.close(directory)
