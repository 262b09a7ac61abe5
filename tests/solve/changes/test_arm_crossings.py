"""Crossings of the imaginary axis by pairs of an arm, and texts on inaccurate thresholds."""

from dataclasses import replace

import numpy as np
import pytest
from reference.dense_arm import eigenvalues

from rodsweep.model.material.profile import Profile
from rodsweep.model.material.rod_material import RodMaterial
from rodsweep.model.rod import Rod
from rodsweep.solve.changes.arm.imaginary_axis_modes import ArmModes, interval_fraction_of_next_count
from rodsweep.solve.changes.status import ThresholdStatus
from rodsweep.solve.changes.threshold_kinds import Threshold, ThresholdKind
from rodsweep.solve.changes.thresholds import ThresholdsRequest, solve_thresholds, thresholds_with_status
from rodsweep.solve.changes.thresholds_along_path import ThresholdSearchResult
from rodsweep.solve.hopf.criticality import solve_criticality
from rodsweep.solve.hopf.status import CriticalityStatus

ROOT_SEGMENT = (1.0,) * 6
MIDDLE_SEGMENT = (
    0.3052741941392067,
    1.0792910558007915,
    3.855073343782774,
    1.0,
    4.736768538519772,
    0.2813046776034669,
)
TIP_SEGMENT = (
    0.5837255394430819,
    0.31862901102482877,
    0.1031608898795434,
    1.0,
    0.4197506506390703,
    0.3434229223897698,
)
FIRST_JUMP, SECOND_JUMP = 0.4342114912155325, 0.6944645738173136
ARM = Rod(
    F=0.0,
    k1=9899.694439291508,
    k2=47.82173276520232,
    gamma3=0.09850614805835134,
    taper=0.15053722165990296,
    material=RodMaterial(
        "neo_hookean",
        profile=Profile(
            (0.0, FIRST_JUMP, FIRST_JUMP, SECOND_JUMP, SECOND_JUMP, 1.0),
            (ROOT_SEGMENT, ROOT_SEGMENT, MIDDLE_SEGMENT, MIDDLE_SEGMENT, TIP_SEGMENT, TIP_SEGMENT),
        ),
    ),
)
UNIFORM_ROD = Rod(F=0.0, k1=300.0, k2=150.0, gamma3=1e-3)


@pytest.mark.long
@pytest.mark.parametrize("F_max", [150.0, 300.0])
def test_a_stop_of_newtons_method_off_the_eigenvalues_is_no_crossing(F_max):
    """Newton's method for w, from the first guess on the axis, stops at a distance of a tenth of w."""
    found = solve_thresholds(ARM, ThresholdsRequest(F_max, 1e-8, True, 2))
    assert [c.kind for c in found.thresholds[1:]] == [ThresholdKind.hopf] * 3
    for crossing in found.thresholds[1:]:
        assert crossing.error <= 1e-8 * crossing.value
        w = eigenvalues(replace(ARM, F=crossing.value), 8, 16)
        assert np.abs(w - 1j * crossing.frequency).min() < 1e-7 * crossing.frequency
    assert found.thresholds[3].value == pytest.approx(0.72978365802, rel=1e-10)


@pytest.mark.parametrize(
    ("distances", "slopes", "length", "is_counted"),
    [
        ((3.561, 13.584), (-21.97, 54.72), 0.6427, True),
        ((3.561, 13.584), (-2.0, 54.72), 0.2, False),
        ((3.561, 13.584), (2.0, 29.2), 0.6427, False),
        ((3.01, 8.24), (17.2, 49.4), 1.0, True),
        ((3.01, 20.6), (17.2, 18.0), 1.0, False),
    ],
    ids=["meet below zero", "meet above zero", "rises", "dips unexplained by the slopes", "rises steadily"],
)
def test_a_pair_may_leave_the_axis_and_return_where_tangents_and_slopes_allow_it(
    distances, slopes, length, is_counted
):
    """The first and the fourth case, of an arm of three segments, hide two crossings; their cubics stay above
    zero."""
    left, right = (
        ArmModes(p, np.array([distance + 1j * (150 + 10 * p)]), np.array([slope + 10j]), 2)
        for p, distance, slope in zip((0.0, length), distances, slopes, strict=True)
    )
    assert (interval_fraction_of_next_count(left, right) > 0) == is_counted


