"""Errors of the amplitude of a cycle near a Hopf point or a fold, where the amplitude depends on the
parameters of the rod like a square root.

There a multiplier mu is near 1: at a relative distance d from a Hopf point 1 - mu is proportional to d, and
rounding errors that displace this point by a relative eps change the amplitude by a relative eps/(2 d).
"""

from dataclasses import replace
from math import log

import numpy as np

from ....arrays import Complex
from ...orbit.measures import CycleMeasures
from ...orbit.newton import ConvergedOrbit
from .cycle_errors import CYCLE_ERROR_SETTINGS, CycleErrors

MIN_MULTIPLIER_DISTANCE_FROM_ONE = 2e-16
"""Smallest distance of a multiplier from 1: smaller distances are rounding errors of the multiplier."""


def relative_largest_y_rounding_error(solved: ConvergedOrbit) -> float:
    """Relative error of the largest y of the orbit `solved` on any mesh, due to rounding:
    `relative_rounding_error` divided by |m - 1|, m: the nontrivial multiplier over the period that is nearest
    to 1; 0 if there is no nontrivial multiplier."""
    multipliers = solved.matrix.multipliers_over_solved_time_interval
    if len(multipliers) < 2:
        return 0.0
    # The multiplier nearest to 1 is the trivial multiplier.
    distance = max(float(np.sort(np.abs(multipliers - 1))[1]), MIN_MULTIPLIER_DISTANCE_FROM_ONE)
    # A multiplier m over half of the period is m^2 over the period, twice as far from 1.
    period_parts = 2 if solved.orbit.is_symmetric else 1
    return CYCLE_ERROR_SETTINGS.relative_rounding_error / (period_parts * distance)


def with_largest_y_rounding_error(
    errors: CycleErrors, solved: ConvergedOrbit, measures: CycleMeasures
) -> CycleErrors:
    """The errors `errors` of the cycle `solved`, in which the errors of the extrema are at least the effect
    of rounding, `relative_largest_y_rounding_error`.

    Two meshes of a comparison share no rounding errors, but may agree by coincidence.
    """
    height_error = relative_largest_y_rounding_error(solved)
    extrema_error = height_error * max(1.0, measures.tip_theta_max / measures.tip_y_max)
    return replace(
        errors,
        amplitude_error=max(errors.amplitude_error, height_error),
        extrema_error=max(errors.extrema_error, extrema_error),
    )


def multiplier_change_per_relative_exponent(multipliers: Complex) -> float:
    """Change of the largest nontrivial multiplier mu per relative change of its exponent ln |mu|: |mu ln
    |mu||; 0 if there is no multiplier. multipliers: nontrivial, by descending modulus, (m,).

    Near a Hopf point the exponent is proportional to the squared amplitude. Its relative error is therefore
    twice the error of the amplitude, even if the multiplier agrees on two meshes by coincidence.
    """
    modulus = float(np.abs(multipliers[0])) if len(multipliers) else 0.0
    return modulus * abs(log(modulus)) if modulus else 0.0
