"""Regions of a plane that are bounded by curves. Each pixel has the class of a known point in the same
region."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy  # loads a subpackage at its first use
from numpy.typing import NDArray

from ....arrays import Array
from ..style import is_logarithmic

PIXEL_COUNT = 900
"""Number of pixels along each axis. In a figure of 183 mm width a pixel measures 0.2 mm, half the width of
the line that is drawn over a boundary."""
CURVE_WIDTH_IN_PIXELS = 2
"""Width, in pixels, of the line that is drawn over a boundary."""
CURVE_POINT_DISTANCE_IN_PIXELS = 0.4
"""Distance, in pixels, between points of a boundary; with a distance below 1 the boundary has no gap."""


@dataclass(frozen=True, slots=True)
class DrawnPlane:
    """Rectangle of a plane. x, y: values along the axes; the first and last values are the edges."""

    x: Array
    y: Array

    def fractions_of_axes(self, x: Array, y: Array) -> Array:
        """Points as fractions of the axes, (n, 2), with 0 and 1 at the edges, linear or logarithmic as the
        axes. x, y: coordinates, (n,) each."""
        columns = []
        for values, axis in ((x, self.x), (y, self.y)):
            if is_logarithmic(axis):
                with np.errstate(all="ignore"):  # outside the plane a curve may reach 0
                    columns.append(np.log(values / axis[0]) / np.log(axis[-1] / axis[0]))
            else:
                columns.append((values - axis[0]) / (axis[-1] - axis[0]))
        return np.column_stack(columns)

    @staticmethod
    def coordinates_at_fractions(axis: Array, fractions: Array) -> Array:
        """Coordinates, (n,), at fractions, (n,), of the axis with the values `axis`."""
        if is_logarithmic(axis):
            return np.asarray(axis[0] * (axis[-1] / axis[0]) ** fractions)
        return np.asarray(axis[0] + (axis[-1] - axis[0]) * fractions)

    @classmethod
    def pixel_centres(cls, axis: Array) -> Array:
        """Coordinates of the centres of pixels along the axis with the values `axis`, (PIXEL_COUNT,)."""
        return cls.coordinates_at_fractions(axis, (np.arange(PIXEL_COUNT) + 0.5) / PIXEL_COUNT)


@dataclass(frozen=True, slots=True)
class ClassifiedPoints:
    """Points of a plane with known classes, for example stability classes. axis_fractions: positions as
    fractions of the two axes, (n, 2). classes: numbers of the classes, (n,)."""

    axis_fractions: Array
    classes: NDArray[Any]

    def points_and_regions_inside(self, regions: NDArray[Any]) -> tuple["ClassifiedPoints", NDArray[Any]]:
        """Returns (points inside the plane, number of the region of each of these points). regions: number of
        the region of each pixel, (PIXEL_COUNT, PIXEL_COUNT)."""
        is_inside = ((self.axis_fractions >= 0) & (self.axis_fractions <= 1)).all(axis=1)
        inside = ClassifiedPoints(self.axis_fractions[is_inside], self.classes[is_inside])
        return inside, regions[tuple(_pixels_of_points(inside.axis_fractions).T)]


def pixel_classes(
    computed: ClassifiedPoints,
    row_points: ClassifiedPoints,
    curves: Sequence[Array],
    closed: NDArray[Any],
    undecided: int,
) -> NDArray[Any]:
    """Class of each pixel, (PIXEL_COUNT, PIXEL_COUNT): the class of the nearest point in the same region.

    The lowest row of pixels comes first. row_points: points that are used in regions without a point of
    `computed`. curves: boundaries as fractions of the axes, (m, 2) each. closed: mask of pixels that belong
    to no region, (PIXEL_COUNT, PIXEL_COUNT). A region without any point has the class `undecided`, or, if the
    lines over its boundary cover it, the class of the nearest computed point.
    """
    walls = scipy.ndimage.binary_dilation(closed)
    for curve in curves:
        row, column = _pixels_of_points(_dense_curve_points(curve)).T
        walls[row, column] = True
    regions, count = scipy.ndimage.label(~walls)
    computed_points, computed_regions = computed.points_and_regions_inside(regions)
    sources = [
        (computed_points, computed_regions),
        row_points.points_and_regions_inside(regions),
        (computed_points, None),
    ]
    table = np.full((PIXEL_COUNT, PIXEL_COUNT), undecided, computed.classes.dtype)
    distance_to_wall = scipy.ndimage.distance_transform_edt(~walls) if walls.any() else None
    for region in range(1, count + 1):
        pixels = np.nonzero(regions == region)
        is_visible = distance_to_wall is None or distance_to_wall[pixels].max() > CURVE_WIDTH_IN_PIXELS
        for source, of_region in sources:
            if of_region is None and is_visible:
                break
            is_inside = (
                np.full(len(source.axis_fractions), True) if of_region is None else of_region == region
            )
            if is_inside.any():
                known = (source.axis_fractions[is_inside], source.classes[is_inside])
                table[pixels] = _nearest_classes(pixels, *known)
                break
    if walls.any() and not walls.all():
        _, nearest_pixels = scipy.ndimage.distance_transform_edt(walls, return_indices=True)
        table = table[tuple(nearest_pixels)]
    return table


def _nearest_classes(pixels: tuple[NDArray[Any], ...], points: Array, classes: NDArray[Any]) -> NDArray[Any]:
    """Class of the point nearest to each pixel, (n,). pixels: (row, column), (n,) each. points: points as
    fractions of the axes, (m, 2). classes: classes of the points, (m,)."""
    if (classes == classes[0]).all():
        return classes[0]
    centres = (np.column_stack(pixels[::-1]) + 0.5) / PIXEL_COUNT
    return classes[scipy.spatial.cKDTree(points).query(centres)[1]]


def _pixels_of_points(points: Array) -> NDArray[np.intp]:
    """(row, column) of the pixels that contain the points, (n, 2). points: fractions of the axes, (n, 2)."""
    return np.clip(points[:, ::-1] * PIXEL_COUNT, 0, PIXEL_COUNT - 1).astype(np.intp)


def _dense_curve_points(curve: Array) -> Array:
    """Points, (m, 2), less than a pixel apart, on the part of a curve that lies inside the plane. curve:
    vertices, (n, 2). Each segment is first cut at the edges of the plane, because a segment may be a thousand
    times longer than the plane."""
    curve = curve[np.isfinite(curve).all(axis=1)]
    half_pixel = 0.5 / PIXEL_COUNT  # rounding may move an end from the edge to the outside
    steps = np.diff(curve, axis=0)
    with np.errstate(all="ignore"):  # a segment parallel to an axis gives infinities, which are correct
        crossed = np.stack([(bound - curve[:-1]) / steps for bound in (-half_pixel, 1 + half_pixel)])
    entry = np.maximum(crossed.min(axis=0).max(axis=1), 0)
    exit_ = np.minimum(crossed.max(axis=0).min(axis=1), 1)
    point_parts = [curve[:1]]
    for i in np.flatnonzero(entry <= exit_):
        inner_fraction = exit_[i] - entry[i]
        count = (
            int(inner_fraction * np.abs(steps[i]).max() * PIXEL_COUNT / CURVE_POINT_DISTANCE_IN_PIXELS) + 1
        )
        point_parts.append(curve[i] + steps[i] * np.linspace(entry[i], exit_[i], count + 1)[:, None])
    points = np.concatenate(point_parts)
    return points[((points > -half_pixel) & (points < 1 + half_pixel)).all(axis=1)]
