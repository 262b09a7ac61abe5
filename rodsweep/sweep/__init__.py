"""Sweeps over many points: their coordinates, their distribution over ranks, and the loop that solves them.

This package is the only sender of MPI messages. It does not know HDF5: the caller passes a function that
stores finished points.

For a user of `import rodsweep as rs`, `rs.sweep` is a function. Python binds the name of a package to the
package, so the package itself is made callable; it passes the call on to `rodsweep.api.sweeping.sweep`, which
describes the arguments.
"""

import sys
from importlib import import_module
from types import ModuleType
from typing import Any


class _CalledPackage(ModuleType):
    """A package that can be called: `rs.sweep(...)` is `rodsweep.api.sweeping.sweep(...)`."""

    @property
    def __wrapped__(self) -> Any:
        """The function itself; `help` and completion read its arguments here."""
        return import_module("rodsweep.api.sweeping").sweep  # by name: `api` imports `sweep`, not the reverse

    def __call__(self, *words: Any, **keywords: Any) -> Any:
        return self.__wrapped__(*words, **keywords)


sys.modules[__name__].__class__ = _CalledPackage
