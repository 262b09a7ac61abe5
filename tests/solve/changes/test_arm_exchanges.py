"""Exchanges of the leading eigenvalue of cones where other eigenvalues meet close to the exchange."""

import numpy as np
import pytest
from surveyed import RODS, survey_only

import rodsweep as rs
from rodsweep.determinant.parameter_path import ParameterPath
from rodsweep.model.arm.arm import SlenderArm
from rodsweep.model.material.profile import Profile
from rodsweep.model.material.rod_material import RodMaterial
from rodsweep.model.rod import Rod
from rodsweep.results.layouts.phase_diagram import STABILITY_CLASSES
from rodsweep.solve.changes.status import ThresholdStatus
from rodsweep.solve.changes.threshold_kinds import ThresholdKind
from rodsweep.solve.changes.thresholds import ThresholdsRequest, solve_thresholds
from rodsweep.solve.spectrum.path.eigenvalue_following import are_distinct_roots
from rodsweep.solve.spectrum.path.followed_arms import FollowedArms
from rodsweep.solve.spectrum.search import SpectrumRequest, solve_spectrum
from rodsweep.verdict.relative_load import rod_with_drag

CONE = SlenderArm(
    length="10.75 cm",
    radius="0.5061 cm",
    tip_radius="0.1058 cm",
    young="5.975e+04 Pa",
    viscosity="1.706 Pa s",
)
NEARLY_TRIPLE = rod_with_drag(CONE, CONE.base_drag_estimates[0])
TO_30 = ThresholdsRequest(30.0, 1e-6, True, 100)


def cone(k1, k2, gamma3, taper, **further):
    return Rod(F=0.0, k1=k1, k2=k2, gamma3=gamma3, taper=taper, **further)


@pytest.mark.parametrize(
    ("rod", "F"),
    [(cone(1e4, 3e3, 1e-4, 0.19), 2.0386255889), (cone(1e4, 3e3, 1e-3, 0.19), 2.0333568822)],
)
def test_a_real_eigenvalue_takes_the_lead_where_bisection_finds_it(rod, F):
    """The forces are from a bisection of dense eigenvalues of another code on two meshes."""
    found = solve_thresholds(rod, TO_30)
    assert found.status == ThresholdStatus.ok
    (taken,) = [c for c in found.thresholds if c.kind == ThresholdKind.real_leads]
    assert taken.value == pytest.approx(F, abs=1e-9)
    assert taken.error < 1e-9


@pytest.mark.parametrize(
    ("rod", "F_max"),
    [
        (
            cone(
                *(232.47833692152994, 163.1012000931068, 0.0002505587603018475, 0.15516879019780894),
                material=RodMaterial("neo_hookean", "swelling"),
            ),
            46.9623437016846,
        ),
        (cone(15253.748780772801, 18327.095650919167, 0.00016823986456179592, 0.17550637707235592), 59.7),
    ],
)
def test_three_exchanges_between_two_samples_are_all_found(rod, F_max):
    found = solve_thresholds(rod, ThresholdsRequest(F_max, 1e-6, True, 100))
    assert found.status == ThresholdStatus.ok
    kinds = [c.kind for c in found.thresholds[:3]]
    assert kinds == [ThresholdKind.onset, ThresholdKind.real_again, ThresholdKind.pair_leads]
    assert_leaders_are_those_of_spectra(rod, found, forces_between(found))


@pytest.mark.long
def test_a_double_eigenvalue_behind_the_leading_pair_is_no_onset():
    rod = cone(20971.78966444228, 401.0547088144865, 4.178687351590938e-05, 0.1542518309504673)
    found = solve_thresholds(rod, ThresholdsRequest(39.13599469496463, 1e-6, True, 100))
    assert found.status == ThresholdStatus.ok
    assert found.thresholds[0].kind == ThresholdKind.pair_leads
    assert_leaders_are_those_of_spectra(rod, found, forces_between(found))


def assert_leaders_are_those_of_spectra(rod, found, forces):
    """At each force the list tells the kind of the leading eigenvalue and the number of unstable modes."""
    for F in forces:
        before = [c for c in found.thresholds if c.value <= F]
        pair = [c.kind.pair_leads_after for c in before if c.kind.switches_real_and_complex][-1:]
        spectrum = solve_spectrum(rod.with_values(F=F), SpectrumRequest(2, 1e-8, True))
        assert spectrum.certified
        assert (spectrum.eigenvalues[0].imag != 0) == (pair == [True])
        assert spectrum.unstable_count == (before[-1].unstable_after if before else 0)


def forces_between(found):
    """Forces close to the ends of each interval between thresholds, and within it: of the first intervals,
    or of all intervals for `make survey`."""
    ends = [0.0, *(c.value for c in found.thresholds), found.end]
    ends = ends if RODS else ends[:5]
    return [
        a + share * (b - a)
        for a, b in zip(ends, ends[1:], strict=False)
        for share in (1e-4, 0.1, 0.5, 0.9, 1 - 1e-4)
    ]


