"""Spacing of the nodes of an element that varies along the element, as the radius of a cone does.

Waves are short where an arm is soft, so nodes are closer there. Fields are polynomials in the element's
coordinate t from 0 to 1, and the position v from 0 to 1 along the element is

    v(t) = (1 - s^t)/(1 - s),        dv/dt = -ln s/(1 - s) (1 - (1 - s) v):

the spacing is linear in v, from 1 to s = `spacing_ratio` in relative units. s = 1: v = t.
"""

import numpy as np

from ...arrays import Array


def positions_at_coordinates(t: Array, spacing_ratio: float) -> Array:
    """Positions v along an element, in [0, 1], at the coordinates t, in [0, 1]; an array of the shape of
    t."""
    if spacing_ratio == 1:
        return t
    v: Array = np.expm1(t * np.log(spacing_ratio)) / (spacing_ratio - 1)
    return v


def coordinates_at_positions(v: Array, spacing_ratio: float) -> Array:
    """Coordinates t of an element, in [0, 1], at the positions v, in [0, 1]; an array of the shape of v."""
    if spacing_ratio == 1:
        return v
    t: Array = np.log1p((spacing_ratio - 1) * v) / np.log(spacing_ratio)
    return t


def position_slopes(t: Array, spacing_ratio: float) -> Array:
    """dv/dt at the coordinates t of an element, in [0, 1]; an array of the shape of t."""
    if spacing_ratio == 1:
        return np.ones_like(t)
    slopes: Array = np.log(spacing_ratio) / (spacing_ratio - 1) * spacing_ratio**t
    return slopes


def node_spacing_ratios_of_halves(ratios: tuple[float, ...]) -> tuple[float, ...]:
    """Spacing ratios of the two halves of every element, element after element. The halves of an element with
    the ratio s have the ratios (1 + s)/2 and 2 s/(1 + s), because the spacing is linear in v."""
    return tuple(half for s in ratios for half in ((1 + s) / 2, 2 * s / (1 + s)))
