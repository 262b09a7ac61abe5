"""The two ways a command ends early: the user's input is bad, or the environment lacks something.

A parameter point that fails is neither: it keeps a status (`rodsweep.solve.status`) and the sweep
goes on. Any other exception is a bug.
"""

from typing import Self

BUG_STATUS = 70
"""Exit status of a bug: EX_SOFTWARE of sysexits.h, "internal software error"."""


class Refusal(Exception):
    """One sentence for the user; `collective` where every rank of a run raises it at the same place."""

    collective = False
    exit_status = BUG_STATUS

    def on_all_ranks(self) -> Self:
        """The same, of which every rank has a copy to raise at the same place."""
        self.collective = True
        return self


class InputError(Refusal):
    """Bad input: the sentence names the key, the value and what is allowed."""

    exit_status = 2


class EnvironmentLacks(Refusal):
    """The machine lacks a component or a right: the sentence says which."""

    exit_status = 3
