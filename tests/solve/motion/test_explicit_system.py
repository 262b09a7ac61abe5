"""The nonlinear rod in its body frame: rates, Jacobian, energy, shape, and its motion by PETSc TS."""

import numpy as np
import pytest
from pointwise_balance import dissipated_power_per_length, strain, velocity

from rodsweep.discretization.elements.basis import differentiation_matrix
from rodsweep.discretization.elements.mesh import shape_from_strains, uniform_mesh
from rodsweep.discretization.elements.quadrature import gauss_lobatto_rule
from rodsweep.discretization.explicit_system import ExplicitSystem
from rodsweep.discretization.straight.longitudinal_modes import longitudinal_eigenvalues
from rodsweep.model.balance import ad
from rodsweep.model.rod import Rod
from rodsweep.solve.backend.petsc import PETSc
from rodsweep.solve.motion.callback_context import MAX_EXTRAPOLATION_POINTS
from rodsweep.solve.motion.integrator import (
    RELAXATION_SCHEME,
    EndReason,
    Integrator,
    RunLimit,
    destroy_integrators,
    integrator,
)
from rodsweep.solve.motion.leading_mode import leading_mode
from rodsweep.solve.motion.stage_predictor import extrapolate
from rodsweep.solve.motion.step_record import STEP_RECORD_SETTINGS
from rodsweep.solve.motion.time_scheme import EXTRAPOLATION_POINTS, TimeScheme
from rodsweep.solve.spectrum.search import SpectrumRequest, solve_spectrum

ROD = Rod(F=50.0, k1=1e4, k2=1e2, gamma3=1e-2)
MESHES = pytest.mark.parametrize("elements, order", [(1, 16), (3, 8)])


def evolve(system, z, duration, scheme=None):
    """The motion of a rod from z over `duration`."""
    return integrator(system.mesh, scheme or TimeScheme()).run(system, z, duration)


def bent(system, size=1.0):
    """A state far from rest, smooth in u."""
    u = system.mesh.node_positions
    E = system.strains(np.zeros(system.layout.unknown_count))
    wave = np.array([0.01 * np.cos(3 * u), 0.3 * np.sin(2 * u + 1), 2 * np.cos(4 * u)])
    return system.state_of_strains(E + size * (1 - u) * wave)


def rough(system):
    """A state that no mesh resolves."""
    return bent(system) + 0.01 * np.random.default_rng(1).standard_normal(system.layout.unknown_count)


def injected_and_dissipated(system, z):
    """-F v1(1), by the reaction v1(1) of the tip's stress, and <Gamma V, V>."""
    coefficients, matrices = system.rod.balance_coefficients, system.mesh.node_matrices
    stress = np.zeros((3, system.mesh.node_count + 1))
    stress[:, :-1] = z.reshape(3, -1) / system.sqrt_compliance[:, :-1]
    stress += coefficients.tip_stress[:, None]
    V = velocity(coefficients, stress, stress @ matrices.differentiation_matrix.T)
    dissipated = dissipated_power_per_length(coefficients, V) @ matrices.quadrature_weights
    straining = ad(strain(coefficients, stress), V)[0, -1]  # ad_E V of the tip
    reaction = matrices.quadrature_weights[-1] * straining - matrices.differentiation_matrix[:, -1] @ (
        matrices.quadrature_weights * V[0]
    )
    return system.rod.F * reaction, dissipated


@MESHES
def test_jacobian_is_the_derivative_of_the_rate(elements, order):
    system = ExplicitSystem(ROD.with_values(gamma1=0.7), uniform_mesh(elements, order))
    z = rough(system)
    J = system.jacobian(z)
    for k, d in enumerate(1e-3 * np.eye(len(z))):  # the rate is cubic: this difference is exact
        difference = 8 * (system.state_derivative(z + d) - system.state_derivative(z - d)) - (
            system.state_derivative(z + 2 * d) - system.state_derivative(z - 2 * d)
        )
        column = difference / (12 * d[k])
        assert np.abs(J[:, k] - column).max() <= 1e-10 * np.abs(J[:, k]).max()


