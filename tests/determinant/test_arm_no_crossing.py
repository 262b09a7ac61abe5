"""Lines that no unknown eigenvalue of a path of arms crosses: no hidden eigenvalue is missed."""

import numpy as np
import pytest
from reference.random_arms import random_arm
from surveyed import RODS

from rodsweep.determinant.arm.count.no_crossing import proves_no_crossing_of_arms, sampled_point_indices
from rodsweep.determinant.arm.count.settings import NO_CROSSING_SETTINGS
from rodsweep.determinant.parameter_path import ParameterPath
from rodsweep.solve.spectrum.path.arm_interval import follow_interval
from rodsweep.solve.spectrum.search import SpectrumRequest

REQUEST = SpectrumRequest(4, 1e-10, certify=True)
CHANGES = {"F": 0.6, "k1": 1.4, "k2": 1.4, "gamma3": 2.0, "taper": 1.2}
"""Parameters along which arms are followed: their last value over the first."""


def proves(path, found, line, ends, kept):
    """Whether no eigenvalue but those kept, by index, is proved to lie on a line between two points."""
    points = sampled_point_indices(*ends)
    known = found.track.w[points][:, kept], found.track.error[points][:, kept]
    rods = [path.rod_at(p) for p in found.p[points].tolist()]
    return proves_no_crossing_of_arms(line, rods, found.p[points], known, found.arm_family, found.hulls)


def followed_path(rng):
    """A random path of arms with its followed eigenvalues, at 20 points or more."""
    while True:
        rod = random_arm(rng)
        name = str(rng.choice(list(CHANGES)))
        path = ParameterPath(rod, name)
        ends = np.array([1.0, CHANGES[name]]) * getattr(rod, name)
        p = np.linspace(*(1 / ends if path.is_compliance_path else ends), 64)
        try:
            found = follow_interval(path, p, REQUEST)
        except ValueError:  # crushed before the end of the path
            continue
        if found is not None and len(found.p) >= 20:
            return path, found


@pytest.mark.parametrize("seed", range(RODS // 10 or 3))
def test_a_hidden_eigenvalue_that_crosses_the_line_is_never_missed(seed):
    rng = np.random.default_rng(7000 + seed)
    hidden = proved = 0
    while hidden < 20:
        path, found = followed_path(rng)
        w = found.track.w
        for k in range(w.shape[1]):
            first = int(rng.integers(len(w) - NO_CROSSING_SETTINGS.arm_count))
            last = min(len(w) - 1, first + int(rng.choice([4, 8, 16, 32])))
            here = w[first : last + 1, k]
            line = float(rng.uniform(here.real.min(), here.real.max()))
            if not np.ptp(here.real) > 1e-6 * np.abs(here).max() or line > 0:
                continue
            mates = [j for j in range(w.shape[1]) if (w[first, j] == here[0].conjugate())]
            kept = [j for j in range(w.shape[1]) if j != k and j not in mates]
            assert not proves(path, found, line, (first, last), kept), (path, found.p[[first, last]], line)
            hidden += 1
            everything = list(range(w.shape[1]))
            proved += proves(path, found, line, (first, last), everything)
    assert proved > hidden / 4  # the hidden eigenvalue is what prevents the proof
