"""What a result file is made of: variables with their types, dimensions, units and meanings.

The same table makes the HDF5 datasets and the records of the journal; `rodsweep.results.layouts` has
the table of every task.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...model.parameters import LINEAR_PARAMETERS, PARAMETERS

NO_NAMES: Mapping[str, str] = {}
TYPED = "typed_unit"
"""The attribute of a variable with the unit in which the user typed it."""
MISSING = -1
"""Status of a point that has not been computed."""

ANGULAR = "rad/tau2"
"""Unit of every frequency, which is angular: imaginary part of an eigenvalue, or 2 pi/period. Of an arm it
stands in cycles per second beside, under a name that ends in `_hz`; rad/s is nowhere."""

DIMENSIONS = {p.name: (p.unit, p.long_name) for p in PARAMETERS.values()} | {
    "point": ("1", "row of the point list, from 1"),
    "mode": ("1", "leading first: descending growth rate, of a pair the positive frequency first"),
    "u": ("1", "material coordinate along the rod"),
    "crossing": ("1", "in increasing order of the parameter that is varied"),
    "curve_point": ("1", "points of all curves, each curve's one after another"),
    "fold": ("1", "points where a curve turns back"),
    "branch_point": ("1", "cycles of all branches of a rod, each branch's one after another"),
    "special": ("1", "special points of all branches of a rod, each branch's one after another"),
    "cycle_special": ("1", "special points of the branches of a row, each branch's one after another"),
    "cycle_curve_point": ("1", "points of all curves of folds and torus points, one curve after another"),
    "bautin": ("1", "generalised Hopf points, of each Hopf curve one after another"),
    "bautin_step": ("1", "points of curves of generalised Hopf points, each curve's one after another"),
    "change": ("1", "changes of the rod on the lines over F between the points, one line after another"),
    "hopf": ("1", "Hopf points on the lines between the points, each line's in increasing order"),
    "harmonic": ("1", "multiple of the cycle's frequency"),
    "multiplier_number": ("1", "Floquet multipliers by descending modulus, without the trivial one"),
    "sample": ("1", "time in periods, from where y of the tip rises through its mean"),
    "shape": ("1", "time in periods, from where y of the tip rises through its mean"),
    "transient": ("1", "time from the start, in units of the last one that is stored of the motion"),
}
"""Units and long names of all dimensions."""


@dataclass(frozen=True, slots=True)
class Variable:
    """One result variable; its shape is that of the points followed by `extra` dimensions."""

    name: str
    dtype: str
    fill: float
    units: str
    long_name: str
    extra: tuple[str, ...] = ()
    flags: tuple[tuple[int, str], ...] = ()
    """Values and meanings, where the variable is a word; those of `status` come from the task's solver."""
    typed: str = ""
    """The unit in which the user typed it, where that is known; the values are in `units`."""

    @property
    def is_truth(self) -> bool:
        """Whether the variable says yes or no."""
        return self.dtype == "|i1" and not self.flags and self.name != STATUS.name


def real(name: str, units: str, long_name: str, *extra: str) -> Variable:
    """A variable of floating-point numbers, NaN where there is none."""
    return Variable(name, "<f8", np.nan, units, long_name, extra)


NOT_KNOWN = "; -1: not known"
"""What the file says of a count that may be missing; tables have nothing there."""


def whole(name: str, long_name: str, *extra: str) -> Variable:
    """A variable of counts, -1 where it is not known."""
    return Variable(name, "<i4", -1, "1", long_name, extra)


def word(name: str, long_name: str, words: Iterable[str | tuple[int, str]], *extra: str) -> Variable:
    """A variable that stands for a word: by its place in a list, or by numbers of their own.

    -1 where it is not known, where that is one of them; else 0, the first word of a list.
    """
    flags = tuple(each if isinstance(each, tuple) else (place, each) for place, each in enumerate(words))
    fill = -1 if any(value == -1 for value, _ in flags) else 0
    return Variable(name, "|i1", fill, "1", long_name, extra, flags)


def truth(name: str, long_name: str) -> Variable:
    """A variable that is 1 where something is so, and 0 elsewhere."""
    return Variable(name, "|i1", 0, "1", long_name)


