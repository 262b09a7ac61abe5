"""Debian's PETSc and SLEPc on Python's search path.

Debian keeps petsc4py and slepc4py beside each build of PETSc. Its own `.pth` files name /usr/lib/petsc, a
link that only the packages for compiling make. This module finds the directories without the link.
"""

import os
import re
import sys
from importlib.util import find_spec
from pathlib import Path

LIBRARIES = Path("/usr/lib")


def add_debian_modules(libraries: Path = LIBRARIES) -> None:
    """Appends Debian's newest real petsc4py and slepc4py to `sys.path`.

    A module that Python already finds stays, and so does the choice of PETSC_DIR and SLEPC_DIR.
    """
    for name in ("petsc", "slepc"):
        if f"{name.upper()}_DIR" in os.environ or is_found(f"{name}4py"):
            continue
        directories = libraries.glob(f"{name}dir/{name}[0-9].*/*-real/lib/python3/dist-packages")
        sys.path += map(str, sorted(directories, key=_version)[-1:])


def is_found(module: str) -> bool:
    """Whether Python finds a module; the module is not loaded."""
    try:
        return find_spec(module) is not None
    except (ImportError, ValueError):  # a module that was set to None, as the tests do
        return False


def _version(directory: Path) -> list[int]:
    """Version in a path such as petscdir/petsc3.18/x86_64-linux-gnu-real/lib/python3/dist-packages."""
    return [int(number) for number in re.findall(r"\d+", directory.parents[3].name)]
