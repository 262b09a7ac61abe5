"""The mixed form of the nonlinear rod: its spectrum, Jacobian, energy law, and the strain form beside it."""

from dataclasses import replace

import mixed_motion as mixed
import numpy as np
import pytest
from mixed_motion import mixed_form, whole_A
from pointwise_balance import strain, velocity
from rods import rod_of

from rodsweep.discretization.elements.basis import differentiation_matrix
from rodsweep.discretization.elements.mesh import uniform_mesh
from rodsweep.discretization.elements.quadrature import gauss_lobatto_rule
from rodsweep.discretization.explicit_system import ExplicitSystem
from rodsweep.discretization.straight.longitudinal_modes import longitudinal_eigenvalues
from rodsweep.model.rod import Rod

INF = np.inf
STIFF, SOFT, FILAMENT = (
    Rod(F=30.0, k1=1e4, k2=1e4, gamma3=1e-4),
    Rod(F=50.0, k1=1e4, k2=1e2, gamma3=1e-2),
    Rod(F=30.0, k1=INF, k2=INF, gamma3=0.0),
)
RODS = pytest.mark.parametrize(
    "rod",
    [
        STIFF,
        SOFT,
        FILAMENT,
        Rod(F=45.0, k1=150.0, k2=INF, gamma3=0.0),
        Rod(F=20.0, k1=50.0, k2=5.0, gamma3=0.0),
        Rod(F=40.0, k1=INF, k2=INF, gamma3=1e-2),
    ],
)
MESHES = pytest.mark.parametrize("elements, order", [(1, 16), (3, 8)])
GAMMA1 = 0.7


def some_state(form, seed=1, imaginary=False):
    """Stresses that bend the rod by about a radian, velocities of the size that such stresses cause."""
    X = np.random.default_rng(seed).standard_normal((2, form.unknown_count))
    X[:, 3 * form.mesh.node_count :] *= 100
    return X[0] + 1j * X[1] if imaginary else X[0]


def consistent(form, X):
    """X with the velocities that its stresses give it, of a rod with rotational drag."""
    S, _ = form.stresses_and_velocities(X)
    Sigma = S + form.rod.balance_coefficients.tip_stress[:, None]
    return form.layout.state(
        S,
        velocity(
            form.rod.balance_coefficients, Sigma, Sigma @ form.mesh.node_matrices.differentiation_matrix.T
        ),
    )


def finite_eigenvalues(form):
    """Those of (A, M): the inverses of those of A^-1 M that are not 0 but for rounding."""
    norm = np.sqrt(np.where(form.M > 0, form.M, 1.0))  # of the energy
    balanced = np.linalg.solve(whole_A(form) / norm / norm[:, None], np.diag(form.M / norm**2))
    inverse = np.linalg.eigvals(balanced)
    return 1 / inverse[np.abs(inverse) > 1e-12 * np.abs(inverse).max()]


def roots(reference_spectra, group, gamma3):
    """(rod, its four rightmost eigenvalues) of the reference, of one group, with or without gamma3."""
    for point in reference_spectra:
        rod = rod_of(*(float(point[name]) for name in ("F", "k1", "k2", "gamma3")))
        if point["group"] == group and (rod.gamma3 > 0) == gamma3 and 0 <= rod.F <= 100:
            yield rod, [complex(float(re), float(im)) for re, im in point["eigenvalues"][:4]]


# --- about the straight rod -------------------------------------------------------------------------------


@pytest.mark.kernel
@pytest.mark.parametrize("elements, order", [(1, 26), (2, 20)])
@pytest.mark.parametrize(
    "group, gamma3", [("a-random", True), ("a-random", False), ("c", True), ("d", True), ("d", False)]
)
def test_spectrum_is_that_of_the_determinant(reference_spectra, group, gamma3, elements, order):
    """Roots to 25 digits, from soft rods to the filament, c1 = c2 = gamma3 = 0."""
    rods = list(roots(reference_spectra, group, gamma3))[:12]
    assert len(rods) >= 5
    for rod, exact in rods:
        found = finite_eigenvalues(mixed_form(rod.with_values(gamma1=GAMMA1), elements, order))
        for w in exact:
            assert np.abs(found - w).min() <= 1e-12 * abs(w)


def test_reference_holds_filaments_and_rods_that_shear_without_rotational_drag(reference_spectra):
    without = [rod for rod, _ in roots(reference_spectra, "d", False)][:12]
    assert Rod(F=30.0, k1=INF, k2=INF, gamma3=0.0) in without
    assert any(rod.c2 > 0 for rod in without)


def test_longitudinal_modes_are_in_the_spectrum():
    found = finite_eigenvalues(mixed_form(SOFT.with_values(gamma1=GAMMA1), 1, 24))
    for rate in longitudinal_eigenvalues(SOFT.k1, GAMMA1, 3):
        assert np.abs(found - rate).min() <= 1e-11 * abs(rate)


