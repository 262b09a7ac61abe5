"""Modes, adjoint modes and non-normality of one rod, against closed forms in 60 digits that share no mesh."""

from dataclasses import replace
from operator import attrgetter

import mpmath as mp
import numpy as np
import pytest
from numpy.polynomial import legendre
from rods import rod_of
from scipy.linalg import expm
from surveyed import few

from rodsweep.determinant.exponents import MACHINE_EPSILON
from rodsweep.determinant.value import distance_to_next_root
from rodsweep.discretization.elements.basis import differentiation_matrix
from rodsweep.discretization.elements.quadrature import gauss_lobatto_rule, lobatto_points
from rodsweep.discretization.elements.resolution import Resolution
from rodsweep.discretization.straight.dense_eigenproblem import dense_eigenproblem
from rodsweep.discretization.straight.pencil import (
    assemble_pencil,
    displacements_of_eigenvectors,
    factors_to_unit_tip_displacement,
    shear_force,
)
from rodsweep.model.rod import Rod
from rodsweep.solve.modes import convergence as convergence_module
from rodsweep.solve.modes import inverse_iteration as inverse_module
from rodsweep.solve.modes import norm_maximum as peak_module
from rodsweep.solve.modes import transient_growth as growth_module
from rodsweep.solve.modes.inverse_iteration import mode_vectors
from rodsweep.solve.modes.leading_modes import ModesRequest, solve_modes
from rodsweep.solve.modes.norm_maximum import NORM_MAXIMUM_SETTINGS, maximum_propagator_norm
from rodsweep.solve.modes.null_vectors import effects_of_rounding, factorised_pencil, null_vectors
from rodsweep.solve.modes.numerical_abscissa import numerical_abscissa_and_error
from rodsweep.solve.modes.propagator import Propagator, matrix_exponential
from rodsweep.solve.modes.stiffness_matrix import StiffnessMatrix
from rodsweep.solve.spectrum.search import SpectrumRequest, solve_spectrum
from rodsweep.solve.spectrum.status import SpectrumStatus

INF = float("inf")
NODES = 65
TIGHT = ModesRequest(mode_count=4, accuracy=1e-10, node_count=NODES, computes_growth=True)
SHAPES = ModesRequest(mode_count=4, accuracy=1e-10, node_count=NODES, computes_growth=False)
POINTS = lobatto_points(NODES)
WEIGHTS = gauss_lobatto_rule(NODES - 1)[1] / 2
SLOPE = 2 * differentiation_matrix(gauss_lobatto_rule(NODES - 1)[0])
ONSET = 20.0080206921031
"""F* of (1e4, 1e4, 1e-4), where the first two eigenvalues meet (docs/method.md, reference values)."""

FIG_2A = (15.0, 1e4, 1e4, 1e-4)
RODS = [
    FIG_2A,
    (30.0, 1e4, 1e4, 1e-4),
    (15.0, 1e4, 1e8, 1e-8),
    (15.0, INF, INF, 0.0),
    (12.0, 200.0, INF, 0.0),
    (3.0, 100.0, 5.0, 5.0),
    (198.0, 200.0, 1e4, 1e-4),
    (-10.0, 1e4, 1e4, 1e-4),
    (15.0, 1e4, 200.0, 0.0),
    (0.0, 1e4, 1e2, 1e-2),
]


@pytest.fixture(autouse=True)
def digits():
    with mp.workdps(60):
        yield


class ClosedForm:
    """sum_j a_j exp(q_j u) (y, theta, s, m)_j at an eigenvalue, Y(1) = 1; `ends` 0 of L, 1 of its adjoint.

    The roots q are those of the corrected quartic (docs/method.md): only the end conditions tell
    L, its adjoint and its Hermitian part (ends 1/2, tip stiffness `layer`) apart.
    """

    def __init__(self, rod, w, ends=0):
        self.rod, self.ends = rod, mp.mpf(ends)
        self.F, self.c2, self.gamma3 = mp.mpf(rod.F), 1 / mp.mpf(rod.k2), mp.mpf(rod.gamma3)
        self.nu = 1 - self.F / mp.mpf(rod.k1)
        self.g = self.nu + self.F * self.c2
        self.w = self._root(mp.mpmathify(w))
        q, v = self._waves(self.w)
        decay = [mp.exp(-max(mp.re(x), 0)) for x in q]
        a = self._null(self._ends(self.w)[:3, :])
        a = [x * d for x, d in zip(a, decay, strict=True)]
        tip = mp.fsum(x * mp.exp(z) * field[0] for x, z, field in zip(a, q, v, strict=True))
        self.q, self.v, self.a = q, v, [x / tip for x in a]
        if ends == 1:  # the adjoint mode belongs to the conjugate eigenvalue
            self.q, self.a = [mp.conj(x) for x in self.q], [mp.conj(x) for x in self.a]
            self.v = [[mp.conj(x) for x in field] for field in self.v]

    def _waves(self, w):
        total = (self.c2 + self.gamma3) * w - self.F * self.g
        root = mp.sqrt(total**2 - 4 * w * (self.c2 * self.gamma3 * w + self.nu * self.g))
        first, second = mp.sqrt((total + root) / 2), mp.sqrt((total - root) / 2)
        q = [first, -first, second, -second]
        shear = [(self.gamma3 * w - x * x) / self.g for x in q]
        return q, [[(self.nu + self.c2 * s) / x, mp.mpf(1), s, x] for s, x in zip(shear, q, strict=True)]

    def _ends(self, w):
        layer = mp.mpf(0)
        if self.ends == 0.5 and self.gamma3 == 0 and self.c2 > 0:
            kappa = mp.sqrt(self.g * self.nu / self.c2)
            layer = self.F**2 / 4 * mp.tanh(kappa) / kappa
        matrix = mp.matrix(4, 4)
        for j, (q, (y, theta, s, m)) in enumerate(zip(*self._waves(w), strict=True)):
            tip = (s - self.ends * self.F * theta + layer * y, m + self.ends * self.F * y)
            column = [y, theta, *(mp.exp(q) * x for x in tip)]
            for i in range(4):
                matrix[i, j] = column[i] * mp.exp(-max(mp.re(q), 0))
        return matrix

    def _root(self, w):
        def value(x):
            q, _ = self._waves(x)
            return mp.det(self._ends(x)) / (q[0] * q[2] * (q[0] ** 2 - q[2] ** 2) ** 2)

        return mp.findroot(value, (w, w * (1 + mp.mpf(10) ** -9)), tol=1e-90, verify=False)

    @staticmethod
    def _null(rows):
        """The null vector of a 3x4 matrix by its minors."""
        minors = []
        for j in range(4):
            rest = mp.matrix([[rows[i, k] for k in range(4) if k != j] for i in range(3)])
            minors.append((-1) ** j * mp.det(rest))
        return minors

    def fields(self, points):
        """(y, theta, s, m), shape (4, points)."""
        a = np.array([complex(x * mp.exp(max(mp.re(q), 0))) for x, q in zip(self.a, self.q, strict=True)])
        v = np.array([[complex(x) for x in field] for field in self.v])
        q = np.array([complex(x) for x in self.q])
        return (a[:, None] * v).T @ np.exp(np.outer(q, points) - np.maximum(q.real, 0)[:, None])

    def exact_fields(self, points):
        """(y, theta, s, m), shape (4, points), summed in many digits."""
        waves = [
            [a * mp.exp(q * mp.mpf(float(u))) for u in points] for a, q in zip(self.a, self.q, strict=True)
        ]
        sums = [
            [
                mp.fsum(v[i] * wave[j] for v, wave in zip(self.v, waves, strict=True))
                for j in range(len(points))
            ]
            for i in range(4)
        ]
        return np.array([[complex(x) for x in row] for row in sums])

    def product(self, other):
        total = mp.mpf(0)
        for a, q, v in zip(self.a, self.q, self.v, strict=True):
            for b, r, x in zip(other.a, other.q, other.v, strict=True):
                k = mp.conj(q) + r
                integral = mp.expm1(k) / k if k else mp.mpf(1)
                weight = mp.conj(v[0]) * x[0] + self.gamma3 * mp.conj(v[1]) * x[1]
                total += mp.conj(a) * b * integral * weight
        return total


