"""Where cycles lose their mirror symmetry, and the branch of cycles without it that is born there."""

from contextlib import contextmanager
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from test_paper import stated

import rodsweep as rs
from rodsweep.determinant.parameter_path import ParameterPath
from rodsweep.model.rod import Rod
from rodsweep.post.stored_branches import StoredBranch, StoredSpecialPoint
from rodsweep.post.summary.branch import _ends_phrase
from rodsweep.solve.branch import branch_continuation
from rodsweep.solve.branch.arc_length_step import next_cycle
from rodsweep.solve.branch.branch_continuation import (
    follow_asymmetric_branch,
    follow_branch_from_hopf_point,
    follow_from_cycle,
)
from rodsweep.solve.branch.branch_curve import BranchCurve
from rodsweep.solve.branch.branch_limits import BranchLimits
from rodsweep.solve.branch.branch_mesh_choice import solve_on_sufficient_mesh
from rodsweep.solve.branch.branches import BranchesOfRod
from rodsweep.solve.branch.special import locating
from rodsweep.solve.branch.special.detection import special_kinds_between
from rodsweep.solve.branch.special.special_point import SPECIAL_POINT_SETTINGS, SpecialPointKind
from rodsweep.solve.branch.start.first_asymmetric_cycle import first_asymmetric_cycle
from rodsweep.solve.branch.start.hopf_point import hopf_branch_start
from rodsweep.solve.branch.status import BranchEndReason, BranchStatus
from rodsweep.solve.branch.symmetry_breaking import (
    bending_moment_asymmetry,
    ends_within_extrapolation_tolerances,
    extended_to_whole_period,
    symmetry_breakings_in,
)
from rodsweep.solve.changes.thresholds_along_path import find_imaginary_axis_crossings
from rodsweep.solve.orbit.matrix.right_sides import write_rates_of_state
from rodsweep.solve.orbit.matrix.workspace import NewtonWorkspace
from rodsweep.solve.orbit.measures import CycleMotion, measures_of
from rodsweep.solve.orbit.symmetry import REFLECTION
from rodsweep.tasks.branch import branch_values

ROUGH, STOP = 1e-3, 20.5
"""Accuracy of the branches, and the end of their range."""


