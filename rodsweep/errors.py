"""The two kinds of error that end a command early: bad input, and an incomplete environment.

A parameter point that fails is no such error: the point keeps a status (`rodsweep.solve.status`) and the
sweep continues. Any other exception is a bug.
"""

from typing import Self

BUG_STATUS = 70
"""Exit status of a bug: EX_SOFTWARE of sysexits.h, "internal software error"."""


class Refusal(Exception):
    """Error that the command line shows as one sentence, without a traceback.

    collective: whether every rank of a run raises the error at the same place.
    """

    collective = False
    exit_status = BUG_STATUS

    def on_all_ranks(self) -> Self:
        """Marks the error as collective: every rank has a copy and raises it at the same place."""
        self.collective = True
        return self


class InputError(Refusal):
    """Bad input: the sentence names the key, the value and what is allowed."""

    exit_status = 2


class EnvironmentIncomplete(Refusal):
    """The machine lacks a component or a permission; the sentence names it."""

    exit_status = 3


def import_refusal(modules: str, reason: object, extra: str = "solvers") -> EnvironmentIncomplete:
    """EnvironmentIncomplete for modules whose import failed; its sentence says how to install the modules.

    modules: names for the sentence. reason: error of the import. extra: name of the optional dependencies
    that install the modules from PyPI. Modules of a Linux distribution are compiled for its NumPy; with
    another major version of NumPy their import fails with a message about binary incompatibility.
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
    return EnvironmentIncomplete(f"{modules} cannot be imported ({reason}); {remedy}")
