"""The command `rodsweep`: entry point, exit statuses and error messages of the command line.

Commands: run, merge, snapshot, check, show, plot, report, portrait, explore, export, schema, arm,
bench.

Exit status: 0 if every point succeeded, 1 if the run is complete but some point failed, 2 for bad input, 3 if
software or resources are missing, 70 for a bug, 75 if a run was asked to stop and can be continued.
"""

import errno
import io
import os
import signal
import sys
import threading
import traceback
from contextlib import suppress
from typing import Any

# Ctrl-C while the modules below are loaded ends the program without the traceback of an import.
_is_quiet_if_interrupted = (
    signal.getsignal(signal.SIGINT) is signal.default_int_handler
    and threading.current_thread() is threading.main_thread()
)
if _is_quiet_if_interrupted:
    signal.signal(signal.SIGINT, signal.SIG_DFL)

# Each rank is one process on one core: threads inside its BLAS would compete with the other ranks.
# BLAS reads these variables when NumPy is imported.
for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

import click  # noqa: E402 - after the environment is set

from ..config.values import printable  # noqa: E402 - after the environment is set
from ..errors import BUG_EXIT_STATUS, UserError  # noqa: E402 - after the environment is set
from .command_line import commands  # noqa: E402 - after the environment is set
from .launchers import prints_messages  # noqa: E402 - after the environment is set
from .output_commands import explore, export, plot, portrait, report  # noqa: E402 - after the environment is set
from .usage_errors import usage_error_text  # noqa: E402 - after the environment is set

if _is_quiet_if_interrupted:
    signal.signal(signal.SIGINT, signal.default_int_handler)

__all__ = ["commands", "main"]

for _command in (explore, export, plot, portrait, report):
    commands.add_command(_command)

MAX_MESSAGE_LENGTH = 350
"""Maximum length of an error message, in characters; longer messages lose their middle."""


def _one_line(message: str) -> str:
    """The message on one line, shortened to about MAX_MESSAGE_LENGTH characters, because quoted values may be
    long."""
    line = printable(" ".join(message.split()))
    return line if len(line) <= MAX_MESSAGE_LENGTH else f"{line[: MAX_MESSAGE_LENGTH - 100]} ... {line[-90:]}"


def main() -> None:
    """Runs the command line; every error is reported as one sentence on standard error, a bug also with its
    traceback."""
    code = 0
    message = ""
    _prepare_streams()
    if not prints_messages() and "run" not in sys.argv[1:2]:
        sys.exit(0)  # under a launcher one rank prints or draws; the others have nothing to do
    try:
        commands.main(standalone_mode=False)
    except click.exceptions.Abort:
        code = 130
        message = "interrupted"
    except click.UsageError as error:
        code = 2
        message = usage_error_text(error)
    except click.ClickException as error:
        code = 3
        message = error.format_message()
    except UserError as error:
        code = error.exit_status
        message = str(error)
    except OSError as error:  # such as a name that is too long, or a directory without permission
        if error.filename is None and error.errno not in (errno.ENOSPC, errno.EIO):
            raise
        code = 2 if error.errno in (errno.ENAMETOOLONG, errno.ELOOP) else 3
        message = f"{error.filename or 'standard output'}: {error.strerror}"
    except MemoryError:
        code = 3
        message = (
            "the memory of this machine is not sufficient; use fewer points, or fewer ranks on this machine"
        )
    except Exception:
        traceback.print_exc()
        code = BUG_EXIT_STATUS
        message = "this is a bug; please report it with the lines above"
    if message and prints_messages():
        with suppress(OSError):  # standard error may also be on the full disk
            click.echo(f"rodsweep: {_one_line(message)}", err=True)
    _drop_unwritable_streams()
    sys.exit(code)


def _prepare_streams() -> None:
    """Prepares the standard streams. /dev/null replaces streams that were closed before the start, as by
    `>&-` in a shell. Otherwise the next opened file would get the file descriptor of a closed stream, and C
    libraries would write messages into this file."""
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, os.fdopen(os.open(os.devnull, os.O_RDWR), mode))
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # a file's name may be any bytes
            if stream is getattr(sys, f"__{name}__"):  # which stays open, as Python keeps it
                setattr(sys, name, _with_optional_reader(stream))
    if os.environ.get("COLUMNS") == "0":  # some launchers say so where there is no window
        del os.environ["COLUMNS"]


class _OptionalReaderFile(io.FileIO):
    """Standard stream that discards its output after the program that read it has ended, as `head` does; the
    command goes on, and its exit status states its own success."""

    def write(self, data: Any) -> int:
        try:
            return super().write(data)
        except BrokenPipeError:
            os.dup2(os.open(os.devnull, os.O_WRONLY), self.fileno())
            return len(data)


def _with_optional_reader(stream: io.TextIOWrapper) -> io.TextIOWrapper:
    """The standard stream `stream`, which discards its output after its reader has ended."""
    stream.flush()
    file = _OptionalReaderFile(stream.fileno(), "w", closefd=False)
    is_flushed = stream.line_buffering or stream.write_through
    return io.TextIOWrapper(io.BufferedWriter(file), stream.encoding, stream.errors, None, is_flushed)


def _drop_unwritable_streams() -> None:
    """Redirects standard streams that cannot be flushed to /dev/null; otherwise Python would exit with
    120."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except OSError:
            os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
