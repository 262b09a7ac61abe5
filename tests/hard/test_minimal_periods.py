"""Random stiff rods from two starts: the same period from both, and no multiple of it.

A cycle born at a Hopf point has a first harmonic that leads; with two or three periods taken for one it would
vanish. A rod that is unstable when straight, as most of these are, must beat. The suite takes a few rods,
RODSWEEP_RODS as many as it says (`make survey`: several hundred).
"""

import os
from functools import cache

import numpy as np
import pytest
from rods import rod_of

from rodsweep.solve.cycle.limit_cycle import CycleRequest, CycleStatus, solve_cycle

RODS, BATCH = int(os.environ.get("RODSWEEP_RODS", "12")), 4
SETTLED = (CycleStatus.cycle, CycleStatus.straight)


def random_rod(index):
    """(F, k1, k2, gamma3, gamma1) of the rod of that number, whatever others are asked for."""
    random = np.random.default_rng([20261122, index])
    k1, F = 10 ** random.uniform(2, 8), random.uniform(20, 150)
    k2, gamma3, gamma1 = 10 ** random.uniform(1.5, 6), 10 ** random.uniform(-6, -1), random.uniform(0.5, 1)
    return min(F, 0.7 * k1), k1, k2, gamma3, gamma1


@cache
def found(rod, amplitude):
    return solve_cycle(rod_of(*rod), CycleRequest(1e-4, amplitude, 8, 0, 0, 0, 400))


@pytest.mark.parametrize("first", range(0, RODS, BATCH))
def test_periods_are_minimal_and_equal_from_both_starts(first):
    wrong = []
    for rod in map(random_rod, range(first, min(first + BATCH, RODS))):
        far, near = found(rod, 0.1), found(rod, 0.01)
        ends = {far.status, near.status}
        if not ends <= set(SETTLED) or (far.linear_growth_rate > 0 and ends != {CycleStatus.cycle}):
            wrong.append((rod, far.status.name, far.message, near.status.name, near.message))
        beating = [c for c in (far, near) if c.status == CycleStatus.cycle]
        if any(np.argmax(c.measures.harmonic_amplitude) != 0 for c in beating):
            wrong.append((rod, "harmonics", [c.measures.harmonic_amplitude.tolist() for c in beating]))
        if len(beating) == 2 and abs(far.measures.period / near.measures.period - 1) > 1e-3:
            wrong.append((rod, "periods", far.measures.period, near.measures.period))
    assert not wrong
