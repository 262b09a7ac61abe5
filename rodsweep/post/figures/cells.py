"""Maps over two parameters: each point of a file is the centre of a cell, which has a colour or a hatch."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from numpy.typing import NDArray

from ...arrays import Array
from ...errors import InputError
from ...results.file.view import ResultView
from ..summary.selection import varied_parameters_at_points
from .grid_slices import infinite_values_clause
from .style import AXIS_LABELS, is_logarithmic, label_few_decades, label_outer_panels, scale_axis

LOGARITHMIC_COLOUR_RATIO = 10
"""The colours of a map are logarithmic if the ratio of the largest to the smallest value exceeds this
number."""


@dataclass(frozen=True, slots=True)
class PointGrid:
    """Points of a file that form a grid over two parameters."""

    names: tuple[str, str]
    """Names of the two parameters; the first is on the horizontal axis."""
    x: Array
    """Values of the first parameter in increasing order, (nx,)."""
    y: Array
    """Values of the second parameter in increasing order, (ny,)."""
    point_indices: NDArray[np.intp]
    """Index in the file of the point in each cell, (ny, nx)."""
    shared_parameters: dict[str, float]
    """Parameters that are equal at all points, by name."""
    omissions_clause: str
    """Clause on infinite values, which an axis cannot show; empty if all values are finite."""

    @property
    def edges(self) -> tuple[Array, Array]:
        """Edges of the cells along x, (nx + 1,), and along y, (ny + 1,)."""
        return cell_edges(self.x), cell_edges(self.y)


def point_grid(view: ResultView) -> PointGrid:
    """Points of a file as a map, without infinite values of the parameters. Raises InputError if the points
    do not form a grid over two parameters with at least two finite values each."""
    names = list(varied_parameters_at_points(view))
    if len(names) != 2:
        varied_clause = _varied_parameters_clause(names)
        raise InputError(f"{view.path}: a map is drawn over two parameters, and {varied_clause}")
    columns = view.point_columns
    (x, column), (y, row) = (np.unique(columns[name], return_inverse=True) for name in names)
    indices: NDArray[np.intp] = np.full((len(y), len(x)), -1)
    indices[row.ravel(), column.ravel()] = np.arange(row.size)
    if (indices < 0).any() or indices.size != row.size:
        raise InputError(
            f"{view.path} holds points that form no grid over {names[0]} and {names[1]}; a map needs every "
            "combination exactly once"
        )
    finite = np.isfinite(x), np.isfinite(y)
    if min(np.count_nonzero(is_finite) for is_finite in finite) < 2:
        raise InputError(
            f"{view.path} has fewer than two finite values of {names[0]} or {names[1]}; a map needs two of "
            "each"
        )
    omissions = infinite_values_clause(columns, names)
    constants = {name: float(values[0]) for name, values in columns.items() if name not in names}
    indices = indices[np.ix_(*finite[::-1])]
    return PointGrid((names[0], names[1]), x[finite[0]], y[finite[1]], indices, constants, omissions)


def varies_two_parameters_on_grid(view: ResultView) -> bool:
    """Whether the points of a file form a grid over two parameters."""
    try:
        point_grid(view)
    except InputError:
        return False
    return True


def _varied_parameters_clause(names: list[str]) -> str:
    """Clause on the varied parameters `names`, with a remedy, for a file in which not exactly two parameters
    vary."""
    if not names:
        return "no parameter varies"
    if names[1:]:
        return f"{', '.join(names)} vary; --at {names[-1]}=VALUE selects the points with one value"
    return f"only {names[0]} varies; without --what maps, lines over {names[0]} are drawn"


def axis_coordinates_and_inverse(values: Array) -> tuple[Array, Callable[[Array], Array]]:
    """Returns (coordinates, inverse): the values, (n,), on the linear or logarithmic scale of their axis, and
    the function that converts coordinates to values."""
    return (np.log(values), np.exp) if is_logarithmic(values) else (values, np.asarray)


def cell_edges(values: Array) -> Array:
    """Edges, (n + 1,), of the cells around increasing `values`, (n,): midpoints on the scale of the axis."""
    centres, from_coordinates = axis_coordinates_and_inverse(values)
    midpoints = (centres[1:] + centres[:-1]) / 2
    ends = (2 * centres[0] - midpoints[0], 2 * centres[-1] - midpoints[-1])
    return from_coordinates(np.array([ends[0], *midpoints, ends[1]]))


def cell_centres(edges: Array) -> Array:
    """Values, (n,), whose cells have the edges `edges`, (n + 1,): the inverse of `cell_edges` for a linear
    scale."""
    centres = np.empty(len(edges) - 1)
    centres[0] = (edges[0] + edges[1]) / 2
    for i in range(1, len(centres)):
        centres[i] = 2 * edges[i] - centres[i - 1]
    return centres


def draw_coloured_cells(
    axes: Axes,
    edges: tuple[np.ndarray, np.ndarray],
    values: np.ndarray,
    label: str,
    colours: str = "viridis",
    ratios: bool = True,
) -> None:
    """Draws coloured cells with a colour bar. edges: (nx + 1,) and (ny + 1,). values: (ny, nx); a cell with
    NaN has no colour. label: label of the colour bar. colours: name of the colour map.

    ratios: whether the colours are logarithmic if the values span more than a decade.
    """
    low = float(np.nanmin(values))
    high = float(np.nanmax(values))
    if ratios and high > LOGARITHMIC_COLOUR_RATIO * low > 0:
        norm: Normalize = LogNorm(low, high)
    else:
        # Equal zeros would give a scale below zero.
        norm = Normalize(low, high if high != low or low else 1.0)
    mesh = axes.pcolormesh(*edges, np.ma.masked_invalid(values), norm=norm, cmap=colours, rasterized=True)
    colorbar = axes.figure.colorbar(mesh, ax=axes, label=label)
    if isinstance(norm, LogNorm):
        label_few_decades(colorbar.ax.yaxis, low, high)


def fill_cells(axes: Axes, edges: tuple[Array, Array], is_filled: NDArray[np.bool_], **look: Any) -> None:
    """Fills or hatches the cells of the mask `is_filled`, (ny, nx), without a change of the limits of the
    axes. edges: edges of the cells, (nx + 1,) and (ny + 1,). look: keywords of matplotlib's PolyCollection; a
    label is a legend entry."""
    x, y = edges
    rows, columns = np.nonzero(is_filled)
    corners = ((0, 0), (0, 1), (1, 1), (1, 0))
    cells = np.stack(
        [np.column_stack([x[columns + right], y[rows + upper]]) for upper, right in corners], axis=1
    )
    if len(cells):
        axes.add_collection(PolyCollection(list(cells), lw=0, **look), autolim=False)


def new_map_panels(panel_count: int, is_stacked: bool, shares_y: bool = True) -> tuple[Figure, list[Axes]]:
    """Returns (figure, panels) with `panel_count` panels that share axes. is_stacked: whether the panels are
    stacked, not side by side. shares_y: whether the panels share the vertical axis, too."""
    # Side by side, the label of the first colour bar needs room.
    layout = ConstrainedLayoutEngine(wspace=0.0 if is_stacked else 0.06)
    size = (4.4, 3.1 * panel_count) if is_stacked else (4.8 * panel_count, 4.5)
    figure = Figure(figsize=size, layout=layout)
    shape = (panel_count, 1) if is_stacked else (1, panel_count)
    return figure, list(figure.subplots(*shape, sharex=True, sharey=shares_y, squeeze=False).ravel())


def label_maps(panels: Sequence[Axes], points: PointGrid) -> None:
    """Sets scales and labels of panels that share axes. Only panels at the left and at the bottom have
    labels."""
    for axes in panels:
        scale_axis(axes, "x", points.x)
        scale_axis(axes, "y", points.y)
        label_outer_panels(axes, *(AXIS_LABELS[name] for name in points.names))
