"""Puts Debian's petsc4py and slepc4py on Python's search path.

Debian installs petsc4py and slepc4py in the directory of each build of PETSc. Debian's `.pth` files name
/usr/lib/petsc, a link that only the development packages create. This module finds the directories without
the link.
"""

import os
import re
import sys
from importlib.util import find_spec
from pathlib import Path

LIBRARIES = Path("/usr/lib")


def add_debian_modules(libraries: Path = LIBRARIES) -> None:
    """Appends to `sys.path` the directories of Debian's newest petsc4py and slepc4py built for real numbers.

    Nothing is appended for a module that Python already finds, or whose environment variable, PETSC_DIR or
    SLEPC_DIR, is set.
    """
    for name in ("petsc", "slepc"):
        if f"{name.upper()}_DIR" in os.environ or is_module_found(f"{name}4py"):
            continue
        directories = libraries.glob(f"{name}dir/{name}[0-9].*/*-real/lib/python3/dist-packages")
        sys.path += map(str, sorted(directories, key=_petsc_version_numbers)[-1:])


def is_module_found(module: str) -> bool:
    """Whether Python finds the module named `module`, tested without an import."""
    try:
        return find_spec(module) is not None
    except (ImportError, ValueError):  # the tests set the module to None
        return False


def _petsc_version_numbers(directory: Path) -> list[int]:
    """Version numbers in the name of the fourth parent directory: [3, 18] for
    petscdir/petsc3.18/x86_64-linux-gnu-real/lib/python3/dist-packages."""
    return [int(number) for number in re.findall(r"\d+", directory.parents[3].name)]