@pytest.mark.kernel
@MESHES
def test_energy_law_holds_on_the_mesh_to_rounding(elements, order):
    system = ExplicitSystem(ROD.with_values(gamma1=0.7), uniform_mesh(elements, order))
    z = rough(system)
    rate, n = system.state_derivative(z), system.mesh.node_count
    stress = z.copy()
    stress[:n] -= ROD.F / ROD.k1**0.5  # Sigma = K^1/2 z + (-F, 0, 0)
    change = stress @ (np.tile(system.mesh.quadrature_weights[:-1], 3) * rate)
    injected, dissipated = injected_and_dissipated(system, z)
    assert change == pytest.approx(injected - dissipated, abs=1e-14 * (abs(injected) + dissipated))
    step = 1e-9
    measured = (system.elastic_energy(z + step * rate) - system.elastic_energy(z - step * rate)) / (2 * step)
    assert measured == pytest.approx(change, rel=1e-6)


@MESHES
def test_strains_do_not_depend_on_where_the_clamp_is(elements, order):
    system = ExplicitSystem(ROD, uniform_mesh(elements, 2 * order))
    E = system.element_strains(bent(system))
    here = shape_from_strains(system.mesh, E, np.zeros(3))
    x, y, theta = there = shape_from_strains(system.mesh, E, np.array([2.0, -1.0, 2.5]))
    turn = np.array([[np.cos(2.5), -np.sin(2.5)], [np.sin(2.5), np.cos(2.5)]])
    assert np.abs(there[:2] - turn @ here[:2] - np.array([[2.0], [-1.0]])).max() < 1e-13
    D = 2 * elements * differentiation_matrix(gauss_lobatto_rule(2 * order)[0])
    for e in range(elements):
        part = slice(e * 2 * order, (e + 1) * 2 * order + 1)
        dx, dy, Pi = D @ x[part], D @ y[part], D @ theta[part]
        cos, sin = np.cos(theta[part]), np.sin(theta[part])
        again = np.array([cos * dx + sin * dy, cos * dy - sin * dx, Pi])
        assert np.abs(again - E.reshape(3, elements, -1)[:, e]).max() < 1e-9


@MESHES
def test_uniformly_bent_rod_is_an_arc(elements, order):
    grid = uniform_mesh(elements, order)
    E = np.zeros((3, grid.element_node_indices.size))
    E[0], E[2] = 0.9, 2.0
    x, y, theta = shape_from_strains(grid, E, np.zeros(3))
    angle = 2.0 * grid.node_positions
    assert np.abs(theta - angle).max() < 1e-14
    assert np.abs(x - 0.45 * np.sin(angle)).max() < 1e-14
    assert np.abs(y - 0.45 * (1 - np.cos(angle))).max() < 1e-14


def test_velocity_of_the_tip_is_that_of_its_reconstruction():
    system = ExplicitSystem(ROD, uniform_mesh(1, 20))
    z, step = bent(system), 1e-8
    rate = system.state_derivative(z)
    difference = (system.tip_coordinates(z + step * rate) - system.tip_coordinates(z - step * rate)) / (
        2 * step
    )
    assert system.tip_position_and_velocity(z, rate)[1] == pytest.approx(difference, rel=1e-6)


@pytest.mark.kernel
@pytest.mark.parametrize(
    "rod", [ROD, Rod(F=27.43, k1=1e4, k2=1e2, gamma3=1e-2), Rod(F=60.0, k1=200.0, k2=1e4, gamma3=1e-4)]
)
def test_linearisation_has_the_spectrum_of_the_straight_rod(rod):
    system = ExplicitSystem(rod.with_values(gamma1=0.8), uniform_mesh(1, 20))
    values = np.linalg.eigvals(system.jacobian(np.zeros(60)))
    transverse = solve_spectrum(rod, SpectrumRequest(4, 1e-12, True)).eigenvalues
    for w in np.concatenate([transverse, longitudinal_eigenvalues(rod.k1, 0.8, 3)]):
        assert np.abs(values - w).min() <= 1e-9 * abs(w)
    assert leading_mode(system).w == pytest.approx(transverse[0], rel=1e-9)


