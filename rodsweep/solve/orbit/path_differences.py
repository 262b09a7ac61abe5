"""Differences between the paths of the tip in two solutions of a cycle, on two meshes."""

import numpy as np

from ...arrays import Array
from ...model.parameters import PARAMETERS
from ...model.rod import Rod
from .measures import CyclePath
from .orbit import Orbit

PERIOD_CHANGE, LARGEST_Y, WORST_EXTREMUM, WHOLE_PATH = range(4)
"""Indices into the array that `path_differences` returns."""


def path_differences(rough: CyclePath, fine: CyclePath) -> Array:
    """Differences of two paths, (4,): period, largest y, extremum with the largest difference, whole path of
    the tip.

    The period's difference is relative; the other three are in units of the largest y. On a branch the two
    rods may differ, too; the relative difference of their parameters then counts as a difference of the
    period.
    """
    apart = np.abs(fine.tip_samples - rough.resampled_tip(len(fine.tip_samples))).max()
    extrema = fine.extrema
    changes = {name: abs(value - extrema[name]) for name, value in rough.extrema.items()}
    size = abs(extrema["tip_y_max"])
    period = max(abs(rough.orbit.period / fine.orbit.period - 1), rod_difference(rough.orbit, fine.orbit))
    return np.array([period, *(np.array([changes["tip_y_max"], max(changes.values()), apart]) / size)])


def rod_difference(one: Orbit, other: Orbit) -> float:
    """Largest relative difference between the parameters of the rods of two orbits."""
    a, b = (_numbers(orbit.form.rod) for orbit in (one, other))
    # A coefficient of 0 is a limit, such as c1 = 0, in which both rods agree exactly.
    return float(np.abs((a - b) / np.where(b == 0, 1, b)).max())


def _numbers(rod: Rod) -> Array:
    """Coefficients in the equations of a uniform rod, or coordinates of all parameters of an arm, (n,)."""
    if rod.standard:
        return np.array([*rod.coefficients, rod.axial_drag])
    return np.array([rod.coordinate(name) for name in PARAMETERS])
