"""What Python has for the values of a config: ranges, arrays and paths, made plain as YAML would be read."""

import os
from typing import Any, TypedDict

import numpy as np

from ..config.document.call_arguments import in_sentences
from ..errors import InputError


class AxisRange(TypedDict):
    """A range of values as a config has it."""

    start: float | str
    stop: float | str
    num: int
    spacing: str


@in_sentences("rs.linspace(0, 10, num=11)")
def linspace(start: float | str, stop: float | str, num: int) -> AxisRange:
    """`num` values from start to stop, equally spaced: an axis of a sweep; of an arm also "2 kPa"."""
    return _range(start, stop, num, "linear")


@in_sentences("rs.logspace(10, 1e6, num=31)")
def logspace(start: float | str, stop: float | str, num: int) -> AxisRange:
    """`num` values from start to stop, in equal ratios: an axis of a sweep.

    `start` and `stop` are values, as NumPy's `geomspace` takes them, not exponents.
    """
    return _range(start, stop, num, "log")


def _range(start: float | str, stop: float | str, num: int, spacing: str) -> AxisRange:
    """A range; InputError where one of its numbers is masked."""
    for name, value in (("start", start), ("stop", stop), ("num", num)):
        if np.ma.is_masked(value):
            raise InputError(f"{name} is masked, so it is no number")
    return {"start": start, "stop": stop, "num": num, "spacing": spacing}


def plain(value: Any) -> Any:
    """A value without NumPy in it: arrays and tuples as lists, scalars as numbers, paths as text.

    Quantities of pint's, and arrays of them, become text with their unit. Raises ValueError for masked
    values: what lies under a mask is no number.
    """
    if isinstance(value, dict):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple | range):
        return [plain(item) for item in value]
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if hasattr(value, "to_base_units"):  # pint's, which NumPy would take the unit from
        return _with_unit(plain(value.magnitude), f"{value.units:~C}")
    if np.ma.is_masked(value):
        raise ValueError("a value is masked, so it is no number; leave it out")
    if hasattr(value, "__array__"):
        return np.asarray(value).tolist()
    return value


def _with_unit(value: Any, unit: str) -> Any:
    """A number or a list of numbers, each as text with a unit; as it is where there is none."""
    if isinstance(value, list):
        return [_with_unit(item, unit) for item in value]
    return f"{value!r} {unit}" if unit else value
