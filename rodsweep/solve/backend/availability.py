"""Whether PETSc can start in this process, and its start, which involves all MPI ranks."""

import os
from importlib import import_module

from ...errors import EnvironmentIncomplete, InputError, import_refusal
from .debian import add_debian_modules, is_module_found


def require_working_directory() -> None:
    """Raises EnvironmentIncomplete if the working directory was deleted: MPI and PETSc cannot start without a
    working directory."""
    try:
        os.getcwd()
    except FileNotFoundError:
        raise EnvironmentIncomplete(
            "the working directory was deleted; change to an existing directory"
        ) from None


def require_solvers() -> None:
    """Raises EnvironmentIncomplete if petsc4py or slepc4py is not found or the working directory was deleted,
    InputError if numba's compiler is switched off."""
    import numba

    if numba.config.DISABLE_JIT:
        raise InputError(
            "NUMBA_DISABLE_JIT is set; unset this variable, because PETSc calls only compiled formulas"
        )
    require_working_directory()
    add_debian_modules()
    for name in ("petsc4py", "slepc4py"):
        if not is_module_found(name):
            raise import_refusal(name, "not found")


def start_solvers() -> None:
    """Starts PETSc and SLEPc. Collective: the start of PETSc waits for all ranks, so `require_solvers` must
    have succeeded on all ranks. Raises EnvironmentIncomplete if PETSc or SLEPc cannot be loaded."""
    import_module(f"{__package__}.petsc")
