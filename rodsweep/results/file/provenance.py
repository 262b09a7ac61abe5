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
from ...arrays import Array, list_of

MAX_RANK_STATISTICS = 10_000
"""Maximum number of ranks whose work statistics are stored, because an attribute is limited to 64 kB."""
MAX_ATTRIBUTE_LENGTH = 60_000
"""Maximum number of characters of an attribute; HDF5 allows 64 kB."""
RANK_STATISTICS_ATTRIBUTES = ("rank_points", "rank_busy_seconds", "rank_idle_seconds")
"""Names of the attributes with the work statistics of each rank of the last run."""
BLAS_KERNELS_ATTRIBUTE = "blas_kernels"
"""Name of the attribute with the BLAS kernels that computed the points of a file in all runs, a kernel per
line, named by `rodsweep.solve.backend.petsc.blas_description`."""
FAILURE_REASONS_ATTRIBUTE = "failure_reasons"
"""Name of the attribute with one example point for each distinct reason of failure, in all runs; each line
has parameters, status and reason."""
MESSAGE_NUMBER_PATTERN = re.compile(r"\d[\d.]*(?:e[+-]?\d+)?")
"""Matches a number in a message. Messages that differ only in numbers are treated as the same reason of
failure."""
FAILED_POINT_PARAMETER_DIGITS = 9
"""Number of digits shown of a computed parameter of a failed point. All digits are shown if a second point
would have the same text."""
MAX_TYPED_DIGITS = 15
"""A parameter of a failed point is shown as the user typed it if it equals a number of at most this many
digits."""
MAX_FAILURE_REASONS = 20
"""Maximum number of reasons of failure in a file; additional reasons are dropped."""
KERNEL_NOT_RECORDED = "unknown"
"""Name of the BLAS kernel of points from an earlier version, which did not record kernels."""


def utc_time() -> str:
    """Current time in ISO 8601, UTC."""
    return datetime.now(UTC).isoformat(timespec="seconds")


def provenance() -> dict[str, str]:
    """Versions of rodsweep, Python and libraries (except PETSc and SLEPc), the git commit, and the system, by
    name of the attribute."""
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


def blas_kernels_in(attributes: Mapping[str, Any]) -> list[str]:
    """Names of the BLAS kernels in the attributes of a result file."""
    return str(attributes.get(BLAS_KERNELS_ATTRIBUTE, KERNEL_NOT_RECORDED)).splitlines()


def merged_blas_kernels(*kernel_texts: Iterable[str]) -> str:
    """Value of BLAS_KERNELS_ATTRIBUTE for a file with points computed by the kernels in the lists
    `kernel_texts`."""
    return "\n".join(sorted({kernel for kernels in kernel_texts for kernel in kernels}))


def example_failure_sentence(failure: str, columns: Mapping[str, Array]) -> str:
    """Sentence about a failed point: "failed, for example at F = 0.3, k1 = 200: no mesh ...". failure: stored
    text, "F=0.3, k1=200.0: failed no mesh ...". columns: values of each parameter at all points, (points,).
    """
    points_text, _, outcome = failure.partition(": ")
    status, _, message = outcome.partition(" ")
    name_value_pairs = (pair.partition("=") for pair in points_text.split(", "))
    point_text = ", ".join(
        f"{name} = {_parameter_text(float(value), columns.get(name, np.empty(0)))}"
        for name, _, value in name_value_pairs
    )
    sentence = f"{status}, for example at {point_text}"
    return f"{sentence}: {message}" if message else sentence


def _parameter_text(value: float, values: Array) -> str:
    """The value `value` of a parameter of a failed point as text: as typed if possible, else with
    FAILED_POINT_PARAMETER_DIGITS digits, or with all digits if another of `values`, (points,), has the same
    text."""
    if float(typed_text := f"{value:.{MAX_TYPED_DIGITS}g}") == value:
        return typed_text
    text = f"{value:.{FAILED_POINT_PARAMETER_DIGITS}g}"
    near = list_of(
        values[np.isclose(values, value, rtol=10.0 ** (1 - FAILED_POINT_PARAMETER_DIGITS), atol=0)]
    )
    is_shared = any(other != value and f"{other:.{FAILED_POINT_PARAMETER_DIGITS}g}" == text for other in near)
    return repr(value) if is_shared else text


