"""The minimal period of an orbit, by the harmonics that it has.

An orbit that closes after T has the minimal period T/g, where g is the greatest common divisor of the numbers
of all its harmonics. The harmonics of the bending strain that stand out of the orbit's error are present for
sure; if they have no common divisor, T is proved to be minimal. If they have one, T/g is solved for; where
only harmonics that may be errors speak for T, the period stays in doubt.
"""

from dataclasses import replace
from math import gcd

import numpy as np

from ....arrays import Array
from ....model.compiled.compilation import compiled
from ...orbit.measures import CyclePath
from ...orbit.orbit import Orbit, node_times

PRESENT = 1e-3
"""Share of the largest harmonic from which another one is taken for present before errors are known."""
CERTAIN = 10.0
"""Share of the largest harmonic, in units of the relative error of the extrema, that is no error for sure."""
LEAST_PRESENT = 1e-6
"""What is asked of a harmonic at least, whatever the error estimate, which is the tip's."""


def common_divisor(path: CyclePath, present: float) -> int:
    """g of the harmonics larger than `present` times the largest; 1 proves that the period is minimal."""
    return int(_divisor_of(path.bending_harmonics, present))


@compiled
def _divisor_of(sizes: Array, present: float) -> int:
    """`common_divisor` of the harmonics of these sizes, from the first; 0 of none."""
    divisor, least = 0, present * sizes.max()
    for k in range(len(sizes)):
        if sizes[k] > least:
            divisor = gcd(divisor, k + 1)
    return divisor


def undecided_divisor(path: CyclePath, error: float) -> int:
    """How many times shorter than the orbit's its period may be for all that is known; 1 is a proof.

    error: relative, of the extrema.
    """
    return common_divisor(path, max(CERTAIN * error, LEAST_PRESENT))


def shortened(orbit: Orbit) -> Orbit:
    """The orbit over the period that its harmonics have in common, still to be solved for."""
    g = common_divisor(CyclePath(orbit), PRESENT)
    if g == 1:
        return orbit
    times = node_times(orbit.intervals, orbit.stages)
    # An even divisor of a symmetric orbit would contradict its symmetry: its harmonics are odd and even.
    return replace(orbit, values=np.append(orbit.at(times / g), orbit.period / g))
