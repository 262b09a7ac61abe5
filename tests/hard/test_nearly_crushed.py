"""F -> k1: the straight rod is compressed to nu = 1 - F/k1 = 10^-j of its length.

Known exactly: every eigenvalue to 30 digits. In the partial beam limit (k2 = inf, gamma3 = 0) the rod is a
filament in disguise, w(F, k1) = W(F nu)/nu^2 with the spectrum W of the filament, so that eigenvalues grow
like 10^2j, and every threshold F of a rod has a mirror image k1 - F.
"""

from math import inf

import mpmath as mp
import numpy as np
import pytest

from rodsweep.model.rod import Rod
from rodsweep.solve.changes.status import ThresholdStatus
from rodsweep.solve.changes.threshold_kinds import ThresholdKind
from rodsweep.solve.changes.thresholds import ThresholdsRequest, solve_thresholds
from rodsweep.solve.spectrum.status import SpectrumStatus

from .exact import leading
from .promises import all_broken, not_ok, spectrum
from .rods import CRUSHED, PARTIAL_BEAMS, crushed


@pytest.mark.parametrize("rod", CRUSHED, ids=str)
def test_nearly_crushed_rods_keep_twelve_digits(rod):
    rods = crushed(*rod)
    assert all_broken(rods) == []
    assert not_ok(rods) == []


@pytest.mark.parametrize("k1", PARTIAL_BEAMS)
def test_nearly_crushed_partial_beams_keep_twelve_digits(k1):
    rods = crushed(k1, inf, 0.0)
    assert all_broken(rods) == []
    assert not_ok(rods) == []


@pytest.mark.parametrize("k1", PARTIAL_BEAMS)
def test_a_partial_beam_is_a_filament_in_disguise(k1):
    """F nu and nu as the floats of F and k1 have them; the filament's own spectrum at that force."""
    for rod in crushed(k1, inf, 0.0)[:6]:
        with mp.workdps(40):
            nu = 1 - mp.mpf(rod[0]) / mp.mpf(k1)
            force = float(rod[0] * nu)
        filament = spectrum((force, inf, inf, 0.0))
        assert filament.status == SpectrumStatus.ok
        scaled = filament.eigenvalues / float(nu) ** 2
        # The rounding of the force itself moves an eigenvalue by up to two of its units.
        assert np.abs(spectrum(rod).eigenvalues / scaled - 1).max() < 2e-14


def test_the_reference_obeys_the_disguise():
    with mp.workdps(40):
        straight, beam = leading((1.0, inf, inf, 0.0), 3), leading((2.0, 4.0, inf, 0.0), 3)
        assert max(abs(4 * a / b - 1) for a, b in zip(straight, beam, strict=True)) < mp.mpf(10) ** -25


def mirrored(k1, end):
    found = solve_thresholds(Rod(F=0.0, k1=k1, k2=inf, gamma3=0.0), ThresholdsRequest(end, 1e-10, True, 60))
    at = np.array([c.value for c in found.thresholds])
    assert at + at[::-1] == pytest.approx(np.full(len(at), k1), rel=1e-12)
    opposite = {
        ThresholdKind.onset: {ThresholdKind.real_again},
        ThresholdKind.hopf: {ThresholdKind.hopf_reverse, ThresholdKind.restabilization},
    }
    for first, last in zip(found.thresholds[: len(at) // 2], found.thresholds[::-1], strict=False):
        assert last.kind in opposite[first.kind]
    assert found.search_result.unstable_at_end == 0
    return found


@pytest.mark.parametrize(("k1", "changes"), [(100.0, 2), (160.0, 4), (1000.0, 6)])
def test_thresholds_of_a_partial_beam_mirror_each_other(k1, changes):
    """F (1 - F/k1) is the same at F and k1 - F: two thresholds for every one of the filament below k1/4."""
    found = mirrored(k1, 0.999 * k1)
    assert len(found.thresholds) == changes
    assert (found.status, found.search_result.is_proved) == (ThresholdStatus.ok, True)


@pytest.mark.parametrize("k1", [100.0, 160.0])
def test_thresholds_of_a_partial_beam_are_proved_up_to_the_crushed_end(k1):
    found = mirrored(k1, 2 * k1)
    assert (found.status, found.message) == (ThresholdStatus.ok, "")


def test_the_last_threshold_before_a_rod_is_crushed_keeps_its_digits():
    """k1 = 100, k2 = 1e4, gamma3 = 1e-4: at 0.989 k1 the pair is born again (30 digits)."""
    found = solve_thresholds(
        Rod(F=0.0, k1=100.0, k2=1e4, gamma3=1e-4), ThresholdsRequest(200.0, 1e-12, True, 16)
    )
    assert found.status == ThresholdStatus.ok
    assert found.end < 100.0
    assert found.thresholds[-1].kind == ThresholdKind.onset
    assert found.thresholds[-1].value == pytest.approx(98.9023098589847539, rel=1e-12)