def reference_condition(rod, w):
    xi, psi = ClosedForm(rod, w), ClosedForm(rod, w, 1)
    return float(mp.sqrt(mp.re(xi.product(xi)) * mp.re(psi.product(psi))) / abs(psi.product(xi)))


class ReferenceGrowth:
    """|exp(L t)| from exact modes and their exact Gram matrices, shape independent of any mesh."""

    def __init__(self, rod, eigenvalues):
        right = [ClosedForm(rod, w) for w in eigenvalues]
        left = [ClosedForm(rod, w, 1) for w in eigenvalues]
        self.w = [x.w for x in right]
        self.pairing = [psi.product(xi) for psi, xi in zip(left, right, strict=True)]
        self.right, self.left = (self._factor(modes) for modes in (right, left))

    @staticmethod
    def _factor(modes):
        gram = mp.matrix(len(modes), len(modes))
        for i, a in enumerate(modes):
            gram[i, i] = mp.re(a.product(a))
            for j, b in enumerate(modes[:i]):
                gram[i, j] = a.product(b)
                gram[j, i] = mp.conj(gram[i, j])
        return mp.cholesky(gram).H

    def __call__(self, t):
        weights = [mp.exp(w * t) / p for w, p in zip(self.w, self.pairing, strict=True)]
        E = self.right * mp.diag(weights) * self.left.H
        return float(np.linalg.norm(np.array(E.tolist(), dtype=complex), 2))


def gamma_products(result, gamma3):
    """(psi_m, xi_n) over the norms of both."""
    y, theta = result.mode_vectors.right_modes
    left_y, left_theta = result.mode_vectors.left_modes
    products = (left_y.conj() * WEIGHTS) @ y.T + gamma3 * (left_theta.conj() * WEIGHTS) @ theta.T
    norms = [
        np.sqrt((WEIGHTS * (abs(a) ** 2 + gamma3 * abs(b) ** 2)).sum(1))
        for a, b in ((y, theta), result.mode_vectors.left_modes)
    ]
    return products, norms[1][:, None] * norms[0]


def relative(found, exact):
    return abs(found - exact).max() / abs(exact).max()


@pytest.mark.parametrize(
    "k1, k2, gamma3", [(1e4, 1e4, 1e-4), (1e4, 5.0, 0.5), (INF, INF, 0.0), (1e4, 50.0, 0.0)]
)
def test_at_rest_left_and_right_modes_are_equal(k1, k2, gamma3):
    result = solve_modes(Rod(F=0.0, k1=k1, k2=k2, gamma3=gamma3), TIGHT)
    assert result.status == SpectrumStatus.ok
    assert (result.spectrum.eigenvalues.imag == 0).all()
    assert (result.spectrum.eigenvalues.real < 0).all()
    assert relative(result.mode_vectors.left_modes, result.mode_vectors.right_modes) < 1e-11
    assert abs(result.mode_vectors.condition - 1).max() < 1e-12
    assert result.growth.numerical_abscissa == pytest.approx(result.spectrum.eigenvalues[0].real, rel=1e-11)
    assert (result.growth.transient_growth, result.growth.transient_time) == (1.0, 0.0)


@pytest.mark.long
@pytest.mark.kernel
@pytest.mark.parametrize("parameters", few(RODS, 5))
def test_modes_are_those_of_appendix_c(parameters):
    """The closed form, deformations included, and condition numbers."""
    rod = rod_of(*parameters)
    result = solve_modes(rod, SHAPES)
    assert result.status == SpectrumStatus.ok
    for n, w in enumerate(result.spectrum.eigenvalues):
        y, theta, s, m = ClosedForm(rod, w).fields(POINTS)
        assert relative(result.mode_vectors.right_modes[0, n], y) < 1e-11
        assert relative(result.mode_vectors.right_modes[1, n], theta) < 1e-11
        assert relative(result.mode_vectors.mode_strains[1, n], m) < 1e-11
        if rod.c2:
            assert relative(result.mode_vectors.mode_strains[0, n], rod.c2 * s) < 1e-11
        y, theta, *_ = ClosedForm(rod, w, 1).fields(POINTS)
        assert relative(result.mode_vectors.left_modes[0, n], y) < 1e-11
        assert relative(result.mode_vectors.left_modes[1, n], theta) < 1e-11
        assert result.mode_vectors.condition[n] == pytest.approx(reference_condition(rod, w), rel=1e-11)


@pytest.mark.kernel
@pytest.mark.parametrize(
    "parameters",
    few([(-54.29, 22670.0, 1152.0, 0.00529), (23.72, 181.2, 4075.0, 0.429), (-1.88, INF, 6.187, 0.00293)], 1),
)
def test_errors_of_modes_include_rounding(parameters):
    """Two meshes that share rounding errors differ by less than their errors, up to a factor of five."""
    rod = rod_of(*parameters)
    result = solve_modes(rod, ModesRequest(6, 1e-10, 9, computes_growth=False))
    assert result.status == SpectrumStatus.ok
    vectors, points = result.mode_vectors, lobatto_points(9)
    for n, w in enumerate(result.spectrum.eigenvalues):
        y, theta, s, m = ClosedForm(rod, w).exact_fields(points)
        left_y, left_theta, *_ = ClosedForm(rod, w, 1).exact_fields(points)
        assert relative(vectors.right_modes[:, n], np.array([y, theta])) < 1e-11
        for found, exact in (
            (vectors.right_modes[0, n], y),
            (vectors.right_modes[1, n], theta),
            (vectors.mode_strains[0, n], rod.c2 * s),
            (vectors.mode_strains[1, n], m),
            (vectors.left_modes[0, n], left_y),
            (vectors.left_modes[1, n], left_theta),
        ):
            assert relative(found, exact) < vectors.mode_error[n] < 1e-10
        assert vectors.condition[n] == pytest.approx(
            reference_condition(rod, w), rel=vectors.condition_error[n]
        )


