"""exp(L t) on one mesh, L: operator of the rod, represented by exp(L_k t) P_k, and data for bounds of the
norm between two times.

P_k is the spectral projector of the k leading modes on the *whole* space; the remainder decays like exp(Re
w_k t). The usual restriction of the initial state to the span of the k leading modes would converge only like
a power of k: the optimal initial state satisfies the boundary conditions of the adjoint.
"""

from dataclasses import dataclass
from math import factorial

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array, Complex
from ...determinant.exponents import MACHINE_EPSILON


@dataclass(frozen=True, slots=True, kw_only=True)
class PropagatorSettings:
    """Settings for exp(L t) and for its representation by the leading modes."""

    zero_inverse_eigenvalue_ratio: float = 1e-12
    """An eigenvalue of G = (L - shift)^-1 whose modulus is at most this fraction of the largest modulus is
    treated as 0: the operator L then has an infinite eigenvalue."""
    taylor_term_count: int = 16
    """Number of Taylor terms of exp for a matrix of norm 1/2; a multiple of 4."""

    def __post_init__(self) -> None:
        if self.taylor_term_count % 4 or 0.5**self.taylor_term_count > MACHINE_EPSILON * factorial(
            self.taylor_term_count
        ):
            raise ValueError(
                f"taylor_term_count = {self.taylor_term_count} is not allowed: it must be a multiple "
                "of 4, and so large that the remainder of the Taylor series is below rounding error"
            )


PROPAGATOR_SETTINGS = PropagatorSettings()


def symmetrised_shifted_inverse(A: Array, B: Array, shift: float) -> Array:
    """B^1/2 (A - shift B)^-1 B^1/2 on the n unknowns with a time derivative, (n, n). A: (unknowns, unknowns).
    B: diagonal matrix, as (unknowns,); 0 for an unknown without time derivative.

    This matrix is G, the inverse of L - shift in coordinates with a Euclidean Gamma norm. G exists for every
    rod, also for c2 = 0 or gamma3 = 0, unless shift is an eigenvalue; its zero eigenvalues are the infinite
    eigenvalues of L. For gamma3 = 0 state and norm contain y alone.
    """
    has_derivative = B > 0
    sqrt_B = np.sqrt(B[has_derivative])
    inverse = np.linalg.inv(A - np.diag(shift * B))[np.ix_(has_derivative, has_derivative)]
    return sqrt_B[:, None] * inverse * sqrt_B


