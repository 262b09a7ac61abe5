"""Atomic writing of text files."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO


@contextmanager
def written_whole(output: Path) -> Iterator[TextIO]:
    """Opens a text file for writing under a temporary name, and renames the complete file to `output`.

    A killed process therefore leaves no partial file named `output`.
    """
    partial = output.with_name(f".{output.name}.partial")
    try:
        with partial.open("w", newline="", encoding="utf-8") as stream:
            yield stream
        os.replace(partial, output)
    finally:
        partial.unlink(missing_ok=True)