@pytest.mark.parametrize(
    "rod",
    [
        # Two real eigenvalues behind a real one become a pair.
        cone(1e4, 3e3, 1e-4, 0.18),
        cone(1e4, 3e3, 1e-3, 0.16),
        # Two pairs exchange the lead.
        cone(201.38319439558708, 296.6030107867904, 7.85603969251972e-05, 0.16587853893457413),
        cone(238.54427297868136, 240.0821900457012, 0.00017730179369483172, 0.1486808577982113),
        # Three real eigenvalues within a thousandth of the path.
        cone(7456.321605964616, 994.9549132857708, 0.00021244815052571517, 0.1874555969069303),
        # Three real eigenvalues within a millionth of the path.
        NEARLY_TRIPLE,
        # An eigenvalue of a pair was taken for the real one; an eigenvalue that had not converged was taken.
        cone(41281.777834686414, 24198.095242172014, 0.0008519563856196541, 0.18778640691937346),
        cone(281.485966480166, 38.82445589689772, 0.0022144599132281196, 0.18180628515845332),
    ],
)
def test_lists_of_cones_with_crowded_eigenvalues_are_proved_and_right(rod):
    found = solve_thresholds(rod, TO_30)
    assert found.status == ThresholdStatus.ok
    assert found.search_result.is_proved
    assert_leaders_are_those_of_spectra(rod, found, forces_between(found))


@survey_only
@pytest.mark.parametrize("seed", range(RODS))
def test_leaders_of_random_arms_are_those_of_spectra(seed):
    random = np.random.default_rng(seed)
    k1 = 10 ** random.uniform(2.3, 5)
    material = RodMaterial("neo_hookean", "swelling") if seed % 3 == 2 else RodMaterial()
    rod = cone(
        *(
            k1,
            k1 * 10 ** random.uniform(-2, 0.2),
            10 ** random.uniform(-5, -2),
            10 ** random.uniform(-1, 0.2),
        ),
        material=material,
    )
    found = solve_thresholds(rod, TO_30)
    assert found.status == ThresholdStatus.ok
    assert_leaders_are_those_of_spectra(rod, found, forces_between(found))


def test_newton_for_a_double_eigenvalue_ends_where_there_is_no_arm():
    """Along the drag of a cone the method steps to a negative drag: no point of the row failed for that."""
    data = rs.sweep(
        "phase_diagram", F=40.0, k1=300.0, k2=100.0, gamma3=[0.01, 2.0], taper=[1.0, 2.0], progress=False
    )
    assert data.status.values.ravel().tolist() == [0, 0]
    classes = data["class"].values.reshape(2, 2)
    for i, taper in enumerate((1.0, 2.0)):
        for j, gamma3 in enumerate((0.01, 2.0)):
            rod = rs.Rod(F=40.0, k1=300.0, k2=100.0, gamma3=gamma3, taper=taper)
            spectrum = rod.spectrum(modes=2)
            word = dict(STABILITY_CLASSES)[classes[i, j]]
            assert (spectrum.growth_rate[0] > 0) == (word == "flutter")
            assert (spectrum.frequency[0] > 0) == (word in ("flutter", "oscillatory"))


NEARLY_CRUSHED = Rod(
    F=0.0,
    k1=109.83750492645562,
    k2=7.02,
    gamma3=0.21681568646611862,
    material=RodMaterial(
        profile=Profile(
            (0.0, 1.0),
            (
                (1.4726647073144412, 1.0, 1.0, 1.0, 1.0, 1.0),
                (1.116211212073014, 1, 1, 1, 1.2836789734528988, 1),
            ),
        )
    ),
)
"""At F = 116.985 two leading real eigenvalues, 2552.01 and 2551.52, grow beside twelve others."""


def test_two_close_eigenvalues_are_not_followed_as_one():
    """Both were followed to the same root, whose stated error was below its distance from itself."""
    found = solve_thresholds(NEARLY_CRUSHED, ThresholdsRequest(121.0, 1e-6, True, 100))
    assert found.status == ThresholdStatus.ok
    followed = FollowedArms(ParameterPath(NEARLY_CRUSHED, "F"), np.linspace(100.0, 121.0, 24), 4)
    for F in (116.98506875, 116.98512780, 116.98542655):
        alone = solve_spectrum(NEARLY_CRUSHED.with_values(F=F), SpectrumRequest(4, 1e-6, certify=True))
        spectrum = followed.spectrum(F, 4)
        if spectrum is not None:
            assert spectrum.eigenvalues == pytest.approx(alone.eigenvalues, rel=1e-10)
    roots = np.array([2551.516951182686, 2551.516951182301], complex)
    assert not are_distinct_roots(roots, np.array([7.9e-12, 7.9e-12]))
