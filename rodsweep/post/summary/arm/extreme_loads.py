"""The arms with the smallest and the largest flutter load, and flutter as a force at the tip, in words."""

import numpy as np

from ....model.arm.quantities import SCALE_NAME
from ....results.file.view import View
from .arm import range_in_unit, region_of_arms

ANSWER_DIGITS = 3
"""Largest number of significant digits in an answer; a number with a large error has fewer digits."""


def flutter_force_line(view: View, rods: np.ndarray) -> list[str]:
    """Line with the range of the flutter forces at the tip, and with their extreme arms; empty if the load is
    a force, and if no arm flutters. rods: mask of the points with a result, (...,).

    Of two arms with tips of different size, the larger flutter pressure may be the smaller force.
    """
    forces = (view.variables["F_hopf"] * view.variables[SCALE_NAME["force"]])[rods]
    if view.load_kind == "force" or not np.isfinite(forces).any():
        return []
    extremes = extreme_arms_text(view, rods, forces, "smallest")
    text = range_in_unit(view, forces, "N", 0.0, ANSWER_DIGITS)
    return [f"flutter as a force at the tip: {text}{f', {extremes}' if extremes else ''}"]


def extreme_arms_text(view: View, rods: np.ndarray, loads: np.ndarray, smallest: str) -> str:
    """The arms with the smallest and with the largest load as text; empty for fewer than two loads. loads:
    loads of the points in the mask `rods`, (n,). smallest: words for the smallest load."""
    if np.isfinite(loads).sum() < 2:
        return ""
    places = np.flatnonzero(rods)
    ends = [places[found(loads)] for found in (np.nanargmin, np.nanargmax)]
    least, most = (region_of_arms(view, np.arange(rods.size) == end) for end in ends)
    return "" if least == most else f"{smallest} at {least}; largest at {most}"
