"""The nonlinear balance: its identities on se(2) and se(3), and the compiled kernels against it."""

import numpy as np
import pytest
from pointwise_balance import (
    PLANE_COMPONENTS,
    dissipated_power_per_length,
    embed_in_se3,
    energy_per_length,
    material_in_space,
    strain,
    velocity,
)

from rodsweep.discretization.elements.mesh import uniform_mesh
from rodsweep.discretization.elements.quadrature import gauss_legendre_rule
from rodsweep.discretization.explicit_system import ExplicitSystem
from rodsweep.model.balance import ad, coad
from rodsweep.model.rod import Rod

ROD, GAMMA1 = Rod(F=50.0, k1=1e4, k2=1e2, gamma3=1e-2), 0.7
PLANE = ROD.with_values(gamma1=GAMMA1).balance_coefficients
SPACE = material_in_space(ROD.with_values(gamma1=GAMMA1), twist_stiffness=0.6, twist_drag=0.02)
SIZES = pytest.mark.parametrize("size", [3, 6], ids=["plane", "space"])


def elements(size, count=3):
    return np.random.default_rng(size).standard_normal((count, size, 5))


def stresses(u, size):
    """(Sigma, Sigma', Sigma'') of a bent rod whose tip carries its load; u has the shape (n,)."""
    number, phase = np.array([3.0, 2.0, 4.0])[:, None], np.array([0.0, 1.0, 0.5])[:, None]
    heights = np.array([40.0, 20.0, 2.0, 3.0, 1.5, 0.1])[:size, None]
    fields = []
    for order in range(3):
        # d^order/du^order of (1 - u) sin(number u + phase)
        turned = number * u + phase + order * np.pi / 2
        field = (1 - u) * number**order * np.sin(turned)
        if order:
            field -= order * number ** (order - 1) * np.sin(turned - np.pi / 2)
        fields.append(heights * np.concatenate([field, field[::-1]])[:size])
    Sigma, dSigma, ddSigma = fields
    Sigma[0] -= ROD.F
    return Sigma, dSigma, ddSigma


def rates(material, Sigma, dSigma, ddSigma):
    """(V, dE/dt) by the balance and its derivative along the rod, ad* being bilinear."""
    scale = material.compliance[:, None]
    E, V = strain(material, Sigma), velocity(material, Sigma, dSigma)
    dV = (ddSigma + coad(scale * dSigma, Sigma) + coad(E, dSigma)) / material.drag[:, None]
    return V, dV + ad(E, V)


# --- the algebra ------------------------------------------------------------------------------------------


@SIZES
def test_ad_star_is_minus_the_transpose_of_ad(size):
    E, V, Sigma = elements(size)
    assert (coad(E, Sigma) * V).sum(axis=0) == pytest.approx(-(Sigma * ad(E, V)).sum(axis=0), rel=1e-12)


@SIZES
def test_bracket_is_antisymmetric_and_satisfies_the_jacobi_identity(size):
    a, b, c = elements(size)
    assert ad(a, b) == pytest.approx(-ad(b, a), abs=1e-14)
    assert ad(a, ad(b, c)) + ad(b, ad(c, a)) + ad(c, ad(a, b)) == pytest.approx(0 * a, abs=1e-13)


def test_the_plane_is_a_subalgebra_of_space():
    E, V, Sigma = elements(3)
    assert ad(embed_in_se3(E), embed_in_se3(V)) == pytest.approx(embed_in_se3(ad(E, V)), abs=1e-15)
    assert coad(embed_in_se3(E), embed_in_se3(Sigma)) == pytest.approx(
        embed_in_se3(coad(E, Sigma)), abs=1e-15
    )


def test_bracket_is_that_of_matrices():
    def matrix(element):
        (h1, h2, h3), (k1, k2, k3) = element.reshape(2, 3)
        return np.array([[0, 0, 0, 0], [h1, 0, -k3, k2], [h2, k3, 0, -k1], [h3, -k2, k1, 0]])

    a, b, _ = elements(6)[:, :, 0]
    A, B = matrix(a), matrix(b)
    assert matrix(ad(a, b)) == pytest.approx(A @ B - B @ A, abs=1e-14)


def test_bracket_does_not_depend_on_the_frame():
    """Ad_g [E, V] = [Ad_g E, Ad_g V] for a rotation R and a shift r, Ad_g (v; W) = (R v + r x R W; R W)."""
    rotation, _ = np.linalg.qr(np.random.default_rng(2).standard_normal((3, 3)))
    rotation *= np.linalg.det(rotation)
    shift = np.array([[0.3], [-1.0], [0.7]])

    def moved(element):
        turned = rotation @ element[3:]
        return np.concatenate([rotation @ element[:3] + np.cross(shift, turned, axis=0), turned])

    E, V, _ = elements(6)
    assert ad(moved(E), moved(V)) == pytest.approx(moved(ad(E, V)), abs=1e-13)


# --- the balance ------------------------------------------------------------------------------------------


