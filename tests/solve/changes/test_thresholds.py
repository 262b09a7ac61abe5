"""All stability changes of a rod: against the independent reference, closed forms and plain counts."""

import json
from math import inf, isnan

import numpy as np
import pytest
from conftest import ROOT

from rodsweep.determinant.certificate.winding_number import count_right_of
from rodsweep.determinant.parameter_path import ParameterPath
from rodsweep.model.rod import Rod
from rodsweep.solve.changes import thresholds_along_path as transitions_module
from rodsweep.solve.changes.diagram.rows import classes_and_unstable_counts
from rodsweep.solve.changes.status import ThresholdStatus
from rodsweep.solve.changes.threshold_kinds import ThresholdKind
from rodsweep.solve.changes.thresholds import ThresholdsRequest, solve_thresholds
from rodsweep.solve.changes.thresholds_along_path import find_imaginary_axis_crossings, find_thresholds
from rodsweep.solve.changes.unstable_modes import UnstableModeCounter
from rodsweep.solve.spectrum.search import SpectrumRequest, solve_spectrum

REFERENCE = json.loads((ROOT / "tests" / "reference" / "thresholds.json").read_text())
SAME_KIND = {"restabilization": "hopf_reverse"}


def thresholds(k1, k2, gamma3, F_max=200.0, accuracy=1e-11):
    return solve_thresholds(
        Rod(F=0.0, k1=k1, k2=k2, gamma3=gamma3), ThresholdsRequest(F_max, accuracy, True, 200)
    )


@pytest.mark.kernel
@pytest.mark.parametrize("rod", REFERENCE, ids=lambda r: f"{r['k1']}-{r['k2']}-{r['gamma3']}-{r['F_end']}")
def test_every_change_of_the_reference_and_no_other_to_twelve_digits(rod):
    found = thresholds(*(float(rod[name]) for name in ("k1", "k2", "gamma3", "F_end")))
    assert found.status == ThresholdStatus.ok, found.message
    assert found.search_result.is_proved
    assert [SAME_KIND.get(c.kind.name, c.kind.name) for c in found.thresholds] == [
        e["kind"] for e in rod["events"]
    ]
    assert found.search_result.unstable_at_end == rod["unstable_at_end"]
    for crossing, event in zip(found.thresholds, rod["events"], strict=True):
        exact = float(event["F"])
        assert crossing.value == pytest.approx(exact, rel=1e-12)
        assert abs(crossing.value - exact) <= 10 * crossing.error
        assert crossing.frequency == pytest.approx(float(event["frequency"]), rel=1e-11)
        # At a double root the eigenvalue is where D and its slope vanish, which keeps its digits too.
        assert crossing.growth_rate == pytest.approx(float(event["rate"]), rel=1e-9)
        assert crossing.unstable_after == event["unstable_after"]


@pytest.mark.parametrize("multiple", [1.0, 2.0, 4.0])
def test_a_range_that_ends_at_a_multiple_of_a_threshold_is_proved(multiple):
    """A sample of the search is then a rod with a pair on the axis: which mode leads is known all the
    same."""
    at = next(c.value for c in thresholds(1e4, 1e4, 1e-4, 40.0).thresholds if c.kind == ThresholdKind.hopf)
    found = thresholds(1e4, 1e4, 1e-4, multiple * at)
    assert found.status == ThresholdStatus.ok, found.message
    assert [c.kind for c in found.thresholds][:2] == [ThresholdKind.onset, ThresholdKind.hopf]
    assert found.thresholds[1].value == pytest.approx(at, rel=1e-13)


BESIDE_A_HOPF_POINT = [
    ("F", Rod(F=0.0, k1=1e4, k2=1e4, gamma3=1e-4), (0.0, 60.0), (0, 2)),
    ("k1", Rod(F=38.0, k1=100.0, k2=1e2, gamma3=1e-3), (40.0, 5e3), (0, 2)),
    ("taper", Rod(F=20.0, k1=1e4, k2=1e4, gamma3=1e-4, taper=0.3), (0.3, 1.0), (2, 0)),
]
"""Parameter, rod, range with one Hopf point, and numbers of unstable modes at both ends of the range."""


