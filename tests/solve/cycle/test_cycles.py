"""Limit cycles: the reference cycles, the neighbourhood of the Hopf point, hard cases, and every status."""

from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from rods import rod_of

from rodsweep.discretization.elements.mesh import uniform_mesh
from rodsweep.discretization.elements.quadrature import lobatto_points
from rodsweep.discretization.elements.trigonometric import interpolate_samples, time_derivative
from rodsweep.errors import EnvironmentIncomplete
from rodsweep.model.rod import Rod
from rodsweep.solve.backend.petsc import PETSc
from rodsweep.solve.changes.thresholds import ThresholdsRequest, solve_thresholds
from rodsweep.solve.cycle.accuracy import refinement
from rodsweep.solve.cycle.accuracy.cycle_errors import CYCLE_ERROR_SETTINGS
from rodsweep.solve.cycle.accuracy.minimal_period import (
    common_harmonic_divisor,
    possible_period_divisor,
    restricted_to_minimal_period,
)
from rodsweep.solve.cycle.limit_cycle import CycleRequest, CycleStatus, solve_cycle
from rodsweep.solve.cycle.rod_with_known_cycle import warm_up
from rodsweep.solve.cycle.transient import cycle_search, schemes, transient_integration
from rodsweep.solve.motion.integrator import destroy_integrators
from rodsweep.solve.orbit.coefficient_tails import coefficient_tails_of, legendre_analysis_matrix
from rodsweep.solve.orbit.compiled_measures import write_powers
from rodsweep.solve.orbit.matrix.workspace import NewtonWorkspace
from rodsweep.solve.orbit.measures import CycleMotion, measures_of
from rodsweep.solve.orbit.newton import newton_step_if_matrix_distant, solve_by_newton
from rodsweep.solve.orbit.orbit import Orbit, node_time_fractions, time_interval_lengths
from rodsweep.solve.orbit.symmetry import NO_SYMMETRY, REFLECTION
from rodsweep.solve.orbit.time_grading import UNIFORM_TIME_GRADING
from rodsweep.solve.unsolvable import Unsolvable

SOFT = (1e4, 1e2, 1e-2, 1.0)
"""(k1, k2, gamma3, gamma1) of the paper's Fig. 5."""
STRETCHABLE = (200.0, 1e4, 1e-4, 1.0)
REQUEST = CycleRequest(
    accuracy=1e-8, amplitude=0.1, harmonics=5, samples=100, shapes=8, nodes=33, most_periods=300
)


@cache
def cycle(F, rod=SOFT, amplitude=0.1, accuracy=1e-6):
    """A solved cycle, once for all tests."""
    return solve_cycle(rod_of(F, *rod), CycleRequest(accuracy, amplitude, 5, 100, 8, 33, 300), None, "F")


def reference():
    return cycle(50.0, SOFT, 0.1, 1e-8)


@cache
def hopf():
    """F** of the soft rod."""
    found = solve_thresholds(rod_of(0.0, *SOFT), ThresholdsRequest(40.0, 1e-12, False, 4))
    return next(c.value for c in found.thresholds if c.kind.name == "hopf")


# An independent displacement-form code: docs/method.md, reference values.
@pytest.mark.kernel
@pytest.mark.parametrize(
    "gamma1, period, y, x, theta",
    [
        (1.0, 0.0344504294, 0.64518306, (0.49134541, 0.87215785), 1.65474908),
        (0.5, 0.0259793620, 0.67645842, None, None),
    ],
)
def test_reference_cycles(gamma1, period, y, x, theta):
    c = cycle(50.0, (*SOFT[:3], gamma1), 0.1, 1e-8)
    assert c.status == CycleStatus.cycle
    assert c.measures.period == pytest.approx(period, rel=1e-7)
    assert c.measures.tip_y_max == pytest.approx(y, rel=1e-7)
    if x is not None:
        assert (c.measures.tip_x_min, c.measures.tip_x_max) == pytest.approx(x, rel=1e-7)
        assert c.measures.tip_theta_max == pytest.approx(theta, rel=1e-7)
    assert max(c.errors.period_error, c.errors.amplitude_error) <= 1e-8
    assert abs(c.measures.energy_imbalance) <= 1e-8
    assert c.trivial_multiplier_error <= 1e-8
    assert c.multiplier < 0.01


