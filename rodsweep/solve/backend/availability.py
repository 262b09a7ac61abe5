"""Whether this process can solve at all, without starting PETSc: starting it is collective over all ranks."""

import os
from importlib.util import find_spec

import numba

from ...errors import EnvironmentLacks, InputError


def require_solvers() -> None:
    """EnvironmentLacks where PETSc cannot be started, InputError where the formulas may not be compiled."""
    if numba.config.DISABLE_JIT:
        raise InputError(
            "NUMBA_DISABLE_JIT is set: PETSc calls compiled formulas, which Python cannot replace; unset it"
        )
    try:
        os.getcwd()
    except FileNotFoundError:
        raise EnvironmentLacks(
            "the working directory has been deleted, and PETSc does not start without one; change to another"
        ) from None
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