@RODS
def test_A_is_affine_in_F_with_the_slope_A_F(rod):
    here = mixed_form(rod.with_values(gamma1=GAMMA1), 2, 6)
    there = mixed_form((replace(rod, F=rod.F - 7.5)).with_values(gamma1=GAMMA1), 2, 6)
    A_F = here.times_force_derivative_of_A(np.eye(here.unknown_count)).T
    assert np.abs(whole_A(here) - 7.5 * A_F - whole_A(there)).max() <= 1e-14 * np.abs(whole_A(here)).max()
    assert np.abs(A_F).max() > 0


@RODS
@MESHES
def test_straight_rod_is_at_rest_and_its_mirror_images_move_as_such(rod, elements, order):
    form = mixed_form(rod.with_values(gamma1=GAMMA1), elements, order)
    assert np.abs(mixed.rate(form, np.zeros(form.unknown_count))).max() == 0
    X, R = some_state(form), form.reflection_signs
    assert mixed.rate(form, R * X) == pytest.approx(R * mixed.rate(form, X), rel=1e-13, abs=1e-10)


# --- the quadratic form -----------------------------------------------------------------------------------


@RODS
@MESHES
def test_bilinear_form_is_symmetric_and_linear(rod, elements, order):
    form = mixed_form(rod.with_values(gamma1=GAMMA1), elements, order)
    X, Y, Z = (some_state(form, seed, imaginary=True) for seed in (1, 2, 3))
    close = {"rel": 1e-12, "abs": 1e-9}
    assert form.bilinear_map(X, Y) == pytest.approx(form.bilinear_map(Y, X), **close)
    twice = form.bilinear_map(X, Y) + 2j * form.bilinear_map(X, Z)
    assert form.bilinear_map(X, Y + 2j * Z) == pytest.approx(twice, **close)
    many = np.stack([X, Y, Z]).reshape(3, 1, -1)
    assert mixed.rate(form, many)[2, 0] == pytest.approx(mixed.rate(form, Z), **close)


@RODS
@MESHES
def test_jacobian_is_the_derivative_of_the_rate(rod, elements, order):
    form, step = mixed_form(rod.with_values(gamma1=GAMMA1), elements, order), 1e-30
    X = some_state(form)
    J = mixed.jacobian(form, X)
    for k, direction in enumerate(1j * step * np.eye(form.unknown_count)):
        column = mixed.rate(form, X + direction).imag / step
        assert np.abs(J[:, k] - column).max() <= 1e-13 * np.abs(column).max()


@MESHES
def test_equations_are_the_balance_weighted_by_the_quadrature(elements, order):
    """By the derivative within each element, of whose residuals those of shared nodes are the sum."""
    form, material = (
        mixed_form(SOFT.with_values(gamma1=GAMMA1), elements, order),
        SOFT.with_values(gamma1=GAMMA1).balance_coefficients,
    )
    X = some_state(form)
    S, V = form.stresses_and_velocities(X)
    Sigma = S + material.tip_stress[:, None]
    nodes, weights = gauss_lobatto_rule(order)
    E, D, W = strain(material, Sigma), 2 * elements * differentiation_matrix(nodes), weights / (2 * elements)
    in_strain, in_force = np.zeros_like(S), np.zeros_like(S)
    for first in range(0, elements * order, order):
        here = slice(first, first + order + 1)
        (h1, h2, kappa), (n1, n2, _), (v1, v2, Omega) = E[:, here], Sigma[:, here], V[:, here]
        bent = np.array([h2 * Omega - kappa * v2, kappa * v1 - h1 * Omega, 0 * Omega])
        in_strain[:, here] += W * bent - (W * V[:, here]) @ D
        turned = np.array([-kappa * n2, kappa * n1, h1 * n2 - h2 * n1])
        in_force[:, here] += W * (Sigma[:, here] @ D.T + turned - material.drag[:, None] * V[:, here])
    residual = form.layout.state(in_strain, in_force)
    assert mixed.rate(form, X) == pytest.approx(residual, rel=1e-12, abs=1e-13 * np.abs(residual).max())


# --- energy and tip ---------------------------------------------------------------------------------------


@MESHES
def test_derivative_is_summed_by_parts(elements, order):
    WD, ends = (
        -uniform_mesh(elements, order).node_matrices.weak_derivative_matrix.T,
        np.zeros((elements * order + 1,) * 2),
    )
    ends[0, 0], ends[-1, -1] = -1, 1
    assert np.abs(WD + WD.T - ends).max() <= 1e-13
    form = mixed_form(FILAMENT.with_values(gamma1=GAMMA1), elements, order)
    u, W = form.mesh.node_positions, form.mesh.quadrature_weights
    assert WD @ u**order == pytest.approx(W * order * u ** (order - 1), abs=1e-13)


