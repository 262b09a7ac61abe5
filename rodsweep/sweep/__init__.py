"""Sweeps over many points: parameter values, distribution over MPI ranks, and the loop that solves the
points.

This package is the only sender of MPI messages. HDF5 is unknown here: the caller passes a function that
stores finished points.

`rs.sweep`, after `import rodsweep as rs`, is a function. Python binds the name of a package to the package,
and the package itself is therefore callable: a call goes on to `rodsweep.api.sweeping.sweep`, which describes
the arguments.
"""

import sys
from importlib import import_module
from types import ModuleType
from typing import Any


class _CalledPackage(ModuleType):
    """Callable class of this package: `rs.sweep(...)` calls `rodsweep.api.sweeping.sweep(...)`."""

    @property
    def __wrapped__(self) -> Any:
        """The function `rodsweep.api.sweeping.sweep`; `help` and completion read the arguments here."""
        return import_module("rodsweep.api.sweeping").sweep  # by name: `api` imports `sweep`, not the reverse

    def __call__(self, *words: Any, **keywords: Any) -> Any:
        return self.__wrapped__(*words, **keywords)


sys.modules[__name__].__class__ = _CalledPackage