def test_accuracy_asked_for_is_reached():
    exact = reference()
    for accuracy in (1e-3, 1e-5, 1e-7):
        c = cycle(50.0, SOFT, 0.1, accuracy)
        assert c.status == CycleStatus.cycle
        assert c.measures.period == pytest.approx(exact.measures.period, rel=accuracy)
        assert c.measures.tip_y_max == pytest.approx(exact.measures.tip_y_max, rel=accuracy)
        for name in ("tip_x_min", "tip_x_max", "tip_theta_max"):
            error = abs(getattr(c.measures, name) - getattr(exact.measures, name)) / exact.measures.tip_y_max
            assert (
                error
                <= c.errors.extrema_error
                <= CYCLE_ERROR_SETTINGS.extrema_to_period_tolerance_ratio * accuracy
            )
        assert (
            abs(c.measures.energy_imbalance)
            <= CYCLE_ERROR_SETTINGS.extrema_to_period_tolerance_ratio * accuracy
        )


def test_cycle_does_not_depend_on_the_start():
    c = cycle(50.0, SOFT, 0.5, 1e-6)
    there = reference().measures
    assert (c.measures.period, c.measures.tip_y_max) == pytest.approx(
        (there.period, there.tip_y_max), rel=1e-6
    )


def test_amplitude_grows_as_the_square_root_beyond_the_hopf_point():
    above = np.array([0.003, 0.01, 0.03])
    cycles = [cycle(hopf() + dF) for dF in above]
    assert {c.status for c in cycles} == {CycleStatus.cycle}
    y = np.array([c.measures.tip_y_max for c in cycles])
    assert np.diff(np.log(y)) / np.diff(np.log(above)) == pytest.approx(0.5, abs=5e-3)
    assert max(c.periods for c in cycles) < 60
    assert max(c.errors.multiplier_error for c in cycles) < 1e-6
    mu = np.array([c.multiplier for c in cycles])
    assert (mu < 1).all()
    # The normal form: what the straight rod gains a period the cycle loses twice.
    gained = np.array([c.linear_growth_rate * c.measures.period for c in cycles])
    assert -np.log(mu) / gained == pytest.approx(2.0, abs=0.02)


def test_frequency_meets_the_linear_one_at_the_hopf_point():
    c = cycle(hopf() + 1e-6)
    assert c.status == CycleStatus.cycle
    assert c.measures.frequency == pytest.approx(c.linear_frequency, rel=1e-7)
    assert 1 - 1e-6 < c.multiplier < 1
    assert c.linear_growth_rate > 0


@pytest.mark.parametrize(
    "F, status", [(27.43, "cycle"), (27.42, "straight"), (10.0, "straight"), (0.0, "straight")]
)
def test_either_side_of_the_hopf_point(F, status):
    c = cycle(F)
    assert c.status.name == status
    assert c.status.succeeded
    assert np.isfinite(c.measures.tip_y_max) == (status == "cycle")


# Displacement form with consistent quadrature, SciPy's Radau, another start: settled to 2e-7. That code did
# not run at gamma3 = 1e-6, whose numbers are this period map's on finer meshes and with more steps.
@pytest.mark.parametrize(
    "F, rod, period, y",
    [
        (60.0, STRETCHABLE, 0.0156218564, 0.23070669),
        (100.0, STRETCHABLE, 0.0089188399, 0.32086302),
        (140.0, STRETCHABLE, 0.0057155730, 0.28575395),
        (150.0, SOFT, 0.0087679849, 0.58139769),
        (50.0, (1e4, 1e2, 1e-6, 1.0), 0.03096821052, 0.61647075),
        (50.0, (1e4, 1e6, 1e-2, 1.0), 0.0310059911, 0.50074471),
    ],
    ids=["soft 60", "soft 100", "soft 140", "F = 150", "gamma3 = 1e-6", "k2 = 1e6"],
)
def test_hard_cases(F, rod, period, y):
    c = cycle(F, rod)
    assert c.status == CycleStatus.cycle
    assert c.measures.period == pytest.approx(period, rel=1e-6)
    assert c.measures.tip_y_max == pytest.approx(y, rel=1e-6)
    # The collocation loses energy of the order of the error of the amplitude.
    assert abs(c.measures.energy_imbalance) <= 1e-6
    assert c.multiplier < 1