@pytest.mark.parametrize(("F", "k1", "k2", "tip"), [(40.0, 1e4, 1e4, 1.0), (8.0, 30.0, 0.3, 0.6)])
def test_leading_mode_has_a_bounded_deflection_everywhere(F, k1, k2, tip):
    """The mode of the second rod, which is soft in shear, deflects three times as far beside its tip."""
    system = ExplicitSystem(Rod(F=F, k1=k1, k2=k2, gamma3=0.1), uniform_mesh(1, 20))
    z, rest = leading_mode(system).mode, np.zeros(60)
    y = np.hypot(*(system.y_velocities(rest, part) for part in (z.real, z.imag)))
    assert y.max() == pytest.approx(1.0 if tip == 1 else 2.0, rel=1e-9)
    deflection, turned = (system.tip_position_and_velocity(rest, part)[1][1] for part in (z.real, z.imag))
    assert (deflection, turned) == pytest.approx((tip, 0), rel=0.02, abs=1e-12)


def test_shape_converges_with_order_and_with_elements():
    exact = ExplicitSystem(ROD, uniform_mesh(1, 36))
    for elements, order in ((1, 24), (2, 18), (4, 12)):
        system = ExplicitSystem(ROD, uniform_mesh(elements, order))
        assert system.tip_coordinates(bent(system)) == pytest.approx(
            exact.tip_coordinates(bent(exact)), abs=1e-12
        )


@pytest.mark.kernel
def test_small_start_grows_like_the_leading_eigenvalue():
    system = ExplicitSystem(ROD, uniform_mesh(1, 20))
    mode, duration = leading_mode(system), 0.02
    start = 1e-7 * mode.mode.real
    values, left = np.linalg.eig(system.jacobian(np.zeros(60)).T)
    row = left[:, np.argmin(np.abs(values - mode.w))]
    run = evolve(system, start, duration, TimeScheme(tolerance=1e-11, newton_tolerance_ratio=0.01))
    assert run.end_reason == EndReason.reached
    grown = np.log((row @ run.states[-1]) / (row @ run.states[0]) * np.exp(-1j * mode.w.imag * duration))
    assert grown.real / duration == pytest.approx(mode.w.real, rel=1e-6)
    assert abs(grown.imag) / duration < 1e-6 * mode.w.imag


@pytest.mark.parametrize("variant, order", [("3", 3), ("4", 4), ("5", 5)])
def test_equal_steps_have_the_order_of_the_method(variant, order):
    """On a rod whose stiffness the steps resolve; order reduction is a stiff rod's."""
    system = ExplicitSystem(Rod(F=5.0, k1=10.0, k2=10.0, gamma3=1.0), uniform_mesh(1, 3))
    start, duration = bent(system), 0.02
    method = TimeScheme("arkimex", variant, tolerance=1e-8, newton_tolerance_ratio=1e-6, has_equal_steps=True)

    def end(steps):
        run = integrator(system.mesh, method).run(system, start, duration, duration / steps)
        assert len(run.times) == steps + 1
        return run.states[-1]

    first, second, third = end(20), end(40), end(80)
    measured = np.log2(np.abs(first - second).max() / np.abs(second - third).max())
    assert measured == pytest.approx(order, abs=0.35)


def test_all_steps_of_a_long_run_are_kept():
    system = ExplicitSystem(ROD, uniform_mesh(1, 6))
    start, steps = leading_mode(system).state(0.1), 3 * STEP_RECORD_SETTINGS.first_capacity
    method = TimeScheme("arkimex", "3", has_equal_steps=True)
    run = integrator(system.mesh, method).run(system, start, 0.03, 0.03 / steps)
    assert run.times == pytest.approx(np.linspace(0.0, 0.03, steps + 1))
    assert np.array_equal(run.states[0], start)
    seen = []
    watched = RunLimit(lambda z: seen.append(z) is not None)
    again = integrator(system.mesh, method).run(system, start, 0.03, 0.03 / steps, watched)
    assert np.array_equal(again.states, run.states)
    assert np.array_equal(seen, run.states[1:])


