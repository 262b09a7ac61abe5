"""Check that PETSc can solve in this process, without starting PETSc: the start is collective over all
ranks."""

import os

from ...errors import EnvironmentIncomplete, InputError, import_refusal
from .debian import add_debian_modules, is_found


def require_directory() -> None:
    """Raises EnvironmentIncomplete if the working directory was deleted: MPI and PETSc need the directory to
    start."""
    try:
        os.getcwd()
    except FileNotFoundError:
        raise EnvironmentIncomplete(
            "the working directory was deleted; change into one that exists"
        ) from None


def require_solvers() -> None:
    """EnvironmentIncomplete if PETSc cannot start, InputError if the formulas may not be compiled."""
    import numba

    if numba.config.DISABLE_JIT:
        raise InputError(
            "NUMBA_DISABLE_JIT is set: PETSc calls compiled formulas, which Python cannot replace; unset it"
        )
    require_directory()
    add_debian_modules()
    for name in ("petsc4py", "slepc4py"):
        if not is_found(name):
            raise import_refusal(name, "not found")
