"""Thresholds of tapered, stepped and rubber arms: published digits, dense scans, and the uniform rod."""

from dataclasses import replace
from decimal import Decimal
from math import inf, isfinite

import numpy as np
import pytest
from reference.dense_arm import eigenvalues
from reference.random_arms import random_arm
from surveyed import RODS

from rodsweep.determinant.arm.hull import hull
from rodsweep.determinant.parameter_path import ParameterPath
from rodsweep.model.material.profile import Profile
from rodsweep.model.material.rod_material import RodMaterial
from rodsweep.model.rod import Rod
from rodsweep.solve.changes.diagram.rows import RowRequest, StabilityClass, solve_row
from rodsweep.solve.changes.search_range import IntervalQueue
from rodsweep.solve.changes.status import ThresholdStatus
from rodsweep.solve.changes.threshold_kinds import ThresholdKind
from rodsweep.solve.changes.thresholds import ThresholdsRequest, solve_thresholds
from rodsweep.solve.changes.thresholds_along_path import find_thresholds
from rodsweep.solve.spectrum.path import followed_arms

ONES = Profile((0.0, 1.0), ((1.0,) * 6, (1.0,) * 6))
ACROSS = (ThresholdKind.hopf, ThresholdKind.hopf_reverse, ThresholdKind.restabilization)


def across_the_axis(found):
    return [(crossing.kind, crossing.value) for crossing in found.thresholds if crossing.kind in ACROSS]


@pytest.mark.parametrize(
    ("rod", "F_max", "expected"),
    [
        (Rod(F=0.0, k1=1e4, k2=1e4, gamma3=1e-4, taper=0.5), 40.0, [(ThresholdKind.hopf, 15.4627583986)]),
        (
            Rod(F=0.0, k1=200.0, k2=1e4, gamma3=1e-4, material=RodMaterial("neo_hookean")),
            150.0,
            [(ThresholdKind.hopf, 45.8967541917)],
        ),
        (
            Rod(F=0.0, k1=100.0, k2=1e4, gamma3=1e-4, material=RodMaterial("neo_hookean")),
            150.0,
            [(ThresholdKind.hopf, 57.3983354479)],
        ),
        (
            Rod(F=0.0, k1=500.0, k2=1e4, gamma3=1e-4, material=RodMaterial("neo_hookean", "swelling")),
            600.0,
            [(ThresholdKind.hopf, 59.0162383065), (ThresholdKind.restabilization, 414.527760519)],
        ),
        (
            Rod(F=0.0, k1=300.0, k2=1e4, gamma3=1e-4, material=RodMaterial("neo_hookean", "swelling")),
            600.0,
            [],
        ),
    ],
    ids=["cone", "rubber 200", "rubber 100", "swelling 500", "swelling 300"],
)
def test_digits_of_an_independent_collocation(rod, F_max, expected):
    found = solve_thresholds(rod, ThresholdsRequest(F_max, 1e-10, True, 16))
    assert found.status == ThresholdStatus.ok
    kinds, places = zip(*across_the_axis(found), strict=True) if expected else ((), ())
    assert kinds == tuple(kind for kind, _ in expected)
    np.testing.assert_allclose(places, [at for _, at in expected], rtol=1e-11)


def test_a_profile_of_ones_has_the_thresholds_of_the_uniform_rod():
    values, request = (
        {"F": 0.0, "k1": 300.0, "k2": 150.0, "gamma3": 1e-3},
        ThresholdsRequest(200, 1e-10, True, 16),
    )
    uniform = solve_thresholds(Rod(**values), request)
    profiled = solve_thresholds(Rod(**values, material=RodMaterial(profile=ONES)), request)
    assert [c.kind for c in profiled.thresholds] == [c.kind for c in uniform.thresholds]
    for name in ("value", "frequency", "growth_rate"):
        ours, theirs = ([getattr(c, name) for c in found.thresholds] for found in (profiled, uniform))
        np.testing.assert_allclose(ours, theirs, rtol=1e-11, atol=1e-9)


