"""The minimal period of a closed orbit, by the harmonics that it has.

An orbit that closes after T has the minimal period T/g, where g is the greatest common divisor of the numbers
of all its harmonics. The harmonics of the bending moments that stand out of the orbit's error are present for
sure; if they have no common divisor, T is proved to be minimal. If they have one, T/g is tried; where only
harmonics that may be errors speak for T, the period stays in doubt.
"""

from math import gcd

import numpy as np

from .shooting import FIRST_STEPS, Orbit, shoot

PRESENT = 1e-3
"""Share of the largest harmonic from which another one is taken for present before errors are known."""
CERTAIN = 10.0
"""Share of the largest harmonic, in units of the relative error of the extrema, that is no error for sure."""
LEAST_PRESENT = 1e-6
"""What is asked of a harmonic at least, whatever the error estimate, which is the tip's."""


def common_divisor(orbit: Orbit, present: float) -> int:
    """g of the harmonics larger than `present` times the largest; 1 proves that the period is minimal."""
    moments = orbit.run.states[:-1, 2 * orbit.beam.mesh.nodes :]
    sizes = np.linalg.norm(np.fft.rfft(moments, axis=0)[1:], axis=1)
    return gcd(*map(int, np.nonzero(sizes > present * sizes.max())[0] + 1))


def undecided_divisor(orbit: Orbit, error: float) -> int:
    """How many times shorter than the orbit's its period may be for all that is known; 1 is a proof.

    error: relative, of the extrema.
    """
    return common_divisor(orbit, max(CERTAIN * error, LEAST_PRESENT))


def shortened(orbit: Orbit) -> Orbit | None:
    """The orbit with the period that its harmonics have in common; None where it does not close then."""
    while (g := common_divisor(orbit, PRESENT)) > 1:
        steps = max(FIRST_STEPS, orbit.steps // g)
        shorter = shoot(orbit.beam, orbit.state, orbit.period / g, steps)
        if shorter is None:
            return None
        orbit = shorter
    return orbit
