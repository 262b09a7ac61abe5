"""What the tip's paths on two meshes differ by."""

import numpy as np

from ...arrays import Array
from .measures import CyclePath
from .orbit import Orbit

PERIOD, HEIGHT, OTHERS, APART = range(4)
"""Places of the differences."""


def path_differences(rough: CyclePath, fine: CyclePath) -> Array:
    """Of the period, of the largest y, of the worst extremum, and of the whole paths, (4,).

    All are relative: the extrema and the largest distance of the paths in units of the largest y. Where the
    rods differ, on a branch that is followed, what they differ by counts as the period does.
    """
    apart = np.abs(fine.tip_samples - rough.resampled_tip(len(fine.tip_samples))).max()
    extrema = fine.extrema
    changes = {name: abs(value - extrema[name]) for name, value in rough.extrema.items()}
    size = abs(extrema["tip_y_max"])
    period = max(abs(rough.orbit.period / fine.orbit.period - 1), rods_apart(rough.orbit, fine.orbit))
    return np.array([period, *(np.array([changes["tip_y_max"], max(changes.values()), apart]) / size)])


def rods_apart(one: Orbit, other: Orbit) -> float:
    """The largest relative difference of their parameters."""
    a, b = (np.array([*orbit.form.rod.coefficients, orbit.form.rod.axial_drag]) for orbit in (one, other))
    return float(np.abs((a - b) / np.where(b == 0, 1, b)).max())