def test_a_stable_rod_may_also_beat():
    """k1 = 200, F = 170: the straight rod is stable again, and so is a cycle of large amplitude.

    Its numbers are the displacement form's, as above.
    """
    assert cycle(170.0, STRETCHABLE, 0.01).status == CycleStatus.straight
    far = cycle(170.0, STRETCHABLE, 0.1)
    below = cycle(150.0, STRETCHABLE, 0.1)
    near = solve_cycle(
        rod_of(170.0, *STRETCHABLE), CycleRequest(1e-6, 0.01, 5, 0, 0, 0, 300), below.start_for_next_rod, "F"
    )
    for c in (far, near):
        assert c.status == CycleStatus.cycle
        assert c.linear_growth_rate < 0
        assert c.measures.period == pytest.approx(0.0041656067, rel=1e-6)
        assert c.measures.tip_y_max == pytest.approx(0.24053930, rel=1e-6)


def test_below_the_hopf_point_a_neighbours_cycle_decays():
    above = cycle(27.43)
    for F in (27.42, 25.0):
        found = solve_cycle(rod_of(F, *SOFT), REQUEST, above.start_for_next_rod, "F")
        assert found.status == CycleStatus.straight


def test_what_a_neighbour_hands_on_is_its_cycle():
    c = reference()
    handed = c.start_for_next_rod
    assert handed.predictor.orbit.period == c.measures.period
    assert handed.predictor.orbit.form.tip_coordinates(handed.predictor.orbit.start_state)[
        1
    ] == pytest.approx(c.measures.tip_y_max)
    again = solve_cycle(rod_of(50.0, *SOFT), REQUEST, c.start_for_next_rod, "F")
    assert again.measures.period == pytest.approx(c.measures.period, rel=1e-9)
    assert again.periods == 0


def test_what_is_stored_agrees_with_the_numbers():
    c = reference()
    assert c.tip.shape == c.energy_and_powers.shape == (3, 100)
    assert c.shape.shape == (3, 8, 33)
    x, y, theta = c.tip
    # The path has harmonics beyond the 50 of 100 samples, far below its error.
    assert np.abs(c.shape[:, :, -1] - interpolate_samples(c.tip.T, np.arange(8) / 8).T).max() < 1e-8
    assert c.shape[:, :, 0] == pytest.approx(0.0, abs=1e-12)
    assert (x.min(), x.max()) == pytest.approx((c.measures.tip_x_min, c.measures.tip_x_max), rel=1e-3)
    assert (y.max(), theta.max()) == pytest.approx((c.measures.tip_y_max, c.measures.tip_theta_max), rel=1e-3)
    assert y[0] == pytest.approx(0.0, abs=1e-8)
    assert y[1] > 0
    (energy, injection, dissipation), m = c.energy_and_powers, c.measures
    assert (injection.mean(), dissipation.mean()) == pytest.approx((m.injection_mean, m.dissipation_mean))
    assert (injection.std(), dissipation.std()) == pytest.approx((m.injection_rms, m.dissipation_rms))
    assert time_derivative(energy) / m.period == pytest.approx(
        injection - dissipation, abs=1e-5 * m.injection_rms
    )
    harmonics = 2 * np.abs(np.fft.rfft(y))[1:6] / len(y)
    assert c.measures.harmonic_amplitude == pytest.approx(harmonics, abs=1e-10)
    assert c.measures.frequency * c.measures.period == pytest.approx(2 * np.pi)
    assert lobatto_points(33)[[0, -1]] == pytest.approx([0.0, 1.0])


def test_a_crushed_rod_has_left_the_model():
    c = cycle(195.0, STRETCHABLE, 0.5)
    assert c.status == CycleStatus.left_the_model
    assert not c.status.succeeded
    assert c.message
    assert np.isnan(c.measures.period)
    assert c.tip is c.start_for_next_rod is None


