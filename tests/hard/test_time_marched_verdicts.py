"""Random rods below and far above their Hopf force: marching in time gives the same verdict and cycle.

The other code has nothing in common with the program: positions and an angle instead of stresses, NumPy and
SciPy's BDF instead of PETSc, and it waits until maxima repeat or the rod has faded. Between 0.96 and 1.05
times the Hopf force it would have to wait for long and is not asked. The suite takes a few rods, as many as
RODSWEEP_RODS says (`make survey`: 50).
"""

import os
from math import log10

import numpy as np
import pytest
from rods import rod_of

from rodsweep.solve.cycle.limit_cycle import CycleRequest, solve_cycle

from .cycles import first_hopf
from .displacement_form import Displaced, march

RODS, BATCH = int(os.environ.get("RODSWEEP_RODS", "4")), 2
AMPLITUDE, MOST_PERIODS = 0.1, 400
SETTLED = {"cycle", "straight"}
WITHIN = 1e-4
"""Relative, of period and largest y: maxima of the march count as equal within 4e-5. Of the first 50 rods the
worst was off by 1.2e-5, by 2e-7 on a finer mesh and with a smaller tolerance of the march."""


def random_rod(index):
    """(F, k1, k2, gamma3, gamma1) of the rod of that number, whatever others are asked for."""
    random = np.random.default_rng([50, index])
    k1, k2 = 10 ** random.uniform(log10(60), 5), 10 ** random.uniform(1.7, 5)
    gamma3, gamma1 = 10 ** random.uniform(-4, -0.5), random.uniform(0.5, 1)
    below = random.random() < 0.25
    share = random.uniform(0.4, 0.96) if below else 10 ** random.uniform(log10(1.05), log10(4))
    hopf = first_hopf(k1, k2, gamma3)
    return min(share * hopf if hopf else 20 * share, 0.8 * k1), k1, k2, gamma3, gamma1


def marched(rod):
    """The verdict of the other code, on a mesh that leaves 1e-6."""
    F, k1, k2, gamma3, gamma1 = rod
    order = int(14 + 1.4 * F**0.5)
    return march(Displaced(F, k1, k2, gamma3, gamma1, order), AMPLITUDE, MOST_PERIODS)


def disagreement(rod):
    """What the two say differently; empty where they agree."""
    found = solve_cycle(rod_of(*rod), CycleRequest(1e-6, AMPLITUDE, 3, 0, 0, 0, MOST_PERIODS))
    other = marched(rod)
    here = found.status.name
    if here != other.word or here not in SETTLED | {"left_the_model"}:
        return f"{here} ({found.message}), marched: {other}"
    if here != "cycle":
        return ""
    period = found.measures.period / other.period - 1
    height = found.measures.tip_y_max / other.tip_y_max - 1
    if max(abs(period), abs(height)) <= WITHIN:
        return ""
    return f"period {found.measures.period:.9g} is {period:.1e} off, largest y {height:.1e}; marched: {other}"


@pytest.mark.long
@pytest.mark.parametrize("first", range(0, RODS, BATCH))
def test_marching_in_time_comes_to_the_same_end(first):
    rods = [random_rod(index) for index in range(first, min(first + BATCH, RODS))]
    said = {rod: disagreement(rod) for rod in rods}
    assert {rod: words for rod, words in said.items() if words} == {}


@pytest.mark.long
def test_the_other_code_knows_the_eigenvalues_and_the_reference_cycle():
    """40-digit roots of D, and the cycle of docs/method.md."""
    w, _ = Displaced(27.4271941267593, 1e4, 1e2, 1e-2, 1.0, 18).leading_mode()
    assert w == pytest.approx(113.547607865j, abs=1e-6)
    found = march(Displaced(50.0, 1e4, 1e2, 1e-2, 1.0, 18), AMPLITUDE, MOST_PERIODS)
    assert found.word == "cycle"
    assert (found.period, found.tip_y_max) == pytest.approx((0.0344504294, 0.64518305), rel=1e-5)
