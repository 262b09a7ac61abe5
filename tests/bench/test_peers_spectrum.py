"""The peers of the spectrum: each converges to the exact eigenvalues, and loses what its form loses."""

import pytest

from benchmarks.spectrum import peers
from benchmarks.spectrum.eigensolvers import (
    PEERS,
    arm_contenders,
    chebyshev_first_order,
    dense_inverse,
    displacement_elements,
)
from rodsweep.bench.spectrum.arm_spectra import (
    ARM_RODS,
    ARM_SPECTRUM_RACE_NAME,
    UncachedArms,
    exact_arm_spectrum,
)
from rodsweep.bench.spectrum.rodsweep_and_exact_spectra import MODE_COUNT, exact_spectrum, relative_error
from rodsweep.bench.spectrum.study import HARD_RODS, SPECTRUM_RACE_NAME
from rodsweep.bench.study import grouped_by_fields
from rodsweep.model.rod import Rod

EASY = Rod(F=30.0, k1=1e4, k2=1e4, gamma3=1e-4)


@pytest.mark.parametrize("peer", PEERS, ids=lambda peer: peer.name)
def test_every_peer_converges_to_the_exact_eigenvalues(peer):
    """Spectrally: two sizes farther the error is a hundredth, until rounding; at its best below 1e-9."""
    roots = exact_spectrum(EASY, MODE_COUNT)
    errors = [relative_error(peer.solve(EASY, size), roots) for size in peer.sizes]
    assert min(errors) < 1e-9
    coarse = [error for error in errors if error > 1e-8]
    assert all(later < earlier / 10 for earlier, later in zip(coarse[:-1], coarse[1:], strict=True))


@pytest.mark.long
@pytest.mark.parametrize("rod", ARM_RODS.values(), ids=list(ARM_RODS))
def test_peers_of_arms_converge_to_the_exact_eigenvalues(rod):
    roots = exact_arm_spectrum(rod)
    for (name,), own in grouped_by_fields(arm_contenders(), "method").items():
        errors = [relative_error(contender.run(UncachedArms(rod)), roots) for contender in own]
        assert min(errors) < 1e-10, name
        assert errors[0] > 100 * min(errors), name


def test_forms_without_stiffness_keep_their_digits_where_the_plain_ones_lose_them():
    stiff = HARD_RODS[next(name for name in HARD_RODS if name.startswith("stiff"))]
    roots = exact_spectrum(stiff, MODE_COUNT)
    assert relative_error(dense_inverse(stiff, 18), roots) < 1e-12
    assert relative_error(chebyshev_first_order(stiff, 24), roots) < 1e-11
    assert relative_error(displacement_elements(stiff, 18), roots) > 1e-8


def test_every_peer_takes_part_at_all_of_its_sizes(tmp_path):
    found = peers(quick=True, folder=tmp_path).contenders_of_race(SPECTRUM_RACE_NAME)
    for peer in PEERS:
        assert [int(c.setting) for c in found if c.method == peer.name] == list(peer.sizes)
    assert {
        c.method for c in peers(quick=True, folder=tmp_path).contenders_of_race(ARM_SPECTRUM_RACE_NAME)
    } < {peer.name for peer in PEERS}
