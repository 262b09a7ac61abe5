"""Python values for a config: ranges, arrays and paths, converted to the types that YAML would give."""

import os
from typing import Any, TypedDict

import numpy as np

from ..config.document.call_arguments import in_sentences
from ..errors import InputError


class AxisRange(TypedDict):
    """A range of values in the form of a config."""

    start: float | str
    stop: float | str
    num: int
    spacing: str


@in_sentences("rs.linspace(0, 10, num=11)")
def linspace(start: float | str, stop: float | str, num: int) -> AxisRange:
    """`num` equally spaced values from start to stop, as an axis of a sweep; quantities of an arm such as "2
    kPa" too.
    """
    return _range(start, stop, num, "linear")


@in_sentences("rs.logspace(10, 1e6, num=31)")
def logspace(start: float | str, stop: float | str, num: int) -> AxisRange:
    """`num` values from start to stop with equal ratios, as an axis of a sweep.

    `start` and `stop` are the end values, as for NumPy's `geomspace`, not exponents.
    """
    return _range(start, stop, num, "log")


def _range(start: float | str, stop: float | str, num: int, spacing: str) -> AxisRange:
    """A range in the form of a config; InputError for a masked value."""
    for name, value in (("start", start), ("stop", stop), ("num", num)):
        if np.ma.is_masked(value):
            raise InputError(f"{name} is masked, so it is not a number")
    return {"start": start, "stop": stop, "num": num, "spacing": spacing}


def plain(value: Any) -> Any:
    """A value in Python types: arrays and tuples become lists, NumPy scalars numbers, paths text.

    pint quantities and arrays of them become text with their unit. Raises ValueError for masked values.
    """
    if isinstance(value, dict):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple | range):
        return [plain(item) for item in value]
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if hasattr(value, "to_base_units"):  # a pint quantity; np.asarray would drop its unit
        return _with_unit(plain(value.magnitude), f"{value.units:~C}")
    if np.ma.is_masked(value):
        raise ValueError("a value is masked, so it is not a number; leave it out")
    if hasattr(value, "__array__"):
        return np.asarray(value).tolist()
    return value


def plain_keyword(key: str, value: Any) -> Any:
    """`plain` of the value of a keyword; InputError, naming the key, for a masked value."""
    try:
        return plain(value)
    except ValueError as error:
        raise InputError(f"{key}: {error}") from None


def _with_unit(value: Any, unit: str) -> Any:
    """Appends a unit to a number, or to each number of a list; without a unit the value is unchanged."""
    if isinstance(value, list):
        return [_with_unit(item, unit) for item in value]
    return f"{value!r} {unit}" if unit else value
