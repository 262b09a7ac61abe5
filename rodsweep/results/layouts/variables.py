"""Variables of a result file, with types, dimensions, units and long names.

The same table makes the HDF5 datasets and the records of the journal; `rodsweep.results.layouts` has the
table of every task.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...model.parameters import NON_OPTIONAL_LINEAR_PARAMETERS, PARAMETERS

NO_NAMES: Mapping[str, str] = {}
"""Empty mapping for the argument `names` of `outcome_values`: every field has the name of its variable."""
TYPED_UNIT = "typed_unit"
"""Name of the attribute of a variable with the unit in which the user typed the values."""
MISSING_STATUS = -1
"""Value of the variable `status` at a point that has not been computed."""
ANGULAR_UNIT = "rad/tau2"
"""Unit of every dimensionless frequency. Frequencies are angular: the imaginary part of an eigenvalue, or 2
pi/period. For an arm a second variable, with a name ending in `_hz`, has cycles per second."""
DIMENSIONS = {p.name: (p.unit, p.long_name) for p in PARAMETERS.values()} | {
    "point": ("1", "row of the point list, from 1"),
    "mode": ("1", "number of the eigenvalue, by descending growth rate; in a pair, positive frequency first"),
    "u": ("1", "material coordinate along the rod"),
    "crossing": ("1", "number of the crossing, by increasing value of the varied parameter"),
    "curve_point": ("1", "number of the point on all boundary curves, curve by curve"),
    "fold": ("1", "number of the fold, at which a boundary curve turns back"),
    "branch_point": ("1", "number of the cycle on all branches of a rod, branch by branch"),
    "special": ("1", "number of the special point on all branches of a rod, branch by branch"),
    "cycle_special": ("1", "number of the special point on all branches of cycles of a row"),
    "cycle_curve_point": ("1", "number of the point on all curves of folds and torus points, curve by curve"),
    "cycle_extremum": ("1", "number of the extremum of the row parameter along a curve of folds of cycles"),
    "cycle_detached": ("1", "number of the row among the rows with detached branches of cycles"),
    "bautin": ("1", "number of the generalised Hopf point, Hopf curve by Hopf curve"),
    "bautin_step": ("1", "number of the point on curves of generalised Hopf points, curve by curve"),
    "change": ("1", "number of the change located between neighbouring points along F, line by line"),
    "hopf": ("1", "number of the Hopf point located between neighbouring points, line by line"),
    "harmonic": ("1", "multiple of the cycle's frequency"),
    "multiplier_number": ("1", "number of the nontrivial Floquet multiplier, by descending modulus"),
    "sample": ("1", "time in periods, from the instant at which y of the tip rises through its mean"),
    "shape": ("1", "time in periods, from the instant at which y of the tip rises through its mean"),
    "transient": ("1", "time since the start, in units of the last stored time of the motion"),
}
"""(unit, long name) of the coordinate of every dimension, by name."""


@dataclass(frozen=True, slots=True)
class Variable:
    """Description of a variable of a result file, with its name, unit and long name.

    dtype: NumPy type. fill: value at missing points. extra: dimensions that follow the dimensions of the
    points.
    """

    name: str
    dtype: str
    fill: float
    units: str
    long_name: str
    extra: tuple[str, ...] = ()
    flags: tuple[tuple[int, str], ...] = ()
    """(stored number, name) pairs of a variable whose numbers stand for names; the pairs of `status` come
    from the solver."""
    typed_unit: str = ""
    """Unit in which the user typed the quantity, or empty; the stored values are in `units`."""

    @property
    def is_boolean(self) -> bool:
        """Whether the variable is 1 for yes and 0 for no."""
        return self.dtype == "|i1" and not self.flags and self.name != STATUS_VARIABLE.name

    @property
    def attributes(self) -> dict[str, Any]:
        """Attributes of the variable in a result file, by name."""
        typed_unit = {TYPED_UNIT: self.typed_unit} if self.typed_unit else {}
        flags = flag_attributes(self.flags, self.dtype) if self.flags else {}
        return {"units": self.units, "long_name": self.long_name} | typed_unit | flags


def dimension_attributes(name: str) -> dict[str, Any]:
    """Attributes of the coordinate of the dimension `name`: unit and long name."""
    return dict(zip(("units", "long_name"), DIMENSIONS[name], strict=True))


def flag_attributes(flags: Iterable[tuple[int, str]], dtype: str = "|i1") -> dict[str, Any]:
    """netCDF attributes flag_values and flag_meanings from the (stored number, word) pairs of a variable.
    dtype: type of the variable, which flag_values must have."""
    values, meanings = zip(*flags, strict=True)
    return {"flag_values": np.array(values, dtype=dtype), "flag_meanings": " ".join(meanings)}


def real(name: str, units: str, long_name: str, *dimensions: str) -> Variable:
    """Description of a variable of floating-point numbers; nan stands for a missing number. dimensions:
    dimensions after those of the points."""
    return Variable(name, "<f8", np.nan, units, long_name, dimensions)


NOT_KNOWN_SUFFIX = "; -1: not known"
"""End of the long name of a count that may be unknown; tables show an unknown count as an empty cell."""


def integer(name: str, long_name: str, *dimensions: str) -> Variable:
    """Description of a variable of counts; -1 stands for an unknown count. dimensions: dimensions
    after those of the points."""
    return Variable(name, "<i4", -1, "1", long_name, dimensions)


def word(name: str, long_name: str, words: Iterable[str | tuple[int, str]], *dimensions: str) -> Variable:
    """Description of a variable whose numbers stand for words. words: words, numbered from 0, or pairs
    (stored number, word). dimensions: dimensions after those of the points. The fill value is -1 if a word
    has the number -1, which means a missing value; otherwise 0."""
    flags = tuple(entry if isinstance(entry, tuple) else (index, entry) for index, entry in enumerate(words))
    fill_value = -1 if any(value == -1 for value, _ in flags) else 0
    return Variable(name, "|i1", fill_value, "1", long_name, dimensions, flags)


def flag_number(word: str, words: Iterable[tuple[int, str]]) -> int:
    """Stored number of `word`, from the (stored number, word) pairs `words`."""
    return next(number for number, known_word in words if known_word == word)


def boolean(name: str, long_name: str) -> Variable:
    """Description of a variable that is 1 at points where `long_name` is true, and 0 elsewhere."""
    return Variable(name, "|i1", 0, "1", long_name)


def along_dimension(dimension: str, *variables: Variable) -> tuple[Variable, ...]:
    """The variables with `dimension` as their only extra dimension."""
    return tuple(replace(v, extra=(dimension,)) for v in variables)


SECONDS_VARIABLE = Variable("seconds", "<f4", np.nan, "s", "time spent on the point")
STATUS_VARIABLE = Variable("status", "|i1", MISSING_STATUS, "1", "outcome of the point")
MESH_VARIABLES = (
    Variable("elements", "<i2", 0, "1", "number of spectral elements"),
    Variable("order", "<i2", 0, "1", "largest polynomial order of the elements"),
)
"""Variables that describe the mesh of a point."""


def outcome_values(
    variables: Iterable[Variable], *outcomes: Any, prefix: str = "", names: Mapping[str, str] = NO_NAMES
) -> dict[str, Any]:
    """Values of variables by name, from fields of solver outcomes; each from the first outcome that has the
    field.

    A field has the name of its variable without `prefix`, or the name in `names`; x_real and x_imag are the
    parts of a complex field x. Raises AttributeError if no outcome has a field.
    """
    return {v.name: _field(names.get(v.name, v.name.removeprefix(prefix)), outcomes) for v in variables}


def _field(name: str, outcomes: Sequence[Any]) -> Any:
    for outcome in outcomes:
        if hasattr(outcome, name):
            return getattr(outcome, name)
    stem, _, part_name = name.rpartition("_")
    if part_name not in ("real", "imag"):
        raise AttributeError(f"no outcome has the field {name}")
    return getattr(_field(stem, outcomes), part_name)


def value_lists(
    variables: Iterable[Variable], rows: Sequence[Mapping[str, Any]], length: int | None = None
) -> dict[str, list[Any]]:
    """List of the values of each variable, by name. rows: for each item, the values of all variables by name.

    length: length of the lists, which are cut or padded with fill values; None for the number of rows.
    """
    rows_to_store = rows[:length]
    empty = max(0, (length or 0) - len(rows))
    return {v.name: [row[v.name] for row in rows_to_store] + [v.fill] * empty for v in variables}


@dataclass(frozen=True, slots=True)
class ExtensionRule:
    """Rule for an option of which a larger value only requests more data of every point of a file.

    The rule determines which stored points need no new solve when the option increases.
    """

    has_data: Callable[[np.ndarray, Any], NDArray[np.bool_]]
    """Function from (stored records, (n,); old value of the option) to whether each record already has the
    additional data, (n,)."""
    option_values: tuple[Any, ...] = ()
    """Values of the option, in increasing order; empty for numbers and booleans."""

    def requests_more_data(self, old: Any, new: Any) -> bool:
        """Whether the value `new` of the option requests more data than the value `old`."""
        if self.option_values:
            return self.option_values.index(new) > self.option_values.index(old)
        return bool(new > old)


NEW_SOLVE_RULE = ExtensionRule(lambda records, before: np.zeros(len(records), bool))
"""Rule for an option whose increase needs a new solve of every point."""
NO_NEW_SOLVE_RULE = ExtensionRule(lambda records, before: np.ones(len(records), bool))
"""Rule for an option whose increase needs no new solve, because the additional data belong to all points
together."""
FilledVariable = tuple[Variable, NDArray[Any]]
"""(variable, values, (...,)), where `extra` of the variable names all dimensions of the values."""


@dataclass(frozen=True, slots=True)
class Layout:
    """Layout of a result file: the variables of every point, and the dimensions."""

    variables: tuple[Variable, ...]
    extents: dict[str, int]
    """Length of each extra dimension, by name."""
    parameters: tuple[str, ...] = NON_OPTIONAL_LINEAR_PARAMETERS
    """Names of the parameters of a point: dimensions of a grid, or variables along the dimension `point`."""
    arm_axes: tuple[str, ...] = ()
    """Names of the dimensions of a grid over an arm's quantities; empty for a grid of parameters or a
    list."""
    has_variables_of_all_points: bool = False
    """Whether a finished file also has variables that are computed from all points together."""
    changed_points: str = ""
    """Name of the variable with the numbers, from 1, of the points whose variables were changed after all
    points were solved; "" if no file of this layout has it. These points are not reused in other files."""

    def dimensions(self, is_list: bool) -> tuple[str, ...]:
        """Names of the dimensions of the points; is_list: whether the points come from a list."""
        return self.arm_axes or (("point",) if is_list else self.parameters)

    @property
    def record_dtype(self) -> np.dtype:
        """NumPy type of the record of a point: its flat index, then every variable."""
        fields: list[Any] = [(v.name, v.dtype, self.point_shape(v)) for v in self.variables]
        return np.dtype([("index", "<i8"), *fields])

    @property
    def bytes_per_point(self) -> int:
        """Size of all variables at a point, in bytes; it may exceed the largest size of a NumPy record."""
        return sum(np.dtype(v.dtype).itemsize * prod(self.point_shape(v)) for v in self.variables)

    @property
    def empty_point(self) -> dict[str, NDArray[Any]]:
        """Fill values of every variable of a point, by name, each of the shape `point_shape`."""
        return {v.name: np.full(self.point_shape(v), v.fill, v.dtype) for v in self.variables}

    def point_shape(self, variable: Variable) -> tuple[int, ...]:
        """Shape of a variable at a single point: lengths of its extra dimensions."""
        return tuple(self.extents[dimension] for dimension in variable.extra)