def failure_kind(line: str) -> str:
    """Status and reason in a line "parameters: status reason", with every number replaced by #."""
    return MESSAGE_NUMBER_PATTERN.sub("#", line.partition(": ")[2])


def joined_reasons_attribute(*reason_texts: str) -> dict[str, str]:
    """Dict with the attribute FAILURE_REASONS_ATTRIBUTE, joined from several values of this attribute; empty
    if there are no reasons.

    Only the first line with each reason is included, at most MAX_FAILURE_REASONS lines; the text is cut to
    MAX_ATTRIBUTE_LENGTH characters.
    """
    lines: dict[str, str] = {}
    for line in (line for text in reason_texts for line in text.splitlines()):
        # The first example of a kind stays, so callers put the newest lines first.
        lines.setdefault(failure_kind(line), line)
    text = "\n".join([*lines.values()][:MAX_FAILURE_REASONS])[:MAX_ATTRIBUTE_LENGTH]
    return {FAILURE_REASONS_ATTRIBUTE: text} if text else {}


def updated_reasons_attribute(lines: Iterable[str], attributes: Mapping[str, Any]) -> dict[str, str]:
    """Dict with the attribute FAILURE_REASONS_ATTRIBUTE after new failures, with the new lines `lines`.
    attributes: attributes of the file, with the reasons of earlier runs.
    """
    # The newest examples first: an earlier one may be a point that has been computed anew.
    return joined_reasons_attribute(*lines, str(attributes.get(FAILURE_REASONS_ATTRIBUTE, "")))


def several_blas_kernels_warning(attribute: str) -> str:
    """Warning that several BLAS kernels computed the points of a file; empty for a single kernel. attribute:
    value of BLAS_KERNELS_ATTRIBUTE."""
    kernels = attribute.splitlines()
    if len(kernels) < 2:
        return ""
    return (
        f"computed in parts by {len(kernels)} BLAS kernels ({'; '.join(kernels)}), between which numbers "
        "differ in the last digits"
    )


def merged_history(attribute_sets: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Attributes of a merged file that describe the runs that computed its points. attribute_sets: attributes
    of the source files."""
    history: dict[str, Any] = {
        # The merged file is no longer a shard.
        "shard": "",
        BLAS_KERNELS_ATTRIBUTE: merged_blas_kernels(*map(blas_kernels_in, attribute_sets))[
            :MAX_ATTRIBUTE_LENGTH
        ],
    }
    reasons = (
        str(attributes_of_file.get(FAILURE_REASONS_ATTRIBUTE, "")) for attributes_of_file in attribute_sets
    )
    history |= joined_reasons_attribute(*reasons)
    runs = [attributes for attributes in attribute_sets if "ranks" in attributes]
    if not runs:
        return history
    hosts = {host for run in runs for host in str(run.get("hosts", "")).split()}
    history |= {
        "stopped": "",
        "ranks": sum(int(run["ranks"]) for run in runs),
        "hosts": " ".join(sorted(hosts))[:MAX_ATTRIBUTE_LENGTH],
        "started": min(str(run["started"]) for run in runs),
    }
    for name in RANK_STATISTICS_ATTRIBUTES:
        values = [np.atleast_1d(run[name]) for run in runs if name in run]
        history |= {name: np.concatenate(values)[:MAX_RANK_STATISTICS]} if values else {}
    return history


@cache
def git_commit() -> str:
    """Git commit of rodsweep's source tree, with "-dirty" if files were changed; "unknown" without git."""
    root = Path(__file__).resolve().parents[3]
    if not (root / ".git").exists():
        return "unknown"
    # The empty pattern matches no tag, so the text is the hash alone.
    command = ["git", "-C", str(root), "describe", "--always", "--dirty", "--abbrev=40", "--match="]
    try:
        run = subprocess.run(command, capture_output=True, text=True, timeout=10, check=False)
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
