"""The errors that the cycles of a chain state against their true ones: chains of random rods.

On a chain a mesh's errors are calibrated at one point and go on by the tails of the orbits. True errors are
by a mesh that is far finer (`test_cycle_errors` says why that is right).
"""

import os

import numpy as np
import pytest

from rodsweep.solve.point import Unsolvable

from .cycles import Case, broken_promises, chain_of, first_hopf, random_case

CHAINS, BATCH, POINTS = max(3, int(os.environ.get("RODSWEEP_RODS", "6")) // 5), 3, 10
STEPS = {"F": (1.003, 1.05), "k2": (0.9, 1.1)}
"""Ratios of successive values."""


def chain(index):
    """Of that number: a rod, what is followed, and in which steps."""
    random = np.random.default_rng([15, index])
    case = random_case(1000 + index)
    parameter = "F" if random.random() < 0.5 or np.isinf(case.k2) else "k2"
    return case, parameter, float(random.uniform(*STEPS[parameter]))


@pytest.mark.parametrize("first", range(0, CHAINS, BATCH))
def test_cycles_of_random_chains_keep_their_promises(first):
    wrong, followed = [], 0
    for index in range(first, min(first + BATCH, CHAINS)):
        case, parameter, ratio = chain(index)
        hopf = first_hopf(case.k1, case.k2, case.gamma3)
        if hopf is None or hopf * case.beyond * ratio**POINTS >= 0.99 * case.k1:
            continue
        try:
            cycles = list(chain_of(case, parameter, ratio, POINTS))
        except Unsolvable:  # at its first point, which `test_cycle_errors` is about
            continue
        followed += len(cycles)
        for place, found in enumerate(cycles):
            broken = broken_promises(found, case.accuracy)
            if broken:
                wrong.append((index, place, case, parameter, ratio, broken))
    assert wrong == []
    assert followed > 0


def test_error_that_changes_its_sign_where_it_is_measured_is_not_believed():
    """The error in time of the period is small at one cycle, and as large as before two cycles later."""
    rod = (np.inf, 3653.326612087487, 0.38416323905216987, 26.630693011029624)
    case = Case(*rod, beyond=2.5100148543047274, accuracy=1.63e-8)
    cycles = list(chain_of(case, "F", 1.0482541621611525, 8))
    assert len(cycles) == 8
    assert [broken_promises(found, case.accuracy) for found in cycles] == [[]] * 8
