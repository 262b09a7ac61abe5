"""Names of the BLAS libraries of this process and of their kernels.

A library such as OpenBLAS has a kernel for every kind of processor, and chooses a kernel at start. Kernels
sum in different orders, so the results of two kernels agree only within rounding. PETSc and NumPy may use
different libraries.
"""

from pathlib import Path

from threadpoolctl import threadpool_info

from . import petsc  # noqa: F401 - libraries are visible only once loaded

UNKNOWN_LIBRARY = "unknown"
"""Name reported for a BLAS library that states no name, for example the reference BLAS."""


def blas_description() -> str:
    """One line with name, version and kernel of PETSc's BLAS library, and of NumPy's BLAS library if the two
    differ."""
    found: dict[str, set[str]] = {"PETSc": set(), "NumPy": set(), "SciPy": set()}
    for library in threadpool_info():
        if library["user_api"] == "blas":
            words = (library["internal_api"], library["version"], library.get("architecture"))
            found[_package_of_library(library["filepath"])].add(" ".join(str(word) for word in words if word))
    petscs, numpys = (" and ".join(sorted(found[name])) for name in ("PETSc", "NumPy"))
    if numpys in ("", petscs):
        return petscs or UNKNOWN_LIBRARY
    return f"PETSc {petscs or UNKNOWN_LIBRARY}, NumPy {numpys}"


def _package_of_library(path: str) -> str:
    """Package to which the library at `path` belongs: NumPy, SciPy, or else PETSc (a library of the
    system)."""
    names = {part.removesuffix(".libs") for part in Path(path).parts}
    wheels = (owner for owner in ("NumPy", "SciPy") if owner.lower() in names)
    return next(wheels, "PETSc")