@contextmanager
def special_points_located_to_1e_5():
    """Saves nine tenths of the time. Within a fixture only: other tests run while the fixture lives."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(locating, "SPECIAL_POINT_SETTINGS", replace(SPECIAL_POINT_SETTINGS, accuracy=1e-5))
        yield


@pytest.fixture(scope="module")
def limits():
    """The first Hopf point of a rod that is soft in shear, whose stable cycles lose their symmetry."""
    straight = Rod(F=0.0, k1=30.0, k2=0.5, gamma3=0.1)
    path = ParameterPath(straight, "F")
    hopf = hopf_branch_start(path, find_imaginary_axis_crossings(path, 0.0, 5.0).thresholds[0])
    return BranchLimits([hopf], (0.0, STOP), (BranchEndReason.range_end,) * 2, ROUGH, 500, NewtonWorkspace())


@pytest.fixture(scope="module")
def symmetric(limits):
    with special_points_located_to_1e_5():
        return follow_branch_from_hopf_point(0, limits)


@pytest.fixture(scope="module")
def known(limits, symmetric):
    """The limits with the one symmetry breaking."""
    (breaking,) = symmetry_breakings_in([symmetric.special_points])
    return branch_continuation.replace(limits, breakings=[breaking])


@pytest.fixture(scope="module")
def asymmetric(known):
    with special_points_located_to_1e_5():
        return follow_asymmetric_branch(0, "F", known)


def kinds(curve):
    return [point.kind.name for point in curve.special_points]


@pytest.mark.long
def test_stable_cycles_lose_their_symmetry_and_those_without_it_turn_at_a_fold(symmetric, asymmetric):
    assert kinds(symmetric) == ["hopf", "symmetry_breaking", "end"]
    assert kinds(asymmetric) == ["symmetry_breaking", "fold", "end"]
    born, fold, end = asymmetric.special_points
    # NaN does not equal NaN, but has the same text.
    assert repr(born) == repr(
        branch_continuation.replace(symmetric.special_points[1], index_of_cycle_before=-1)
    )
    # The references are located to 1e-9 on finer meshes.
    _, breaks_at, turns_at = stated("lopsided")
    assert abs(born.parameter_value / breaks_at - 1) < 1e-5
    assert abs(fold.parameter_value / turns_at - 1) < 1e-5
    assert max(born.error, fold.error) < 1e-3
    assert end.parameter_value == pytest.approx(STOP, rel=1e-14)
    assert end.end_reason == BranchEndReason.range_end
    turn = symmetric.special_points[1].index_of_cycle_before + 1
    assert {point.unstable_count for point in symmetric.stored_cycles[:turn]} - {-1} == {0}
    assert {point.unstable_count for point in symmetric.stored_cycles[turn:]} - {-1} == {1}
    turn = fold.index_of_cycle_before + 1
    assert {point.unstable_count for point in asymmetric.stored_cycles[:turn]} - {-1} == {1}
    assert {point.unstable_count for point in asymmetric.stored_cycles[turn:]} - {-1} == {0}


def test_symmetry_breaks_for_a_stretchable_rod_that_is_almost_crushed():
    """At the reference, by Chebyshev collocation of the strains in space and Radau collocation in time of
    another code, the map of half a period and reflection has the multiplier -1 within 5e-10, so that the
    force is accurate to 3e-8."""
    rod = rs.Rod(k1=124, k2=2e4, gamma3=0.021, gamma1=0.65)
    branch = rod.branch(start=50, stop=110, accuracy=1e-5)
    breakings = branch.special_points[branch.special_points.special_kind == "symmetry_breaking"]
    assert breakings.special_at.to_numpy() == pytest.approx(107.636174, abs=1e-6)
    assert len(breakings) == 2  # an end of the branch without symmetry, and a point of the one with it


@pytest.mark.long
def test_asymmetry_grows_with_the_square_root_of_the_distance(symmetric, asymmetric):
    """So do largest and smallest y; symmetric cycles have none."""
    assert all(point.measures.tip_y_min == -point.measures.tip_y_max for point in symmetric.stored_cycles)
    born = asymmetric.special_points[0]
    (near, F), (far, beyond) = (
        ((point.measures.tip_y_max + point.measures.tip_y_min) ** 2, point.parameter_value)
        for point in asymmetric.stored_cycles[:2]
    )
    # Without the square the two would lead 5e-4 beside it.
    assert (F + (F - beyond) * near / (far - near)) / born.parameter_value == pytest.approx(1, abs=2e-4)


def test_a_cycle_without_symmetry_closes_when_another_integrator_marches_it(known):
    """SciPy's LSODA, over a period, from a cycle on the unstable part."""
    here, _ = first_asymmetric_cycle(known.breakings[0], "F", ROUGH, known.workspace)
    orbit = next_cycle(here, ROUGH).orbit
    p, nodes = orbit.orbit_equations, orbit.form.mesh.node_count
    V, G, F = np.empty((3, nodes + 1)), np.empty((3, nodes + 1)), np.empty(orbit.form.unknown_count)

    def rate(_, x):
        write_rates_of_state(x, F, V, G, p)
        return F / p.mass_diagonal

    times = orbit.period * np.array([0.5, 1.0])
    size = np.abs(orbit.all_states).max()
    found = solve_ivp(rate, (0, times[1]), orbit.start_state, "LSODA", times, rtol=1e-6, atol=1e-6 * size)
    half, whole = found.y.T
    assert np.abs(whole - orbit.start_state).max() < 0.01 * size
    assert np.abs(half - orbit.states_at_time_fractions(np.array([0.5]))[0]).max() < 0.01 * size
    moments = slice(2 * nodes, 3 * nodes)
    assert np.abs(half + orbit.start_state)[moments].max() > 0.05 * np.abs(orbit.start_state[moments]).max()


def test_the_largest_angle_is_that_of_the_mirror_image(known):
    here, _ = first_asymmetric_cycle(known.breakings[0], "F", ROUGH, known.workspace)
    orbit = next_cycle(here, ROUGH).orbit
    states = REFLECTION.apply(orbit.all_states, orbit.form.layout)
    image = replace(orbit, values=np.append(states.ravel(), orbit.period))
    paths = [CycleMotion(each) for each in (orbit, image)]
    signed = [path.tip_samples[:, 2].max() for path in paths]
    assert abs(signed[0] / signed[1] - 1) > 0.01
    for path in paths:
        assert measures_of(path).tip_theta_max == pytest.approx(max(signed), rel=1e-4)


