"""Provenance of a result: versions, commit, hosts, times and BLAS kernels, as attributes of the file."""

import platform
import re
import subprocess
from collections.abc import Iterable, Mapping, Sequence
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from ... import __version__

MAX_RANK_SHARES = 10_000
"""Largest number of ranks with a stored share of the work; more would exceed the 64 kB of an attribute."""
LONGEST_ATTRIBUTE = 60_000
"""Largest number of characters of an attribute; HDF5 allows 64 kB."""
RANK_SHARES = ("rank_points", "rank_busy_seconds", "rank_idle_seconds")
"""Attributes with the work of each rank of the last run."""
KERNELS_ATTRIBUTE = "blas_kernels"
"""Attribute with the BLAS kernels that computed the points of a file in all runs, a kernel a line, named by
`rodsweep.solve.backend.blas_kernel`."""
FAILURE_REASONS = "failure_reasons"
"""Attribute with an example point of each distinct reason for which points failed, in all runs, a line each:
parameters, status and reason."""
NUMBER = re.compile(r"\d[\d.]*(?:e[+-]?\d+)?")
"""A number in a message; messages that differ only in numbers state one reason."""
MAX_FAILURE_REASONS = 20
"""Maximum number of distinct failure reasons in a file; further reasons are dropped."""
KERNEL_NOT_RECORDED = "unknown"
"""Kernel of points from an earlier version, which did not record kernels."""


def now() -> str:
    """Current time in ISO 8601, UTC."""
    return datetime.now(UTC).isoformat(timespec="seconds")


def provenance() -> dict[str, str]:
    """Attributes with the versions of Python and packages, except solver libraries, and the commit."""
    return {
        "rodsweep_version": __version__,
        "git_commit": git_commit(),
        "python_version": platform.python_version(),
        "numpy_version": np.__version__,
        "numba_version": _version("numba"),
        "mpi4py_version": _version("mpi4py"),
        "h5py_version": h5py.__version__,
        "hdf5_version": h5py.version.hdf5_version,
        "system": platform.platform(),
    }


def kernels_of(attributes: Mapping[str, Any]) -> list[str]:
    """Names of the BLAS kernels in the attributes of a file."""
    return str(attributes.get(KERNELS_ATTRIBUTE, KERNEL_NOT_RECORDED)).splitlines()


def united_kernels(*several: Iterable[str]) -> str:
    """Value of KERNELS_ATTRIBUTE for a file whose points were computed by any of the given kernels."""
    return "\n".join(sorted({kernel for kernels in several for kernel in kernels}))


def reason_of(line: str) -> str:
    """The status and reason of a line `parameters: status reason`, its numbers left out."""
    return NUMBER.sub("#", line.partition(": ")[2])


def united_reasons(*several: str) -> dict[str, str]:
    """Merges values of the attribute FAILURE_REASONS of several files; may be empty.

    Of lines with equal reasons the first remains.
    """
    lines: dict[str, str] = {}
    for line in "\n".join(several).splitlines():
        lines.setdefault(reason_of(line), line)
    kept = "\n".join([*lines.values()][:MAX_FAILURE_REASONS])[:LONGEST_ATTRIBUTE]
    return {FAILURE_REASONS: kept} if kept else {}


def reasons_added(lines: Iterable[str], before: Mapping[str, Any]) -> dict[str, str]:
    """The attribute FAILURE_REASONS of a file with further points, from the lines of these points.

    before: attributes with the reasons of earlier runs.
    """
    # The newest examples first: an earlier one may be a point that has been computed anew.
    return united_reasons(*lines, str(before.get(FAILURE_REASONS, "")))


def kernels_sentence(attribute: str) -> str:
    """Warning that points of a file were computed by several kernels; empty for a single kernel."""
    kernels = attribute.splitlines()
    if len(kernels) < 2:
        return ""
    return (
        f"computed in parts by {len(kernels)} BLAS kernels ({'; '.join(kernels)}), between which numbers "
        "differ in the last digits"
    )


def merged_history(several: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Attributes of a merged file about the computation of the points, from the attributes of the sources."""
    history: dict[str, Any] = {
        "shard": "",
        KERNELS_ATTRIBUTE: united_kernels(*map(kernels_of, several))[:LONGEST_ATTRIBUTE],
    }
    history |= united_reasons(*(str(each.get(FAILURE_REASONS, "")) for each in several))
    runs = [attributes for attributes in several if "ranks" in attributes]
    if not runs:
        return history
    hosts = {host for run in runs for host in str(run.get("hosts", "")).split()}
    history |= {
        "stopped": "",
        "ranks": sum(int(run["ranks"]) for run in runs),
        "hosts": " ".join(sorted(hosts))[:LONGEST_ATTRIBUTE],
        "started": min(str(run["started"]) for run in runs),
    }
    for name in RANK_SHARES:
        values = [np.atleast_1d(run[name]) for run in runs if name in run]
        history |= {name: np.concatenate(values)[:MAX_RANK_SHARES]} if values else {}
    return history


@cache
def git_commit() -> str:
    """Commit of the checkout containing this code, marked if files were changed; or unknown."""
    root = Path(__file__).resolve().parents[3]
    if not (root / ".git").exists():
        return "unknown"
    try:
        run = subprocess.run(
            ["git", "-C", str(root), "describe", "--always", "--dirty", "--abbrev=40", "--match="],
            capture_output=True,
            text=True,
            timeout=10,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired):
        return "unknown"
    return run.stdout.strip() or "unknown"


def cpu_name() -> str:
    """Name of the processor as the system reports it."""
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


@cache
def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "unknown"
