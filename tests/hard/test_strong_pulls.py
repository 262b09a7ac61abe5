"""Eigenvalues under strong pulls, down to 1e-200, within their stated errors."""

import mpmath as mp
import numpy as np
import pytest
from reference import determinant as reference
from surveyed import RODS

from rodsweep.model.rod import Rod
from rodsweep.solve.spectrum.search import SpectrumRequest, solve_spectrum
from rodsweep.solve.spectrum.status import SpectrumStatus

BEYOND = [
    (-2288.3691490014203, 3675.4682588493315, np.inf, 3.63567192399217e-05),
    (-2635.7723460416864, 58.407018322825444, np.inf, 3.0854300445975757e-06),
    (-264.68698964141265, 163.69511011365498, np.inf, 0.12424162731933856),
    (-430.98237665584793, 23.13216331617521, 3530.769317993791, 0.0525468748181304),
    (-2435.396491691431, 36.2377642702722, np.inf, 0.0024668777254547563),
]
"""Rods whose leading eigenvalue was off by more than an earlier estimate: four by up to three times, without
the rounding error of the scale S of D, the last by twelve times, as the square of |w| = 3e-173 underflows."""


def random_pull(rng):
    """A rod under a pull of up to 1e4 that is not beyond the shear stiffness."""
    while True:
        k1, k2 = (float(10 ** rng.uniform(1, 5)) if rng.random() < 0.8 else np.inf for _ in range(2))
        gamma3 = float(10 ** rng.uniform(-6, 0)) if rng.random() < 0.8 else 0.0
        F = -float(10 ** rng.uniform(1, 4))
        if -0.9 * k2 < F:
            return F, k1, k2, gamma3


def check_errors(F, k1, k2, gamma3):
    """Asserts that all eigenvalues of a rod lie within their errors; whether they have any."""
    found = solve_spectrum(Rod(F=F, k1=k1, k2=k2, gamma3=gamma3), SpectrumRequest(4, 1e-10, certify=True))
    if found.status != SpectrumStatus.ok:
        return False
    for w, error in zip(found.eigenvalues.tolist(), found.error_estimate.tolist(), strict=True):
        if w.imag >= 0:
            with mp.workdps(40):
                exact = reference.refine(mp.mpmathify(w), F, k1, k2, gamma3, digits=30)
                assert abs(exact - mp.mpmathify(w)) <= error, (F, k1, k2, gamma3, w)
    return True


def test_an_eigenvalue_that_underflows_costs_no_other_eigenvalue():
    """The leading eigenvalue of this cone is about -1e-1977; the point failed with a division by zero. The
    others are those of collocation of the first-order system on 400 elements, to 4e-10."""
    cone = Rod(F=-176.0, k1=2e3, k2=5e4, gamma3=1e-4, taper=0.03)
    found = solve_spectrum(cone, SpectrumRequest(3, 1e-10, certify=True))
    assert found.status == SpectrumStatus.accuracy_not_reached
    assert abs(found.eigenvalues[0]) <= found.error_estimate[0]
    assert found.error_estimate[0] == np.nextafter(0, 1)
    assert found.eigenvalues[1:] == pytest.approx([-598.92142188, -2998.498347], rel=1e-9)


@pytest.mark.long
@pytest.mark.parametrize("rod", BEYOND)
def test_exponentially_small_eigenvalues_lie_within_their_errors(rod):
    assert check_errors(*rod)


@pytest.mark.long
def test_eigenvalues_under_random_pulls_lie_within_their_errors():
    rng = np.random.default_rng(31)
    solved = [check_errors(*random_pull(rng)) for _ in range(max(RODS, 20))]
    assert sum(solved) > len(solved) / 2