def test_a_rod_that_needs_longer_is_not_settled():
    c = solve_cycle(rod_of(30.0, *SOFT), CycleRequest(1e-6, 1e-7, 3, 10, 2, 5, 3))
    assert c.status == CycleStatus.not_settled
    assert c.periods >= 3
    assert np.isnan(c.measures.period)
    assert np.isnan(c.measures.harmonic_amplitude).all()


def test_a_failed_integration_is_a_status():
    options = {"cycle_snes_max_it": "1", "cycle_ts_max_snes_failures": "1"}
    for name, value in options.items():
        PETSc.Options()[name] = value
    destroy_integrators()
    try:
        c = solve_cycle(rod_of(50.0, *SOFT), REQUEST)
    finally:
        for name in options:
            PETSc.Options().delValue(name)
        destroy_integrators()
    assert c.status == CycleStatus.failed
    assert c.message
    assert c.linear_growth_rate > 0


def test_an_error_inside_is_a_status(monkeypatch):
    def fail(*_):
        raise np.linalg.LinAlgError("Singular matrix")

    monkeypatch.setattr(cycle_search, "refined_cycle", fail)
    c = solve_cycle(rod_of(50.0, *SOFT), REQUEST)
    assert (c.status, c.message) == (CycleStatus.failed, "Singular matrix")


def test_every_status_has_a_sentence():
    assert all(status.sentence for status in CycleStatus)
    known = [CycleStatus.cycle, CycleStatus.straight, CycleStatus.unstable, CycleStatus.torus]
    assert [status for status in CycleStatus if status.succeeded] == known


def test_warm_up_solves_a_cycle():
    warm_up()


def test_a_mesh_is_not_refined_for_what_is_left_of_time():
    """The extrema of two meshes are sampled at different phases, which no mesh can make agree to 1e-9."""
    cycle = solve_cycle(
        Rod(F=88.9376, k1=629.929, k2=60628.4, gamma3=5.59844e-4, gamma1=2.07035),
        replace(REQUEST, accuracy=1e-9),
    )
    assert cycle.status == CycleStatus.cycle
    assert cycle.order * cycle.elements < 60


@pytest.mark.long
def test_within_rounding_of_the_hopf_point_no_cycle_is_claimed():
    cycle = solve_cycle(Rod(F=27.42719413, k1=1e4, k2=1e2, gamma3=1e-2, gamma1=1.0), REQUEST)
    assert cycle.status == CycleStatus.not_settled
    assert np.isnan(cycle.measures.period)


def test_options_that_lose_the_cycle_are_refused_in_one_sentence():
    PETSc.Options()["cycle_ts_type"] = "nosuch"
    destroy_integrators()
    try:
        with pytest.raises(
            EnvironmentIncomplete, match="options '-cycle_ts_type nosuch' .* cannot run; remove"
        ):
            warm_up()
    finally:
        PETSc.Options().delValue("cycle_ts_type")
        destroy_integrators()
    warm_up()


# Their periods came out twice or three times as long: the motion settles by thirds of a turn (multipliers
# near exp(2 pi i/3)), or what the steps miss of the stiff components outweighed the distance of two returns.
@pytest.mark.kernel
@pytest.mark.parametrize("amplitude", [0.1, 0.01])
@pytest.mark.parametrize(
    "rod, period, accuracy",
    [
        ((55.18, 15694879, 875, 4.168693834703355e-06, 1.0), 0.0254862109, 1e-5),
        ((55.18, 15694879, 875, 4.168693834703355e-06, 1.0), 0.0254862109, 1e-6),
        ((55.18, 15694879, 875, 4.168693834703355e-06, 1.0), 0.0254862109, 1e-8),
        ((128.624, 4408.5, 34.034, 0.0016928, 0.85995), 0.0058406659, 1e-6),
    ],
)
def test_period_is_the_minimal_one(rod, period, accuracy, amplitude):
    c = solve_cycle(rod_of(*rod), CycleRequest(accuracy, amplitude, 9, 0, 0, 0, 400))
    assert c.status == CycleStatus.cycle
    assert c.measures.period == pytest.approx(period, rel=1e-5)
    assert np.argmax(c.measures.harmonic_amplitude) == 0


def orbit_at_fifty():
    return reference().start_for_next_rod.predictor.orbit


