"""Starts PETSc and SLEPc on import; reports versions, user options, the sparse solver and the BLAS kernels of
this installation.

A library such as OpenBLAS has a kernel for every kind of processor, and chooses a kernel at start. Kernels
sum in different orders, so the results of two kernels agree only within rounding. PETSc and NumPy may use
different libraries.
"""

from functools import cache
from pathlib import Path

from threadpoolctl import threadpool_info

from ...errors import import_failure_error
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
    raise import_failure_error("petsc4py and slepc4py", error) from error

__all__ = [
    "PETSC_EXCEPTIONS",
    "PETSc",
    "SLEPc",
    "blas_description",
    "user_options_text",
    "sparse_lu_package",
    "library_versions",
]

PETSC_EXCEPTIONS = (PETSc.Error, SystemError)
"""Exceptions after a failure inside PETSc; some releases of petsc4py wrap a PETSc.Error in a SystemError."""

SPARSE_LU_PACKAGES = ("superlu", "umfpack", "klu", "mumps")
"""Names of PETSc's sparse LU packages with pivoting, the fastest first, as measured on the rod's matrices.
PETSc's built-in LU has no pivoting."""
UNKNOWN_BLAS_NAME = "unknown"
"""Name reported for a BLAS library that states no name, for example the reference BLAS."""


@cache
def sparse_lu_package() -> str | None:
    """First package in SPARSE_LU_PACKAGES that this PETSc was built with; None if PETSc has no such
    package."""
    for name in SPARSE_LU_PACKAGES:
        if PETSc.Sys.hasExternalPackage({"umfpack": "suitesparse", "klu": "suitesparse"}.get(name, name)):
            return name
    return None


def library_versions() -> dict[str, str]:
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
    options = sorted((k, v) for k, v in PETSc.Options().getAll().items() if k != "no_signal_handler")
    return " ".join(f"-{k} {v or ''}".strip() for k, v in options if k.startswith(prefix))


def blas_description() -> str:
    """One line with name, version and kernel of PETSc's BLAS library, and of NumPy's if the two differ."""
    descriptions: dict[str, set[str]] = {"PETSc": set(), "NumPy": set(), "SciPy": set()}
    for library in threadpool_info():
        if library["user_api"] == "blas":
            parts = (library["internal_api"], library["version"], library.get("architecture"))
            descriptions[_package_of_blas_library(library["filepath"])].add(
                " ".join(str(word) for word in parts if word)
            )
    petscs, numpys = (" and ".join(sorted(descriptions[name])) for name in ("PETSc", "NumPy"))
    if numpys in ("", petscs):
        return petscs or UNKNOWN_BLAS_NAME
    return f"PETSc {petscs or UNKNOWN_BLAS_NAME}, NumPy {numpys}"


def _package_of_blas_library(path: str) -> str:
    """Package to which the library at `path` belongs: NumPy, SciPy, or else PETSc (a system library)."""
    names = {part.removesuffix(".libs") for part in Path(path).parts}
    packages = (package for package in ("NumPy", "SciPy") if package.lower() in names)
    return next(packages, "PETSc")
