"""Smooth path of the tip through the shapes of an animation."""

import numpy as np
import scipy  # loads a subpackage at its first use

from ....arrays import Array

SEGMENTS_BETWEEN_SHAPES = 8
"""Number of straight segments that are drawn between two shapes. With 32 shapes on a closed path of the tip,
two segments enclose an angle of 1.4 degrees on average, and of 12 degrees at sharp turns."""


def smooth_tip_path(tips: Array, is_closed: bool) -> Array:
    """Smooth path, (vertices, 2), through the positions `tips` of the tip at equal time steps, (n, 2), with
    SEGMENTS_BETWEEN_SHAPES straight segments between two positions.

    Each coordinate is a cubic polynomial between two shapes, and its rate at a shape is the central
    difference of the neighbouring shapes, as on the page of `rodsweep explore`. is_closed: whether the last
    shape is followed by the first; the path then ends where it begins. Fewer than three tips are returned
    unchanged.
    """
    if len(tips) < 3:
        return tips
    if is_closed:
        knots = np.concatenate([tips, tips[:1]])
        slopes = np.gradient(np.concatenate([tips[-1:], knots, tips[1:2]]), axis=0)[1:-1]
    else:
        knots = tips
        slopes = np.gradient(tips, axis=0, edge_order=2)
    last = len(knots) - 1
    spline = scipy.interpolate.CubicHermiteSpline(np.arange(last + 1), knots, slopes)
    return np.asarray(spline(np.linspace(0, last, last * SEGMENTS_BETWEEN_SHAPES + 1)))
