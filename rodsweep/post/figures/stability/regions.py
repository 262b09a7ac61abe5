"""Regions of a plane that curves bound: a pixel takes its class from points of its own region."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt, label
from scipy.spatial import cKDTree

from ....arrays import Array
from ..style import is_logarithmic

PIXELS = 900
"""Pixels along either axis: at 183 mm a fifth of a millimetre, half as much as the line that is drawn over a
boundary."""
STEP = 0.4
"""Pixels from a place to the next where a curve is drawn into the plane: below one it has no gap."""


@dataclass(frozen=True, slots=True)
class DrawnPlane:
    """A rectangle of two parameters from the first value of each to the last, in the scales of their axes."""

    x: Array
    y: Array

    def unit(self, x: Array, y: Array) -> Array:
        """Places, both of the shape (n,), as fractions of the axes, (n, 2): 0 and 1 are the edges."""
        columns = []
        for values, axis in ((x, self.x), (y, self.y)):
            if is_logarithmic(axis):
                with np.errstate(all="ignore"):  # a curve may leave the plane through 0
                    columns.append(np.log(values / axis[0]) / np.log(axis[-1] / axis[0]))
            else:
                columns.append((values - axis[0]) / (axis[-1] - axis[0]))
        return np.column_stack(columns)


@dataclass(frozen=True, slots=True)
class ClassedPlaces:
    """Places whose class is known, (n, 2), as fractions of the axes, and their classes, (n,)."""

    at: Array
    classes: NDArray[Any]

    def within(self, regions: NDArray[Any]) -> tuple["ClassedPlaces", NDArray[Any]]:
        """(those that lie in the plane, the region of each), by the region of every pixel."""
        inside = ((self.at >= 0) & (self.at <= 1)).all(axis=1)
        at = self.at[inside]
        return ClassedPlaces(at, self.classes[inside]), regions[tuple(_pixels(at).T)]


def coloured(computed: ClassedPlaces, further: ClassedPlaces, curves: Sequence[Array]) -> NDArray[Any]:
    """The class of each pixel, (PIXELS, PIXELS), lowest row first: that of the nearest point of its region.

    further: places for regions in which no point was computed; curves: the boundaries, each (m, 2), in
    fractions of the axes. A region without any place takes the class of the nearest computed point.
    """
    walls = np.zeros((PIXELS, PIXELS), bool)
    for curve in curves:
        row, column = _pixels(_dense(curve)).T
        walls[row, column] = True
    regions, count = label(~walls)
    known, region_of_known = computed.within(regions)
    sources = [(known, region_of_known), further.within(regions), (known, None)]
    table = np.zeros((PIXELS, PIXELS), computed.classes.dtype)
    for region in range(1, count + 1):
        pixels = np.nonzero(regions == region)
        for source, of_region in sources:
            own = np.full(len(source.at), True) if of_region is None else of_region == region
            if own.any():
                table[pixels] = _nearest(pixels, source.at[own], source.classes[own])
                break
    if walls.any() and not walls.all():
        nearest = distance_transform_edt(walls, return_distances=False, return_indices=True)
        table = table[tuple(nearest)]
    return table


def _nearest(pixels: tuple[NDArray[Any], ...], places: Array, classes: NDArray[Any]) -> NDArray[Any]:
    """The class of the point that is nearest to each pixel, (rows, columns) of the shape (n,) each."""
    if (classes == classes[0]).all():
        return classes[0]
    centres = (np.column_stack(pixels[::-1]) + 0.5) / PIXELS
    return classes[cKDTree(places).query(centres)[1]]


def _pixels(places: Array) -> NDArray[np.intp]:
    """(row, column) of the pixels in which places lie, (n, 2)."""
    return np.clip(places[:, ::-1] * PIXELS, 0, PIXELS - 1).astype(np.intp)


def _dense(curve: Array) -> Array:
    """The part of a curve, (n, 2), that lies in the plane, at places less than a pixel apart.

    Each piece is cut at the edges of the plane first: what lies outside may be a thousand times as long.
    """
    curve = curve[np.isfinite(curve).all(axis=1)]
    edge = 0.5 / PIXELS  # an end on the edge may lie outside by rounding
    steps = np.diff(curve, axis=0)
    with np.errstate(all="ignore"):  # along an axis a piece may not move, and is between its edges or is not
        crossed = np.stack([(bound - curve[:-1]) / steps for bound in (-edge, 1 + edge)])
    enters = np.maximum(crossed.min(axis=0).max(axis=1), 0)
    leaves = np.minimum(crossed.max(axis=0).min(axis=1), 1)
    pieces = [curve[:1]]
    for i in np.flatnonzero(enters <= leaves):
        share = leaves[i] - enters[i]
        count = int(share * np.abs(steps[i]).max() * PIXELS / STEP) + 1
        pieces.append(curve[i] + steps[i] * np.linspace(enters[i], leaves[i], count + 1)[:, None])
    places = np.concatenate(pieces)
    return places[((places > -edge) & (places < 1 + edge)).all(axis=1)]