@pytest.mark.long
@pytest.mark.parametrize(("name", "rod", "ends", "counts"), BESIDE_A_HOPF_POINT)
def test_a_search_that_starts_beside_a_hopf_point_is_proved(name, rod, ends, counts):
    """At the start a pair is so close to the axis that the unstable modes there cannot be counted."""
    path = ParameterPath(rod, name)
    (hopf,) = find_imaginary_axis_crossings(path, *ends).thresholds
    for distance in (1e-6, 1e-7, 1e-9, 1e-12, 0.0):
        start = hopf.value * (1 - distance)
        for search in (find_imaginary_axis_crossings, find_thresholds):
            found = search(path, start, ends[1])
            crossings = [c for c in found.thresholds if not c.kind.switches_real_and_complex]
            assert [c.value for c in crossings] == pytest.approx([hopf.value], rel=1e-13)
            assert (found.unstable_at_start, found.unstable_at_end) == counts
            assert found.is_proved, found.doubt_text
        if distance > 1e-13:
            beyond = find_imaginary_axis_crossings(path, hopf.value * (1 + distance), ends[1])
            assert not beyond.thresholds
            assert beyond.is_proved
            assert (beyond.unstable_at_start, beyond.unstable_at_end) == (counts[1], counts[1])


def test_a_start_beside_two_hopf_points_is_counted_after_both(monkeypatch):
    """No position before or between the first two crossings gives a count: a later one gives all numbers."""
    path = ParameterPath(Rod(F=0.0, k1=1e4, k2=1e4, gamma3=1e-4), "F")
    whole = find_imaginary_axis_crossings(path, 0.0, 200.0)
    second = whole.thresholds[1].value
    counted = UnstableModeCounter.count_at
    monkeypatch.setattr(
        UnstableModeCounter, "count_at", lambda self, value: counted(self, value) if value > second else -1
    )
    found = find_imaginary_axis_crossings(path, 1.0, 200.0, certify=False)
    assert found.unstable_at_start == 0
    assert [c.unstable_after for c in found.thresholds] == [c.unstable_after for c in whole.thresholds]


def test_the_partial_beam_flutters_where_the_compressed_filament_does():
    """k2 = inf, gamma3 = 0: F (1 - F/k1) = Fc (Sec. VIII), so both ends of the window are known."""
    filament = thresholds(inf, inf, 0.0)
    Fc = next(c.value for c in filament.thresholds if c.kind == ThresholdKind.hopf)
    assert Fc == pytest.approx(37.6954308403186, rel=1e-13)
    for k1 in (4 * Fc * 1.0001, 163.0, 400.0):
        root = np.sqrt(1 - 4 * Fc / k1)
        found = [c for c in thresholds(k1, inf, 0.0, 2 * k1).thresholds if c.kind in (2, 4)]
        assert [c.kind for c in found][:2] == [
            ThresholdKind.hopf,
            ThresholdKind.restabilization,
        ] or k1 == 400.0
        # Near the fold F moves like the root of what D can tell.
        assert found[0].value == pytest.approx(k1 / 2 * (1 - root), rel=1e-13 / root)
        assert found[-1].value == pytest.approx(k1 / 2 * (1 + root), rel=1e-13 / root)
    assert not [c for c in thresholds(4 * Fc * 0.9999, inf, 0.0, 2e3).thresholds if c.kind in (2, 3, 4)]


FOLD = 147.921519683199662  # of k2 = 1e4, gamma3 = 1e-4, 30 digits known


