"""Energy that is lost by the collocation in time, and the error of the amplitude of a cycle due to this loss.

Forces and drag balance over a period of the exact cycle. On a mesh the collocation loses some more energy:
with a linear law, each time interval loses the square of a norm of its truncation error. All these losses
have the same sign, so their sum does not vanish at single cycles of a chain. A signed error that is measured
by comparison with a finer mesh may vanish.
"""

import numpy as np

from ....arrays import Array, Complex
from ...orbit.newton import ConvergedOrbit


def energy_errors(found: ConvergedOrbit) -> Array:
    """Relative errors due to the time intervals, (2,): w/(2 E), and the estimated error of the amplitude.

    w: energy lost by the collocation in the solved part of the period. E: energy of the motion. E is
    proportional to the squared amplitude, so the loss w changes the amplitude by the fraction w/(2 E). A
    change of the amplitude decays at the rate |ln h| per part, h: the nontrivial multiplier of the slowest
    decay over the solved part. If w is lost at a constant rate, the amplitude has the error w/(2 E |ln h|).
    Near a fold or a Hopf point, where h = 1, this error is large.
    """
    orbit = found.orbit
    mean = orbit.means
    loss = abs(mean.injection_mean - mean.dissipation_mean) * orbit.duration
    # The squared energy norm is twice the elastic energy.
    twice_energy = float((orbit.form.energy_norm(orbit.regular_states) ** 2).mean())
    in_one_part = loss / twice_energy
    return np.array([in_one_part, in_one_part / _decay_in_one_part(found.matrix.partial_multipliers)])


def _decay_in_one_part(partial: Complex) -> float:
    """Smallest |ln h| of the nontrivial multipliers h; 1 if there is none. partial: multipliers over the
    solved part of the period, with the trivial multiplier, (rank,)."""
    exponents = np.sort(np.abs(np.log(partial[partial != 0])))[1:]  # the exponent of the trivial one is 0
    return float(exponents[0]) if len(exponents) else 1.0
