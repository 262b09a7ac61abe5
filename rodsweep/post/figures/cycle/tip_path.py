"""Smooth path of the tip through the shapes of an animation."""

import numpy as np

from ....arrays import Array

SEGMENTS_BETWEEN_SHAPES = 8
"""Number of straight segments that are drawn between two shapes. With 32 shapes per return of the tip, two
segments enclose an angle of 1.4 degrees on average, and of 12 degrees at sharp turns."""


def smooth_tip_path(tips: Array, is_closed: bool) -> Array:
    """Path through the tips of shapes at equal distances in time, (n, 2): SEGMENTS_BETWEEN_SHAPES segments
    between two tips, (vertices, 2).

    Each coordinate is a cubic polynomial between two shapes, and its rate at a shape is the central
    difference of the neighbouring shapes. is_closed: whether the last shape is followed by the first; the
    path then ends where it begins. Otherwise the second difference at an end equals the second difference at
    the next shape. Fewer than three tips are returned unchanged.
    """
    if len(tips) < 3:
        return tips
    if is_closed:
        padded_tips = np.concatenate([tips[-1:], tips, tips[:2]])
    else:
        tip_before = 3 * (tips[0] - tips[1]) + tips[2]
        tip_after = 3 * (tips[-1] - tips[-2]) + tips[-3]
        padded_tips = np.concatenate([[tip_before], tips, [tip_after]])
    fraction = np.arange(SEGMENTS_BETWEEN_SHAPES)[:, None] / SEGMENTS_BETWEEN_SHAPES
    slopes = (padded_tips[2:] - padded_tips[:-2]) / 2
    start, end = padded_tips[1:-2, None], padded_tips[2:-1, None]
    start_slope, end_slope = slopes[:-1, None], slopes[1:, None]
    remainder = 1 - fraction
    points = (
        remainder**2 * (1 + 2 * fraction) * start
        + fraction**2 * (1 + 2 * remainder) * end
        + fraction * remainder * (remainder * start_slope - fraction * end_slope)
    )
    path: Array = np.concatenate([points.reshape(-1, 2), padded_tips[-2:-1]])
    return path
