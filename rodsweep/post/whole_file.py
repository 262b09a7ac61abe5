"""Names of written files, and atomic writing of text files."""

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO

from ..errors import InputError


def require_name(output: Path, endings: Sequence[str], noun: str, inputs: Sequence[Path] = ()) -> None:
    """Raises InputError unless the file, a `noun`, can be written under this name; inputs: files to keep."""
    if output.suffix not in endings:
        raise InputError(f"--output {output}: the name must end in {', '.join(endings)}")
    if not output.parent.is_dir():
        raise InputError(f"--output {output}: there is no directory {output.parent}")
    if output.exists() and not output.is_file():
        raise InputError(f"--output {output} is not a name for a {noun}; choose another")
    if output.exists() and any(output.samefile(path) for path in inputs if path.exists()):
        raise InputError(f"--output {output} is a file to report and would be overwritten; choose another")


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