METHODS = [
    TimeScheme(tolerance=1e-6),
    TimeScheme("arkimex", "3", 1e-7),
    TimeScheme("arkimex", "4", 1e-6),
    TimeScheme("bdf", "5", 1e-7),
    TimeScheme("rosw", "ra34pw2", 1e-6),
    TimeScheme("rosw", "rodas3", 1e-6),
    TimeScheme("alpha", "", 1e-5),  # its rates are not taken at the unknown of its stage
    TimeScheme("cn", "", 1e-5),  # its stage has a right side, and its slope a shift of its own
]
if PETSc.Sys.getVersion() >= (3, 20):  # its first slopes come from a solve whose matrix PETSc scales in place
    METHODS += [TimeScheme("dirk", "es325sal", 1e-7), TimeScheme("dirk", "es648sa", 1e-7)]


@pytest.mark.parametrize("method", METHODS, ids=lambda method: f"{method.ts_type} {method.ts_sub_type}")
def test_every_method_follows_the_same_motion(method):
    system = ExplicitSystem(ROD, uniform_mesh(1, 14))
    start = leading_mode(system).state(0.3)
    exact = evolve(system, start, 0.03, TimeScheme(tolerance=1e-10, newton_tolerance_ratio=0.01)).states[-1]
    run = evolve(system, start, 0.03, method)
    assert run.end_reason == EndReason.reached
    assert run.times[-1] == pytest.approx(0.03)
    assert np.abs(run.states[-1] - exact).max() < 2e-4 * np.abs(exact).max()


def test_stages_of_a_polynomial_motion_are_predicted_exactly():
    rng = np.random.default_rng(2)
    times, coefficients = rng.random(8), rng.standard_normal((4, 5))
    states, out = np.polynomial.polynomial.polyval(times, coefficients).T, np.empty(5)
    extrapolate(np.array([6, 1, 3, 4]), times, states, 1.3, out)
    assert out == pytest.approx(np.polynomial.polynomial.polyval(1.3, coefficients), abs=1e-11)


@pytest.mark.parametrize("variant", EXTRAPOLATION_POINTS)
def test_predicted_stages_are_known_by_then(variant):
    stages = len(EXTRAPOLATION_POINTS[variant]) + 1
    for stage, (this, last) in EXTRAPOLATION_POINTS[variant].items():
        assert all(k < stage for k in this)
        assert all(k < stages for k in last)
        assert 0 < len(this) + len(last) <= MAX_EXTRAPOLATION_POINTS


@pytest.mark.parametrize("variant", EXTRAPOLATION_POINTS)
def test_prediction_spares_iterations_and_leaves_the_motion_alone(variant):
    system = ExplicitSystem(ROD, uniform_mesh(1, 14))
    start, scheme = leading_mode(system).state(0.3), TimeScheme("arkimex", variant, 1e-6)
    predicting, plain = Integrator(system.mesh, scheme), Integrator(system.mesh, scheme)
    plain.workspace.set_extrapolation_points("")
    ends, iterations = [], []
    for made in (predicting, plain):
        ends.append(made.run(system, start, 0.03).states[-1])
        iterations.append(made.ts.getSNESIterations())
        made.destroy()
    assert np.abs(ends[0] - ends[1]).max() < 1e-4 * np.abs(ends[1]).max()
    assert 0 < iterations[0] < 0.75 * iterations[1]