def turned_back(here):
    """A cycle of a branch that is followed to its other side."""
    derivatives = replace(here.derivatives, tangent=-here.tangent, unit_tangent=-here.unit_tangent)
    return replace(here, derivatives=derivatives, previous=None)


@pytest.mark.long
def test_followed_back_the_branch_ends_where_it_was_born(known):
    here, _ = first_asymmetric_cycle(known.breakings[0], "F", ROUGH, known.workspace)
    for _ in range(2):
        here = next_cycle(here, ROUGH)
    curve = follow_from_cycle(
        BranchCurve(start_hopf_index=-1), turned_back(solve_on_sufficient_mesh(here, ROUGH)), known
    )
    assert curve.is_complete
    assert curve.end_breaking is known.breakings[0]
    assert kinds(curve) == ["symmetry_breaking"]


def test_a_symmetric_orbit_over_its_whole_period_is_the_same_motion(known):
    orbit = known.breakings[0].special_point.orbit
    whole = extended_to_whole_period(orbit)
    assert not whole.is_symmetric
    times = np.linspace(0, 1, 21)
    assert (
        np.abs(whole.states_at_time_fractions(times / 2) - orbit.states_at_time_fractions(times)).max()
        < 1e-4 * np.abs(orbit.all_states).max()
    )
    assert np.abs(bending_moment_asymmetry(whole)).max() < 1e-5 * np.abs(orbit.start_state).max()


def test_a_known_breaking_that_lies_elsewhere_is_not_taken_for_the_end(known):
    here, _ = first_asymmetric_cycle(known.breakings[0], "F", ROUGH, known.workspace)
    curve = follow_from_cycle(
        BranchCurve(start_hopf_index=-1), turned_back(here), replace(known, breakings=[])
    )
    assert not curve.is_complete
    assert curve.special_points[-1].end_reason == BranchEndReason.no_cycle_found
    assert "no symmetry breaking is known there" in curve.special_points[-1].message


@pytest.mark.parametrize(("has", "kind"), [(True, "symmetry_breaking"), (False, "period_doubling")])
def test_a_multiplier_that_passes_minus_one_is_told_by_the_symmetry(has, kind):
    here, there = (
        SimpleNamespace(
            parameter_per_arc_length=1.0,
            multipliers_over_solved_time_interval=np.array([h, 0.1, 0.2j, -0.2j]),
            orbit=SimpleNamespace(is_symmetric=has),
        )
        for h in (-0.9, -1.1)
    )
    assert special_kinds_between(here, there) == ([SpecialPointKind[kind]], True)


def test_errors_within_the_accuracy_do_not_keep_a_branch_from_its_end():
    """The period at a Hopf point had a tolerance of 1e-3 at any accuracy."""
    end, with_errors = (40.0, 0.04), (40.2, 0.0402)
    assert ends_within_extrapolation_tolerances(with_errors, end, end, accuracy=1e-2)
    assert not ends_within_extrapolation_tolerances(with_errors, end, end, accuracy=1e-4)


def test_the_file_says_which_branches_meet(symmetric, asymmetric):
    found = BranchesOfRod(status=BranchStatus.ok, curves=(symmetric, asymmetric))
    values = branch_values(found, "F", 200, 8)
    assert values["branch_count"] == 2
    assert values["special_meets"][:7] == [-1, 2, -1, 1, -1, -1, -1]
    assert values["special_branch"][:6] == [1, 1, 1, 2, 2, 2]
    first = values["branch"].index(2)
    assert values["tip_y_max"][first] > -values["tip_y_min"][first]


def test_show_says_from_which_branch_one_is_born():
    ends = (StoredSpecialPoint("symmetry_breaking", at, 1e-9, 0.1, 1.0, "none", -1, 1) for at in (19.9, 25.5))
    none = np.empty(0)
    told = _ends_phrase(StoredBranch(none, none, none, none, none, tuple(ends)), "F")
    assert told.startswith("without mirror symmetry, from branch 1 at F = 19.9")
    assert " to branch 1 at F = 25.5" in told