def test_printed_form_of_appendix_c():
    """Y and Theta as printed (G, g1, g2, chi), with the corrected quartic, normalised to Y(1) = 1."""
    rod = rod_of(*FIG_2A)
    result = solve_modes(rod, SHAPES)
    w, mu = result.spectrum.eigenvalues[1], rod.k2 * rod.nu + rod.F
    b = rod.F * mu - (1 + rod.k2 * rod.gamma3) * w
    root = np.sqrt(b * b - 4 * rod.k2 * w * (rod.gamma3 * w + rod.nu * mu))
    x1, x2 = np.sqrt((-b + root) / (2 * rod.k2)), np.sqrt((b + root) / (2 * rod.k2))
    g1, g2 = (rod.k2 * x1**2 - w) / (mu * x1), (rod.k2 * x2**2 + w) / (mu * x2)
    G = (x1 * g1 * np.cosh(x1) + x2 * g2 * np.cos(x2)) / (x1 * np.sinh(x1) + x2 * np.sin(x2))
    a, c = x1 * POINTS, x2 * POINTS
    Y = np.cosh(a) - np.cos(c) - G * (np.sinh(a) / g1 - np.sin(c) / g2)
    Theta = g1 * np.sinh(a) + g2 * np.sin(c) - G * (np.cosh(a) - np.cos(c))
    assert relative(result.mode_vectors.right_modes[0, 1], Y / Y[-1]) < 1e-9
    assert relative(result.mode_vectors.right_modes[1, 1], Theta / Y[-1]) < 1e-9


@pytest.mark.kernel
@pytest.mark.parametrize("parameters", RODS)
def test_left_and_right_modes_are_biorthogonal(parameters):
    rod = rod_of(*parameters)
    result = solve_modes(rod, SHAPES)
    products, norms = gamma_products(result, rod.gamma3)
    off = products - np.diag(np.diag(products))
    assert (abs(off) / norms).max() < 1e-10
    assert (
        abs(np.diag(products) - result.mode_vectors.pairing).max()
        < 1e-10 * abs(result.mode_vectors.pairing).max()
    )
    assert abs(np.diag(norms) / abs(np.diag(products)) / result.mode_vectors.condition - 1).max() < 1e-10
    assert abs(result.mode_vectors.right_modes[0, :, -1] - 1).max() < 1e-12
    assert abs(result.mode_vectors.left_modes[0, :, -1] - 1).max() < 1e-12


@pytest.mark.parametrize("parameters", RODS)
def test_left_modes_have_the_ends_of_appendix_b(parameters):
    """psi(0) = 0, (K D psi + ad*_psi Sigma0)(1) = 0: Theta+' = -F Y+, Y+' - nu Theta+ = c2 F Theta+."""
    rod = rod_of(*parameters)
    result = solve_modes(rod, SHAPES)
    slope = result.mode_vectors.left_modes @ SLOPE.T
    size = abs(slope).max(axis=2)
    assert (result.mode_vectors.left_modes[:, :, 0] == 0).all()
    assert (abs(slope[1, :, -1] + rod.F * result.mode_vectors.left_modes[0, :, -1]) / size[1]).max() < 1e-9
    assert (abs(slope[0, :, -1] - rod.g * result.mode_vectors.left_modes[1, :, -1]) / size[0]).max() < 1e-9


def test_left_null_vector_of_the_pencil_has_the_adjoint_ends():
    """Its third part is -(s+ - F Theta+), which the transposed weak form makes vanish at the tip.

    This holds the shear condition where k2 = inf makes it invisible in Y+, and to the order of the mesh.
    """
    rod = Rod(F=15.0, k1=INF, k2=INF, gamma3=0.0)
    w = complex(ClosedForm(rod, -43.923).w)
    left_over = []
    for order in (8, 12, 16):
        pencil = assemble_pencil(1, order)
        form = dense_eigenproblem(rod, pencil)
        _, z = null_vectors(factorised_pencil(StiffnessMatrix(form.A, form.bending_factor), form.B, w))
        force = shear_force(pencil, z[:, None].astype(complex), np.linspace(0, 1, 11))
        left_over.append(abs(force[-1, 0]) / abs(force).max())
    assert left_over[0] < 1e-3
    assert left_over[1] < 1e-3 * left_over[0]
    assert left_over[2] < 1e-10


@pytest.mark.kernel
def test_condition_diverges_at_the_onset_like_a_square_root():
    distances = [1e-2, 1e-4]
    condition = []
    for distance in distances:
        rod = Rod(F=ONSET * (1 - distance), k1=1e4, k2=1e4, gamma3=1e-4)
        result = solve_modes(rod, ModesRequest(2, 1e-8, 9, computes_growth=False))
        assert result.status == SpectrumStatus.ok
        condition.append(result.mode_vectors.condition)
    order = np.log(condition[1] / condition[0]) / np.log(distances[0] / distances[1])
    assert abs(order - 0.5).max() < 0.01
    assert condition[1].min() > 50


@pytest.mark.kernel
def test_a_rod_at_the_onset_says_that_its_modes_are_inaccurate():
    result = solve_modes(Rod(F=ONSET, k1=1e4, k2=1e4, gamma3=1e-4), TIGHT)
    assert result.status == SpectrumStatus.accuracy_not_reached
    assert result.mode_vectors.condition[:2].min() > 1e5
    assert result.mode_vectors.condition_error[:2].max() > 1e-3
    assert result.mode_vectors.condition_error[2:].max() < 1e-11


@pytest.mark.kernel
def test_modes_next_to_the_onset_are_not_called_accurate():
    """The eigenvalues are right to 1e-10 there, their condition numbers are not."""
    request = ModesRequest(mode_count=4, accuracy=1e-10, node_count=9, computes_growth=False)
    rod = Rod(F=20.008, k1=1e4, k2=1e4, gamma3=1e-4)
    assert solve_spectrum(rod, SpectrumRequest(4, 1e-10, True)).status == SpectrumStatus.ok
    result = solve_modes(rod, request)
    assert result.status == SpectrumStatus.accuracy_not_reached
    assert "condition numbers" in result.message
    assert solve_modes(rod, replace(request, accuracy=1e-6)).status == SpectrumStatus.ok


