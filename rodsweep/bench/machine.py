"""Processor, date and versions of a benchmark."""

import platform
from collections.abc import Mapping

from ..results.file.provenance import cpu_name, now, provenance
from ..solve.backend import petsc


def machine() -> dict[str, str]:
    """Processor, date and versions, as attributes of a file."""
    return {"processor": cpu_name(), "created": now()} | provenance() | petsc.versions()


def where_and_when(peers: Mapping[str, str]) -> str:
    """Machine, date and versions, including the peers' versions, in one line."""
    versions = petsc.versions() | {k.removesuffix("_version"): v for k, v in provenance().items()}
    shown = {name: versions[name] for name in ("rodsweep", "petsc", "slepc", "numpy", "python")}
    where = ", ".join(f"{name} {its}" for name, its in (shown | dict(peers)).items())
    return f"One core of {cpu_name()}, {platform.system()}, {now()[:10]}; {where}. Threads: one."