EXCHANGING_SEGMENTS = (
    (1.0,) * 6,
    (0.3797, 3.393, 0.3506, 0.7758, 0.1164, 4.57),
    (0.1791, 0.5192, 0.6305, 0.4522, 1.225, 0.2182),
)
EXCHANGING_ARM = Rod(
    F=0.0,
    k1=419.9,
    k2=11.34,
    gamma3=3.325e-4,
    taper=0.1561,
    material=RodMaterial(
        "neo_hookean",
        profile=Profile(
            (0.0, 0.1953, 0.1953, 0.3509, 0.3509, 1.0),
            tuple(segment for segment in EXCHANGING_SEGMENTS for _ in range(2)),
        ),
    ),
)


@pytest.mark.long
@pytest.mark.parametrize("F_max", [5.5, 8.0])
def test_a_window_of_one_pair_less_between_two_pairs_that_exchange_their_parts_is_found(F_max):
    """Ten pairs grow before and after it, nine at F = 5.39."""
    found = solve_thresholds(EXCHANGING_ARM, ThresholdsRequest(F_max, 1e-8, True, 30))
    window = [(c.kind, c.value) for c in found.thresholds if 5.3 < c.value < 5.5]
    assert [kind for kind, _ in window] == [ThresholdKind.hopf_reverse, ThresholdKind.hopf]
    for (_, value), growing_pairs in zip(window, (9, 10), strict=True):
        w = eigenvalues(replace(EXCHANGING_ARM, F=value + 1e-3), 12, 24)
        assert ((w.real > 0) & (w.imag > 0)).sum() == growing_pairs


def test_a_pair_far_from_the_axis_may_come_from_it_while_another_one_leaves():
    """Two pairs of an arm of three segments exchange their parts; the slopes of the wrong pairs agree."""
    left = ArmModes(5.31448, np.array([13.2 + 169j]), np.array([-40 + 130j]), 20)
    right = ArmModes(5.5, np.array([-9.7 + 157j, 69 + 309j]), np.array([140 - 90j, 716 + 780j]), 20)
    assert interval_fraction_of_next_count(left, right) > 0


def test_a_growing_pair_without_partner_at_the_other_end_has_crossed_the_axis():
    places = [(5.29213, 13.5 + 164j, 10 + 90j), (5.56706, -1e-4 + 154j, 146 - 60j)]
    left, right = (ArmModes(p, np.array([w]), np.array([slope]), 20) for p, w, slope in places)
    assert interval_fraction_of_next_count(left, right) > 0
    same = ArmModes(5.56706, np.array([16.0 + 189j]), np.array([8 + 90j]), 20)
    assert interval_fraction_of_next_count(left, same) == 0


def search_result(*errors, **others):
    thresholds = tuple(
        Threshold(float(F), ThresholdKind.hopf, 30.0, 0.0, error, 2 * F) for F, error in enumerate(errors, 1)
    )
    return ThresholdSearchResult(
        thresholds=thresholds, searched_interval=(0.0, 9.0), is_proved=True, doubt_text="the text", **others
    )


@pytest.mark.parametrize(
    ("others", "max_thresholds", "status"),
    [
        ({"ended_early": True}, 4, ThresholdStatus.ended_early),
        ({"range_of_further_crossings": (7.0, 8.0)}, 4, ThresholdStatus.window_open),
        ({}, 2, ThresholdStatus.list_full),
    ],
)
def test_a_more_serious_status_does_not_hide_a_missed_accuracy(others, max_thresholds, status):
    found = thresholds_with_status(
        "k1", search_result(1e-9, 1e-3, 1e-9, **others), 1e-8, True, max_thresholds
    )
    assert found.status == status
    assert found.message == "the text; the requested accuracy is missed at k1 = 2"
    accurate = thresholds_with_status("k1", search_result(*[1e-9] * 3, **others), 1e-8, True, max_thresholds)
    assert accurate.status == status
    assert accurate.message == "the text"


def test_a_threshold_beyond_the_list_misses_no_accuracy():
    found = thresholds_with_status("F", search_result(1e-9, 1e-9, 1e-3), 1e-8, True, 2)
    assert (found.status, found.message) == (ThresholdStatus.list_full, "the text")


def test_a_status_that_says_it_is_not_repeated():
    found = thresholds_with_status("F", search_result(1e-9, 1e-3), 1e-8, True, 2)
    assert (found.status, found.message) == (ThresholdStatus.accuracy_not_reached, "the text")


def test_a_full_list_does_not_hide_an_inaccurate_hopf_point():
    found = solve_criticality(UNIFORM_ROD, ThresholdsRequest(200.0, 1e-16, True, 1))
    assert found.status == CriticalityStatus.list_full
    hopf = found.search_result.thresholds[0]
    assert f"the requested accuracy is missed at F = {hopf.value:.9g}" in found.message