def repeated(half, times):
    """A symmetric orbit over so many of its halves, as one that is not known to be symmetric."""
    K = times * (half.interval_count - 1) + 1
    at = times * node_time_fractions(K, half.stage_count)
    number = np.floor(at + 1e-9)
    states = half.states_at_time_fractions(np.maximum(at - number, 0.0))
    later = number % 2 == 1
    states[later] = REFLECTION.apply(states[later], half.form.layout)
    return Orbit.from_states(half.form, NO_SYMMETRY, times * half.period / 2, states, half.stage_count)


def test_three_periods_are_recognised_and_cut_to_one():
    half = solve_by_newton(
        orbit_at_fifty().on_mesh(uniform_mesh(1, 16), 12, 4), 1e-10, NewtonWorkspace()
    ).orbit
    thrice = replace(repeated(half, 3), symmetry=REFLECTION)
    thrice = replace(thrice, values=np.append(thrice.values[:-1], 3 * half.period))
    assert [common_harmonic_divisor(CycleMotion(orbit), 1e-3) for orbit in (half, thrice)] == [1, 3]
    assert [possible_period_divisor(CycleMotion(orbit), 1e-8) for orbit in (half, thrice)] == [1, 3]
    assert restricted_to_minimal_period(half) is half
    once = newton_step_if_matrix_distant(
        solve_by_newton(restricted_to_minimal_period(thrice), 1e-10, NewtonWorkspace()), 0.0
    )
    assert once.orbit.period == pytest.approx(half.period, rel=1e-7)  # 34 intervals instead of 12
    assert np.abs(once.matrix.multipliers()[0]) == pytest.approx(1.0, abs=1e-8)


@cache
def orbit_on(elements, order):
    return solve_by_newton(
        orbit_at_fifty().on_mesh(uniform_mesh(elements, order), 12, 4, UNIFORM_TIME_GRADING),
        1e-10,
        NewtonWorkspace(),
    ).orbit


@pytest.mark.parametrize("elements, order", [(1, 15), (2, 8)])
def test_the_path_is_that_of_the_states_strains_and_shapes(elements, order):
    half = orbit_on(elements, order)
    path, form = CycleMotion(half), half.form
    states = np.concatenate(
        (
            half.states_equidistant_in_mesh_time,
            REFLECTION.apply(half.states_equidistant_in_mesh_time, form.layout),
        )
    )
    tip = form.tip_coordinates(states).T
    assert path.tip_x_y_theta_from_orbit_start(22 * 4)[::4] == pytest.approx(tip, abs=1e-13)
    strains = form.element_strains(states)
    series = path.strain_coefficients
    waves = np.exp(2j * np.pi * np.outer(np.arange(22) / 22, np.arange(23)))
    assert np.tensordot(waves, series, 1).real.swapaxes(0, 1) == pytest.approx(strains, abs=1e-12)
    assert path.curvature_harmonic_sizes == pytest.approx(np.linalg.norm(series[1:, 2], axis=1), abs=1e-13)
    unsymmetric = CycleMotion(repeated(half, 2))
    assert unsymmetric.tip_coefficients == pytest.approx(path.tip_coefficients, abs=1e-13)
    assert unsymmetric.curvature_harmonic_sizes == pytest.approx(path.curvature_harmonic_sizes, abs=1e-12)
    assert unsymmetric.tip_extrema == pytest.approx(path.tip_extrema, rel=1e-13)


def test_extrema_are_those_of_a_dense_path():
    path = CycleMotion(orbit_on(1, 15))
    x, y, theta = path.tip_x_y_theta_from_orbit_start(20000).T
    dense = {"tip_x_min": x.min(), "tip_x_max": x.max(), "tip_y_max": y.max(), "tip_theta_max": theta.max()}
    assert path.tip_extrema == pytest.approx(dense, rel=1e-6)
    assert path.tip_extrema["tip_x_min"] <= x.min() and path.tip_extrema["tip_x_max"] >= x.max()


