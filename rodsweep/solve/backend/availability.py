"""Whether PETSc can start in this process, and its start, which involves all MPI ranks.

Debian installs petsc4py and slepc4py in the directory of each build of PETSc. Debian's `.pth` files name
/usr/lib/petsc, a link that only the development packages create. `add_debian_modules` finds the directories
without the link.
"""

import os
import re
import sys
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

from ...errors import EnvironmentIncomplete, InputError, import_failure_error

SYSTEM_LIBRARY_FOLDER = Path("/usr/lib")


def add_debian_modules(libraries: Path = SYSTEM_LIBRARY_FOLDER) -> None:
    """Appends to `sys.path` the directories of Debian's newest petsc4py and slepc4py built for real numbers.
    Nothing is appended for a module that Python already finds, or whose environment variable, PETSC_DIR or
    SLEPC_DIR, is set. libraries: folder that contains the directories of the builds."""
    for name in ("petsc", "slepc"):
        if f"{name.upper()}_DIR" in os.environ or is_module_found(f"{name}4py"):
            continue
        directories = libraries.glob(f"{name}dir/{name}[0-9].*/*-real/lib/python3/dist-packages")
        sys.path += map(str, sorted(directories, key=_petsc_version_in_path)[-1:])


def is_module_found(module: str) -> bool:
    """Whether Python finds the module named `module`, tested without an import."""
    try:
        return find_spec(module) is not None
    except (ImportError, ValueError):  # the tests set the module to None
        return False


def _petsc_version_in_path(directory: Path) -> list[int]:
    """Version numbers in the name of the fourth parent directory: [3, 18] for
    petscdir/petsc3.18/x86_64-linux-gnu-real/lib/python3/dist-packages."""
    return [int(number) for number in re.findall(r"\d+", directory.parents[3].name)]


def enter_directory(directory: Path) -> None:
    """Makes `directory`, in which the first rank works, the working directory of this rank; raises
    EnvironmentIncomplete if it cannot be entered."""
    try:
        os.chdir(directory)
    except OSError as error:
        raise EnvironmentIncomplete(
            f"the directory {directory} of the first rank cannot be entered: {error.strerror}; all ranks "
            "need the same file system"
        ) from error


def require_working_directory() -> None:
    """Raises EnvironmentIncomplete if the working directory was deleted: MPI and PETSc cannot start then."""
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
            raise import_failure_error(name, "not found")


def start_solvers() -> None:
    """Starts PETSc and SLEPc. Collective: the start of PETSc waits for all ranks, so `require_solvers` must
    have succeeded on all ranks. Raises EnvironmentIncomplete if PETSc or SLEPc cannot be loaded."""
    import_module(f"{__package__}.petsc")
