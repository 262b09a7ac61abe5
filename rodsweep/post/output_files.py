"""Checks of output names, and atomic writing of text files and figures."""

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

from ..errors import EnvironmentIncomplete, InputError

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def require_output_path(output: Path, endings: Sequence[str], noun: str, inputs: Sequence[Path] = ()) -> None:
    """Raises InputError if `output` has a suffix not in `endings`, if its directory does not exist, or if
    `output` exists but is no regular file, or is one of the files `inputs`; EnvironmentIncomplete if its
    directory is not writable. noun: noun for the file, for the message."""
    if output.suffix not in endings:
        raise InputError(f"--output {output}: the name must end in {', '.join(endings)}")
    if not output.parent.is_dir():
        raise InputError(f"--output {output}: there is no directory {output.parent}")
    if output.exists() and not output.is_file():
        raise InputError(f"--output {output} is not a regular file; choose another name for the {noun}")
    if output.exists() and any(output.samefile(path) for path in inputs if path.exists()):
        raise InputError(f"--output {output} is an input file and would be overwritten; choose another name")
    if not os.access(output.parent, os.W_OK | os.X_OK):
        raise EnvironmentIncomplete(f"{output} cannot be written: its directory is not writable")


@contextmanager
def temporary_output_path(output: Path) -> Iterator[Path]:
    """Context manager that yields a temporary path beside `output`, with the same suffix. At the end the file
    written at the temporary path is renamed to `output`.

    An error or a killed process therefore leaves no incomplete file with the name `output`. Raises
    EnvironmentIncomplete if the disk refuses, as when it is full.
    """
    partial = output.with_name(f".{output.stem}.partial{output.suffix}")
    try:
        yield partial
        os.replace(partial, output)
    except OSError as error:
        if error.errno is None:  # raised by HDF5, about the file that is read
            raise
        raise EnvironmentIncomplete(f"{output} cannot be written: {error.strerror}") from error
    finally:
        with suppress(OSError):
            partial.unlink(missing_ok=True)


@contextmanager
def atomic_write(output: Path) -> Iterator[TextIO]:
    """Context manager that opens a text file for writing; at the end the file gets the name `output`, see
    `temporary_output_path`."""
    with temporary_output_path(output) as partial, partial.open("w", newline="", encoding="utf-8") as stream:
        yield stream


def save_figure(figure: "Figure", output: Path) -> None:
    """Writes a figure in the format that the suffix of `output` names; see `temporary_output_path`.

    The figure is drawn in memory first: on a full disk, matplotlib's own writer of PDF ends with an error of
    its compression instead of an OSError.
    """
    image = BytesIO()
    figure.savefig(image, format=output.suffix.removeprefix("."))
    with temporary_output_path(output) as partial:
        partial.write_bytes(image.getvalue())