def test_a_plane_motion_in_space_stays_in_the_plane_and_is_the_same():
    fields = stresses(np.linspace(0, 1, 7), 3)
    V, rate = rates(PLANE, *fields)
    V_space, rate_space = rates(SPACE, *map(embed_in_se3, fields))
    assert V_space == pytest.approx(embed_in_se3(V), rel=1e-14, abs=1e-12)
    assert rate_space == pytest.approx(embed_in_se3(rate), rel=1e-13, abs=1e-9)
    assert SPACE.compliance[PLANE_COMPONENTS].tolist() == PLANE.compliance.tolist()


def test_a_rod_turned_about_its_axis_moves_turned():
    turn = np.array([[1, 0, 0], [0, np.cos(0.8), -np.sin(0.8)], [0, np.sin(0.8), np.cos(0.8)]])
    turn = np.kron(np.eye(2), turn)
    fields = stresses(np.linspace(0, 1, 7), 6)
    here, there = rates(SPACE, *fields), rates(SPACE, *(turn @ field for field in fields))
    for value, turned in zip(here, there, strict=True):
        assert turned == pytest.approx(turn @ value, rel=1e-10, abs=1e-9)


@pytest.mark.parametrize("material, size", [(PLANE, 3), (SPACE, 6)], ids=["plane", "space"])
def test_energy_law(material, size):
    x, weights = gauss_legendre_rule(40)
    u, weights = (x + 1) / 2, weights / 2
    Sigma, *more = stresses(u, size)
    V, rate = rates(material, Sigma, *more)
    ends = [stresses(np.array([end]), size) for end in (0.0, 1.0)]
    clamp, tip = ((fields[0] * rates(material, *fields)[0]).sum() for fields in ends)
    assert ends[1][0][:, 0] == pytest.approx(material.tip_stress)
    change, lost = (Sigma * rate).sum(axis=0) @ weights, dissipated_power_per_length(material, V) @ weights
    assert change == pytest.approx(tip - clamp - lost, rel=1e-11, abs=1e-11 * lost)
    small = 1e-7  # C dSigma = dE: the energy's derivative along the motion
    motion = rate / material.compliance[:, None]
    ahead, back = (energy_per_length(material, Sigma + sign * small * motion) @ weights for sign in (1, -1))
    assert (ahead - back) / (2 * small) == pytest.approx(change, rel=1e-6)


# --- the compiled kernels ---------------------------------------------------------------------------------


def stress_of(system, z):
    """Sigma of z at all nodes, (3, nodes + 1), the tip's load included; complex for a complex z."""
    Sigma = np.zeros((3, system.mesh.node_count + 1), z.dtype)
    Sigma[:, :-1] = z.reshape(3, -1) / system.sqrt_compliance[:, :-1]
    Sigma[0] -= system.rod.F
    return Sigma


def collocated(system, z):
    """dz/dt by the balance at the nodes of a mesh of one element, where the clamp is natural."""
    D, w = system.mesh.node_matrices.differentiation_matrix, system.mesh.quadrature_weights
    Sigma = stress_of(system, z)
    V = velocity(PLANE, Sigma, Sigma @ D.T)
    rate = (V @ D.T + ad(strain(PLANE, Sigma), V))[:, :-1]
    rate[:, 0] += V[:, 0] / w[0]
    return (rate / system.sqrt_compliance[:, :-1]).ravel()


def rough(system):
    return np.random.default_rng(3).standard_normal(system.layout.unknown_count)


def test_compiled_rate_is_the_balance_at_the_nodes():
    system = ExplicitSystem(ROD.with_values(gamma1=GAMMA1), uniform_mesh(1, 16))
    z = rough(system)
    rate = collocated(system, z)
    assert system.state_derivative(z) == pytest.approx(rate, rel=1e-10, abs=1e-12 * np.abs(rate).max())


def test_compiled_jacobian_is_the_derivative_of_the_balance():
    system, step = ExplicitSystem(ROD.with_values(gamma1=GAMMA1), uniform_mesh(1, 12)), 1e-30
    z = rough(system)
    J = system.jacobian(z)
    for k, direction in enumerate(1j * step * np.eye(len(z))):
        column = collocated(system, z + direction).imag / step
        assert np.abs(J[:, k] - column).max() <= 1e-11 * np.abs(column).max()


@pytest.mark.parametrize("elements, order", [(1, 26), (3, 14)])
def test_compiled_rate_of_a_smooth_rod_is_that_of_the_balance(elements, order):
    """But at the clamp: V(0) of an arbitrary field is not 0, and the natural condition answers with 1/w."""
    system = ExplicitSystem(ROD.with_values(gamma1=GAMMA1), uniform_mesh(elements, order))
    u = system.mesh.node_positions
    Sigma, dSigma, ddSigma = stresses(u, 3)
    _, exact = rates(PLANE, Sigma, dSigma, ddSigma)
    z = system.state_of_strains(strain(PLANE, Sigma))
    rate = system.state_derivative(z).reshape(3, -1) * system.sqrt_compliance[:, :-1]
    assert np.abs(rate - exact[:, :-1])[:, 1:].max() <= 1e-7 * np.abs(exact).max()