@pytest.mark.parametrize("seed", range(RODS // 10 or 4))
def test_no_crossing_is_missed_between_the_forces_of_a_dense_scan(seed):
    rng = np.random.default_rng(seed)
    rod = random_arm(rng, pulled=0.0)
    found = solve_thresholds(rod.with_values(F=0.0), ThresholdsRequest(3 * rod.F, 1e-9, True, 32))
    assert found.status == ThresholdStatus.ok, (rod, rod.material, found.message)
    crossings = [c for c in found.thresholds if c.kind in ACROSS]
    for F in np.linspace(0.03, 0.999, 12) * found.end:
        expected = [c.unstable_after for c in crossings if c.value < F]
        unstable = int((eigenvalues(rod.with_values(F=float(F))).real > 0).sum())
        assert unstable == (expected[-1] if expected else 0), (rod, rod.material, F)


def test_search_of_a_cone_ends_where_its_tip_is_crushed():
    found = solve_thresholds(
        Rod(F=0.0, k1=40.0, k2=1e4, gamma3=1e-4, taper=0.5), ThresholdsRequest(200, 1e-8, True, 8)
    )
    assert found.end == pytest.approx(10.0, rel=2e-6)
    assert found.status == ThresholdStatus.ok


SOFT_TIP = (1.0, 0.5, 0.5, 1.0, 1.0, 1.0)
STEP = Profile((0.0, 0.5, 0.5, 1.0), ((1.0,) * 6, (1.0,) * 6, SOFT_TIP, SOFT_TIP))
STEPPED = Rod(F=0.0, k1=inf, k2=1e4, gamma3=0.0, material=RodMaterial(profile=STEP))


@pytest.fixture
def no_bound_beyond_some_force(monkeypatch):
    """The a-priori bound of the stepped arm grows with F; a smaller limit leaves none from F = 36 on."""
    monkeypatch.setattr(hull, "HULL_SETTINGS", replace(hull.HULL_SETTINGS, min_one_minus_c=0.995))


def test_a_place_that_cannot_be_proved_ends_the_search_there(no_bound_beyond_some_force, monkeypatch):
    found = solve_thresholds(STEPPED, ThresholdsRequest(60.0, 1e-10, True, 16))
    assert found.status == ThresholdStatus.ended_early
    assert 30.0 < found.end < 60.0
    assert not isfinite(hull.hull_of(STEPPED.with_values(F=found.end + 60 / 12)).a)
    assert f"ends at F = {found.end:.12g}: " in found.message
    assert "no a-priori bound" in found.message
    assert found.search_result.is_proved
    assert not found.search_result.is_proved_to_the_end
    monkeypatch.undo()
    whole = solve_thresholds(STEPPED, ThresholdsRequest(60.0, 1e-10, True, 16))
    assert whole.status == ThresholdStatus.ok
    expected = [c for c in whole.thresholds if c.value < found.end]
    assert (
        [c.kind for c in found.thresholds]
        == [c.kind for c in expected]
        == [ThresholdKind.onset, ThresholdKind.hopf]
    )
    np.testing.assert_allclose([c.value for c in found.thresholds], [c.value for c in expected], rtol=1e-11)
    assert found.search_result.unstable_at_end == 2


def test_a_search_that_cannot_begin_has_failed(monkeypatch):
    monkeypatch.setattr(hull, "HULL_SETTINGS", replace(hull.HULL_SETTINGS, min_one_minus_c=1.0))
    found = solve_thresholds(STEPPED, ThresholdsRequest(60.0, 1e-10, True, 16))
    assert (found.status, found.thresholds) == (ThresholdStatus.failed, ())
    assert "no a-priori bound" in found.message


def test_beyond_a_search_that_ended_early_a_row_is_undecided(no_bound_beyond_some_force):
    row = solve_row(STEPPED, RowRequest("F", np.linspace(0.0, 60.0, 13), 1e-8, True, 16))
    assert row.status == ThresholdStatus.ended_early
    known = np.linspace(0.0, 60.0, 13) <= row.thresholds.end
    assert (row.stability_class[~known] == StabilityClass.undecided).all()
    assert row.stability_class[known].tolist() == [0] * 3 + [1] * 3 + [2] * int(known.sum() - 6)


def test_stiffnesses_are_searched_from_the_stiff_end(no_bound_beyond_some_force):
    """Along k2 the path variable is the compliance: a bound is known for stiff arms only."""
    found = find_thresholds(ParameterPath(STEPPED.with_values(F=30.0), "k2"), 1e3, 1e5)
    assert found.ended_early
    assert 1e3 < found.searched_interval[0] < 1e5
    assert found.searched_interval[1] == 1e5
    assert (found.unstable_at_start, found.unstable_at_end) == (2, 2)


def test_a_crossing_beyond_the_end_of_a_search_is_found_again_but_once():
    """Intervals right of an unsolvable place are dropped, and parts of them are searched anew."""
    intervals, seen = IntervalQueue([0.0, 1.0, 2.0, 3.0]), []
    for a, b in intervals:
        if b > 1.7:
            intervals.limit_search_to_left_half((a, b), "no")
        else:
            seen.append((a, b))
    assert seen == [(0.0, 1.0), (1.0, 1.5), (1.5, 1.625), (1.625, 1.6875)]
    assert intervals.end == (1.6875, "no")


def test_a_full_list_ends_the_search_and_holds_the_same_changes():
    """A slender cone has dozens of crossings, each of which takes longer than all before."""
    rod = Rod(F=0.0, k1=1e4, k2=1e4, gamma3=1e-4, taper=0.2)
    whole = solve_thresholds(rod, ThresholdsRequest(60.0, 1e-10, True, 16))
    found = solve_thresholds(rod, ThresholdsRequest(60.0, 1e-10, True, 2))
    assert (whole.status, whole.end) == (ThresholdStatus.ok, 60.0)
    assert found.status == ThresholdStatus.ended_early
    assert found.thresholds[2].value < found.end < 60.0
    assert "more than 2 crossings" in found.message
    known = [crossing.value for crossing in whole.thresholds if crossing.value <= found.end]
    np.testing.assert_allclose([crossing.value for crossing in found.thresholds], known, rtol=1e-11)


def test_each_load_of_a_search_is_counted_once(monkeypatch):
    """The places of a search, the samples of the leading eigenvalue and the confirmation share counts."""
    counted, whole = [], followed_arms.confirmed_mode_count_at

    def count(path, hulls, p, modes, here):
        counted.append(p)
        return whole(path, hulls, p, modes, here)

    monkeypatch.setattr(followed_arms, "confirmed_mode_count_at", count)
    rod = STEPPED.with_values(k2=100.0)
    found = solve_thresholds(rod, ThresholdsRequest(80.0, 1e-8, True, 16))
    assert found.status == ThresholdStatus.ok
    assert len(counted) > 5
    assert len(counted) == len(set(counted))


def test_errors_of_double_eigenvalues_hold_in_the_last_digit():
    """Rounding of propagators moved two of them by 4 and 27 times what was stated; forces from 34 digits."""
    k1, k2, k3, gamma1 = (0.95, 1.4, 0.88), (1.3, 1.0, 1.0), (1.7, 1.7, 2.6), (0.86, 0.86, 0.56)
    factors = [(1.0,) * 6, *zip(k1, k2, k3, gamma1, (1.0, 0.93, 0.93), (1.0,) * 3, strict=True)]
    rows = tuple(row for row in factors for _ in range(2))
    material = RodMaterial("neo_hookean", "swelling", Profile((0.0, 0.3, 0.3, 0.4, 0.4, 0.7, 0.7, 1.0), rows))
    rod = Rod(F=0.0, k1=5800.0, k2=29.0, gamma3=0.17, material=material)
    found = solve_thresholds(rod, ThresholdsRequest(130.0, 1e-10, True, 16)).thresholds
    double = [
        crossing for crossing in found if crossing.kind in (ThresholdKind.onset, ThresholdKind.real_again)
    ]
    exact = "11.144982346022727144", "79.813236894182175485", "125.31246511120310814"
    for crossing, at in zip(double, exact, strict=True):
        assert abs(Decimal(crossing.value) - Decimal(at)) <= Decimal(crossing.error) <= 1e-12 * crossing.value


@pytest.mark.parametrize("multiple", [1.0, 1.5, 2.0, 3.0, 8.0])
def test_a_range_that_ends_at_a_multiple_of_a_threshold_is_searched_to_its_end(multiple):
    """With equal intervals one of their ends would be the Hopf point, where no count succeeds; where the
    range ends at the Hopf point itself, the modes are counted just beyond."""
    rod = Rod(F=0.0, k1=1e4, k2=1e4, gamma3=1e-4, taper=0.5)
    (first,) = across_the_axis(
        solve_thresholds(rod, ThresholdsRequest(20.0, 1e-10, certify=True, max_thresholds=32))
    )
    found = solve_thresholds(
        rod, ThresholdsRequest(multiple * first[1], 1e-10, certify=True, max_thresholds=32)
    )
    assert found.status == ThresholdStatus.ok
    assert across_the_axis(found)[0] == (first[0], pytest.approx(first[1], rel=1e-11))


def test_a_pair_on_the_axis_at_the_end_of_a_search_is_one_crossing():
    """Neither a crossing just beyond the end belongs to the search, nor is one just before the end lost."""
    path = ParameterPath(Rod(F=0.0, k1=1e4, k2=1e4, gamma3=1e-4, taper=0.5), "F")
    at = find_thresholds(path, 0.0, 20.0).thresholds[-1].value
    for end, number in ((at * (1 - 1e-7), 0), (at, 1), (at * (1 + 1e-7), 1)):
        found = find_thresholds(path, 0.0, end)
        assert found.is_proved_to_the_end, found.doubt_text
        assert len(across_the_axis(found)) == number
        assert found.searched_interval == (0.0, end)
    from_there = find_thresholds(path, at * (1 - 1e-7), 20.0)
    assert len(across_the_axis(from_there)) == 1
    assert from_there.is_proved_to_the_end