@pytest.mark.kernel
@pytest.mark.parametrize("rod", [STIFF, SOFT, Rod(F=-20.0, k1=30.0, k2=20.0, gamma3=0.5)])
@MESHES
def test_energy_law_holds_on_the_mesh_to_rounding(rod, elements, order):
    form = mixed_form(rod.with_values(gamma1=GAMMA1), elements, order)
    X = consistent(form, some_state(form))
    equation, stresses = mixed.rate(form, X), slice(3 * form.mesh.node_count)
    change = np.zeros(form.unknown_count)
    change[stresses] = equation[stresses] / form.M[stresses]
    power = mixed.energy(form, X + 1e-30j * change).imag / 1e-30
    terms = np.abs(form.stresses_and_velocities(X)[0][:, :-1].ravel() * equation[stresses]).sum()
    injected, lost = rod.F * mixed.reaction(form, X)[0], mixed.dissipation(form, X)
    assert power == pytest.approx(injected - lost, abs=1e-13 * (terms + abs(injected) + lost))


@MESHES
def test_consistent_velocities_satisfy_their_equation(elements, order):
    form = mixed_form(SOFT.with_values(gamma1=GAMMA1), elements, order)
    X = some_state(form)
    moving = consistent(form, X)
    left = mixed.rate(form, moving)[3 * form.mesh.node_count :]
    size = np.abs(whole_A(form)[3 * form.mesh.node_count :]) @ np.abs(moving)
    assert np.abs(left).max() <= 1e-13 * size.max()
    assert np.all(moving[: 3 * form.mesh.node_count] == X[: 3 * form.mesh.node_count])


@pytest.mark.parametrize("rod", [STIFF, SOFT, Rod(F=-20.0, k1=30.0, k2=20.0, gamma3=0.5)])
@MESHES
def test_it_is_the_form_from_which_the_velocities_are_eliminated(rod, elements, order):
    form = mixed_form(rod.with_values(gamma1=GAMMA1), elements, order)
    root = np.repeat(np.sqrt(form.rod.balance_coefficients.compliance), form.mesh.node_count)
    X = consistent(form, some_state(form))
    z = root * X[: 3 * form.mesh.node_count]
    expected = ExplicitSystem(rod.with_values(gamma1=GAMMA1), uniform_mesh(elements, order)).state_derivative(
        z
    )
    rate = root * mixed.rate(form, X)[: 3 * form.mesh.node_count] / form.M[: 3 * form.mesh.node_count]
    assert rate == pytest.approx(expected, rel=1e-10, abs=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize("rod", [SOFT, Rod(F=-20.0, k1=30.0, k2=20.0, gamma3=0.5)])
@pytest.mark.parametrize("elements, order", [(1, 24), (3, 10)])
def test_row_of_the_tip_is_the_slope_of_the_reconstructed_tip(rod, elements, order):
    form, system = (
        mixed_form(rod.with_values(gamma1=GAMMA1), elements, order),
        ExplicitSystem(rod.with_values(gamma1=GAMMA1), uniform_mesh(elements, order)),
    )
    u, root = (
        form.mesh.node_positions[:-1],
        np.repeat(np.sqrt(form.rod.balance_coefficients.compliance), form.mesh.node_count),
    )
    S = np.concatenate([np.sin(k * u + k) * (1 - u) for k in (1, 2, 3)])
    exact = system.tip_position_and_velocity(np.zeros(system.layout.unknown_count), root * S)[1][1]
    assert form.tip_y_functional @ np.append(S, np.zeros(form.unknown_count - len(S))) == pytest.approx(
        exact, rel=1e-12
    )


@RODS
def test_tip_of_a_small_motion_moves_with_the_reaction(rod):
    """dy/dt = -r2 to first order, exactly on every mesh; derivative of the first equation under the row."""
    form = mixed_form(rod.with_values(gamma1=GAMMA1), 2, 8)
    X = 1j * 1e-30 * some_state(form)
    u = form.mesh.node_positions[:-1]
    test = np.concatenate([0 * u, 1 + 0 * u, rod.nu * (1 - u)])  # tip_y = test W C
    assert form.tip_y_functional[: 3 * form.mesh.node_count] == pytest.approx(
        test * form.M[: 3 * form.mesh.node_count], rel=1e-14
    )
    rate = test @ mixed.rate(form, X).imag[: 3 * form.mesh.node_count]
    assert rate == pytest.approx(-mixed.reaction(form, X).imag[1], rel=1e-11, abs=1e-41)


def test_clamp_and_tip_are_met_in_the_limit():
    """V(0) = 0 is natural and r(V) tends to -V(1): both by the leading mode."""
    form = mixed_form(SOFT.with_values(gamma1=GAMMA1), 1, 26)
    values, vectors = np.linalg.eig(np.linalg.solve(whole_A(form), np.diag(form.M)))
    X = vectors[:, np.argmax(values.real)]  # of 1/w: the one that grows
    _, V = form.stresses_and_velocities(X)
    assert np.abs(V[:, 0]).max() <= 1e-8 * np.abs(V).max()
    assert mixed.reaction(form, X) == pytest.approx(-V[:, -1], abs=1e-8 * np.abs(V).max())
