"""Check that PETSc can solve here, without starting PETSc: the start is collective over all ranks."""

import os
from importlib.util import find_spec

from ...errors import EnvironmentIncomplete, InputError


def require_directory() -> None:
    """EnvironmentIncomplete if the working directory was deleted: MPI and PETSc read it when they start."""
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
    for name in ("petsc4py", "slepc4py"):
        try:
            found = find_spec(name) is not None
        except (ImportError, ValueError):
            found = False
        if not found:
            raise EnvironmentIncomplete(
                f"{name} cannot be imported; `make install` provides it, or set PETSC_DIR and SLEPC_DIR to "
                "where PETSc and SLEPc are installed"
            )
