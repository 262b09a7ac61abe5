"""Checks of output names, and atomic writing of text files."""

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO

from ..errors import InputError


def require_output_path(output: Path, endings: Sequence[str], noun: str, inputs: Sequence[Path] = ()) -> None:
    """Raises InputError if `output` has a suffix not in `endings`, if its directory does not exist, or if
    `output` is a directory or one of the files `inputs`. noun: noun for the file, for the message.
    """
    if output.suffix not in endings:
        raise InputError(f"--output {output}: the name must end in {', '.join(endings)}")
    if not output.parent.is_dir():
        raise InputError(f"--output {output}: there is no directory {output.parent}")
    if output.exists() and not output.is_file():
        raise InputError(f"--output {output} is not a regular file; choose another name for the {noun}")
    if output.exists() and any(output.samefile(path) for path in inputs if path.exists()):
        raise InputError(f"--output {output} is an input file and would be overwritten; choose another name")


@contextmanager
def atomic_write(output: Path) -> Iterator[TextIO]:
    """Context manager that opens a text file with a temporary name and, at the end, renames the file to
    `output`.

    A killed process therefore leaves no incomplete file with the name `output`.
    """
    partial = output.with_name(f".{output.name}.partial")
    try:
        with partial.open("w", newline="", encoding="utf-8") as stream:
            yield stream
        os.replace(partial, output)
    finally:
        partial.unlink(missing_ok=True)
