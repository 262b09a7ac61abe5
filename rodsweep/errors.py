"""The two ways a command ends early: the user's input is bad, or the environment lacks something.

A parameter point that fails is neither: it keeps a status (`rodsweep.solve.status`) and the sweep
goes on.
"""


class Refusal(Exception):
    """One sentence for the user; `collective` where every rank of a run raises it at the same place."""

    collective = False


class InputError(Refusal):
    """Bad input: the sentence names the key, the value and what is allowed. Exit status 2."""


class EnvironmentLacks(Refusal):
    """The machine lacks a component or a right: the sentence says which. Exit status 3."""
