"""The one singular limit: gamma3 -> 0 where a pull exceeds the shear stiffness, g = nu + F c2 < 0.

Known exactly: for w = X/gamma3 and gamma3 -> 0 the inertia of y leaves s = -nu theta/c2, and theta'' =
(X + g nu k2) theta with theta(0) = theta'(1) = 0. So for every n with X_n = -g nu k2 - (pi (n - 1/2))^2 > 0
one unstable mode runs away to infinity like X_n/gamma3, with layers of width sqrt(gamma3); all other modes
tend to those of gamma3 = 0. No a-priori bound holds in the limit (docs/method.md): nothing is proved
there.
"""

import mpmath as mp
import numpy as np
import pytest
from reference import determinant as reference
from rods import rod_of
from surveyed import few

from rodsweep.determinant.certificate.winding_number import count_right_of
from rodsweep.solve.spectrum.search import SpectrumRequest, solve_spectrum
from rodsweep.solve.spectrum.status import SpectrumStatus

from .exact import leading, unstable
from .promises import all_broken, broken_promises, spectrum

PULLED = (-24.0, 1e4, 10.0)
DRAGS = [1.0, 1e-1, 1e-2, 1e-3, 1e-4]


def runaways(F, k1, k2):
    """The positive X_n."""
    nu = 1 - F / k1
    X = -(nu + F / k2) * nu * k2 - (np.pi * (np.arange(1, 50) - 0.5)) ** 2
    return X[X > 0]


def test_pulled_rods_with_drag_are_right_and_proved():
    rods = [(*PULLED, gamma3) for gamma3 in DRAGS]
    assert all_broken(rods) == []
    assert all(spectrum(rod).status == SpectrumStatus.ok for rod in rods)


@pytest.mark.parametrize("pull", [PULLED, (-12.0, 1e3, 4.0)], ids=str)
def test_one_mode_runs_away_as_the_drag_goes(pull):
    """w gamma3 -> X at the rate of the layer, sqrt(gamma3), and the second mode to that without drag."""
    (X,) = runaways(*pull)
    here = [spectrum((*pull, gamma3)).eigenvalues for gamma3 in (1e-3, 1e-4, 1e-5)]
    short = [X - w[0].real * gamma3 for w, gamma3 in zip(here, (1e-3, 1e-4, 1e-5), strict=True)]
    assert np.divide(short[:-1], short[1:]) == pytest.approx([10**0.5] * 2, rel=0.1)
    rest = spectrum((*pull, 0.0)).eigenvalues[0].real
    assert np.abs([w[1].real - rest for w in here]).max() < 1e-2 * rest


def test_the_count_falls_by_the_runaway_modes_in_the_limit_and_nothing_is_proved_there():
    rod = (*PULLED, 0.0)
    found = spectrum(rod)
    assert found.status in (SpectrumStatus.not_certified, SpectrumStatus.accuracy_not_reached)
    assert not found.certified
    assert broken_promises(rod) == []
    assert unstable((*PULLED, 1e-3)) - unstable(rod) == len(runaways(*PULLED)) == 1
    assert count_right_of(0.0, rod_of(*rod)).number is None
    assert abs(found.eigenvalues[0] / complex(leading(rod, 1)[0]) - 1) < 1e-14


@pytest.mark.parametrize("modes", [1, 2, 3])
@pytest.mark.parametrize("rod", [(-107.517, 2.5685, 1.8414, 5.096e-4), (-61.54, 2636.0, 0.4888, 0.002182)])
def test_few_modes_of_runaway_rods_start_from_a_mesh_that_has_their_layers(rod, modes):
    """The first of these rods had `failed` for one mode, `modes_missing` for two, and was ok for three."""
    found = solve_spectrum(rod_of(*rod), SpectrumRequest(modes, 1e-8, True))
    assert (found.status, found.certified) == (SpectrumStatus.ok, True)
    with mp.workdps(60):
        for w in found.eigenvalues:
            exact = reference.refine(mp.mpc(complex(w)), *rod)
            assert abs(exact - complex(w)) < 1e-13 * abs(exact)


@pytest.mark.long
@pytest.mark.parametrize("gamma3", few([1e-6, 1e-14], 1))
def test_next_to_the_limit_numbers_are_right_or_withheld(gamma3):
    """The layers outgrow every mesh in the end; the mode that is then missing must not go unnoticed."""
    found = spectrum((*PULLED, gamma3))
    if np.isfinite(found.eigenvalues).all():
        assert found.unstable_count in (2, -1)
        assert found.eigenvalues[0].real * gamma3 == pytest.approx(runaways(*PULLED)[0], rel=1e-2)
    else:
        assert found.status in (SpectrumStatus.failed, SpectrumStatus.modes_missing)
        assert (found.certified, found.unstable_count) == (False, -1)
