"""Lists of points as figures take them: as a grid where they make up one, else point after point."""

from dataclasses import replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from ...results.file.view import View

BESIDE_POINTS = ("mode", "u", "crossing")
"""Coordinates of other dimensions, which may be as long as the list."""
FEW_POINTS = 12
"""Points of a list whose places along an axis are all labelled."""


def as_grid(view: View) -> View:
    """The grid that the points of a list make up, in whatever order; the view itself where they make up none.

    That is one of one or two parameters, each combination once, or a single point.
    """
    if view.is_grid:
        return view
    columns = view.point_columns
    count = len(view.variables["point"])
    values = {name: np.unique(column, return_inverse=True) for name, column in columns.items()}
    sizes = tuple(len(unique) for unique, _ in values.values())
    places = np.ravel_multi_index([place.ravel() for _, place in values.values()], sizes)
    if np.prod(sizes) != count or len(np.unique(places)) != count or sum(n > 1 for n in sizes) > 2:
        return view
    order = np.argsort(places)
    variables = {
        name: data[order].reshape(*sizes, *data.shape[1:])
        if data.shape[:1] == (count,) and name not in BESIDE_POINTS
        else data
        for name, data in view.variables.items()
        if name != "point"
    }
    variables |= {name: unique for name, (unique, _) in values.items()}
    return replace(view, variables=variables)


def shared_parameters(view: View) -> dict[str, float]:
    """The parameters that all points share, with their values."""
    columns = view.point_columns
    return {name: float(column[0]) for name, column in columns.items() if len(np.unique(column)) == 1}


def number_points(axes: Axes, count: int) -> None:
    """Makes an axis that of the points of a list, from 1, half a place free at both ends."""
    axes.set_xlim(0.5, count + 0.5)
    axes.xaxis.set_major_locator(MaxNLocator(min(count, FEW_POINTS), integer=True, min_n_ticks=1))
    axes.set_xlabel("point of the list")