def test_a_decaying_rod_may_grow_at_first():
    """Fig. 2a's rod at F = 15: all modes decay like exp(-44 t) or faster, yet the abscissa is positive."""
    result = solve_modes(rod_of(*FIG_2A), TIGHT)
    exact = ClosedForm(rod_of(*FIG_2A), result.spectrum.eigenvalues[0]).w
    assert result.spectrum.eigenvalues[0].real == pytest.approx(float(mp.re(exact)), rel=1e-11)
    assert result.spectrum.eigenvalues[0].real < -44
    assert result.growth.numerical_abscissa > 21.9
    assert result.growth.transient_growth > 1


@pytest.mark.parametrize("parameters", RODS)
def test_abscissa_is_the_largest_root_of_the_averaged_ends(parameters):
    rod = rod_of(*parameters)
    found = numerical_abscissa_and_error(rod, assemble_pencil(1, 24))[0]
    exact = ClosedForm(rod, found, 0.5).w
    assert found == pytest.approx(float(mp.re(exact)), rel=1e-11, abs=1e-10)
    assert ClosedForm(rod, found, 0.5)._root(mp.mpf(found)) == pytest.approx(exact)


@pytest.mark.kernel
@pytest.mark.parametrize(
    ("parameters", "exact"),
    few(
        [
            # Legendre-Galerkin matrices in 60 digits, two sizes.
            ((5.754, INF, 115.1, 0.00017), -8.6598132112994469),
            ((-5.193, 66.98, 584.4, 1.22e-5), -0.42042419948722422),
            ((21.67, 6.214e5, INF, 0.00108), 64.645769861566285),
        ],
        2,
    ),
)
def test_the_error_of_the_abscissa_includes_rounding(parameters, exact):
    growth = solve_modes(rod_of(*parameters), ModesRequest(1, 1e-8, 3, computes_growth=True)).growth
    assert growth.numerical_abscissa == pytest.approx(exact, abs=growth.abscissa_error, rel=0)
    assert growth.abscissa_error < 1e-10


def test_abscissa_is_found_where_no_bound_is_known():
    """A soft rod without rotational drag, pulled beyond its shear stiffness (g < 0)."""
    rod = Rod(F=-48.0, k1=1e6, k2=3.5, gamma3=0.0)
    found = numerical_abscissa_and_error(rod, assemble_pencil(2, 32))[0]
    leading = solve_modes(
        rod, ModesRequest(1, 1e-8, 9, computes_growth=False, certify=False)
    ).spectrum.eigenvalues[0]
    assert rod.g < 0
    assert found > leading.real > 5000
    assert found == pytest.approx(float(mp.re(ClosedForm(rod, found, 0.5).w)), rel=1e-11)


def polynomial_suprema(rod, degree):
    """(over the form domain, over the domain of L): the largest quotient over polynomials y, theta; c2 > 0.

    With gamma3 = 0 theta is the polynomial and y follows from theta'' + g s = 0.
    """
    x, weights = legendre.leggauss(2 * degree + 2)
    points, weights = np.append((x + 1) / 2, [0.0, 1.0]), np.append(weights / 2, [0.0, 0.0])
    one = np.eye(degree + 1)
    P, D, D2 = (
        np.stack([2**k * legendre.legval(2 * points - 1, legendre.legder(e, k)) for e in one], 1)
        for k in range(3)
    )
    if rod.gamma3 == 0:
        integral = [legendre.legval(2 * points - 1, legendre.legint(e, lbnd=-1) / 2) for e in one]
        theta, moment, s = P, D, -D2 / rod.g
        y = rod.nu * np.stack(integral, 1) - rod.c2 / rod.g * (D - D[-2])
    else:
        zero = np.zeros_like(P)
        y, theta, moment = np.hstack([P, zero]), np.hstack([zero, P]), np.hstack([zero, D])
        s = (np.hstack([D, zero]) - rod.nu * theta) / rod.c2
    clamp = [y[-2], theta[-2]]
    form = [*clamp, moment[-1]] if rod.gamma3 == 0 else clamp
    suprema = []
    for conditions in (form, [*clamp, moment[-1], rod.c2 * s[-1]]):
        _, sizes, rows = np.linalg.svd(np.array(conditions))
        free = rows[(sizes > 1e-10 * sizes[0]).sum() :].T
        Y, T, M, S = (field @ free for field in (y, theta, moment, s))
        W = weights[:, None]
        Q = rod.F * rod.c2 * T.T @ (W * S) - rod.F * Y.T @ (W * M) - rod.c2 * S.T @ (W * S) - M.T @ (W * M)
        factor = np.linalg.inv(np.linalg.cholesky(Y.T @ (W * Y) + rod.gamma3 * T.T @ (W * T)))
        suprema.append(np.linalg.eigvalsh(factor @ (Q + Q.T) @ factor.T / 2)[-1])
    return suprema


@pytest.mark.parametrize(
    "parameters", [(15.0, 1e4, 1e2, 1e-2), (15.0, 1e4, 200.0, 0.0), (3.0, 100.0, 5.0, 5.0)]
)
def test_abscissa_is_the_supremum_over_the_domain(parameters):
    """The form domain reaches it at once; fields with the ends of L only in the limit, like 1/degree^2."""
    rod = rod_of(*parameters)
    exact = numerical_abscissa_and_error(rod, assemble_pencil(1, 24))[0]
    over_form, over_domain = np.array([polynomial_suprema(rod, degree) for degree in (14, 28)]).T
    assert over_form == pytest.approx(exact, rel=1e-7)
    assert (over_domain < exact).all()
    order = np.log2((exact - over_domain[0]) / (exact - over_domain[1]))
    assert 1.5 < order < 2.5


def test_unshearable_limit_is_reached_at_first_order():
    """k2 -> inf at gamma3 = 1e-2, every number; h2 = c2 s is exactly 0 there."""
    limit = solve_modes(Rod(F=15.0, k1=1e4, k2=INF, gamma3=1e-2), TIGHT)
    assert (limit.mode_vectors.mode_strains[0] == 0).all()
    differences = []
    for k2 in (1e5, 1e6):
        near = solve_modes(Rod(F=15.0, k1=1e4, k2=k2, gamma3=1e-2), TIGHT)
        differences.append(
            [
                abs(near.growth.numerical_abscissa - limit.growth.numerical_abscissa),
                abs(near.growth.transient_growth - limit.growth.transient_growth),
                abs(near.mode_vectors.condition - limit.mode_vectors.condition).max(),
                abs(near.mode_vectors.left_modes - limit.mode_vectors.left_modes).max(),
                abs(near.mode_vectors.right_modes - limit.mode_vectors.right_modes).max(),
                abs(near.mode_vectors.mode_strains[0]).max(),
            ]
        )
    assert np.array(differences[0]) / np.array(differences[1]) == pytest.approx(10, rel=0.01)


