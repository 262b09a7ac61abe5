"""Which BLAS kernels computed the points of a file: kept over all its runs, told where they are several."""

from collections.abc import Iterable, Mapping
from typing import Any

KERNELS = "blas_kernels"
"""The attribute: one kernel a line, as `rodsweep.solve.backend.blas_kernel` calls it."""
UNKNOWN = "unknown"
"""The kernel of points that an earlier version wrote, which did not ask."""


def kernels_of(attributes: Mapping[str, Any]) -> list[str]:
    """The kernels that a file's attributes name."""
    return str(attributes.get(KERNELS, UNKNOWN)).splitlines()


def united(*several: Iterable[str]) -> str:
    """The attribute of a file with the points of all these kernels."""
    return "\n".join(sorted({kernel for kernels in several for kernel in kernels}))


def told(attribute: str) -> str:
    """A sentence where a file has, or will have, points of more than one kernel; else empty."""
    kernels = attribute.splitlines()
    if len(kernels) < 2:
        return ""
    return (
        f"computed in parts by {len(kernels)} BLAS kernels ({'; '.join(kernels)}), between which numbers "
        "differ in the last digits"
    )
