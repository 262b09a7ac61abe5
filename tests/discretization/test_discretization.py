"""Quadrature, basis and pencil: orders and exact answers."""

import pickle

import mpmath as mp
import numpy as np
import pytest
from numpy.polynomial import Polynomial

from rodsweep.discretization.elements.basis import differentiation_matrix, lagrange_interpolation_matrix
from rodsweep.discretization.elements.mesh import mesh_with_edges, shape_from_strains, uniform_mesh
from rodsweep.discretization.elements.node_spacing import (
    coordinates_at_positions,
    node_spacing_ratios_of_halves,
    position_slopes,
)
from rodsweep.discretization.elements.quadrature import gauss_legendre_rule, gauss_lobatto_rule
from rodsweep.discretization.elements.resolution import (
    RESOLUTION_SETTINGS,
    finer_resolution,
    required_order,
    resolution_for,
)
from rodsweep.discretization.straight.pencil import assemble_pencil
from rodsweep.discretization.stress.tip_motion import tip_matrices, write_tip_motion
from rodsweep.model.rod import Rod


@pytest.mark.parametrize(
    ("rule", "n", "degree"),
    [(gauss_legendre_rule, 9, 17), (gauss_lobatto_rule, 9, 17), (gauss_lobatto_rule, 40, 79)],
)
def test_quadrature_is_exact_to_its_degree_and_no_further(rule, n, degree):
    x, w = rule(n)
    for k in range(degree + 1):
        exact = 2 / (k + 1) if k % 2 == 0 else 0.0
        assert abs(w @ x**k - exact) < 1e-13
    if degree < 30:
        assert abs(w @ x ** (degree + 1) - 2 / (degree + 2)) > 1e-9


@pytest.mark.parametrize("n", [1, 2, 30, 60])
def test_gauss_nodes_and_weights_are_accurate_next_to_the_ends_too(n):
    """The weights there are small, and NumPy's are off by 2e-12 of their size for n = 60."""
    x, w = gauss_legendre_rule(n)
    with mp.workdps(40):
        for node, weight in zip(x, w, strict=True):
            exact = mp.findroot(lambda u: mp.legendre(n, u), mp.mpf(node))
            slope = mp.diff(lambda u: mp.legendre(n, u), exact)
            assert abs(node - exact) < 1e-16
            assert abs(weight * (1 - exact**2) * slope**2 / 2 - 1) < 1e-13


@pytest.mark.parametrize("p", [1, 2, 7, 33, 64])
def test_basis_reproduces_polynomials_and_their_slopes(p):
    x, _ = gauss_lobatto_rule(p)
    points = np.linspace(-1, 1, 23)
    chebyshev = np.polynomial.chebyshev.Chebyshev.basis(p)
    assert np.abs(lagrange_interpolation_matrix(x, points) @ chebyshev(x) - chebyshev(points)).max() < 1e-12
    slope = differentiation_matrix(x) @ chebyshev(x) - chebyshev.deriv()(x)
    assert np.abs(slope).max() < 1e-12 * max(p, 2) ** 4


def dense(rod, elements, order):
    """All finite eigenvalues of the pencil by LAPACK, largest real part first."""
    pencil = assemble_pencil(elements, order)
    A = np.zeros((pencil.unknown_count,) * 2)
    A[pencil.rows, pencil.columns] = pencil.stiffness_entries(rod)
    T = np.linalg.solve(A, np.diag(pencil.mass_diagonal(rod)))[
        : 2 * pencil.node_count, : 2 * pencil.node_count
    ]
    inverse = np.linalg.eigvals(T)
    w = 1 / inverse[np.abs(inverse) > 1e-13 * np.abs(inverse).max()]
    return w[np.argsort(-w.real)]


@pytest.mark.parametrize("order", [2, 3, 4])
def test_eigenvalues_converge_with_twice_the_order(order):
    """h-refinement of a filament: the error of the first eigenvalue falls as h^(2 p)."""
    rod = Rod(F=5.0, k1=np.inf, k2=np.inf, gamma3=0.0)
    exact = dense(rod, 2, 20)[0].real
    errors = [abs(dense(rod, n, order)[0].real - exact) for n in (4, 8)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2 * order, abs=0.35)


def test_pencil_at_rest_is_symmetric_and_negative():
    """At F = 0 the operator is self-adjoint and negative definite in the Gamma inner product (Sec. VI)."""
    pencil = assemble_pencil(2, 7)
    rod = Rod(F=0.0, k1=50.0, k2=30.0, gamma3=0.5)
    A = np.zeros((pencil.unknown_count,) * 2)
    A[pencil.rows, pencil.columns] = pencil.stiffness_entries(rod)
    n = pencil.node_count
    sign = np.where(np.arange(3 * n) < 2 * n, 1.0, -1.0)[:, None]  # the third row is a constraint
    assert np.abs(sign * A - (sign * A).T).max() < 1e-12 * np.abs(A).max()
    assert dense(rod, 2, 7).real.max() < 0
    assert np.abs(dense(rod, 2, 7).imag).max() < 1e-9 * np.abs(dense(rod, 2, 7)).max()


def test_evaluation_at_points_is_the_polynomial():
    pencil = assemble_pencil(3, 6)
    x, _ = gauss_lobatto_rule(6)
    nodes = np.unique(np.round(np.concatenate([(x + 1) / 6 + e / 3 for e in range(3)]), 14))
    points = np.array([0.0, 0.1, 1 / 3, 0.5, 0.999, 1.0])
    assert np.abs(pencil.evaluation_matrix(points) @ nodes**5 - points**5).max() < 1e-13