def test_without_rotational_drag_only_the_abscissa_jumps():
    """gamma3 -> 0 at c2 > 0: theta loses the freedom to start anywhere, which the norm does not notice."""
    limit = solve_modes(Rod(F=15.0, k1=1e4, k2=200.0, gamma3=0.0), TIGHT)
    near, nearer = (
        solve_modes(Rod(F=15.0, k1=1e4, k2=200.0, gamma3=gamma3), TIGHT) for gamma3 in (1e-6, 1e-8)
    )
    vectors = (
        "mode_vectors.condition",
        "mode_vectors.left_modes",
        "mode_vectors.right_modes",
        "mode_vectors.mode_strains",
    )
    for name in ("spectrum.eigenvalues", *vectors, "growth.transient_growth"):
        value = attrgetter(name)
        far, close = (np.max(abs(value(x) - value(limit))) for x in (near, nearer))
        assert close < 0.11 * far, name
    assert nearer.growth.numerical_abscissa - limit.growth.numerical_abscissa > 2
    assert nearer.growth.numerical_abscissa == pytest.approx(near.growth.numerical_abscissa, rel=1e-5)


def test_abscissa_is_continuous_where_theta_is_no_state_of_its_own():
    """c2 = 0, gamma3 -> 0 at first order; and c2 -> 0 at gamma3 = 0 like the layer's thickness, sqrt(c2)."""
    limit = numerical_abscissa_and_error(Rod(F=15.0, k1=1e4, k2=INF, gamma3=0.0), assemble_pencil(1, 24))[0]
    drags = [
        abs(
            numerical_abscissa_and_error(Rod(F=15.0, k1=1e4, k2=INF, gamma3=x), assemble_pencil(1, 24))[0]
            - limit
        )
        for x in (1e-4, 1e-5)
    ]
    assert drags[0] / drags[1] == pytest.approx(10, rel=0.02)
    shears = [
        abs(
            numerical_abscissa_and_error(Rod(F=15.0, k1=1e4, k2=x, gamma3=0.0), assemble_pencil(1, 24))[0]
            - limit
        )
        for x in (1e6, 1e8)
    ]
    assert shears[0] / shears[1] == pytest.approx(10, rel=0.02)


@pytest.mark.long
@pytest.mark.kernel
@pytest.mark.parametrize(
    "parameters",
    few(
        [
            (20.008, 1e4, 1e4, 1e-4),
            (30.0, INF, INF, 0.0),
            (7.0, 100.0, 5.0, 5.0),
            (-10.0, 1e4, 1e4, 1e-4),
            FIG_2A,
            (30.0, 1e4, 1e4, 1e-4),
            (37.6559, 1e4, 1e4, 1e-4),
            (15.0, 1e4, 200.0, 0.0),
        ],
        2,
    ),
)
def test_transient_growth_is_the_largest_norm_of_the_exact_propagator(parameters):
    rod = rod_of(*parameters)
    result = solve_modes(rod, TIGHT)
    # Ten modes represent exp(L t) to 1e-12 at these times.
    exact = ReferenceGrowth(
        rod, solve_modes(rod, ModesRequest(10, 1e-7, 2, computes_growth=False)).spectrum.eigenvalues
    )
    peak = result.growth.transient_time
    assert result.growth.growth_error < 1e-10
    assert result.growth.transient_growth == pytest.approx(exact(peak), rel=1e-11)
    step = 1e-3 * peak
    assert exact(peak) > max(exact(peak - step), exact(peak + step))
    scan = [exact(t) for t in np.geomspace(peak / 2, 50 * peak, 40)]
    assert max(scan) <= result.growth.transient_growth


def toy(generator):
    """exp(L t) of a small matrix L, all modes kept."""
    propagator = Propagator(np.linalg.inv(np.array(generator, dtype=float)), 0.0)
    assert propagator.use_leading_modes(len(generator)) == len(generator)
    return propagator


def abscissa_of(propagator):
    return np.linalg.eigvalsh(propagator.generator + propagator.generator.T)[-1] / 2


def brute_force(propagator, times):
    return np.array([np.linalg.norm(expm(propagator.generator * t), 2) for t in times])


def test_a_peak_later_than_the_decay_time_is_found():
    """Three close modes in a chain, |exp(L t)| near 1800 t^2 exp(-t): the peak is at t = 2, not before 1."""
    propagator = toy(np.diag([-1.0, -1.002, -1.004]) + np.diag([60.0, 60.0], 1))
    end, tail = growth_module._end_of_growth_and_excess(propagator, 1e-3, 20.0)
    largest, time, bound = maximum_propagator_norm(
        propagator, (1e-3, end), abscissa_of(propagator), 1.0, 1e-6
    )
    assert propagator.norm_and_log_slope(end)[0] < 1
    assert tail == 0
    assert time == pytest.approx(2, rel=1e-2)
    assert largest == pytest.approx(4 * 1800 * np.exp(-2), rel=1e-2)
    scan = brute_force(propagator, np.linspace(0.1, 20, 1000)).max()
    assert scan * (1 - 1e-9) < largest <= bound <= largest * (1 + 1e-6)


def test_no_pair_is_cut():
    propagator = toy([[-1.0, 5.0, 0.3], [-5.0, -1.0, 0.2], [0.0, 0.0, -2.0]])
    assert [propagator.use_leading_modes(k) for k in (1, 2, 3, 4)] == [2, 2, 3, 3]


def test_all_modes_of_a_mesh_say_the_same_as_few():
    """Most have decayed by 1e-100 then, and must not cost digits: w t is up to 1e6."""
    propagator = growth_module.propagator_of(
        Rod(F=12.0, k1=INF, k2=INF, gamma3=0.0), assemble_pencil(1, 32), 0.0
    )
    norms = []
    for k in (12, 18, 32):
        assert propagator.use_leading_modes(k) == k
        assert (np.tril(propagator.generator, -2) == 0).all()
        norms.append(propagator.norm_and_log_slope(4.3e-5)[0])
    assert norms == pytest.approx([norms[0]] * 3, rel=5e-14)


def test_a_mesh_that_makes_an_unstable_eigenvalue_up_is_refused():
    made_up = toy(np.diag([0.1, -1.0, -2.0]))
    assert growth_module.transient_growth(made_up, made_up, 0.2, 1e-8).growth_error == INF


@pytest.mark.parametrize(("abscissa", "shift"), [(float("nan"), 0.0), (-2.0, 0.0), (9.0, 3.0)])
def test_the_inverse_of_the_operator_is_shifted_only_above_its_spectrum(abscissa, shift):
    rod = Rod(F=-10.0, k1=1e4, k2=1e3, gamma3=0.0)
    propagator = growth_module.propagator_of(rod, assemble_pencil(1, 16), abscissa)
    exact = solve_spectrum(rod, SpectrumRequest(2, 1e-10, False)).eigenvalues
    assert propagator.shift == shift
    assert propagator.w[:2] == pytest.approx(exact, rel=1e-8)


