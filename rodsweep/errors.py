"""The two kinds of error that end a command early, bad input and an incomplete environment, and exit
statuses.

A parameter point that cannot be solved raises no error: the point gets a status (`rodsweep.solve.status`) and
the sweep continues. Any other exception is a bug.
"""

from datetime import date
from typing import Any, Self

BUG_EXIT_STATUS = 70
"""Exit status of a bug: EX_SOFTWARE of sysexits.h, "internal software error"."""
STOPPED_EXIT_STATUS = 75
"""Exit status of a run stopped by a signal (EX_TEMPFAIL of sysexits.h); the same command continues the
run."""
MAX_QUOTED_VALUE_LENGTH = 60
"""Maximum length of a quoted value in a message, in characters; longer values lose their end."""


def short_repr(value: Any) -> str:
    """`repr` of a value for messages, on one line, cut to `MAX_QUOTED_VALUE_LENGTH` characters; a phrase if
    `repr` fails because the value is too large or nested too deeply. A date of YAML, 2024-01-01, is shown as
    text."""
    try:
        text = " ".join((str(value) if isinstance(value, date) else repr(value)).split())
    except (ValueError, RecursionError):  # an integer of thousands of digits, or a tree too deep
        article = "an" if isinstance(value, int) else "a"
        return f"{article} {type(value).__name__} too large to be shown"
    return text if len(text) <= MAX_QUOTED_VALUE_LENGTH else text[: MAX_QUOTED_VALUE_LENGTH - 3] + "..."


class UserError(Exception):
    """Error that the command line prints as one sentence, without a traceback.

    is_collective: whether every MPI rank of a run raises the error at the same statement.
    """

    is_collective = False
    exit_status = BUG_EXIT_STATUS

    def __str__(self) -> str:
        """The message on one line: control characters, as in the name of a file, are escaped."""
        return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in super().__str__())

    def marked_collective(self) -> Self:
        """Marks this error as collective (every MPI rank raises a copy), and returns the error."""
        self.is_collective = True
        return self


class InputError(UserError):
    """Bad input. The message names the key, the value and the allowed values."""

    exit_status = 2


class EnvironmentIncomplete(UserError):
    """A component or a permission is missing on this machine. The message names the missing item."""

    exit_status = 3


def import_failure_error(modules: str, reason: object, extra: str = "solvers") -> EnvironmentIncomplete:
    """EnvironmentIncomplete for modules whose import failed, with a message that says how to install them.

    modules: names of the modules, for the message. reason: error raised by the import. extra: name of the
    optional dependencies that install the modules from PyPI. The modules of a Linux distribution are compiled
    for the distribution's NumPy; with another major version of NumPy the import fails with a message about
    binary incompatibility.
    """
    if "binary incompatibility" in str(reason):
        remedy = "they are compiled for another NumPy: on Debian 12 pip install 'rodsweep[debian12]'"
    else:
        wheel = "pip install 'rodsweep[solvers]', which compiles PETSc"
        if extra != "solvers":
            wheel = f"pip install 'rodsweep[{extra}]' to read and draw results; to solve, {wheel}"
        remedy = (
            f"`make install` in a clone installs all; or take the packages of Debian or conda, or {wheel}"
        )
    reason_text = " ".join(str(reason).split())
    return EnvironmentIncomplete(f"{modules} cannot be imported ({reason_text}); {remedy}")
