"""What a result file holds, as one table: the variables, their types, dimensions, units and meanings.

The same table makes the HDF5 datasets and the records of the journal.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

MISSING = -1
"""Status of a point that has not been computed."""


@dataclass(frozen=True, slots=True)
class Variable:
    """One result variable; its shape is that of the points followed by `extra` dimensions."""

    name: str
    dtype: str
    fill: float
    units: str
    long_name: str
    extra: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Layout:
    """The variables of one file and the lengths of their extra dimensions."""

    variables: tuple[Variable, ...]
    extents: dict[str, int]

    @property
    def record(self) -> np.dtype:
        """One point as a flat record: its index, then every variable."""
        fields: list[Any] = [("index", "<i8")]
        for v in self.variables:
            fields.append((v.name, v.dtype, tuple(self.extents[d] for d in v.extra)))
        return np.dtype(fields)

    @property
    def bytes_per_point(self) -> int:
        return self.record.itemsize - 8


PARAMETER_NAMES = {
    "F": ("k3/L^2", "follower force at the tip, along -e1"),
    "k1": ("k3/L^2", "stretch stiffness; inf is inextensible"),
    "k2": ("k3/L^2", "shear stiffness; inf is unshearable"),
    "gamma3": ("gamma2 L^2", "rotational drag"),
}
"""Units and long names of the parameters."""

EACH_MODE = (
    Variable("growth_rate", "<f8", np.nan, "1/tau2", "real part of the transverse eigenvalue", ("mode",)),
    Variable("frequency", "<f8", np.nan, "1/tau2", "imaginary part of the transverse eigenvalue", ("mode",)),
    Variable(
        "error_estimate",
        "<f8",
        np.nan,
        "1/tau2",
        "modulus of the Newton correction D/D' of the characteristic determinant at the eigenvalue",
        ("mode",),
    ),
)
EACH_POINT = (
    Variable("unstable_count", "<i4", -1, "1", "number of modes with positive growth rate; -1: not known"),
    Variable(
        "certified", "|i1", 0, "1", "1 where the winding number of D proves that no leading mode is missing"
    ),
    Variable("elements", "<i2", 0, "1", "spectral elements used"),
    Variable("order", "<i2", 0, "1", "polynomial order used"),
    Variable("seconds", "<f4", np.nan, "s", "time spent on the point"),
    Variable("status", "|i1", MISSING, "1", "outcome of the point"),
)
VECTORS = tuple(
    Variable(
        f"{field}_{part}", "<f8", np.nan, "1", f"{word} part of the eigenmode's {meaning}", ("mode", "u")
    )
    for field, meaning in (("Y", "deflection, scaled to Y(1) = 1"), ("Theta", "angle, scaled as Y"))
    for part, word in (("real", "real"), ("imag", "imaginary"))
)


def spectrum_layout(modes: int, vector_nodes: int) -> Layout:
    """The layout of the task spectrum; vectors only where vector_nodes > 0."""
    vectors = VECTORS if vector_nodes else ()
    extents = {"mode": modes} | ({"u": vector_nodes} if vector_nodes else {})
    return Layout(EACH_MODE + vectors + EACH_POINT, extents)