def test_where_nothing_can_grow_no_propagator_is_needed(monkeypatch):
    monkeypatch.setattr(growth_module, "propagator_of", None)
    result = solve_modes(Rod(F=9.8, k1=1e4, k2=1e4, gamma3=1e-4), TIGHT)
    assert result.status == SpectrumStatus.ok
    assert result.growth.numerical_abscissa < 0
    assert (result.growth.transient_growth, result.growth.transient_time, result.growth.growth_error) == (
        1.0,
        0.0,
        0.0,
    )


@pytest.mark.parametrize("fast", [1e2, 1e6, 1e12])
def test_fast_modes_cost_the_slow_ones_no_digits(fast):
    """Squaring exp(L t) itself some 40 times would leave 4 of 16 digits."""
    L = np.array([[-0.3, 2.0, 0.7], [-1.0, -0.2, 0.4], [0.0, 0.0, -1.0]]) * [1.0, 1.0, fast**0.5]
    L[2, 2] = -fast
    exact = np.array(mp.expm(mp.matrix(L.tolist())).tolist(), dtype=float)
    assert abs(matrix_exponential(L) - exact)[:2].max() < 1e-14 * abs(exact).max()
    many = matrix_exponential(L * np.array([0.5, 1.0])[:, None, None])
    assert many[1] == pytest.approx(matrix_exponential(L), abs=1e-14)
    assert many[0] @ many[0] == pytest.approx(many[1], abs=1e-13)


@pytest.mark.parametrize("frequency", [7.3, 31.0, 155.0])
def test_a_peak_between_two_times_is_found(frequency):
    """A damped pair with |exp(L t)| up to 9 twice a turn: the times to start with see few of the peaks."""
    propagator = toy([[-0.05, 9 * frequency], [-frequency / 9, -0.05]])
    largest, time, bound = maximum_propagator_norm(propagator, (1.0, 8.0), abscissa_of(propagator), 1.0, 1e-8)
    first = (np.ceil(frequency / np.pi - 0.5) + 0.5) * np.pi / frequency
    assert time == pytest.approx(first, rel=1e-2)
    assert largest == pytest.approx(9 * np.exp(-0.05 * first), rel=1e-3)
    scan = brute_force(propagator, np.linspace(1, 8, 4000)).max()
    assert scan <= largest * (1 + 1e-12)
    assert largest <= bound <= largest * (1 + 1e-8)


@pytest.mark.parametrize("seed", range(6))
def test_no_time_within_an_interval_exceeds_its_bound(seed):
    """Random non-normal operators: the bound of first order is below that of second, and the other way."""
    draw = np.random.default_rng(seed)
    generator = draw.normal(size=(5, 5)) * 10 ** draw.uniform(-1, 1, 5)
    generator -= (np.linalg.eigvals(generator).real.max() + 0.1) * np.eye(5)
    propagator = toy(generator)
    abscissa = abscissa_of(propagator)
    for t, h in ((0.1, 1e-3), (0.1, 0.03), (0.4, 0.2), (1.0, 1.0)):
        squares, bends = propagator.squared_norms_and_curvature_bounds(np.array([t, t + h]))
        inside = brute_force(propagator, np.linspace(t, t + h, 60)) ** 2
        assert squares == pytest.approx(inside[[0, -1]], rel=1e-9)
        for bend in (bends[0], INF):  # both orders together, and the first alone
            bound = peak_module._squared_norm_bound(
                np.array([h]), *squares[:, None], np.array([bend]), abscissa
            )
            assert inside.max() <= bound[0] * (1 + 1e-12)


def test_the_bound_is_reached_round_the_peak_of_a_pair():
    """|exp(L t)|^2 is 81 at the peak: the bound adds what an interval astride lacks, and little else."""
    propagator = toy([[0.0, 9.0], [-1 / 9, 0.0]])
    h = 1e-4
    ends = np.pi / 2 + np.array([-h / 2, h / 2])
    squares, bends = propagator.squared_norms_and_curvature_bounds(ends)
    bound = peak_module._squared_norm_bound(
        np.array([h]), *squares[:, None], bends[:1], abscissa_of(propagator)
    )
    lack = 81 - squares.max()
    assert 0 < bound[0] - 81 < 0.03 * lack


def test_a_search_that_is_given_up_leaves_the_bound_where_it_is(monkeypatch):
    monkeypatch.setattr(peak_module, "NORM_MAXIMUM_SETTINGS", replace(NORM_MAXIMUM_SETTINGS, max_halvings=1))
    propagator = toy([[-0.05, 9 * 155.0], [-155.0 / 9, -0.05]])
    largest, _, bound = maximum_propagator_norm(propagator, (1.0, 8.0), abscissa_of(propagator), 1.0, 1e-8)
    scan = brute_force(propagator, np.linspace(1, 8, 4000)).max()
    assert scan < bound
    assert bound > 1.01 * largest


def test_the_bend_is_that_of_the_most_concave_square():
    """c of (-f'')/2 over unit vectors, by differences; for a symmetric operator every f is convex."""
    propagator = toy([[-1.0, 9.0, 0.0], [0.0, -2.0, 5.0], [0.0, 0.0, -3.0]])
    t, h = 0.3, 1e-3
    matrices = [expm(propagator.generator * x) for x in (t - h, t, t + h)]
    low, middle, high = (E.T @ E for E in matrices)
    exact = -np.linalg.eigvalsh((low - 2 * middle + high) / h**2)[0]
    assert propagator.squared_norms_and_curvature_bounds(np.array([t]))[1][0] == pytest.approx(
        exact, rel=1e-4
    )
    assert exact > 1
    symmetric = toy(np.diag([-1.0, -2.0]) + 0.1 * np.ones((2, 2)))
    assert symmetric.squared_norms_and_curvature_bounds(np.array([t]))[1][0] == 0


def test_a_leading_pair_next_to_its_threshold_is_followed_for_half_a_turn_only():
    """It decays like exp(-1e-9 t): waiting for |exp(L t)| < 1 would take 1e9; the rest is gone by 30."""
    generator = np.zeros((4, 4))
    generator[:2, :2] = [[-1e-9, 12.0], [-3.0, -1e-9]]
    generator[2:, 2:] = [[-1.0, 8.0], [0.0, -1.5]]
    generator[:2, 2:] = 4.0
    propagator = toy(generator)
    end, tail = growth_module._end_of_growth_and_excess(propagator, 1e-2, 25.0)
    assert 20 < end < 40
    left_over = expm(generator * (end - np.pi / 6)) - mode_part(generator, end - np.pi / 6)
    assert tail == pytest.approx(2 * np.linalg.norm(left_over, 2), rel=1e-3)
    assert tail < 1e-7
    scans = [brute_force(propagator, np.linspace(*span, 4000)).max() for span in ((0, end), (end, 500))]
    assert scans[1] <= scans[0] * (1 + tail)


