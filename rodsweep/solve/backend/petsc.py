"""Starts PETSc and SLEPc on import; reports versions, user options and the sparse solver of this
installation."""

from functools import cache

from ...errors import import_refusal
from .availability import add_debian_modules

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

__all__ = ["PETSC_ERRORS", "PETSc", "SLEPc", "user_options_text", "sparse_package", "versions"]

PETSC_ERRORS = (PETSc.Error, SystemError)
"""Exceptions that a failure inside PETSc raises; some releases of petsc4py wrap a PETSc.Error in a
SystemError."""

SPARSE_PACKAGES = ("superlu", "umfpack", "klu", "mumps")
"""Names of PETSc's sparse LU packages with pivoting, the fastest first, as measured on the rod's matrices.
PETSc's built-in LU has no pivoting."""


@cache
def sparse_package() -> str | None:
    """First package in SPARSE_PACKAGES that this PETSc was built with; None if PETSc has no such package."""
    for name in SPARSE_PACKAGES:
        if PETSc.Sys.hasExternalPackage({"umfpack": "suitesparse", "klu": "suitesparse"}.get(name, name)):
            return name
    return None


def versions() -> dict[str, str]:
    """Versions of PETSc, SLEPc, petsc4py and slepc4py, by lower-case name."""
    return {
        "petsc": ".".join(map(str, PETSc.Sys.getVersion())),
        "slepc": ".".join(map(str, SLEPc.Sys.getVersion())),
        "petsc4py": petsc4py.__version__,
        "slepc4py": slepc4py.__version__,
    }


def user_options_text(prefix: str = "") -> str:
    """One line with the user's PETSc options whose names begin with `prefix`, as set in PETSC_OPTIONS or a
    resource file."""
    given = sorted((k, v) for k, v in PETSc.Options().getAll().items() if k != "no_signal_handler")
    return " ".join(f"-{k} {v or ''}".strip() for k, v in given if k.startswith(prefix))