def test_resolution_grows_with_waves_and_digits():
    assert required_order(20, 1e-10) > required_order(10, 1e-10) > required_order(10, 1e-6)
    last = 0
    for wave in (5, 20, 60, 200, 1000):
        resolution = resolution_for(wave, 1e-10)
        assert resolution.order <= RESOLUTION_SETTINGS.max_order + 1
        assert resolution.unknown_count > last
        assert finer_resolution(resolution).unknown_count >= 1.2 * resolution.unknown_count
        last = resolution.unknown_count


UNEQUAL_ORDERS = mesh_with_edges((0.0, 0.3, 0.45, 1.0), 14, (0.5, 0.3125, 1.0))


def test_elements_of_unequal_orders_are_exact_for_polynomials_of_these_orders():
    """A polynomial of the order of each element: interpolation, derivative and integral."""
    grid, u = UNEQUAL_ORDERS, np.linspace(0, 1, 29)
    assert grid.orders == (7, 5, 14)
    pieces = [Polynomial(np.random.default_rng(p).standard_normal(p + 1)) for p in grid.orders]
    # Continuous at the edges, as fields on a mesh are.
    for e in (1, 2):
        pieces[e] -= pieces[e](grid.edges[e]) - pieces[e - 1](grid.edges[e])
    values = np.empty(grid.node_count + 1)
    for piece, nodes in zip(pieces, grid.node_ranges, strict=True):
        values[nodes] = piece(grid.node_positions[nodes])
    element = np.clip(np.searchsorted(grid.edges, u, side="right") - 1, 0, 2)
    exact = np.array([pieces[e](at) for e, at in zip(element, u, strict=True)])
    assert np.abs(grid.evaluation_matrix(u) @ values - exact).max() < 1e-12
    both_sides = values[grid.element_node_indices]
    assert np.abs(grid.one_sided_evaluation_matrix(u) @ both_sides - exact).max() < 1e-12
    integral = sum(
        p.integ()(b) - p.integ()(a) for p, a, b in zip(pieces, grid.edges[:-1], grid.edges[1:], strict=True)
    )
    # Lobatto's rule with p + 1 nodes is exact up to the order 2 p - 1.
    assert grid.quadrature_weights @ values == pytest.approx(integral, abs=1e-13)
    slopes = grid.node_matrices.differentiation_matrix @ values
    for piece, nodes in zip(pieces, grid.node_ranges, strict=True):
        inner = slice(nodes.start + 1, nodes.stop - 1)
        assert np.abs(slopes[inner] - piece.deriv()(grid.node_positions[inner])).max() < 1e-10
    sent = pickle.loads(pickle.dumps(grid))
    assert sent == grid
    assert (
        sent.node_matrices.differentiation_matrix.tobytes()
        == grid.node_matrices.differentiation_matrix.tobytes()
    )


SPACED = mesh_with_edges((0.0, 0.4, 1.0), 18, (0.75, 1.0), (2.5, 0.25))


def test_spaced_nodes_keep_the_accuracy_of_equally_spaced_ones():
    """Positions, quadrature, slopes and interpolation of a smooth field; nodes are closer where s says so."""
    u = np.linspace(0, 1, 29)
    values = np.sin(3 * SPACED.node_positions)
    assert SPACED.quadrature_weights @ values == pytest.approx((1 - np.cos(3)) / 3, abs=1e-12)
    assert (
        np.abs(
            SPACED.node_matrices.differentiation_matrix @ values - 3 * np.cos(3 * SPACED.node_positions)
        ).max()
        < 1e-7
    )
    assert np.abs(SPACED.evaluation_matrix(u) @ values - np.sin(3 * u)).max() < 1e-10
    assert np.abs(SPACED.evaluation_matrix(SPACED.node_positions) - np.eye(len(values))).max() < 1e-12
    for nodes, s in zip(SPACED.node_ranges, SPACED.node_spacing_ratios, strict=True):
        steps = np.diff(SPACED.node_positions[nodes])
        assert steps[-1] / steps[0] == pytest.approx(s, rel=0.1)
    # A field linear in u turns an arm of constant curvature into an arc, whatever the spacing.
    strains = np.zeros((3, SPACED.element_node_indices.size))
    strains[0] = 1.0
    strains[2] = 2.0
    arc = shape_from_strains(SPACED, strains, np.zeros(3))
    assert np.abs(arc[1] - (1 - np.cos(2 * SPACED.node_positions)) / 2).max() < 1e-13


@pytest.mark.parametrize("s", [0.25, 1.0, 3.0])
def test_halved_elements_have_the_spacing_of_the_whole(s):
    start, middle, end = position_slopes(coordinates_at_positions(np.array([0.0, 0.5, 1.0]), s), s)
    assert node_spacing_ratios_of_halves((s,)) == pytest.approx((middle / start, end / middle), rel=1e-14)


@pytest.mark.parametrize("grid", [uniform_mesh(1, 15), uniform_mesh(3, 6), UNEQUAL_ORDERS, SPACED])
def test_the_compiled_motion_of_the_tip_is_that_of_the_whole_shape(grid):
    rng = np.random.default_rng(5)
    strains, rates = rng.standard_normal((2, 3, 4, grid.element_node_indices.size))
    tip, velocity = np.empty((2, 4, 3))
    write_tip_motion(strains, rates, tip_matrices(grid), tip, velocity)
    tiny = 1e-30
    exact = shape_from_strains(grid, strains + 1j * tiny * rates, np.zeros(3))[..., -1].T
    assert np.abs(tip - exact.real).max() < 1e-13 * np.abs(exact.real).max()
    assert np.abs(velocity - exact.imag / tiny).max() < 1e-13 * np.abs(exact.imag / tiny).max()
