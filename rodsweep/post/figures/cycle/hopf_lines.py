"""The lines of Hopf points over two parameters, from the growth rates that a file holds."""

import numpy as np
from matplotlib.figure import Figure

from ....arrays import Array
from ....results.file.view import View
from ...hopf_points import hopf_points
from .point_map import PointMap, in_its_scale


def hopf_lines(points: PointMap, view: View) -> list[Array]:
    """The contours on which the leading growth rate is 0, each of shape (2, n): x, y.

    Rows are linear between their points and zeros, and between rows the growth rate is linear in the scale of
    y: so a contour passes through the zeros of every row, which `hopf_points` finds far better than the chord
    between two points does.
    """
    (x, x_back), (y, y_back) = (in_its_scale(values) for values in (points.x, points.y))
    growth, frequency = (
        view.variables[name].ravel()[points.at] for name in ("linear_growth_rate", "linear_frequency")
    )
    found = [hopf_points(x, *row) for row in zip(growth, frequency, strict=True)]
    zeros = [np.array([hopf.position for hopf in row]) for row in found]
    refined = np.unique(np.concatenate([x, *zeros]))
    rows = []
    for row, own in zip(growth, zeros, strict=True):
        nodes, first = np.unique(np.concatenate([x, own]), return_index=True)
        rows.append(np.interp(refined, nodes, np.concatenate([row, np.zeros_like(own)])[first]))
    if not np.nanmin(rows) < 0 < np.nanmax(rows):
        return []
    contours = Figure().subplots().contour(refined, y, np.ma.masked_invalid(rows), levels=[0.0])
    lines = (line for line in contours.allsegs[0] if len(line) > 1)
    return [np.array([x_back(line[:, 0]), y_back(line[:, 1])]) for line in lines]
