"""Indicators of the errors of a cycle in time, and the growth of errors along a chain of cycles. The
indicators are the energy lost by the collocation, the error of the amplitude due to this loss, and the last
harmonics of the tip's path.

Forces and drag balance over a period of the exact cycle. On a mesh the collocation loses some more energy:
with a linear law, each time interval loses the square of a norm of its truncation error. All these losses
have the same sign, so their sum does not vanish at single cycles of a chain. A signed error that is measured
by comparison with a finer mesh may vanish.
"""

import numpy as np

from ....arrays import Array, Complex
from ...orbit.coefficient_tails import smooth_element_and_time_tails
from ...orbit.measures import CycleMotion
from ...orbit.newton import ConvergedOrbit
from ...orbit.orbit import Orbit
from .cycle_errors import CYCLE_ERROR_SETTINGS
from .settings import MESH_ERROR_CALIBRATION_SETTINGS

ENERGY_LOSS_INDEX, AMPLITUDE_ERROR_INDEX, LAST_HARMONICS_INDEX = range(3)
"""Indices into the array that `error_indicators` returns."""
LAST_HARMONIC_COUNT = 3
"""Number of last harmonics of the tip's path in the indicators. The path of a symmetric orbit has even
harmonics in x and odd harmonics in y and theta; only the slopes determine the very last harmonic."""


def error_indicators(solved: ConvergedOrbit, motion: CycleMotion) -> Array:
    """Indicators, (3,), of the errors due to the time intervals: w/(2 E), the estimated relative error of the
    amplitude, and the 2-norm of the last harmonics of the tip's path, divided by the largest y; not below
    `CYCLE_ERROR_SETTINGS.relative_rounding_error`. motion: motion of the orbit `solved`.

    w: energy lost by the collocation in the solved part of the period. E: energy of the motion. E is
    proportional to the squared amplitude, so the loss w changes the amplitude by the fraction w/(2 E). A
    change of the amplitude decays at the rate |ln h| per solved part, h: the nontrivial multiplier of the
    slowest decay over the solved part. If w is lost at a constant rate, the amplitude has the error w/(2 E
    |ln h|). Near a fold or a Hopf point, where h = 1, this error is large.
    """
    orbit = solved.orbit
    means = orbit.mean_powers_and_least_stretch
    # Over a period a cycle gains no energy, so the imbalance is the error of the collocation.
    lost_energy = abs(means.injection_mean - means.dissipation_mean) * orbit.solved_duration
    # The squared energy norm is twice the elastic energy.
    twice_energy = float((orbit.form.energy_norm(orbit.states_equidistant_in_mesh_time) ** 2).mean())
    relative_loss = lost_energy / twice_energy
    # A slowly attracting cycle is displaced farther by the same loss.
    amplitude_error = relative_loss / _slowest_decay_over_solved_time_interval(
        solved.matrix.multipliers_over_solved_time_interval
    )
    last_harmonics = float(np.linalg.norm(motion.last_tip_coefficients[-LAST_HARMONIC_COUNT:]))
    indicators = np.array(
        [relative_loss, amplitude_error, last_harmonics / abs(motion.tip_extrema["tip_y_max"])]
    )
    return np.maximum(indicators, CYCLE_ERROR_SETTINGS.relative_rounding_error)


def _slowest_decay_over_solved_time_interval(multipliers: Complex) -> float:
    """Smallest |ln h| of the nontrivial multipliers h; 1 without a nontrivial multiplier. multipliers:
    multipliers over the solved part of the period, with the trivial multiplier, (m,)."""
    exponents = np.sort(np.abs(np.log(multipliers[multipliers != 0])))[
        1:
    ]  # the exponent of the trivial multiplier is 0
    return float(exponents[0]) if len(exponents) else 1.0


def coefficient_tails_and_orbit_size(orbit: Orbit) -> Array:
    """Coefficient tails of an orbit relative to its size, in space for each element, then in time, and the
    size itself (largest energy norm), (elements + 2,). Tails are at least `min_coefficient_tail`."""
    tails = np.maximum(
        smooth_element_and_time_tails(orbit), MESH_ERROR_CALIBRATION_SETTINGS.min_coefficient_tail
    )
    return np.append(tails, orbit.max_energy_norm)


def error_growth_factors(earlier_tails: Array, later_tails: Array) -> Array:
    """Estimated growth factors of the errors in space and in time between two orbits, (2,), at least 1.

    earlier_tails, later_tails: `coefficient_tails_and_orbit_size` of the earlier and of the later orbit,
    (elements + 2,) each.

    Absolute errors grow as the squares of the tails. Near the Hopf point where the cycles end, the error of
    the size also grows as the reciprocal of the squared size, because the mesh displaces the Hopf point.
    The indicators include this factor for the errors in time. A predicted decrease is ignored.
    """
    # Errors are of second order in the tails.
    growth = np.maximum(squared_tail_growth(earlier_tails, later_tails), 1.0)
    # The error in space is relative to the size of the orbit; where the orbit shrinks, it grows.
    growth[0] *= max((earlier_tails[-1] / later_tails[-1]) ** 2, 1.0)
    return growth


def squared_tail_growth(earlier_tails: Array, later_tails: Array) -> Array:
    """Growth factors of the squared absolute tails in space and in time between two orbits, (2,). The growth
    in space is the largest of all elements, because the cycle may hardly depend on the element with the
    largest tail. earlier_tails, later_tails: `coefficient_tails_and_orbit_size` of both orbits, (elements +
    2,) each; of meshes with different numbers of elements, the largest tails in space are compared."""
    if len(earlier_tails) != len(later_tails):
        earlier_tails, later_tails = (
            np.append(tails[:-2].max(), tails[-2:]) for tails in (earlier_tails, later_tails)
        )
    earlier, later = (
        np.append(
            np.maximum(
                tails[:-2],
                MESH_ERROR_CALIBRATION_SETTINGS.min_tail_over_largest_element_tail * tails[:-2].max(),
            ),
            tails[-2:],
        )
        for tails in (earlier_tails, later_tails)
    )
    growth: Array = ((later * later[-1] / (earlier * earlier[-1])) ** 2)[:-1]
    return np.array([growth[:-1].max(), growth[-1]])
