"""k1 -> inf, k2 -> inf, gamma3 -> 0, one by one and all at once, approached and reached.

Known exactly: the first derivative of every eigenvalue and threshold by a compliance or the drag at its
limit (`hard.limits`), so that what is left of the difference to the limit falls like epsilon.

The one limit that is singular has a module of its own, `test_singular_pull`.
"""

from functools import cache
from math import inf

import mpmath as mp
import numpy as np
import pytest
from rods import rod_of

from rodsweep.model.rod import Rod
from rodsweep.solve.changes.status import ThresholdStatus
from rodsweep.solve.changes.threshold_kinds import ThresholdKind
from rodsweep.solve.changes.thresholds import ThresholdsRequest, solve_thresholds
from rodsweep.solve.modes.leading_modes import ModesRequest, solve_modes
from rodsweep.solve.spectrum.status import SpectrumStatus

from .adjoint import condition
from .exact import leading
from .limits import EPSILONS, PATHS, eigenvalue_slope, hopf_slope, onset_slope, rate_of, rod_on
from .promises import all_broken, not_ok, spectrum

BEND = 1e3
"""No more than this many epsilons of the first-order change may be the second-order one."""
DIGIT = 2.3e-16


def deviation(value, limit, slope, epsilon):
    """How far a change is from first order, and how much of that second order explains."""
    first = slope * rate_of(epsilon)
    return abs(value - limit - first), BEND * epsilon * abs(first)


@pytest.mark.parametrize("path", PATHS, ids=str)
def test_limits_and_rods_beside_them_keep_every_promise(path):
    rods = [rod_on(path, epsilon) for epsilon in (0.0, *EPSILONS)]
    assert all_broken(rods) == []
    assert not_ok(rods) == []


@pytest.mark.parametrize("path", PATHS, ids=str)
def test_spectra_leave_the_limit_at_first_order(path):
    limit = spectrum(rod_on(path, 0.0))
    slopes = np.array([complex(eigenvalue_slope(path, w)) for w in leading(rod_on(path, 0.0), 4)])
    for epsilon in EPSILONS:
        found = spectrum(rod_on(path, epsilon))
        off, bend = deviation(found.eigenvalues, limit.eigenvalues, slopes, epsilon)
        rounding = 10 * (found.error_estimate + limit.error_estimate) + DIGIT * abs(limit.eigenvalues)
        assert (off <= bend + rounding).all(), (epsilon, off / abs(slopes * epsilon))
        if epsilon >= 1e-10:  # the digits that are left show the slope, and not only that it is small
            assert (bend + rounding < 2e-3 * abs(slopes * epsilon)).all()


@cache
def thresholds(path, epsilon):
    _, k1, k2, gamma3 = rod_on(path, epsilon)
    return solve_thresholds(Rod(F=0.0, k1=k1, k2=k2, gamma3=gamma3), ThresholdsRequest(50.0, 1e-12, True, 16))


@pytest.mark.parametrize("path", [p for p in PATHS if p[0] > 0], ids=str)
def test_thresholds_leave_the_limit_at_first_order(path):
    limit = thresholds(path, 0.0)
    assert limit.status == ThresholdStatus.ok
    for i, there in enumerate(limit.thresholds[:2]):
        here = (there.value, *path[1:])
        if there.kind == ThresholdKind.onset:
            slope = float(mp.re(onset_slope(here, there.growth_rate)))
        else:
            slope = float(hopf_slope(here, 1j * there.frequency))
        for epsilon in EPSILONS:
            found = thresholds(path, epsilon)
            assert found.status == ThresholdStatus.ok, epsilon
            assert [c.kind for c in found.thresholds] == [c.kind for c in limit.thresholds]
            off, bend = deviation(found.thresholds[i].value, there.value, slope, epsilon)
            rounding = 10 * (found.thresholds[i].error + there.error) + DIGIT * there.value
            assert off <= bend + rounding, (epsilon, there.kind)
            if epsilon >= 1e-10:
                assert bend + rounding < 2e-2 * abs(slope * epsilon)


@cache
def conditions(path, epsilon):
    return solve_modes(rod_of(*rod_on(path, epsilon)), ModesRequest(2, 1e-10, 9, False))


@pytest.mark.parametrize("path", PATHS, ids=str)
def test_condition_numbers_leave_the_limit_at_first_order(path):
    """Their slope by a difference of exact condition numbers; at rest they are 1 on the whole path."""
    limit = conditions(path, 0.0)
    exact = [condition(rod_on(path, at), leading(rod_on(path, at), 4)[0]) for at in (0.0, 1e-10)]
    assert limit.status == SpectrumStatus.ok
    assert limit.mode_vectors.condition[0] == pytest.approx(float(exact[0]), rel=1e-10)
    slope = float((exact[1] - exact[0]) / rate_of(1e-10))
    for epsilon in EPSILONS:
        found = conditions(path, epsilon)
        assert found.status == SpectrumStatus.ok
        off, bend = deviation(
            found.mode_vectors.condition[0], limit.mode_vectors.condition[0], slope, epsilon
        )
        rounding = (
            10
            * (found.mode_vectors.condition_error[0] + limit.mode_vectors.condition_error[0])
            * limit.mode_vectors.condition[0]
        )
        assert off <= bend + rounding + 1e-12, epsilon


def test_all_limits_at_once_and_at_rest_give_the_cantilever():
    """cos b cosh b = -1, w = -b^4: reached, and approached to 1e14 (where the fourth is off by 3e-12)."""
    b = np.array([1.8751040687119612, 4.6940911329741746, 7.8547574382376126, 10.995540734875467])
    for rod in ((0.0, inf, inf, 0.0), (0.0, 1e14, 1e14, 1e-14), (1e-12, 1e14, 1e14, 1e-14)):
        found = spectrum(rod)
        assert (found.status, found.unstable_count) == (SpectrumStatus.ok, 0)
        assert found.eigenvalues.real == pytest.approx(-(b**4), rel=5e-12)
        assert (found.eigenvalues.imag == 0).all()
