"""Start of PETSc and SLEPc, and the capabilities of this installation."""

from functools import cache

from ...errors import import_refusal
from .debian import add_debian_modules

add_debian_modules()
try:
    import petsc4py
    import slepc4py

    # With PETSc's signal handlers a broken pipe of a reader would abort all ranks.
    petsc4py.init(["rodsweep", "-no_signal_handler"])
    slepc4py.init(["rodsweep"])
    from petsc4py import PETSc
    from slepc4py import SLEPc
except (ImportError, ValueError) as error:  # ValueError: compiled for another NumPy
    raise import_refusal("petsc4py and slepc4py", error) from error

__all__ = ["PETSC_ERRORS", "PETSc", "SLEPc", "options", "sparse_package", "versions"]

PETSC_ERRORS = (PETSc.Error, SystemError)
"""Errors of PETSc; some releases of petsc4py wrap a PETSc.Error into a SystemError."""

SPARSE_PACKAGES = ("superlu", "umfpack", "klu", "mumps")
"""Sparse factorisations with pivoting, the fastest on these matrices first; PETSc's own has no pivoting."""


@cache
def sparse_package() -> str | None:
    """First of SPARSE_PACKAGES in this PETSc; None for a PETSc without sparse direct solvers."""
    for name in SPARSE_PACKAGES:
        if PETSc.Sys.hasExternalPackage({"umfpack": "suitesparse", "klu": "suitesparse"}.get(name, name)):
            return name
    return None


def versions() -> dict[str, str]:
    """Versions of PETSc, SLEPc and their Python bindings."""
    return {
        "petsc": ".".join(map(str, PETSc.Sys.getVersion())),
        "slepc": ".".join(map(str, SLEPc.Sys.getVersion())),
        "petsc4py": petsc4py.__version__,
        "slepc4py": slepc4py.__version__,
    }


def options(prefix: str = "") -> str:
    """PETSc options with this prefix from PETSC_OPTIONS or a resource file, as one line."""
    given = sorted((k, v) for k, v in PETSc.Options().getAll().items() if k != "no_signal_handler")
    return " ".join(f"-{k} {v or ''}".strip() for k, v in given if k.startswith(prefix))
