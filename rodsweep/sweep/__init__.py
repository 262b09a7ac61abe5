"""Sweeps over many points: parameter values, distribution over MPI ranks, and the loop that solves the
points.

Only this package sends MPI messages. The package does not use HDF5: the caller passes a function that stores
finished points.

`rs.sweep`, after `import rodsweep as rs`, is a function. Because Python binds the name `sweep` to this
package, the package itself is callable: a call is forwarded to `rodsweep.api.sweeping.sweep`, whose docstring
describes the arguments.
"""

import sys
from importlib import import_module
from types import ModuleType
from typing import Any


class _CalledPackage(ModuleType):
    """Class of this package, which makes the package callable: `rs.sweep(...)` calls
    `rodsweep.api.sweeping.sweep(...)`."""

    @property
    def __wrapped__(self) -> Any:
        """The function `rodsweep.api.sweeping.sweep`; `help` and completion read the arguments here."""
        return import_module("rodsweep.api.sweeping").sweep  # by name: `api` imports `sweep`, not the reverse

    def __call__(self, *words: Any, **keywords: Any) -> Any:
        return self.__wrapped__(*words, **keywords)


sys.modules[__name__].__class__ = _CalledPackage
