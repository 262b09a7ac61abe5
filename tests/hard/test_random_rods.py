"""Thousands of random rods: the certificate against a plain count.

The plain count is LAPACK's: all eigenvalues of an independent discretisation (`hard.integral_equation`). A
rod is left out only where that count is in doubt itself, because a finer mesh and another shift give another
one or move an eigenvalue as far as the line.
"""

from math import inf

import numpy as np
import pytest
from rods import rod_of
from surveyed import RODS

from rodsweep.determinant.certificate.winding_number import count_right_of

from .exact import SHIFT
from .integral_equation import coefficients_of, dense_eigenvalues, fastest_wave, nodes_for

RODS_A_SEED = 600
MOST_NODES, MOST_PULL = 64, 14.0
"""The force is halved until so many nodes resolve the most amplified wave; and a pull while sqrt(|F| g) is
larger, because its first eigenvalue, about exp(-sqrt(|F| g)), would drown in the dense solver's rounding."""
WIDE = 1e-3
"""Relative gap between real parts that a line is drawn through."""
SELDOM = 0.02


def random_rod(rng):
    """k1, k2 log-uniform, gamma3 as well, F uniform; each in its limit, and F negative, now and then."""
    k1, k2 = (inf if rng.random() < 0.1 else 10 ** rng.uniform(0, 10) for _ in range(2))
    gamma3 = 0.0 if rng.random() < 0.1 else 10 ** rng.uniform(-8, np.log10(30))
    F = rng.uniform(0, min(k1, 2000.0)) if rng.random() < 0.9 else -rng.uniform(0, 60.0)
    while too_much((F, k1, k2, gamma3)):
        F /= 2
    return F, k1, k2, gamma3


def too_much(rod):
    F, *_, g = coefficients_of(*rod)
    return nodes_for(rod) > MOST_NODES or (F < 0 and np.sqrt(abs(F * g)) > MOST_PULL)


def lines_of(w, rng):
    """The imaginary axis, and one line through a gap among the first eigenvalues."""
    gaps = [i for i in range(min(6, len(w) - 1)) if w[i].real - w[i + 1].real > WIDE * abs(w[i + 1])]
    here = rng.choice(gaps) if gaps else None
    return [0.0] + ([(w[here].real + w[here + 1].real) / 2] if gaps else [])


def in_doubt(rod, line, number, nodes, shift):
    """Whether two finer meshes disagree about the count, or move an eigenvalue as far as the line."""
    finer = [dense_eigenvalues(rod, nodes + more, shift * (1 + more / 50)) for more in (8, 16)]
    counts = {number, *(int((w.real > line).sum()) for w in finer)}
    if len(counts) > 1:
        return True
    nearest = finer[0][abs(finer[0].real - line).argmin()]
    return abs(finer[1] - nearest).min() > abs(nearest.real - line)


@pytest.mark.parametrize("seed", range(6 if RODS else 1))
def test_certified_counts_are_those_of_a_dense_solver(seed):
    rng = np.random.default_rng(seed)
    agreed, refused, doubtful, wrong = 0, [], [], []
    for _ in range(RODS_A_SEED):
        rod = random_rod(rng)
        nodes, shift = nodes_for(rod), SHIFT * fastest_wave(rod)[0]
        w = dense_eigenvalues(rod, nodes, shift)
        for line in lines_of(w, rng):
            number = int((w.real > line).sum())
            count = count_right_of(float(line), rod_of(*rod)).number
            if count == number:
                agreed += 1
            elif in_doubt(rod, line, number, nodes, shift):
                doubtful.append((rod, line, number, count))
            elif count is None:
                refused.append((rod, line))
            else:
                wrong.append((rod, line, number, count))
    total = agreed + len(refused) + len(doubtful)
    assert wrong == []
    assert total > 1.8 * RODS_A_SEED
    assert len(doubtful) < SELDOM * total, doubtful
    assert len(refused) < SELDOM * total, refused
