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

from ...model.parameters import NON_OPTIONAL_LINEAR_PARAMETER_NAMES

NO_RENAMED_FIELDS: Mapping[str, str] = {}
"""Empty mapping for the argument `names` of `outcome_values`: every field has the name of its variable."""
TYPED_UNIT_ATTRIBUTE = "typed_unit"
"""Name of the attribute of a variable with the unit in which the user typed the values."""
MISSING_STATUS = -1
"""Value of the variable `status` at a point that has not been computed."""
ANGULAR_UNIT = "rad/tau2"
"""Unit of every dimensionless frequency. Frequencies are angular: the imaginary part of an eigenvalue, or 2
pi/period. For an arm a second variable, with a name ending in `_hz`, has cycles per second."""


@dataclass(frozen=True, slots=True)
class Variable:
    """Description of a variable of a result file, with its name, unit and long name.

    dtype: NumPy type. fill_value: value at missing points. extra_dimensions: dimensions that follow the
    dimensions of the points.
    """

    name: str
    dtype: str
    fill_value: float
    units: str
    """Unit, as the attribute `units`: a text such as "1/tau2"; "1" for a number without a unit."""
    long_name: str
    """Meaning in words, as the attribute `long_name`."""
    extra_dimensions: tuple[str, ...] = ()
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
        typed_unit = {TYPED_UNIT_ATTRIBUTE: self.typed_unit} if self.typed_unit else {}
        flags = flag_attributes(self.flags, self.dtype) if self.flags else {}
        return {"units": self.units, "long_name": self.long_name} | typed_unit | flags


def flag_attributes(flags: Iterable[tuple[int, str]], dtype: str = "|i1") -> dict[str, Any]:
    """netCDF attributes flag_values and flag_meanings from the (stored number, word) pairs of a variable.
    dtype: type of the variable, which flag_values must have."""
    values, meanings = zip(*flags, strict=True)
    return {"flag_values": np.array(values, dtype=dtype), "flag_meanings": " ".join(meanings)}


def real_variable(name: str, units: str, long_name: str, *dimensions: str) -> Variable:
    """Description of a variable of floating-point numbers; nan stands for a missing number. dimensions: names
    of the dimensions after the dimensions of the points."""
    return Variable(name, "<f8", np.nan, units, long_name, dimensions)


UNKNOWN_COUNT_LONG_NAME_SUFFIX = "; -1: not known"
"""End of the long name of a count that may be unknown; tables show an unknown count as an empty cell."""


def integer_variable(name: str, long_name: str, *dimensions: str) -> Variable:
    """Description of a variable of counts; -1 stands for an unknown count. dimensions: names of the
    dimensions after the dimensions of the points."""
    return Variable(name, "<i4", -1, "1", long_name, dimensions)


def word_variable(
    name: str, long_name: str, words: Iterable[str | tuple[int, str]], *dimensions: str
) -> Variable:
    """Description of a variable whose numbers stand for words. words: words, numbered from 0, or pairs
    (stored number, word). dimensions: names of the dimensions after the dimensions of the points. The fill
    value is -1 if a word has the number -1, which means a missing value; otherwise 0."""
    flags = tuple(entry if isinstance(entry, tuple) else (index, entry) for index, entry in enumerate(words))
    fill_value = -1 if any(value == -1 for value, _ in flags) else 0
    return Variable(name, "|i1", fill_value, "1", long_name, dimensions, flags)


def stored_number_of_word(word: str, words: Iterable[tuple[int, str]]) -> int:
    """Number that stands for `word` in a `word_variable`. words: pairs (stored number, word)."""
    return next(number for number, known_word in words if known_word == word)


def boolean_variable(name: str, long_name: str) -> Variable:
    """Description of a variable that is 1 at points where `long_name` is true, and 0 elsewhere."""
    return Variable(name, "|i1", 0, "1", long_name)


def along_dimension(dimension: str, *variables: Variable) -> tuple[Variable, ...]:
    """The variables with `dimension` as their only extra dimension."""
    return tuple(replace(v, extra_dimensions=(dimension,)) for v in variables)


def curve_end_variables(curve: str, reasons: Iterable[str]) -> tuple[Variable, Variable]:
    """Variables with the reasons why curves begin and end, without the dimension of the points of the curves.
    curve: prefix of the variables' names. reasons: names of all reasons; the file stores the position in this
    list."""
    reasons = tuple(reasons)
    return (
        word_variable(f"{curve}_start", "why the curve begins at the point", reasons),
        word_variable(f"{curve}_end", "why the curve ends at the point", reasons),
    )