def test_jacobian_is_right_whatever_petsc_did_to_the_matrix():
    system, shift = ExplicitSystem(ROD, uniform_mesh(1, 8)), 1e3
    made = integrator(system.mesh, TimeScheme())
    z, rows = bent(system), list(range(system.layout.unknown_count))
    made.workspace.set_rod_and_tolerances(system, 1e-8, 1e-8)
    made.workspace.base[:] = z
    state, slope = made.vector.duplicate(), made.vector.duplicate()
    state.array_w[:] = z
    expected = shift * np.eye(len(z)) - system.jacobian(z)

    def again():
        made.ts.computeIJacobian(0.0, state, slope, shift, made.matrix)
        return made.matrix.getValues(rows, rows)  # reading a dense array counts as a change

    assert again() == pytest.approx(expected, rel=1e-13, abs=1e-9)
    factored = int(made.workspace.context["factorisations"])
    assert again() == pytest.approx(expected, rel=1e-13, abs=1e-9)
    assert made.workspace.context["factorisations"] == factored, "a matrix that nobody touched is made once"
    made.matrix.scale(1e-3)
    assert again() == pytest.approx(expected, rel=1e-13, abs=1e-9)
    made.matrix.zeroEntries()
    assert again() == pytest.approx(expected, rel=1e-13, abs=1e-9)
    for vector in (state, slope):
        vector.destroy()


@pytest.fixture
def petsc_options():
    """Sets PETSc options for one test."""
    given = []

    def give(name, value):
        given.append(name)
        PETSc.Options()[name] = value
        destroy_integrators()

    yield give
    for name in given:
        PETSc.Options().delValue(name)
    destroy_integrators()


def test_users_options_override_the_method(petsc_options):
    grid = uniform_mesh(1, 8)
    assert integrator(grid, TimeScheme()).ts.getType() == "arkimex"
    petsc_options("cycle_ts_type", "bdf")
    assert integrator(grid, TimeScheme()).ts.getType() == "bdf"
    assert integrator(grid, RELAXATION_SCHEME).ts.getType() == "beuler"


def test_newtons_method_may_be_petscs(petsc_options):
    system = ExplicitSystem(ROD, uniform_mesh(1, 14))
    start = leading_mode(system).state(0.3)
    ours = evolve(system, start, 0.03, TimeScheme(tolerance=1e-8))
    petsc_options("cycle_snes_type", "newtonls")
    assert integrator(system.mesh, TimeScheme()).ts.getSNES().getType() == "newtonls"
    theirs = evolve(system, start, 0.03, TimeScheme(tolerance=1e-8))
    assert np.abs(theirs.states[-1] - ours.states[-1]).max() < 1e-6 * np.abs(ours.states[-1]).max()


def test_defaults_of_the_method_are_not_recorded_as_the_users_options():
    before = PETSc.Options().getAll()
    destroy_integrators()
    integrator(uniform_mesh(1, 8), TimeScheme())
    assert PETSc.Options().getAll() == before


def test_a_failed_integration_is_an_ending(petsc_options):
    petsc_options("cycle_snes_max_it", "1")
    petsc_options("cycle_ts_max_snes_failures", "1")
    system = ExplicitSystem(ROD, uniform_mesh(1, 14))
    run = evolve(system, bent(system), 1.0)
    assert run.end_reason == EndReason.failed
    assert len(run.times) == len(run.states)


def test_an_error_inside_petsc_is_an_ending(petsc_options):
    petsc_options("cycle_pc_factor_mat_solver_type", "nosuch")
    system = ExplicitSystem(ROD, uniform_mesh(1, 14))
    run = evolve(system, bent(system), 1.0)
    assert run.end_reason == EndReason.failed
    assert run.message


def test_a_crushed_rod_has_left_the_model():
    system = ExplicitSystem(Rod(F=195.0, k1=200.0, k2=1e4, gamma3=1e-4), uniform_mesh(1, 14))
    run = evolve(system, leading_mode(system).state(0.5), 1e-3)
    assert run.end_reason == EndReason.left_the_model
    assert system.least_stretch(run.states[-1]) <= 0 < system.least_stretch(run.states[0])
