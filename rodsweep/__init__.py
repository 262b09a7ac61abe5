"""rodsweep: oscillation and flutter of a soft rod under a follower load in a viscous fluid.

The Python interface, `import rodsweep as rs`, is described in docs/python.md. Importing the package starts
neither MPI nor PETSc and loads only this module: each public name is imported when it is first used.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .api.answers.answer import Answer
    from .api.answers.picture import Picture, plot
    from .api.answers.tabling import table
    from .api.arm import Arm
    from .api.dataset import open_result as open  # noqa: A004 - `rs.open`
    from .api.keyword_arguments import linspace, logspace
    from .api.rod import SoftRod as Rod
    from .api.sweeping import sweep
    from .errors import EnvironmentIncomplete, InputError

__version__ = "1.0.0"
__all__ = [
    "Answer",
    "Arm",
    "EnvironmentIncomplete",
    "InputError",
    "Picture",
    "Rod",
    "linspace",
    "logspace",
    "open",
    "plot",
    "sweep",
    "table",
]

_IMPORT_PATHS = {
    "Answer": "api.answers.answer.Answer",
    "Arm": "api.arm.Arm",
    "EnvironmentIncomplete": "errors.EnvironmentIncomplete",
    "InputError": "errors.InputError",
    "Picture": "api.answers.picture.Picture",
    "Rod": "api.rod.SoftRod",
    "linspace": "api.keyword_arguments.linspace",
    "logspace": "api.keyword_arguments.logspace",
    "open": "api.dataset.open_result",
    "plot": "api.answers.picture.plot",
    "sweep": "sweep",
    "table": "api.answers.tabling.table",
}
"""Import path of every public name, relative to the package. `sweep` is a callable package."""


def __getattr__(name: str) -> Any:
    """Imports the public name `name` when it is first used. Raises AttributeError for an unknown name."""
    if name not in _IMPORT_PATHS:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    module, _, attribute = _IMPORT_PATHS[name].rpartition(".")
    module_ = import_module(f".{module or attribute}", __name__)
    globals()[name] = value = getattr(module_, attribute) if module else module_
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