class Propagator:
    """exp(L t) from the spectral decomposition of G = (L - shift)^-1 on one mesh, for any number k of leading
    modes.

    w: finite eigenvalues of the mesh, by descending real part. right, left: right and left eigenvectors of G
    as columns. generator: L_k, the restriction of L to the k leading modes; overlap: Z^T Q, products of the
    left and right bases Z and Q (see `use_leading_modes`); (k, k) each, (0, 0) before the first call of that
    method. Eigenvalues that the mesh does not resolve are not eigenvalues of the rod, but together they
    represent the remaining spectrum.
    """

    def __init__(self, G: Array, shift: float):
        self.G = G
        self.shift = shift
        values, right_vectors = np.linalg.eig(G)
        finite = np.nonzero(
            np.abs(values) > PROPAGATOR_SETTINGS.zero_inverse_eigenvalue_ratio * np.abs(values).max()
        )[0]
        # G is an inverse: its eigenvalues near 0 are the infinite eigenvalues of the pencil, which carry no
        # dynamics.
        w = shift + 1 / values[finite]
        # `lexsort` sorts by its last key first.
        order = np.lexsort((-w.imag, -w.real))
        self.w: Complex = w[order].astype(complex)
        self.right = right_vectors[:, finite[order]]
        # The rows of the inverse are left eigenvectors in the order of the right ones.
        self.left = np.linalg.inv(right_vectors)[finite[order]].T
        self.generator: Array = np.zeros((0, 0))
        self.overlap: Array = np.zeros((0, 0))

    def use_leading_modes(self, k: int) -> int:
        """Represents exp(L t) from now on by k leading modes, as Q exp(L_k t) (Z^T Q)^-1 Z^T, with
        orthonormal real Q, Z.

        Q and Z are bases of the right and left invariant subspaces: at a double eigenvalue the eigenvectors
        are parallel, but the subspaces are well conditioned. The subspaces are nested, so L_k is upper
        triangular except for the 2 x 2 blocks of conjugate pairs. Returns the k used: at most the number of
        modes of the mesh, and increased by 1 if k would split a conjugate pair.
        """
        k = min(k, len(self.w))
        # A complex pair must not be split, or the basis would not be real.
        if self.w[k - 1].imag > 0:
            k += 1
        Q = _orthonormal_basis(self.right[:, :k], self.w[:k])
        Z = _orthonormal_basis(self.left[:, :k], self.w[:k])
        # In the basis of nested invariant subspaces G is block triangular: entries below are rounding errors.
        mask = np.tri(k, dtype=bool).T | np.diag(self.w[: k - 1].imag > 0, -1)
        self.generator = np.linalg.inv(np.where(mask, Q.T @ self.G @ Q, 0.0)) + self.shift * np.eye(k)
        self.overlap = Z.T @ Q
        return k

    def propagators_at(self, times: Array) -> Array:
        """The matrix exp(L_k t) (Z^T Q)^-1 at each t of `times`, in tau2: (times, k, k). L_k, Z, Q: see
        `use_leading_modes`. The 2-norm of the matrix is the norm of exp(L t) P_k."""
        return matrix_exponential(self.generator * times[:, None, None]) @ np.linalg.inv(self.overlap)

    def norm_and_log_slope(self, time: float) -> tuple[float, float]:
        """Returns (norm |exp(L t)|, derivative of its logarithm) at `time`, in tau2."""
        # d|E|/dt = u . dE/dt v = |E| u . L u, with u the left singular vector.
        u, singular_values, _ = np.linalg.svd(self.propagators_at(np.array([time]))[0])
        return float(singular_values[0]), float(u[:, 0] @ self.generator @ u[:, 0])

    def squared_norms_and_curvature_bounds(self, times: Array) -> tuple[Array, Array]:
        """Returns (N^2, c), (times,) each, for each time t of `times`, in tau2. N = |exp(L t)|. c >= 0 bounds
        the curvature of growth curves from below: f''(t) >= -c for f(t) = |exp(L t) v|^2 and every v with |v|
        = 1."""
        E = self.propagators_at(times)
        rate_of_E = self.generator @ E
        half_second_derivative = (
            np.swapaxes(E, 1, 2) @ (self.generator @ rate_of_E) + np.swapaxes(rate_of_E, 1, 2) @ rate_of_E
        )
        squared_norms = np.asarray(np.linalg.eigvalsh(np.swapaxes(E, 1, 2) @ E)[:, -1], np.float64)
        return squared_norms, np.maximum(
            -np.linalg.eigvalsh(half_second_derivative + np.swapaxes(half_second_derivative, 1, 2))[:, 0], 0.0
        )

    def norm_of_truncated_modes(self, m: int, time: float) -> float:
        """Norm |exp(L t) (P_k - P_m)| at the time t = `time`, in tau2: the contribution of the modes m + 1 to
        k, k: number of leading modes in use. m < k must not split a complex pair."""
        E = self.propagators_at(np.array([time]))[0]
        E[:m, :m] -= matrix_exponential(self.generator[:m, :m] * time) @ np.linalg.inv(self.overlap[:m, :m])
        return float(np.linalg.norm(E, 2))


def _orthonormal_basis(vectors: NDArray, w: NDArray) -> Array:
    """Real orthonormal basis, (n, k), of the invariant subspace of the eigenvalues w, (k,), with eigenvectors
    `vectors`, (n, k); the first columns span the subspaces of the first eigenvalues."""
    columns = np.hstack([vectors.real[:, w.imag >= 0], vectors.imag[:, w.imag > 0]])
    column_order = np.concatenate([np.nonzero(w.imag >= 0)[0], np.nonzero(w.imag > 0)[0] + 1])
    return np.linalg.qr(columns[:, np.argsort(column_order)])[0]


def matrix_exponential(matrices: Array) -> Array:
    """exp of one small matrix or a stack of matrices, (..., k, k), by Taylor series, scaling and squaring.
    The function squares exp - 1 instead of exp: in a block triangular matrix with slow and fast blocks, the
    slow blocks then keep their digits, however many squarings the fast blocks need."""
    norm = float(np.abs(matrices).sum(axis=-2).max())
    squaring_count = max(0, int(np.ceil(np.log2(norm))) + 1) if norm > 0 else 0
    scaled_matrices = matrices / 2.0**squaring_count
    identity = np.eye(matrices.shape[-1])
    powers = [identity, scaled_matrices, scaled_matrices @ scaled_matrices]
    powers += [powers[2] @ scaled_matrices, powers[2] @ powers[2]]
    # exp(x) - 1 is squared, not exp(x): small norms keep their digits, since (1 + r)^2 - 1 = 2 r + r^2.
    result = np.zeros_like(scaled_matrices)
    for order in range(PROPAGATOR_SETTINGS.taylor_term_count - 4, -1, -4):  # four terms a product
        terms = sum(powers[i] / float(factorial(order + i)) for i in range(4) if order + i > 0)
        result = terms + powers[4] @ result
    for _ in range(squaring_count):
        result = 2 * result + result @ result
    return result + identity
