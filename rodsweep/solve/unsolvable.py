"""Exceptions of the solvers, in a module that does not load PETSc."""


class Unsolvable(Exception):
    """The rod has no solution in the model, or the numerical method finds none; the message states the
    cause."""


class MeshLimitReached(Unsolvable):
    """No mesh of allowed size reaches the requested accuracy."""


class WorkLimitReached(Unsolvable):
    """The next matrix would exceed the requested limit of the work on a rod."""
