"""The proof that no eigenvalue is missing: it holds of complete lists, and of no list that lacks one."""

import numpy as np
import pytest
from reference.dense_arm import eigenvalues
from reference.random_arms import random_arm
from surveyed import RODS

from rodsweep.determinant.arm.completeness import (
    COMPLETENESS_SETTINGS,
    points_right_of_hull,
    prove_complete,
    sum_over_unknown_eigenvalues,
)
from rodsweep.determinant.arm.determinant import ArmDeterminant
from rodsweep.determinant.arm.hull.hull import hull_of
from rodsweep.determinant.arm.hull.region import EigenvalueHull
from rodsweep.determinant.arm.newton import refine_eigenvalue_and_error
from rodsweep.model.rod import Rod


def known_roots(rod, determinant, wanted):
    """(w, error) of so many leading eigenvalues, pairs whole: roots of D from another discretisation."""
    dense = eigenvalues(rod)[: wanted + 1].astype(complex)
    number = wanted + (dense[wanted - 1].imag > 0)
    upper = np.array(
        [refine_eigenvalue_and_error(complex(w), determinant)[0] for w in dense[:number] if w.imag >= 0]
    )
    w = np.append(upper, upper[upper.imag > 0].conj())
    return w, 1e-12 * np.abs(w)


@pytest.mark.parametrize("seed", range(max(6, RODS // 10)))
def test_lists_are_proved_complete_and_none_that_lacks_an_eigenvalue(seed):
    rng, proved = np.random.default_rng(3000 + seed), 0
    for _ in range(6):
        rod = random_arm(rng)
        determinant, hull = ArmDeterminant(rod), hull_of(rod)
        w, error = known_roots(rod, determinant, 8)
        line = min(np.sort(w.real)[-4] * (1 + 1e-6), 0.0)
        proved += prove_complete(line, w, error, determinant, hull)[0]
        for lacking in np.flatnonzero((w.real >= line) & (w.imag >= 0)):
            kept = (w != w[lacking]) & (w != w[lacking].conjugate())
            assert not prove_complete(line, w[kept], error[kept], determinant, hull)[0], (rod, rod.material)
    assert proved >= 3


def test_a_number_that_is_no_eigenvalue_proves_nothing():
    """It would make room for one that is missing, but R is then below 0 by as much as it contributes."""
    rod = Rod(F=15.0, k1=1e4, k2=1e4, gamma3=1e-4, taper=0.5)
    determinant, hull = ArmDeterminant(rod), hull_of(rod)
    w, error = known_roots(rod, determinant, 8)
    line = np.sort(w.real)[-4] - 1.0
    assert prove_complete(line, w, error, determinant, hull)[0]
    for false in (line + 2.0, -1.0, 0.5 * line):
        more = np.append(w, false)
        assert not prove_complete(line, more, np.append(error, 0.0), determinant, hull)[0]


@pytest.mark.parametrize("k", COMPLETENESS_SETTINGS.real_point_counts)
@pytest.mark.parametrize(
    "hull",
    [
        EigenvalueHull(0.0, 0.0),
        EigenvalueHull(7.0, 0.0),
        EigenvalueHull(7.0, 0.1),
        EigenvalueHull(300.0, 0.05),
    ],
)
def test_every_term_is_positive_in_the_hull_and_as_large_as_stated_right_of_the_line(k, hull):
    line = -1000.0
    points = points_right_of_hull(line, hull.a, hull.c, k)
    n = np.linspace(0, 400, 4001)
    share = np.linspace(0, 1, 21)[:, None]
    v = hull.a * n - (1 - hull.c) * n**2 + 1j * share * (hull.a * n + hull.c * n**2)
    phi = 1 / np.prod(points[:, None, None] - v, axis=0)
    assert (phi.real >= 0).all()
    rod = Rod(F=5.0, k1=1e4, k2=1e4, gamma3=1e-4, taper=0.5)
    none, level = np.empty(0, complex), ArmDeterminant(rod).propagators_for(points[-1])
    least = sum_over_unknown_eigenvalues(
        line, none, np.empty(0), hull, points, level
    ).min_unknown_contribution
    right = v.real >= line
    contribution = np.where(v.imag == 0, 1, 2) * phi.real
    assert least <= contribution[right].min() * (1 + 1e-12)
