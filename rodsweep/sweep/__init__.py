"""Sweeps over many points: parameter values, distribution over MPI ranks, and the loop that solves the
points.

Only this package sends MPI messages. The package does not use HDF5: the caller passes a function that stores
finished points.

`rs.sweep`, after `import rodsweep as rs`, is a function. Because Python binds the name `sweep` to this
package, the package itself is callable: a call is forwarded to `rodsweep.api.sweeping.sweep`, and
`help(rs.sweep)` shows the arguments and the docstring of this function.
"""

import inspect
import sys
from importlib import import_module
from types import ModuleType
from typing import Any


class _CallablePackage(ModuleType):
    """Module class of this package, callable: `rs.sweep(...)` calls `rodsweep.api.sweeping.sweep(...)`."""

    @property
    def __wrapped__(self) -> Any:
        """The function `rodsweep.api.sweeping.sweep`, from which `help` and completion read the arguments."""
        return import_module("rodsweep.api.sweeping").sweep  # by name: `api` imports `sweep`, not the reverse

    @property
    def __doc__(self) -> str:  # type: ignore[override]
        """Call signature and docstring of the function `rs.sweep`, as text that `help(rs.sweep)` shows."""
        function = self.__wrapped__
        return f"rs.sweep{inspect.signature(function)}\n\n{inspect.getdoc(function)}"

    def __call__(self, *words: Any, **keywords: Any) -> Any:
        return self.__wrapped__(*words, **keywords)


sys.modules[__name__].__class__ = _CallablePackage
