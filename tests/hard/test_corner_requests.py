"""What somebody tries first: no force, hardly any force, one mode, forty modes, modes that tie.

Known exactly: without force k1 plays no part and all is real; the cantilever's -b^4 with cos b cosh b = -1 in
the limits; with a force F = +-1e-12 the first derivative; every eigenvalue of every rod to 30 digits.
"""

from math import inf

import mpmath as mp
import numpy as np
import pytest

from rodsweep.solve.spectrum.status import SpectrumStatus

from .exact import derivatives, leading
from .promises import all_broken, broken_promises, not_ok, spectrum

CORNERS = [(k1, k2, gamma3) for k1 in (1e4, inf) for k2 in (20.0, inf) for gamma3 in (1e-2, 0.0)]
NEXT_TO_ALL_LIMITS = (30.0, 1e14, 1e14, 1e-14)
OVERTAKEN = (424.7068961055969, 2.2470358417416847, 0.00041823639524173143)
"""k1, k2, gamma3 of a pulled rod: its pair and its real eigenvalue have one real part near F = -4.939."""


@pytest.mark.parametrize("corner", CORNERS, ids=str)
def test_a_rod_at_rest_is_real_stable_and_does_not_know_its_stretch_stiffness(corner):
    k1, k2, gamma3 = corner
    rod = (0.0, *corner)
    found = spectrum(rod, 6)
    assert broken_promises(rod, 6) == []
    assert (found.status, found.unstable_count) == (SpectrumStatus.ok, 0)
    assert (found.eigenvalues.imag == 0).all()
    assert (found.eigenvalues.real < 0).all()
    assert np.array_equal(found.eigenvalues, spectrum((0.0, 3.0, k2, gamma3), 6).eigenvalues)


@pytest.mark.parametrize("corner", CORNERS, ids=str)
def test_a_trillionth_of_a_force_changes_the_spectrum_by_its_first_derivative(corner):
    """dw = -D_F/D_w dF, along the floats' rounding: 1e-12 is above it for none of the digits asked for."""
    for F in (1e-12, -1e-12, 1e-6):
        rod = (F, *corner)
        assert broken_promises(rod) == []
        found, rest = spectrum(rod), spectrum((0.0, *corner))
        assert (found.status, found.unstable_count) == (SpectrumStatus.ok, 0)
        for w, w0, exact in zip(found.eigenvalues, rest.eigenvalues, leading((0.0, *corner), 4), strict=True):
            first = float(mp.re(along(exact, (0.0, *corner), "F"))) * F
            assert abs(w - w0 - first) <= 1e-5 * abs(first) + 2e-15 * abs(w0)


@pytest.mark.long
@pytest.mark.parametrize("modes", [1, 2, 3, 40])
@pytest.mark.parametrize(
    "rod",
    [
        (0.0, inf, inf, 0.0),
        (30.0, 1e4, 1e4, 1e-4),
        (150.0, 200.0, 1e4, 1e-4),
        (9.0, 10.0, 0.5, 10.0),
        (-8.0, 1e4, 1e2, 1e-2),
        NEXT_TO_ALL_LIMITS,
    ],
    ids=str,
)
def test_one_mode_or_forty_are_the_leading_ones(rod, modes):
    assert broken_promises(rod, modes, 1e-10) == []
    assert not_ok([rod], modes, 1e-10) == []
    few = spectrum(rod, 1).eigenvalues[0]
    assert spectrum(rod, modes, 1e-10).eigenvalues[0] == pytest.approx(few, rel=1e-13)


def test_next_to_all_limits_at_once_is_the_limit():
    """1e14 stiffnesses and 1e-14 of drag move the four leading eigenvalues by less than 1e-11."""
    limit = spectrum((30.0, inf, inf, 0.0)).eigenvalues
    assert np.abs(spectrum(NEXT_TO_ALL_LIMITS).eigenvalues / limit - 1).max() < 1e-11
    assert all_broken([NEXT_TO_ALL_LIMITS, (30.0, 1e300, 1e300, 1e-300), (30.0, 1e308, 1e14, 0.0)]) == []
    assert not_ok([NEXT_TO_ALL_LIMITS, (30.0, 1e300, 1e300, 1e-300), (30.0, 1e308, 1e14, 0.0)]) == []


def tie():
    """The force at which the real part of the leading pair is the real eigenvalue, to 25 digits."""
    rod = (-4.939486265464671, *OVERTAKEN)
    w = leading(rod, 3)
    real, pair = (next(x for x in w if bool(mp.im(x)) == oscillates) for oscillates in (False, True))
    slopes = [mp.re(along(x, rod, "F")) for x in (real, pair)]
    return mp.mpf(rod[0]) - (real - mp.re(pair)) / (slopes[0] - slopes[1])


def along(w, rod, name):
    """dw/dname"""
    D_w, change = derivatives(w, rod, ("w", name))
    return -change / D_w


@pytest.mark.parametrize("modes", [1, 2, 3, 4])
def test_a_pair_and_a_real_mode_that_tie_are_all_there_in_either_order(modes):
    """Real parts that agree to all digits: which leads is rounding's to say, but none is lost or doubled."""
    F = tie()
    for offset in (0.0, 1e-14, -1e-14, 1e-12, -1e-12, 1e-9, -1e-9):
        rod = (float(F * (1 + offset)), *OVERTAKEN)
        assert broken_promises(rod, modes) == []
        assert spectrum(rod, modes).unstable_count == 0
        assert spectrum(rod, modes).status == SpectrumStatus.ok


def test_a_tie_is_one():
    w = leading((float(tie()), *OVERTAKEN), 3)
    assert max(abs(mp.re(x) - mp.re(w[0])) for x in w) < 1e-12 * abs(w[0])
    assert sorted(mp.im(x) != 0 for x in w) == [False, True, True]