def mode_part(generator, t):
    """exp(L t) of the leading pair alone."""
    w, V = np.linalg.eig(generator)
    leading = np.isclose(abs(w.imag), abs(w.imag).max())
    return ((V * np.where(leading, np.exp(w * t), 0)) @ np.linalg.inv(V)).real


EARLY = [(10.5, 1e4, 1e4, 1e-4), (11.0, 1e4, 1e8, 1e-8), (9.9, 1e4, 1e2, 1e-2)]


@pytest.mark.long
@pytest.mark.parametrize("parameters", few(EARLY, 1))
def test_early_growth_is_that_of_the_exact_propagator(parameters):
    """Abscissae of 2 to 4, peaks at 1e-6 to 1e-4 of S - 1 from 1e-7 to 1e-4: 26 exact modes."""
    rod = rod_of(*parameters)
    result = solve_modes(rod, TIGHT)
    assert result.status == SpectrumStatus.ok
    exact = ReferenceGrowth(
        rod, solve_modes(rod, ModesRequest(26, 1e-8, 2, computes_growth=False)).spectrum.eigenvalues
    )
    scan = {x: exact(x * result.growth.transient_time) for x in (0.9, 1.0, 1.1)}
    assert max(scan, key=scan.get) == 1.0
    assert result.growth.transient_growth == pytest.approx(scan[1.0], rel=1e-10)
    assert abs(result.growth.transient_growth - scan[1.0]) < 1e-4 * (scan[1.0] - 1)


@pytest.mark.long
@pytest.mark.parametrize("F", [9.8697, 9.87, 9.88, 9.9, 9.95, 10.0, 10.2, 10.5, 11.0])
def test_growth_is_as_accurate_as_it_says_where_the_abscissa_is_small(F):
    """Abscissae from 1e-4 to 4; S - 1 below the accuracy is 0 at 0 and covered by the error estimate."""
    rod = Rod(F=F, k1=1e4, k2=1e4, gamma3=1e-4)
    fine = solve_modes(rod, TIGHT)
    assert fine.status == SpectrumStatus.ok
    assert 0 < fine.growth.numerical_abscissa < 4.1
    for accuracy in (1e-4, 1e-6, 1e-8):
        coarse = solve_modes(rod, replace(TIGHT, accuracy=accuracy))
        assert coarse.status == SpectrumStatus.ok
        assert coarse.growth.growth_error <= accuracy
        assert (
            abs(coarse.growth.transient_growth - fine.growth.transient_growth)
            <= coarse.growth.growth_error + 1e-10
        )


def test_transient_growth_is_smooth_across_the_onset():
    """Eigenvectors become parallel there and exp(L t) does not notice: second differences are O(h^2)."""
    growth = {}
    for h in (-2, -1, 0, 1, 2):
        result = solve_modes(Rod(F=ONSET + 0.01 * h, k1=1e4, k2=1e4, gamma3=1e-4), TIGHT)
        assert result.growth.growth_error < 1e-10
        growth[h] = result.growth.transient_growth
    second, wide = (growth[h] - 2 * growth[0] + growth[-h] for h in (1, 2))
    assert wide / second == pytest.approx(4, rel=1e-3)


def test_an_unstable_rod_grows_without_end():
    result = solve_modes(Rod(F=40.0, k1=1e4, k2=1e4, gamma3=1e-4), TIGHT)
    assert result.status == SpectrumStatus.ok
    assert result.spectrum.unstable_count == 2
    assert (result.growth.transient_growth, result.growth.transient_time) == (INF, INF)
    assert result.growth.numerical_abscissa > result.spectrum.eigenvalues[0].real


def test_growth_lies_between_one_and_what_the_abscissa_allows():
    for F in (5.0, 9.9, 10.0, 11.0, 20.0, 35.0):
        result = solve_modes(
            Rod(F=F, k1=1e4, k2=1e4, gamma3=1e-4), ModesRequest(2, 1e-6, 9, computes_growth=True)
        )
        assert result.status == SpectrumStatus.ok
        bound = np.exp(max(result.growth.numerical_abscissa, 0) * result.growth.transient_time)
        assert 1 <= result.growth.transient_growth <= bound * (1 + 1e-12)
        assert (result.growth.transient_time > 0) == (result.growth.transient_growth > 1)
        assert result.growth.transient_time == 0 or result.growth.numerical_abscissa > 0


@pytest.mark.kernel
@pytest.mark.parametrize(
    ("parameters", "exact"),
    few(
        [
            # Legendre-Galerkin matrices in 60 digits, two sizes.
            ((-300.0, 200.0, 1e4, 1e-4), 2.186180108731386),
            ((-349.2, 1554.0, 19520.0, 0.0733), 4.534631091713965),
            ((-1000.0, INF, INF, 1e-3), None),
            ((-1e4, 1e4, 1e4, 1e-4), None),
        ],
        2,
    ),
)
def test_growth_under_a_strong_pull_is_the_condition_of_the_leading_mode(parameters, exact):
    """The leading eigenvalue is of order exp(F), from -1e-5 to -4e-38: a state stays at its part in the
    leading mode once all other modes have decayed. Without a shift rounding hides all other modes."""
    result = solve_modes(rod_of(*parameters), ModesRequest(1, 1e-7, 9, computes_growth=True))
    assert result.status == SpectrumStatus.ok
    growth, condition = result.growth, result.mode_vectors.condition[0]
    assert growth.transient_growth == pytest.approx(exact or condition, rel=growth.growth_error)


def test_growth_is_computed_only_where_asked_for():
    result = solve_modes(rod_of(*FIG_2A), SHAPES)
    assert result.status == SpectrumStatus.ok
    assert np.isnan(
        [result.growth.numerical_abscissa, result.growth.transient_growth, result.growth.growth_error]
    ).all()


def test_a_point_that_fails_is_a_status():
    result = solve_modes(Rod(F=1e200, k1=INF, k2=1e-5, gamma3=1e-4), TIGHT)
    assert result.status == SpectrumStatus.failed
    assert result.message
    assert np.isnan(result.mode_vectors.right_modes).all()
    assert (
        result.mode_vectors.right_modes.shape
        == result.mode_vectors.left_modes.shape
        == result.mode_vectors.mode_strains.shape
        == (2, 4, NODES)
    )


def test_a_failing_mesh_is_a_status(monkeypatch):
    def broken(*_, **__):
        raise np.linalg.LinAlgError("Singular matrix")

    monkeypatch.setattr(convergence_module, "mode_vectors", broken)
    result = solve_modes(rod_of(*FIG_2A), TIGHT)
    assert result.status == SpectrumStatus.failed
    assert result.message == "Singular matrix"


