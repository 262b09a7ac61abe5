"""Whether PETSc can be started at all, without starting it: starting it is collective over all ranks."""

import os
from importlib.util import find_spec

from ...errors import EnvironmentLacks


def require_petsc() -> None:
    """EnvironmentLacks where petsc4py or slepc4py is not to be found, or there is no working directory."""
    try:
        os.getcwd()  # PETSc asks for it when it starts
    except FileNotFoundError:
        raise EnvironmentLacks("the working directory was deleted; change into one that exists") from None
    for name in ("petsc4py", "slepc4py"):
        try:
            found = find_spec(name) is not None
        except (ImportError, ValueError):
            found = False
        if not found:
            raise EnvironmentLacks(
                f"{name} cannot be imported; `make install` provides it, or set PETSC_DIR and SLEPC_DIR to "
                "where PETSc and SLEPc are installed"
            )
