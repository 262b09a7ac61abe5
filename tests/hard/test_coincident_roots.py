"""Eigenvalues at w = -g nu/(c2 gamma3), where two of the four exponents q vanish together (P = 0).

The paper's Appendix C divides by what vanishes there, and z+ = z-. D itself has no singular point: the
eigenvalue is as well conditioned as its neighbours. Known exactly: gamma3 to 30 digits at which an eigenvalue
lies there, and the eigenvalue at the float nearest to it. (z+- = 0, where exponents coincide without
vanishing, is the most amplified wave, right of every eigenvalue: see `test_crowded_spectra`.)
With g = 0 (F = -k2 nu) all four exponents are roots of w alone, D = cosh sqrt(c2 w) cosh sqrt(gamma3 w), and
the spectrum is -(pi (n - 1/2))^2 times k2 and 1/gamma3; for k2 gamma3 = 1 every eigenvalue is double.
"""

from math import inf

import numpy as np
import pytest
from rods import rod_of
from surveyed import few

from rodsweep.determinant.certificate.winding_number import count_right_of
from rodsweep.model.rod import Rod
from rodsweep.solve.spectrum.status import SpectrumStatus

from .exact import leading
from .promises import all_broken, not_ok, spectrum
from .rods import COINCIDENT, coincident

OFFSETS = (0.0, 1e-15, -1e-15, 1e-13, -1e-12, 1e-10, -1e-9, 1e-7, 1e-4)
MODES = 6
NO_COUPLING = [
    (-20.0, inf, 20.0, 1 / 16),
    (-16.0, 16.0, 8.0, 1 / 4),
    (-20.0, inf, 20.0, 1e-9),
    (-20.0, inf, 20.0, 0.0),
    (-16.0, inf, 16.0, 1 / 64),
]


def rods_at(place):
    with_gamma3, guess, _ = place
    gamma3 = coincident(*with_gamma3, guess)
    return [(*with_gamma3, float(gamma3 * (1 + offset))) for offset in OFFSETS]


@pytest.mark.long
@pytest.mark.parametrize("place", few(COINCIDENT, 4), ids=lambda p: str(p[0]))
def test_an_eigenvalue_where_exponents_vanish_is_as_accurate_as_it_says(place):
    assert all_broken(rods_at(place), MODES) == []


@pytest.mark.parametrize("place", COINCIDENT, ids=lambda p: str(p[0]))
def test_an_eigenvalue_where_exponents_vanish_keeps_twelve_digits(place):
    assert not_ok(rods_at(place), MODES) == []


@pytest.mark.parametrize("place", COINCIDENT, ids=lambda p: str(p[0]))
def test_the_count_beside_an_eigenvalue_where_exponents_vanish_is_right(place):
    """A part in a thousand beside it; a part in a million beside it, it may be refused."""
    (F, k1, k2), _, index = place
    rod = rod_of(*rods_at(place)[0])
    there = -rod.g * rod.nu / (rod.c2 * rod.gamma3)
    assert abs(leading((F, k1, k2, rod.gamma3), MODES)[index] / there - 1) < 1e-12
    for offset, allowed in ((1e-3, ()), (1e-6, (None,))):
        assert count_right_of(there * (1 + offset), rod).number in (index + 1, *allowed)
        assert count_right_of(there * (1 - offset), rod).number in (index, *allowed)
    assert count_right_of(there, rod).number is None


@pytest.mark.parametrize(
    ("F", "k1", "k2", "gamma3"), [(30.0, 1e4, 1e2, 0.05), (5.0, 1e4, 10.0, 0.1), (-5.0, 50.0, 20.0, 0.3)]
)
def test_a_line_that_ends_where_exponents_vanish_counts_right_or_not_at_all(F, k1, k2, gamma3):
    rod = Rod(F=F, k1=k1, k2=k2, gamma3=gamma3)
    there = -rod.g * rod.nu / (rod.c2 * rod.gamma3)
    exact = sum(w.real > there for w in leading((F, k1, k2, gamma3), 9))
    assert exact < 9
    assert count_right_of(there, rod).number in (None, exact)
    for beside in (1 + 1e-3, 1 - 1e-3):
        assert count_right_of(there * beside, rod).number == exact


def decoupled(k2, gamma3, modes):
    n = np.arange(1, modes + 1)
    stiffnesses = [k2] + ([1 / gamma3] if gamma3 else [])
    return -np.sort(np.concatenate([(np.pi * (n - 0.5)) ** 2 * k for k in stiffnesses]))[:modes]


@pytest.mark.parametrize("rod", NO_COUPLING, ids=str)
def test_without_coupling_the_spectrum_is_a_closed_form(rod):
    found = spectrum(rod, MODES)
    assert (found.status, found.unstable_count) == (SpectrumStatus.ok, 0)
    assert found.elements == 1  # by the first Krylov vector, which moves and turns the tip, not by rounding
    assert found.eigenvalues == pytest.approx(decoupled(rod[2], rod[3], MODES), rel=1e-13)


@pytest.mark.parametrize("rod", [(-16.0, inf, 16.0, 1 / 16), (-16.0, 16.0, 8.0, 1 / 8)], ids=str)
def test_where_every_eigenvalue_is_double_no_digit_is_claimed_that_is_lost(rod):
    for accuracy in (1e-12, 1e-6):
        found = spectrum(rod, 4, accuracy)
        error = abs(found.eigenvalues - np.repeat(decoupled(rod[2], 0.0, 2), 2))
        assert (error <= 10 * found.error_estimate).all()
        assert (error < 1e-7 * abs(found.eigenvalues)).all()
        if accuracy == 1e-12:
            assert found.status == SpectrumStatus.accuracy_not_reached
        assert found.unstable_count == 0
