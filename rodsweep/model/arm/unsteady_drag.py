"""Phase lag of the drag on a bending filament in unsteady Stokes flow."""

from math import exp, log

import numpy as np
from numpy.typing import ArrayLike

from ...arrays import Array

MAX_SERIES_FREQUENCY = 1e-3
"""The mobility is computed from a power series for frequencies s below this number, in eta k^2/rho. At this
frequency the rounding error of the closed formula is 1e-11 of the phase lag, the truncation error of the
series less than 1e-12."""
LOWEST_SEARCHED_FREQUENCY = 1e-6
"""Lower end of the frequencies s among which `frequency_of_phase_lag` searches."""
PHASE_LAG_SUBINTERVAL_COUNT = 64
"""Number of subintervals into which `frequency_of_phase_lag` divides the current interval of ln s."""
PHASE_LAG_DIVISION_COUNT = 10
"""Number of divisions in `frequency_of_phase_lag`. 64^10 = 2^60 subintervals of an initial interval of width
20 to 30 reach rounding error with few calls on arrays."""


def drag_phase_lag(s: ArrayLike, logarithm: float) -> Array:
    """Phase lag, in radians, of the drag on a line of forces of wavenumber k in unsteady Stokes flow.

    s = rho omega/(eta k^2), any shape. logarithm: Lambda = 4 pi eta/gamma2.

    The mobility across the line is, with two-dimensional wave vectors q,

        int d^2q/(2 pi)^2 (q^2/2 + k^2)/(eta (q^2 + k^2) (q^2 + k^2 + i s k^2))
            = (Lambda - 1/2 - (1 - 1/(i s)) ln(1 + i s)/2)/(4 pi eta)

    In steady flow the mobility is Lambda/(4 pi eta). The phase lag, of the shape of s, is 3 s/(4 Lambda) for
    small s.
    """
    z = 1j * np.asarray(s, float)
    # In the closed formula 1/2 and -(1/z) log(1 + z)/2 cancel for small z.
    # nan where nothing moves; 1/z is not used at 0, and the series not where it overflows
    with np.errstate(all="ignore"):
        series_for_small_s = z * (3 / 4 - z * (5 / 12 - z * (7 / 24 - z * (9 / 40))))
        closed_formula = 0.5 + (1 - 1 / z) * np.log1p(z) / 2
    return np.asarray(
        # 0 minus the angle instead of -angle, which would be -0 at rest.
        0.0
        - np.angle(logarithm - np.where(z.imag < MAX_SERIES_FREQUENCY, series_for_small_s, closed_formula))
    )


def frequency_of_phase_lag(phase: float, logarithm: float) -> float:
    """Frequency s at which `drag_phase_lag` equals `phase` < pi/2, by repeated subdivision of the interval of
    ln s. logarithm: Lambda = 4 pi eta/gamma2."""
    low_log = log(LOWEST_SEARCHED_FREQUENCY)
    high_log = 2 * logarithm  # here the real part of the mobility is -1/2, so the phase is above pi/2
    for _ in range(PHASE_LAG_DIVISION_COUNT):
        # A call with 64 values costs little more than with one, so few wide divisions beat bisection.
        edges = np.linspace(low_log, high_log, PHASE_LAG_SUBINTERVAL_COUNT + 1)
        index = np.count_nonzero(drag_phase_lag(np.exp(edges[1:-1]), logarithm) < phase)  # the phase rises
        low_log = float(edges[index])
        high_log = float(edges[index + 1])
    return exp(high_log)
