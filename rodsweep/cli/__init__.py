"""The command `rodsweep`: run, merge, snapshot, check, show, plot, export, schema, arm, bench.

It joins the packages.

Exit status: 0 when every point succeeded, 1 when the run is whole but some point did not, 2 for bad
input, 3 when the machine lacks something, 70 for a bug, 75 when a run was asked to stop and wants to be
continued.
"""

import errno
import io
import os
import sys
import traceback
from contextlib import suppress

# Each rank is one process on one core: threads inside its BLAS would compete with the other ranks.
# This has to be said before NumPy is imported.
for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

import click  # noqa: E402 - after the environment is set

from ..config.values import printable  # noqa: E402 - after the environment is set
from ..errors import BUG_STATUS, Refusal  # noqa: E402 - after the environment is set
from .command_line import commands  # noqa: E402 - after the environment is set
from .launchers import speaks  # noqa: E402 - after the environment is set

__all__ = ["commands", "main"]

LONGEST_MESSAGE = 350
"""Characters of a refusal."""


def _one_line(message: str) -> str:
    """A message in one line of bounded length: what it quotes may be as long as a user likes."""
    line = printable(" ".join(message.split()))
    return line if len(line) <= LONGEST_MESSAGE else f"{line[: LONGEST_MESSAGE - 100]} ... {line[-90:]}"


def main() -> None:
    """Runs the command line; every refusal is one sentence on standard error."""
    code, message = 0, ""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # a file's name may be any bytes
    if not speaks() and "run" not in sys.argv[1:2]:
        sys.exit(0)  # under a launcher one rank shows or draws, and the others have nothing to add
    try:
        commands.main(standalone_mode=False)
    except click.exceptions.Abort:
        code, message = 130, "interrupted"
    except click.UsageError as error:
        code, message = 2, error.format_message()
    except click.ClickException as error:
        code, message = 3, error.format_message()
    except Refusal as error:
        code, message = error.exit_status, str(error)
    except OSError as error:  # a name too long, a directory that may not be looked into
        if error.filename is None and error.errno not in (errno.ENOSPC, errno.EIO):
            raise
        code = 2 if error.errno in (errno.ENAMETOOLONG, errno.ELOOP) else 3
        message = f"{error.filename or 'standard output'}: {error.strerror}"
    except MemoryError:
        code, message = 3, "there is not enough memory"
    except Exception:
        traceback.print_exc()
        code, message = BUG_STATUS, "this is a bug; please report it with the lines above"
    if message and speaks():
        with suppress(OSError):  # both streams may go into one log on one full disk
            click.echo(f"rodsweep: {_one_line(message)}", err=True)
    _drop_what_cannot_be_written()
    sys.exit(code)


def _drop_what_cannot_be_written() -> None:
    """Gives what cannot be flushed /dev/null: Python flushes at exit, and would end with 120."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except OSError:
            os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
