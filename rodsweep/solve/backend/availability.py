"""Whether PETSc can be started at all, without starting it: starting it is collective over all ranks."""

import os
from importlib.util import find_spec

from ...errors import EnvironmentLacks


def require_directory() -> None:
    """EnvironmentLacks where the working directory was deleted: MPI and PETSc ask for it when they start."""
    try:
        os.getcwd()
    except FileNotFoundError:
        raise EnvironmentLacks("the working directory was deleted; change into one that exists") from None


def require_petsc() -> None:
    """EnvironmentLacks where petsc4py or slepc4py is not to be found, or there is no working directory."""
    require_directory()
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
