"""Lists of points in figures: conversion to a grid if the points form a grid, and axes with the number of the
point."""

from dataclasses import replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from ...model.arm.drag import DRAG_ESTIMATE_NAMES
from ...model.arm.quantities import ALL_QUANTITIES, ARM_SCALES
from ...model.units import with_si_prefix
from ...results.file.view import ResultView
from ..summary.arm.arm import quantity_words

DIMENSIONS_OF_ITEMS = ("mode", "u", "crossing")
"""Names of dimensions that are not dimensions of points; their length may equal the length of the list."""
MAX_LABELLED_POINTS = 12
"""With at most this number of points, every point has a tick label."""


def as_grid_if_possible(view: ResultView) -> ResultView:
    """The view as a grid, if the points of the list form a grid, in any order; else the view itself.

    The grid has at most two varied parameters, and each combination of the values of the parameters once.
    """
    if view.is_grid:
        return view
    columns = view.point_columns
    count = len(view.variables["point"])
    values = {name: np.unique(column, return_inverse=True) for name, column in columns.items()}
    sizes = tuple(len(unique) for unique, _ in values.values())
    flat_indices = np.ravel_multi_index([index.ravel() for _, index in values.values()], sizes)
    is_complete = np.prod(sizes) == count and len(np.unique(flat_indices)) == count
    if not is_complete or sum(size > 1 for size in sizes) > 2:
        return view
    order = np.argsort(flat_indices)
    variables = {name: data for name, data in view.variables.items() if name != "point"}
    for name, data in variables.items():
        if data.shape[:1] == (count,) and name not in DIMENSIONS_OF_ITEMS:
            variables[name] = data[order].reshape(*sizes, *data.shape[1:])
    variables |= {name: unique for name, (unique, _) in values.items()}
    return replace(view, variables=variables)


def shared_parameters(view: ResultView) -> dict[str, float]:
    """Parameters that are equal at all points, by name."""
    columns = view.point_columns
    return {name: float(column[0]) for name, column in columns.items() if len(np.unique(column)) == 1}


def label_point_numbers(axes: Axes, view: ResultView, point_count: int) -> None:
    """Labels the horizontal axis with the numbers of the points of a list, from 1.

    For an arm, the label names the varied quantities, in SI units; the tick labels of a short list are the
    values of these quantities.
    """
    axes.set_xlim(0.5, point_count + 0.5)
    axes.xaxis.set_major_locator(
        MaxNLocator(min(point_count, MAX_LABELLED_POINTS), integer=True, min_n_ticks=1)
    )
    varied_values = _varied_quantities(view)
    if varied_values and point_count <= MAX_LABELLED_POINTS:
        columns = zip(*(numbers for _, numbers in varied_values), strict=True)
        axes.set_xticks(np.arange(1, point_count + 1), ["\n".join(numbers) for numbers in columns])
        axes.set_xlabel("\n".join(name for name, _ in varied_values))
    else:
        range_texts = (f"{name}: {numbers[0]} to {numbers[-1]}" for name, numbers in varied_values)
        axes.set_xlabel("\n".join(["point of the list", *range_texts]))


def _varied_quantities(view: ResultView) -> list[tuple[str, list[str]]]:
    """Pairs (name with unit, values at the points as text), one pair for each quantity of an arm that
    varies."""
    quantities = view.quantities.items()
    varied = (
        (quantity_name, quantity_values)
        for quantity_name, quantity_values in quantities
        if quantity_name not in ARM_SCALES and len(np.unique(quantity_values)) > 1
    )
    return [_name_and_value_texts(name, values) for name, values in varied]


def _name_and_value_texts(name: str, values: np.ndarray) -> tuple[str, list[str]]:
    """Returns (name with unit, values as text) of the quantity `name`. values: (points,); for a drag, indices
    in DRAG_ESTIMATE_NAMES."""
    if name == "drag":
        return quantity_words(name), [DRAG_ESTIMATE_NAMES[int(value)].replace("_", " ") for value in values]
    unit = ALL_QUANTITIES[name].unit
    if unit == "1":
        return quantity_words(name), [f"{value:.4g}" for value in values]
    factor, unit = with_si_prefix(float(np.abs(values).max()), unit)
    return f"{quantity_words(name)} ({unit})", [f"{factor * value:.4g}" for value in values]