@pytest.mark.parametrize("beyond", [1e-3, 9e-5, 3e-5, 1e-5, 1e-7])
def test_a_window_far_narrower_than_any_sampling_is_found(beyond):
    """Just beyond the fold the window of flutter is as wide as the root of `beyond`; its ends are found."""
    known = next(rod for rod in REFERENCE if rod["k1"] == "147.93")
    start, stop = (float(e["F"]) for e in known["events"] if e["kind"].startswith("hopf"))
    found = thresholds(FOLD + beyond, 1e4, 1e-4, accuracy=1e-8)
    window = [c for c in found.thresholds if c.kind in (ThresholdKind.hopf, ThresholdKind.restabilization)]
    assert [c.unstable_after for c in window] == [2, 0]
    assert window[1].value - window[0].value == pytest.approx(
        (stop - start) * np.sqrt(beyond / (147.93 - FOLD)), rel=2e-3
    )
    assert found.status == ThresholdStatus.ok


def test_before_the_fold_there_is_no_window():
    found = thresholds(FOLD - 1e-9, 1e4, 1e-4)
    assert found.status == ThresholdStatus.ok
    assert not [c for c in found.thresholds if c.unstable_after]


@pytest.mark.parametrize("beyond", [0.0, 1e-11, 1e-9])
def test_a_window_that_rounding_cannot_decide_is_reported_open(beyond):
    found = thresholds(FOLD + beyond, 1e4, 1e-4)
    assert found.status == ThresholdStatus.window_open
    assert (
        found.search_result.range_of_further_crossings[0]
        < 75.3972626336
        < found.search_result.range_of_further_crossings[1]
    )
    assert (
        found.search_result.range_of_further_crossings[1] - found.search_result.range_of_further_crossings[0]
        < 1e-3
    )
    assert not found.search_result.is_proved
    assert found.search_result.unstable_at_end == 0


def test_classes_agree_with_certified_spectra_at_random_points_of_random_rods():
    rng = np.random.default_rng(5)
    compared = 0
    for _ in range(12):
        k1, k2 = (10 ** rng.uniform(1.3, 6) if rng.random() < 0.85 else inf for _ in range(2))
        gamma3 = 10 ** rng.uniform(-6, 1) if rng.random() < 0.85 else 0.0
        end = min(150.0, 0.999 * k1)
        found = find_thresholds(ParameterPath(Rod(F=0.0, k1=k1, k2=k2, gamma3=gamma3), "F"), 0.0, end)
        forces = np.sort(rng.uniform(0, end, 20))
        for F, motion, unstable in zip(forces, *classes_and_unstable_counts(found, forces), strict=True):
            spectrum = solve_spectrum(Rod(F=F, k1=k1, k2=k2, gamma3=gamma3), SpectrumRequest(2, 1e-6, True))
            if spectrum.certified:
                leads = 2 if spectrum.unstable_count else int(spectrum.eigenvalues[0].imag != 0)
                assert (motion, unstable) == (leads, spectrum.unstable_count), (F, k1, k2, gamma3)
                compared += 1
    assert compared > 200


@pytest.mark.parametrize(
    ("name", "fixed", "start", "stop"),
    [
        ("k1", Rod(F=60.0, k1=1e3, k2=1e4, gamma3=1e-4), 70.0, 1e5),
        ("k2", Rod(F=30.0, k1=1e4, k2=1e3, gamma3=1e-4), 3.0, 1e6),
        ("gamma3", Rod(F=30.0, k1=1e4, k2=1e3, gamma3=1e-4), 1e-6, 10.0),
    ],
)
def test_a_change_along_any_parameter_is_a_change_along_the_force(name, fixed, start, stop):
    found = find_thresholds(ParameterPath(fixed, name), start, stop).thresholds
    assert found
    for crossing in found:
        values = {n: getattr(fixed, n) for n in ("k1", "k2", "gamma3")} | {name: crossing.value}
        forces = [c.value for c in thresholds(**values, F_max=1.2 * fixed.F).thresholds]
        assert min(abs(F - fixed.F) for F in forces) < 1e-10 * fixed.F
        before, after = (
            count_right_of(
                0.0, ParameterPath(fixed, name).rod_at(ParameterPath(fixed, name).coordinate(v))
            ).number
            for v in (crossing.value * 0.99, crossing.value * 1.01)
        )
        assert after == crossing.unstable_after
        if crossing.kind in (ThresholdKind.hopf, ThresholdKind.hopf_reverse, ThresholdKind.restabilization):
            assert after - before == (2 if crossing.kind == ThresholdKind.hopf else -2)


