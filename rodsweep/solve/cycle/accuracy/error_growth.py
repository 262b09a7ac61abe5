"""Growth of the errors of a mesh along a chain, from coefficient tails, sizes and error indicators."""

import numpy as np

from ....arrays import Array
from ...orbit.orbit import Orbit
from ...orbit.tails import smooth_tails
from .calibration_settings import CALIBRATION_SETTINGS
from .error_indicators import LAST_HARMONICS_INDEX


def tails_and_size(orbit: Orbit) -> Array:
    """Relative tails of an orbit in space and in time, not below a minimum, and size of the orbit, (3,)."""
    return np.append(np.maximum(smooth_tails(orbit), CALIBRATION_SETTINGS.min_tail), orbit.max_energy_norm)


def error_growth_factors(before: Array, after: Array) -> Array:
    """Estimated growth factors of the errors in space and in time between two orbits, (2,), at least 1.

    before, after: tails in space and in time, and size, of the earlier and of the later orbit, (3,) each.

    Absolute errors grow as the squares of the tails. Near the Hopf point where the cycles end, the error of
    the size also grows as the reciprocal of the squared size, because the mesh displaces the Hopf point.
    `indicator_growth` includes this factor for the errors in time. A predicted decrease is ignored.
    """
    # Errors are of second order in the tails.
    growth = np.maximum(squared_tail_growth(before, after), 1.0)
    growth[0] *= max((before[2] / after[2]) ** 2, 1.0)
    return growth


def squared_tail_growth(before: Array, after: Array) -> Array:
    """Growth factors of the squared absolute tails in space and in time between two orbits, (2,). before,
    after: relative tails and size, (3,) each."""
    change: Array = ((after * after[2] / (before * before[2])) ** 2)[:2]
    return change


def indicator_growth(before: Array, after: Array) -> tuple[float, float]:
    """Returns (growth of errors in time, growth of errors of extrema), between two orbits of a chain.

    before, after: `error_indicators` of both orbits, (3,) each. Errors in time grow with the lost energy or
    with the amplitude error due to this loss, whichever grows more; errors of extrema between the time nodes
    grow with the last harmonics of the path. The lost energy is the sum over all fields and intervals. The
    tail in time is not used, because the largest tail may belong to a field on which the cycle hardly
    depends.
    """
    growth = after / before
    return float(growth[:LAST_HARMONICS_INDEX].max()), float(growth[LAST_HARMONICS_INDEX])
