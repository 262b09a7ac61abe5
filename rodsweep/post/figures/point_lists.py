"""Lists of points in figures: conversion to a grid if the points form a grid, and axes with the number of the
point."""

from dataclasses import replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from ...results.file.view import ResultView
from ..summary.arm.arm_texts import varied_arm_quantities
from .arm.quantities import quantity_label_and_texts

DIMENSIONS_OTHER_THAN_POINTS = ("mode", "u", "crossing")
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
        if data.shape[:1] == (count,) and name not in DIMENSIONS_OTHER_THAN_POINTS:
            variables[name] = data[order].reshape(*sizes, *data.shape[1:])
    variables |= {name: unique for name, (unique, _) in values.items()}
    return replace(view, variables=variables)


def shared_parameters(view: ResultView) -> dict[str, float]:
    """Parameters that are equal at all points, by name."""
    columns = view.point_columns
    return {name: float(column[0]) for name, column in columns.items() if len(np.unique(column)) == 1}


def label_point_numbers(axes: Axes, view: ResultView, point_count: int) -> None:
    """Labels the horizontal axis with the numbers of the points of a list, from 1.

    For an arm, the label names the varied quantities, in the units typed by the user; the tick labels of a
    short list are the values of these quantities.
    """
    axes.set_xlim(0.5, point_count + 0.5)
    axes.xaxis.set_major_locator(
        MaxNLocator(min(point_count, MAX_LABELLED_POINTS), integer=True, min_n_ticks=1)
    )
    labels_and_texts = [
        quantity_label_and_texts(view, name, column) for name, column in varied_arm_quantities(view).items()
    ]
    if labels_and_texts and point_count <= MAX_LABELLED_POINTS:
        columns = zip(*(texts for _, texts in labels_and_texts), strict=True)
        axes.set_xticks(np.arange(1, point_count + 1), ["\n".join(texts) for texts in columns])
        axes.set_xlabel("\n".join(label for label, _ in labels_and_texts))
    else:
        range_texts = (f"{label}: {texts[0]} to {texts[-1]}" for label, texts in labels_and_texts)
        axes.set_xlabel("\n".join(["point of the list", *range_texts]))