SECONDS = Variable("seconds", "<f4", np.nan, "s", "time spent on the point")
STATUS = Variable("status", "|i1", MISSING, "1", "outcome of the point")
MESH = (
    Variable("elements", "<i2", 0, "1", "spectral elements used"),
    Variable("order", "<i2", 0, "1", "polynomial order used"),
)
"""What every layout has, or every layout with a mesh."""


def recorded(
    variables: Iterable[Variable], *outcomes: Any, prefix: str = "", names: Mapping[str, str] = NO_NAMES
) -> dict[str, Any]:
    """The values of variables by name: each is a field of the first outcome that has it.

    A field has the name of its variable without `prefix`, or the one that `names` says; x_real and x_imag are
    the parts of a complex field x. AttributeError where no outcome has a field.
    """
    return {v.name: _field(names.get(v.name, v.name.removeprefix(prefix)), outcomes) for v in variables}


def _field(name: str, outcomes: Sequence[Any]) -> Any:
    for outcome in outcomes:
        if hasattr(outcome, name):
            return getattr(outcome, name)
    whole, _, part = name.rpartition("_")
    if part not in ("real", "imag"):
        raise AttributeError(f"no outcome has the field {name}")
    return getattr(_field(whole, outcomes), part)


def listed(
    variables: Iterable[Variable], rows: Sequence[Mapping[str, Any]], room: int | None = None
) -> dict[str, list[Any]]:
    """A list of items, one row an item, by variable: as many as there is room for, then fills."""
    kept = rows[:room]
    empty = max(0, (room or 0) - len(rows))
    return {v.name: [row[v.name] for row in kept] + [v.fill] * empty for v in variables}


@dataclass(frozen=True, slots=True)
class Increase:
    """An option of which a larger value asks for more of every point, and for nothing else."""

    has: Callable[[np.ndarray, Any], NDArray[np.bool_]]
    """From stored records, (n,), and the option's stored value: which have all that is asked, (n,)."""
    values: tuple[Any, ...] = ()
    """The option's values, of which the later ask for more; none where they are numbers or truths."""

    def is_more(self, before: Any, now: Any) -> bool:
        """Whether the value `now` asks for more than the one `before`."""
        if self.values:
            return self.values.index(now) > self.values.index(before)
        return bool(now > before)


ANEW = Increase(lambda records, before: np.zeros(len(records), bool))
"""More that only solving a point anew gives."""
BESIDE = Increase(lambda records, before: np.ones(len(records), bool))
"""More that is computed beside the points."""

Filled = tuple[Variable, NDArray[Any]]
"""A variable that is known as a whole, with its values; `extra` names all of its dimensions."""


@dataclass(frozen=True, slots=True)
class Layout:
    """The variables of one file and their dimensions."""

    variables: tuple[Variable, ...]
    extents: dict[str, int]
    """Lengths of the extra dimensions."""
    parameters: tuple[str, ...] = LINEAR_PARAMETERS
    """What makes a point: the dimensions of a grid, or what is given along `point`."""
    over: tuple[str, ...] = ()
    """The dimensions of the points where these are a grid over an arm's quantities."""
    needs_all_points: bool = False
    """Whether the file is whole only with variables that all points together give."""

    def dimensions(self, is_list: bool) -> tuple[str, ...]:
        """Names of the dimensions of the points; is_list: whether these are from a file of points."""
        return self.over or (("point",) if is_list else self.parameters)

    @property
    def record(self) -> np.dtype:
        """One point as a flat record: its index, then every variable."""
        fields: list[Any] = [(v.name, v.dtype, self.inner(v)) for v in self.variables]
        return np.dtype([("index", "<i8"), *fields])

    @property
    def bytes_per_point(self) -> int:
        """Size of all variables at one point, also where that is more than a record can hold."""
        return sum(np.dtype(v.dtype).itemsize * prod(self.inner(v)) for v in self.variables)

    @property
    def empty_point(self) -> dict[str, NDArray[Any]]:
        """Every variable of a point without numbers, each in its shape at one point."""
        return {v.name: np.full(self.inner(v), v.fill, v.dtype) for v in self.variables}

    def inner(self, variable: Variable) -> tuple[int, ...]:
        """Shape of a variable at one point."""
        return tuple(self.extents[d] for d in variable.extra)
