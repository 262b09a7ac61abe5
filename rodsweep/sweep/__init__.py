"""Many points: from axes to points, who solves which, and the loop. The only sender of MPI messages.

Nothing here knows HDF5: finished points go to a function that the caller gives.

To a user of `import rodsweep as rs` this name is the function that sweeps. Python gives the name of a package
to the package, so it is this that is called, and passes the call on to `rodsweep.api.sweeping.sweep`, where
its arguments are described.
"""

import sys
from importlib import import_module
from types import ModuleType
from typing import Any


class _CalledPackage(ModuleType):
    """A package that can be called: `rs.sweep(...)` is `rodsweep.api.sweeping.sweep(...)`."""

    @property
    def __wrapped__(self) -> Any:
        """The function itself, by which `help` and completion find its arguments."""
        return import_module("rodsweep.api.sweeping").sweep  # by name: the arrow of imports points here

    def __call__(self, *words: Any, **keywords: Any) -> Any:
        return self.__wrapped__(*words, **keywords)


sys.modules[__name__].__class__ = _CalledPackage