def test_a_lost_crossing_is_noticed_by_the_counts(monkeypatch):
    whole = transitions_module.zeros_and_open_boxes_of_covering

    def loses_one(*arguments):
        zeros, left, examined = whole(*arguments)
        return sorted(zeros, key=lambda z: z[1])[1:], left, examined

    monkeypatch.setattr(transitions_module, "zeros_and_open_boxes_of_covering", loses_one)
    found = thresholds(1e4, 1e4, 1e-4)
    assert found.status == ThresholdStatus.not_certified
    assert "modes are unstable between" in found.message
    assert not found.search_result.is_proved


def test_the_search_ends_below_a_crushed_rod_and_says_where():
    found = thresholds(60.0, 1e3, 1e-3, F_max=500.0)
    assert found.end == pytest.approx(60.0, rel=2e-6)
    assert found.end < 60.0


def test_more_changes_than_the_list_holds_are_counted():
    found = solve_thresholds(
        Rod(F=0.0, k1=1e4, k2=1e4, gamma3=1e-4), ThresholdsRequest(200.0, 1e-10, True, 2)
    )
    assert found.status == ThresholdStatus.list_full
    assert len(found.thresholds) == 3


def test_what_overflows_fails_with_a_reason():
    found = thresholds(1e300, 1e-300, 1e300)
    assert found.status == ThresholdStatus.failed
    assert found.message
    assert isnan(found.search_result.range_of_further_crossings[0])


def test_a_search_up_to_a_force_without_a_bound_names_the_force():
    found = solve_thresholds(
        Rod(F=0.0, k1=inf, k2=1e4, gamma3=1e-4), ThresholdsRequest(1e300, 1e-10, True, 16)
    )
    assert found.status == ThresholdStatus.failed
    assert found.message.startswith(
        "no a-priori bound on the eigenvalues applies to all rods from F = 0 to F = "
    )
    assert found.message.endswith("F = 1e+300")


def test_a_rod_pulled_beyond_its_shear_stiffness_buckles_and_every_kind_of_change_occurs():
    """F c2 < -nu: two positive real eigenvalues become a pair, which later a real one overtakes."""
    found = find_thresholds(ParameterPath(Rod(F=-8.0, k1=1e4, k2=3.0, gamma3=0.01), "F"), -8.0, 20.0)
    kinds = [c.kind for c in found.thresholds]
    assert found.unstable_at_start == 2
    assert not found.oscillates_at_start
    assert kinds[:3] == [ThresholdKind.onset, ThresholdKind.restabilization, ThresholdKind.real_leads]
    assert found.is_proved
    onset, _, overtaken = found.thresholds[:3]
    assert onset.growth_rate > 60
    for change, before, after in ((onset, False, True), (overtaken, True, False)):
        for F, pair in ((change.value - 1e-3, before), (change.value + 1e-3, after)):
            w = solve_spectrum(
                Rod(F=F, k1=1e4, k2=3.0, gamma3=0.01), SpectrumRequest(4, 1e-8, True)
            ).eigenvalues
            assert (w[0].imag != 0) == pair
    # A real eigenvalue and a pair have the same real part where the one overtakes the other.
    w = solve_spectrum(
        Rod(F=overtaken.value, k1=1e4, k2=3.0, gamma3=0.01), SpectrumRequest(3, 1e-10, True)
    ).eigenvalues
    assert w.real == pytest.approx(overtaken.growth_rate, rel=1e-9)
    assert w.imag.max() == pytest.approx(overtaken.frequency, rel=1e-9)


