"""The two ways a command ends early: the user's input is bad, or the environment lacks something.

A parameter point that fails is neither: it keeps a status (`rodsweep.solve.status`) and the sweep
goes on.
"""


class InputError(Exception):
    """Bad input: one sentence that names the key, the value and what is allowed. Exit status 2."""


class EnvironmentLacks(Exception):
    """The machine lacks a component or a right: one sentence that says which. Exit status 3."""
