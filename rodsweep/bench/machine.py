"""Where and when a benchmark ran, and with which versions of what."""

import importlib
import platform
import shutil
import subprocess
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from ..results.file.provenance import cpu_name, now, provenance
from ..solve.backend import petsc

PEER_PACKAGES = ("scipy", "pycont-lite", "scikit-sundae")


def machine() -> dict[str, str]:
    """Processor, date and versions, as attributes of a file."""
    return {"processor": cpu_name(), "created": now()} | provenance() | petsc.versions()


def where_and_when() -> str:
    """The machine, the date and the versions, in one line."""
    versions = petsc.versions() | {k.removesuffix("_version"): v for k, v in provenance().items()}
    shown = {name: versions[name] for name in ("rodsweep", "petsc", "slepc", "numpy", "python")}
    where = ", ".join(f"{name} {its}" for name, its in (shown | peer_versions()).items())
    return f"One core of {cpu_name()}, {platform.system()}, {now()[:10]}; {where}. Threads: one."


def peer_versions() -> dict[str, str]:
    """Of the peers that are installed; AUTO does not tell its own, but Debian's package does."""
    found = {}
    for name in PEER_PACKAGES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            continue
    if query := shutil.which("dpkg-query"):
        words = [query, "-W", "-f", "${Version}", "auto-07p"]
        auto = subprocess.run(words, capture_output=True, text=True, check=False).stdout
        found |= {"auto-07p": auto} if auto else {}
    return found


def installed(module: str) -> Any | None:
    """A peer's module; None where it is not installed."""
    try:
        return importlib.import_module(module)
    except ImportError:
        return None