SECONDS_VARIABLE = Variable("seconds", "<f4", np.nan, "s", "time spent on the point")
STATUS_VARIABLE = Variable("status", "|i1", MISSING_STATUS, "1", "outcome of the point")
MESH_VARIABLES = (
    Variable("elements", "<i2", 0, "1", "number of spectral elements"),
    Variable("order", "<i2", 0, "1", "largest polynomial order of the elements"),
)
"""Variables that describe the mesh of a point."""


def outcome_values(
    variables: Iterable[Variable],
    *outcomes: Any,
    prefix: str = "",
    names: Mapping[str, str] = NO_RENAMED_FIELDS,
) -> dict[str, Any]:
    """Values of variables by name, from fields of solver outcomes; each from the first outcome that has the
    field.

    A field has the name of its variable without `prefix`, or the name in `names`; x_real and x_imag are the
    parts of a complex field x. Raises AttributeError if no outcome has a field.
    """
    return {
        v.name: _outcome_field(names.get(v.name, v.name.removeprefix(prefix)), outcomes) for v in variables
    }


def _outcome_field(name: str, outcomes: Sequence[Any]) -> Any:
    for outcome in outcomes:
        if hasattr(outcome, name):
            return getattr(outcome, name)
    stem, _, part_name = name.rpartition("_")
    if part_name not in ("real", "imag"):
        raise AttributeError(f"no outcome has the field {name}")
    return getattr(_outcome_field(stem, outcomes), part_name)


def value_lists(
    variables: Iterable[Variable], rows: Sequence[Mapping[str, Any]], length: int | None = None
) -> dict[str, list[Any]]:
    """List of the values of each variable, by name. rows: for each item, the values of all variables by name.

    length: length of the lists, which are cut or padded with fill values; None for the number of rows.
    """
    rows_to_store = rows[:length]
    empty = max(0, (length or 0) - len(rows))
    return {v.name: [row[v.name] for row in rows_to_store] + [v.fill_value] * empty for v in variables}


@dataclass(frozen=True, slots=True)
class ReuseRule:
    """Rule for an option of which a larger value only requests more data of every point of a file.

    The rule determines which stored points need no new solve when the option increases.
    """

    has_additional_data: Callable[[np.ndarray, Any], NDArray[np.bool_]]
    """Function from (stored records, (n,); old value of the option) to whether each record already has the
    additional data, (n,)."""
    increasing_option_values: tuple[Any, ...] = ()
    """Values of the option, in increasing order; empty for numbers and booleans."""

    def requests_more_data(self, old: Any, new: Any) -> bool:
        """Whether the value `new` of the option requests more data than the value `old`."""
        if self.increasing_option_values:
            return self.increasing_option_values.index(new) > self.increasing_option_values.index(old)
        return bool(new > old)


NEW_SOLVE_RULE = ReuseRule(lambda records, before: np.zeros(len(records), bool))
"""Rule for an option whose increase needs a new solve of every point."""
NO_NEW_SOLVE_RULE = ReuseRule(lambda records, before: np.ones(len(records), bool))
"""Rule for an option whose increase needs no new solve, because the additional data belong to all points
together."""
FilledVariable = tuple[Variable, NDArray[Any]]
"""(variable, values, (...,)), where `extra_dimensions` of the variable names all dimensions of the values."""


@dataclass(frozen=True, slots=True)
class Layout:
    """Layout of a result file: the variables of every point, and the dimensions."""

    variables: tuple[Variable, ...]
    extents: dict[str, int]
    """Length of each extra dimension, by name."""
    parameters: tuple[str, ...] = NON_OPTIONAL_LINEAR_PARAMETER_NAMES
    """Names of the parameters of a point: dimensions of a grid, or variables along the dimension `point`."""
    arm_axes: tuple[str, ...] = ()
    """Names of the dimensions of a grid over an arm's quantities; empty for a grid of parameters or a
    list."""
    has_sweep_wide_variables: bool = False
    """Whether a finished file also has variables that are computed from all points together."""
    changed_points_variable: str = ""
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
    def fill_values_of_point(self) -> dict[str, NDArray[Any]]:
        """Fill values of every variable of a point, by name, each of the shape `point_shape`."""
        return {v.name: np.full(self.point_shape(v), v.fill_value, v.dtype) for v in self.variables}

    def point_shape(self, variable: Variable) -> tuple[int, ...]:
        """Shape of a variable at a single point: lengths of its extra dimensions."""
        return tuple(self.extents[dimension] for dimension in variable.extra_dimensions)