def test_means_are_integrals_by_the_methods_own_quadrature():
    half = orbit_on(2, 8)
    m, stages = measures_of(CycleMotion(half)), half.stage_states.reshape(-1, half.form.unknown_count)
    power, weights = (
        np.empty((2, len(stages))),
        np.outer(time_interval_lengths(12), half.collocation_method.weights).ravel(),
    )
    write_powers(stages, power, half.orbit_equations)
    mean = power @ weights
    rms = np.sqrt((power - mean[:, None]) ** 2 @ weights)
    assert (m.injection_mean, m.dissipation_mean) == pytest.approx(tuple(mean), rel=1e-13)
    assert (m.injection_rms, m.dissipation_rms) == pytest.approx(tuple(rms), rel=1e-13)
    assert m.least_stretch == pytest.approx(half.form.least_stretch(stages), rel=1e-15)


@pytest.mark.parametrize("elements, order", [(1, 15), (2, 8)])
def test_the_tail_in_space_is_of_the_last_two_legendre_coefficients(elements, order):
    half = orbit_on(elements, order)
    stresses = half.form.stresses(half.stage_states[:, -1])
    analysis = legendre_analysis_matrix(2 * uniform_mesh(1, order).node_positions - 1)
    parts = [stresses[..., e * order : (e + 1) * order + 1] @ analysis.T for e in range(elements)]
    c = np.abs(np.stack(parts)).max(axis=(0, 2))
    envelope = np.maximum.accumulate((c / c.max(axis=1)[:, None]).max(axis=0)[::-1])[::-1]
    upper = np.arange(order + 1)[(order + 1) // 2 :]
    slope = np.polyfit(upper, np.log(envelope[upper]), 1)[0]
    assert coefficient_tails_of(half).log_coefficient_decay_per_order == pytest.approx(-slope, rel=1e-9)


@pytest.mark.parametrize(
    "sizes, error, divisor",
    [
        ({1: 1.0}, 1e-8, 1),
        ({2: 1.0, 6: 0.1}, 1e-8, 2),
        ({3: 1.0, 9: 0.1, 15: 1e-3}, 1e-8, 3),
        ({2: 1.0, 3: 0.01}, 1e-8, 1),
        ({3: 1.0, 1: 1e-4}, 1e-8, 1),
        ({3: 1.0, 1: 1e-4}, 1e-4, 3),  # the first harmonic may be an error
        ({6: 1.0, 9: 0.5}, 1e-8, 3),
        ({}, 1e-8, 0),
    ],
)
def test_harmonics_in_common_are_a_shorter_period_for_all_that_is_known(sizes, error, divisor):
    harmonics = np.zeros(32)
    for k, size in sizes.items():
        harmonics[k - 1] = size
    path = SimpleNamespace(curvature_harmonic_sizes=harmonics, tip_angle_harmonic_sizes=np.zeros(32))
    assert possible_period_divisor(path, error) == divisor
    # The tip alone shows that the period is minimal.
    path = SimpleNamespace(curvature_harmonic_sizes=np.eye(32)[1], tip_angle_harmonic_sizes=harmonics)
    assert possible_period_divisor(path, error) == (1 if divisor == 1 else 2)


def test_a_period_in_doubt_is_not_called_a_cycle(monkeypatch):
    monkeypatch.setattr(
        "rodsweep.solve.cycle.accuracy.refined_cycle.possible_period_divisor", lambda *given: 2
    )
    c = solve_cycle(rod_of(50.0, *SOFT), CycleRequest(1e-4, 0.1, 3, 0, 0, 0, 300))
    assert c.status == CycleStatus.not_settled
    assert "the period found may be 2 times the minimal period" in c.message


def test_a_start_off_the_slow_manifold_does_not_fail():
    """The fast components of k2 = 6e5, gamma3 = 6e-6 turn a scaled state into a rate of 1e7."""
    rod = (38.7203737525035, 893.9849423743017, 608319.4594422684, 5.91245928044301e-06, 0.7551516248693426)
    for amplitude in (0.1, 0.01):
        c = solve_cycle(rod_of(*rod), CycleRequest(1e-6, amplitude, 3, 0, 0, 0, 400))
        assert c.status == CycleStatus.straight


def test_what_grows_the_faster_the_larger_it_is_need_not_be_waited_for():
    """Just beyond the Hopf point motions grow the faster the larger they are, by 1e-3 a period at first."""
    rod = (85.54, 150.0, 1e4, 1e-4, 1.0)
    far, near = (solve_cycle(rod_of(*rod), CycleRequest(1e-6, a, 3, 0, 0, 0, 400)) for a in (0.1, 0.01))
    assert far.status == near.status == CycleStatus.cycle
    assert near.measures.period == pytest.approx(far.measures.period, rel=1e-6)
    assert near.measures.tip_y_max == pytest.approx(far.measures.tip_y_max, rel=1e-6)
    assert near.periods < 200


def test_a_motion_that_takes_too_many_steps_is_not_settled_and_says_so(monkeypatch):
    """Motions that return seldom went on for a minute, because only returns were counted."""
    monkeypatch.setattr(
        schemes,
        "TIME_SCHEME_SETTINGS",
        replace(schemes.TIME_SCHEME_SETTINGS, default_scheme_max_steps_per_return=1),
    )
    c = solve_cycle(rod_of(240.0, *SOFT), REQUEST)
    assert c.status == CycleStatus.not_settled
    assert c.periods < REQUEST.most_periods
    assert "no periodic motion within" in c.message
    assert "at the maximum of" in c.message


@pytest.mark.parametrize(("repeats", "meshes"), [(1, 4), (9, 1)])
def test_finer_meshes_are_tried_for_short_cycles_only(repeats, meshes, monkeypatch):
    """Chaotic motions, taken for cycles of nine returns, spent a minute on meshes of 280 intervals."""
    tried = []

    def fails(orbit, *_):
        tried.append(orbit.interval_count)
        raise Unsolvable("no orbit")

    half = orbit_at_fifty()
    monkeypatch.setattr(refinement, "solve_by_newton", fails)
    points = np.concatenate([half.all_states[:1], np.tile(half.all_states[1:], (repeats, 1))])
    orbit = Orbit.from_states(half.form, half.symmetry, repeats * half.period, points, half.stage_count)
    with pytest.raises(Unsolvable):
        refinement.refined_cycle_of_any_period(orbit, 1e-6, NewtonWorkspace())
    assert len(tried) == meshes


def test_a_closed_motion_without_a_cycle_near_ends_and_says_so(monkeypatch):
    """It went on to the last return, and then "none periodic" was said of it."""

    def fails(*_):
        raise Unsolvable("no orbit")

    monkeypatch.setattr(cycle_search, "refined_cycle", fails)
    c = solve_cycle(rod_of(50.0, *SOFT), REQUEST)
    assert c.status == CycleStatus.not_settled
    assert c.periods < REQUEST.most_periods
    assert "the motion repeats within" in c.message
    assert "but Newton's method finds no cycle near this motion on finer meshes" in c.message


@pytest.mark.long
def test_a_slow_motion_near_a_fold_reaches_the_cycle_by_its_amplitude_equation():
    """The branch of these cycles folds at F = 85.60558. The motion needs 800 returns from above, and
    thousands from below; a cycle with a multiplier of 0.99789 is its limit."""
    rod = Rod(F=85.6, k1=150.0, k2=1e4, gamma3=1e-4)
    for amplitude in (0.06, 0.1):
        request = CycleRequest(
            amplitude=amplitude, harmonics=8, samples=0, shapes=0, nodes=0, most_periods=400, accuracy=1e-5
        )
        found = solve_cycle(rod, request)
        assert found.status == CycleStatus.cycle
        assert found.measures.tip_y_max == pytest.approx(0.0426912583, rel=1e-5)


@pytest.mark.long
def test_a_motion_that_is_slow_near_a_fold_is_said_to_be(monkeypatch):
    """Without the amplitude equation the motion above is not settled within 320 returns."""
    monkeypatch.setattr(
        transient_integration.AmplitudeEquation, "scaling_factor_to_slow_limit", lambda *_: None
    )
    rod = Rod(F=85.6, k1=150.0, k2=1e4, gamma3=1e-4)
    request = CycleRequest(
        amplitude=0.06, harmonics=8, samples=0, shapes=0, nodes=0, most_periods=320, accuracy=1e-5
    )
    found = solve_cycle(rod, request)
    assert found.status == CycleStatus.not_settled
    assert "only: the motion changes slowly, as near a fold of a branch of cycles" in found.message