def test_coarse_meshes_are_refined_until_they_agree(monkeypatch):
    monkeypatch.setattr(convergence_module, "mesh_accuracy_for_modes", lambda _: 1.0)
    result = solve_modes(rod_of(*FIG_2A), SHAPES)
    assert result.status == SpectrumStatus.ok
    assert result.mode_vectors.resolution.order > 16
    y, *_ = ClosedForm(rod_of(*FIG_2A), result.spectrum.eigenvalues[3]).fields(POINTS)
    assert relative(result.mode_vectors.right_modes[0, 3], y) < 1e-10


def test_a_tip_that_does_not_move_leaves_a_mode_without_scale():
    """Y(1) = 0 is met at single points only: a made-up vector has it."""
    rod, pencil = rod_of(*FIG_2A), assemble_pencil(1, 12)
    vectors = np.ones((pencil.unknown_count, 3), complex)
    vectors[pencil.node_count - 1] = [0.0, 1e-15, 2.0]
    with np.errstate(all="ignore"):
        scale = factors_to_unit_tip_displacement(
            *displacements_of_eigenvectors(vectors, pencil.displacement_factors(rod))
        )
    assert np.isnan(scale[:2]).all()
    assert scale[2] * displacements_of_eigenvectors(vectors, pencil.displacement_factors(rod))[0][
        -1, 2
    ] == pytest.approx(1)


def test_a_mode_whose_tip_does_not_move_is_nan_and_not_called_accurate(monkeypatch):
    def still(pencil):
        x, z = null_vectors(pencil)
        if pencil.w.real < -100:
            x[len(x) // 3 - 1] = 0
        return x, z

    monkeypatch.setattr(inverse_module, "null_vectors", still)
    result = solve_modes(rod_of(*FIG_2A), SHAPES)
    still_tips = result.spectrum.eigenvalues.real < -100
    assert (np.isnan(result.mode_vectors.right_modes).all(axis=(0, 2)) == still_tips).all()
    assert np.isfinite(result.mode_vectors.left_modes).all()
    assert result.status == SpectrumStatus.accuracy_not_reached
    assert result.message == "no digit of the modes is known"


def test_of_a_pair_only_one_vector_is_computed(monkeypatch):
    """The other is its conjugate; two of different pairs are not mistaken for one."""
    calls = []

    def counted(pencil):
        calls.append(pencil.w)
        return null_vectors(pencil)

    rod, pencil = Rod(F=30.0, k1=1e4, k2=1e4, gamma3=1e-4), assemble_pencil(1, 24)
    pair = solve_spectrum(rod, SpectrumRequest(2, 1e-10, True)).eigenvalues
    other = pair[1] - 5j  # no eigenvalue: its vector is the nearest one's, from a shift of its own
    monkeypatch.setattr(inverse_module, "null_vectors", counted)
    vectors = mode_vectors(rod, pencil, pair, POINTS)
    assert calls == [pair[0]]
    assert (vectors.right_modes[:, 1] == vectors.right_modes[:, 0].conj()).all()
    assert (vectors.left_modes[:, 1] == vectors.left_modes[:, 0].conj()).all()
    mode_vectors(rod, pencil, np.array([pair[0], other]), POINTS)
    assert calls[1:] == [pair[0], other]


def test_the_distance_to_the_next_eigenvalue_is_sharp_where_it_is_small():
    """Beside the onset F* = 20.008 the two lie close together."""
    for force, tolerance in ((20.0080207, 1e-3), (20.0081, 1e-3), (20.0, 1e-2)):
        rod = Rod(F=force, k1=1e4, k2=1e4, gamma3=1e-4)
        w = solve_spectrum(rod, SpectrumRequest(2, 1e-10, True)).eigenvalues
        found = distance_to_next_root(complex(w[0]), rod.coefficients)
        assert found == pytest.approx(abs(w[0] - w[1]), rel=tolerance)


def test_growth_on_a_coarse_mesh_is_refined_until_meshes_agree():
    rod = rod_of(*FIG_2A)
    exact = solve_modes(rod, TIGHT)
    coarse, fine = (growth_module.propagator_of(rod, assemble_pencil(1, order), 0.0) for order in (4, 6))
    first = growth_module.transient_growth(coarse, fine, 23.0, 1e-10)
    assert 1e-9 < abs(first.transient_growth / exact.growth.transient_growth - 1) < first.growth_error
    growth = growth_module.converged_transient_growth(rod, Resolution(1, 4), 1e-10, True, 45.0)
    assert max(growth.relative_errors_by_name(45.0).values()) < 1e-10
    assert growth.transient_growth == pytest.approx(exact.growth.transient_growth, rel=1e-10)
    assert growth.numerical_abscissa == pytest.approx(exact.growth.numerical_abscissa, rel=1e-9)


NOT_SPLIT = np.zeros((0, 0))
"""Bending factor of a matrix that is not split."""


def test_a_pivot_that_is_exactly_zero_gives_null_vectors():
    matrix = StiffnessMatrix(np.diag([1.0, 2.0, 3.0]), NOT_SPLIT)
    x, z = null_vectors(factorised_pencil(matrix, np.ones(3), 2.0))
    assert x == pytest.approx([0, 1, 0], abs=1e-15)
    assert z == pytest.approx([0, 1, 0], abs=1e-15)


def test_rms_errors_by_rounding_are_those_of_random_matrices():
    """Of the tip displacement, and of the condition number, for random relative errors of 1e-9."""
    form = dense_eigenproblem(rod_of(*FIG_2A), assemble_pencil(1, 12))
    A, B, tip = form.A, form.B, form.mesh.node_count - 1
    G, theta = form.bending_factor, slice(form.mesh.node_count, 2 * form.mesh.node_count)
    pencil_matrix, other_terms = StiffnessMatrix(A, G), A.copy()
    other_terms[theta, theta] = 0
    w = float(ClosedForm(rod_of(*FIG_2A), -44.02).w.real)
    x, z = null_vectors(factorised_pencil(pencil_matrix, B, w))
    found = effects_of_rounding(factorised_pencil(pencil_matrix, B, w), (x, z), tip)
    rng = np.random.default_rng(1)
    numbers = []
    for _ in range(200):
        changed, rows, columns = (
            each * (1 + 1e-9 * rng.standard_normal(each.shape)) for each in (other_terms, G, G)
        )
        changed[theta, theta] = -rows.T @ columns
        right, left = null_vectors(factorised_pencil(StiffnessMatrix(changed, NOT_SPLIT), B, w))
        tips = right[tip] / (z @ (B * right)), left[tip] / (x @ (B * left))
        norms = np.sqrt(B @ right**2) * np.sqrt(B @ left**2)
        numbers.append([*tips, norms / abs(left @ (B * right))])
    right_tip, left_tip, condition = np.std(np.log(np.abs(numbers)), axis=0) / 1e-9 * MACHINE_EPSILON
    assert found.tip_error == pytest.approx(max(right_tip, left_tip), rel=0.3)
    assert found.condition_error == pytest.approx(condition, rel=0.3)