@pytest.mark.parametrize("beyond", [1e-3, 1e-6, 1e-9])
def test_a_narrow_window_of_oscillations_is_found(beyond):
    """Partial beam: F (1 - F/k1) = F* of the filament twice, as close as one likes (k1 -> 4 F*)."""
    start = 20.0509536189737612
    k1 = 4 * start * (1 + beyond)
    found = thresholds(k1, inf, 0.0, 60.0, accuracy=1e-8)
    half = k1 / 2 * np.sqrt(1 - 4 * start / k1)
    assert found.status == ThresholdStatus.ok
    assert [c.kind for c in found.thresholds] == [ThresholdKind.onset, ThresholdKind.real_again]
    assert found.thresholds[1].value - found.thresholds[0].value == pytest.approx(2 * half, rel=1e-3)


def test_a_pair_about_to_cross_the_axis_leads():
    """The onset and an overtaking lie close together before it, between two spectra that agree in kind."""
    rod = Rod(F=-27.0, k1=424.7068961055969, k2=2.2470358417416847, gamma3=0.00041823639524173143)
    found = find_thresholds(ParameterPath(rod, "F"), -27.170544378578725, 100.0)
    kinds = [c.kind for c in found.thresholds]
    assert ThresholdKind.onset in kinds
    assert ThresholdKind.real_leads in kinds
    motion, _ = classes_and_unstable_counts(found, np.array([-4.95]))
    assert motion.tolist() == [1]
    assert found.is_proved


def test_no_change_outside_the_path_is_reported():
    """A Hopf point 1e-6 beyond the end, which Newton's method finds from a box at the edge."""
    hopf = 37.6559805452710668
    before = thresholds(1e4, 1e4, 1e-4, F_max=hopf * (1 - 1e-6))
    assert before.status == ThresholdStatus.ok
    assert [c.kind for c in before.thresholds] == [ThresholdKind.onset]
    assert before.search_result.unstable_at_end == 0
    beyond = find_thresholds(
        ParameterPath(Rod(F=0.0, k1=1e4, k2=1e4, gamma3=1e-4), "F"), hopf * (1 + 1e-6), 50.0
    )
    assert (beyond.unstable_at_start, beyond.thresholds) == (2, ())


@pytest.mark.parametrize("k1", [8e8, 1.6e8, 3.1e9])
def test_a_change_on_the_border_of_two_boxes_is_one(k1):
    """A path along k1 at a force for which the Hopf point lies where the error of k1 is large."""
    hopf = next(
        c.value for c in thresholds(k1, 1e4, 1e-4, F_max=60.0).thresholds if c.kind == ThresholdKind.hopf
    )
    found = find_thresholds(ParameterPath(Rod(F=hopf, k1=k1, k2=1e4, gamma3=1e-4), "k1"), 100.0, 1e12)
    assert [c.unstable_after for c in found.thresholds if c.kind == ThresholdKind.hopf] == [2]


@pytest.mark.parametrize("F_max", [1e-3, 0.3, 0.7])
def test_a_search_that_ends_before_anything_happens(F_max):
    found = thresholds(1e4, 1e4, 1e-4, F_max=F_max)
    assert (found.status, found.thresholds, found.search_result.unstable_at_end) == (
        ThresholdStatus.ok,
        (),
        0,
    )


@pytest.mark.parametrize("k1", [1e4, 200.0])
def test_strong_pulls_cost_no_more_than_pushes(k1):
    """Both exponentials of D grow there and cancel; bounded apart they would take a million boxes."""
    path = ParameterPath(Rod(F=0.0, k1=k1, k2=1e4, gamma3=1e-4), "F")
    for start in (-400.0, -100.0):
        zeros, left, examined = transitions_module.zeros_and_open_boxes_of_covering(
            transitions_module.first_crossing_boxes(path, start, 0.0), path.origin, path.direction
        )
        assert (zeros, left) == ([], [])
        assert examined < 20_000


def test_a_box_that_holds_only_the_neighbourhood_of_zero_is_counted():
    """A rod so quiet that D is near 1 along the whole imaginary axis within the a-priori box."""
    assert count_right_of(0.0, Rod(F=1e-3, k1=1e4, k2=1e4, gamma3=1e-4)).number == 0
    assert count_right_of(0.0, Rod(F=0.0, k1=1e4, k2=1e4, gamma3=1e-4)).number == 0
