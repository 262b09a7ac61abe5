"""How fast and how far a perturbation can grow in the Gamma norm: numerical abscissa, transient growth.

Both are asked of the dense operator on one mesh. Its inverse G = B^1/2 A^-1 B^1/2, in the coordinates
in which the Gamma norm is Euclidean, exists in every limit; infinite eigenvalues of the pencil are its
zeros. For gamma3 = 0 the state is y alone, and so is the norm: theta follows at once.

exp(L t) is represented as exp(L_k t) P_k, with the spectral projector P_k of the k leading modes on the
*whole* space: the rest dies like exp(Re w_k t). Restricting the initial state to the span of the k
leading modes instead, the usual way, converges only like a power of k, because the optimal
initial state has the ends of the adjoint.
"""

from dataclasses import dataclass
from math import exp, inf, log, nan, pi

import numpy as np
from numpy.typing import NDArray

from ..discretization.pencil import Pencil, angle_weight
from ..model.adjoint import hermitian_tip
from ..model.bounds import eigenvalue_box
from ..model.rod import Rod

Array = NDArray[np.float64]

MOST_SHIFTS = 60
"""Shifts tried to get above the numerical abscissa where no bound is known; each doubles the last."""
CLOSE_SHIFT = 0.05
"""Relative distance at which a shift above the abscissa no longer costs digits."""
POSITIVE = 1e-9
"""Relative size above which an eigenvalue of the shifted inverse is not rounding."""
INFINITE = 1e-12
"""Relative size of an eigenvalue of G below which it stands for an infinite one."""
FEWEST_MODES, MORE_MODES = 8, 1.5
"""Modes that represent exp(L t) at first, and the factor to the next attempt."""
TRUNCATION_MARGIN = 3.0
"""exp(-this): share of the accuracy that the modes left out may use up."""
TIMES_PER_OCTAVE = 12
TIMES_PER_RADIAN = 4.0
ALIVE = 8.0
"""A mode counts for the spacing of times while |Re w| t is below this."""
MOST_TIMES = 4000
BATCH = 256
CONTENDER = 0.98
"""A local maximum on the grid is refined where it is at least this share of the highest."""
EXTRAPOLATION_FACTOR = 30.0
"""Factor within which the growth at times too early for the mesh is extrapolated."""
LITTLE = 1e-2
"""Relative growth that the bound before the first time may leave open where |exp(L t)| rises there."""
MOST_STEPS = 40
TIME_TOLERANCE = 1e-12


@dataclass(frozen=True, slots=True)
class Growth:
    """sup_t |exp(L t)| in the Gamma norm, when, and the relative error estimate of the first."""

    largest: float
    time: float
    error: float


def dense_operator(rod: Rod, pencil: Pencil) -> tuple[Array, Array]:
    """(A, diagonal of B) of the rod as whole arrays, shapes (unknowns, unknowns) and (unknowns,)."""
    A = np.zeros((pencil.unknowns, pencil.unknowns))
    A[pencil.rows, pencil.columns] = pencil.stiffness(rod)
    return A, pencil.inertia(rod)


def shifted_inverse(A: Array, B: Array, shift: float) -> Array:
    """B^1/2 (A - shift B)^-1 B^1/2 on the unknowns that carry a time derivative."""
    moving = B > 0
    root = np.sqrt(B[moving])
    inverse = np.linalg.inv(A - np.diag(shift * B))[np.ix_(moving, moving)]
    return root[:, None] * inverse * root


def numerical_abscissa(rod: Rod, pencil: Pencil) -> float:
    """sup Re (xi, L xi)/(xi, xi) over the domain of L, in 1/tau2: the growth rate at t = 0+.

    The largest eigenvalue of the Hermitian part (`rodsweep.model.adjoint`), approached by shifts from
    above: nan where none is above it, which only a rod without rotational drag and g < 0 can bring about.
    """
    A, B = dense_operator(rod, pencil)
    n, t, tip_mass = pencil.nodes, angle_weight(rod.gamma3), pencil.mass[-1]
    pair, layer = hermitian_tip(rod)
    A[n - 1, 2 * n - 1] += pair / (t * tip_mass)
    A[2 * n - 1, n - 1] -= pair / (t * tip_mass)
    A[n - 1, n - 1] -= layer / tip_mass
    bound, _ = eigenvalue_box(rod)
    shift = bound + 1 if bound < inf else rod.F**2 + 1
    for _ in range(MOST_SHIFTS):
        H = shifted_inverse(A, B, shift)
        values = np.linalg.eigvalsh((H + H.T) / 2)
        if values[-1] > -POSITIVE * values[0]:  # something lies above the shift
            shift = 2 * abs(shift) + 1
            continue
        abscissa = shift + 1 / float(values[0])
        close = abscissa + CLOSE_SHIFT * abs(abscissa) + CLOSE_SHIFT
        if shift - abscissa <= 2 * (close - abscissa):
            return abscissa
        shift = close
    return nan


class Propagator:
    """exp(L t) on one mesh from its spectral decomposition, for any number k of leading modes.

    w: the finite eigenvalues of the mesh, by descending real part; those beyond the mesh are not
    eigenvalues of the rod, but what they stand for together is.
    """

    def __init__(self, rod: Rod, pencil: Pencil):
        self.G = shifted_inverse(*dense_operator(rod, pencil), 0.0)
        values, right = np.linalg.eig(self.G)
        finite = np.nonzero(np.abs(values) > INFINITE * np.abs(values).max())[0]
        w = 1 / values[finite]
        order = np.lexsort((-w.imag, -w.real))
        self.w: NDArray[np.complex128] = w[order].astype(complex)
        self.right = right[:, finite[order]]
        self.left = np.linalg.inv(right)[finite[order]].T
        self.generator, self.entry = np.zeros((0, 0)), np.zeros((0, 0))

    def keep(self, k: int) -> int:
        """Represents exp(L t) P_k as Q exp(L_k t) (Z^T Q)^-1 Z^T, with orthonormal real Q and Z.

        The bases of the right and left invariant subspaces, not their vectors, are used: at a double
        eigenvalue the vectors are parallel and the subspaces are as good as ever. Returns the k
        used: at most what the mesh has, and none that would cut a conjugate pair.
        """
        k = min(k, len(self.w))
        if self.w[k - 1].imag > 0:
            k += 1
        Q = _orthonormal(self.right[:, :k], self.w[:k])
        Z = _orthonormal(self.left[:, :k], self.w[:k])
        self.generator = np.linalg.inv(Q.T @ self.G @ Q)
        self.entry = np.linalg.inv(Z.T @ Q)
        return k

    def norms(self, times: Array) -> Array:
        """|exp(L t)| at many times, shape (times,); half of the digits are lost at a double eigenvalue."""
        w, R = np.linalg.eig(self.generator)
        inner = np.linalg.solve(R, self.entry.astype(complex))
        parts = np.array_split(times, len(times) // BATCH + 1)
        E = (((R * np.exp(part[:, None] * w)[:, None, :]) @ inner).real for part in parts)
        return np.concatenate([np.linalg.svd(part, compute_uv=False)[:, 0] for part in E])

    def norm(self, time: float) -> tuple[float, float]:
        """(|exp(L t)|, its logarithmic derivative) at one time, to all digits."""
        E = exponential(self.generator * time) @ self.entry
        u, sizes, _ = np.linalg.svd(E)
        rate = u[:, 0] @ self.generator @ u[:, 0]
        return float(sizes[0]), float(rate)


def _orthonormal(vectors: NDArray, w: NDArray) -> Array:
    """A real orthonormal basis of the invariant subspace that the vectors of w span, in their order."""
    columns = np.hstack([vectors.real[:, w.imag >= 0], vectors.imag[:, w.imag > 0]])
    place = np.concatenate([np.nonzero(w.imag >= 0)[0], np.nonzero(w.imag > 0)[0] + 1])
    return np.linalg.qr(columns[:, np.argsort(place)])[0]


def exponential(matrix: Array) -> Array:
    """exp of a small matrix: the Taylor series of a scaled one, squared."""
    size = float(np.abs(matrix).sum(axis=0).max())
    squarings = max(0, int(np.ceil(np.log2(size))) + 1) if size > 0 else 0
    scaled = matrix / 2.0**squarings
    identity = np.eye(len(matrix))
    result = identity
    for order in range(16, 0, -1):
        result = identity + scaled @ result / order
    for _ in range(squarings):
        result = result @ result
    return result


def transient_growth(rod: Rod, pencils: tuple[Pencil, Pencil], abscissa: float, accuracy: float) -> Growth:
    """The largest growth of a stable rod on the second mesh, compared with that on the first.

    1 at t = 0 where the numerical abscissa is <= 0. Before the first time that is looked at the
    growth is at most exp(abscissa t), which bounds what may be hidden there; more modes allow an earlier
    first time. What is too early for the mesh, and then too small to matter, is extrapolated.
    """
    if abscissa <= 0:
        return Growth(1.0, 0.0, 0.0)
    coarse, fine = (Propagator(rod, pencil) for pencil in pencils)
    if not fine.w[0].real < 0:  # the mesh makes an eigenvalue up that the rod has not
        return Growth(nan, nan, inf)
    patience = log(1 / accuracy) + TRUNCATION_MARGIN
    best, hidden, k, stop = (1.0, 0.0), inf, FEWEST_MODES, 0.0
    while True:
        k = fine.keep(k)
        first = patience / abs(fine.w[min(k, len(fine.w) - 1)].real)
        times = _times(fine, first, stop or _end(fine, first, patience))
        best, stop = max(best, _highest(fine, times)), first
        hidden = max(exp(min(abscissa * first, 700.0)) / best[0] - 1, 0.0)
        if hidden <= LITTLE and best[0] > 1 and fine.norm(first)[1] > 0:
            hidden = 0.0  # still rising there, so by the law of `_extrapolated` it only rose before
        if hidden <= accuracy / 4:
            break
        enough = k >= len(fine.w) // 2
        if best[0] == 1:
            early = _extrapolated(fine, first, abscissa)
            if enough or early[0] - 1 <= accuracy / EXTRAPOLATION_FACTOR:
                return Growth(*early, min(hidden, EXTRAPOLATION_FACTOR * (early[0] - 1)))
        if enough:
            break
        k = min(int(MORE_MODES * k), len(fine.w) // 2)
    coarse.keep(k)
    return Growth(*best, hidden + abs(coarse.norm(best[1])[0] / best[0] - 1))


def _extrapolated(propagator: Propagator, first: float, abscissa: float) -> tuple[float, float]:
    """(sup |exp(L t)|, t) by the law 1 + abscissa t - C t^p, 1 < p < 2, through `first` and its double.

    At the shortest times the tip layers in which the field changes ends, of a thickness that grows like a
    power of t, are all that takes from the growth (p = 5/4 in bending, 3/2 in shear).
    """
    pair = np.array([first, 2 * first])
    lost = 1 + abscissa * pair - propagator.norms(pair)
    if not lost[1] > lost[0] > 0:
        return 1.0, 0.0
    p = min(max(log(lost[1] / lost[0]) / log(2.0), 1.1), 1.9)
    time = first * (abscissa * first / (p * float(lost[0]))) ** (1 / (p - 1))
    time = min(time, first)
    return 1 + (1 - 1 / p) * abscissa * time, time


def _end(propagator: Propagator, first: float, patience: float) -> float:
    """A time after which |exp(L t)| is nowhere larger than before.

    Since |exp(L (t + r))| <= |exp(L t)| |exp(L r)|, that is the first time at which it is below 1. Near
    a threshold this is far off; but once the leading pair is alone it repeats itself and shrinks.
    """
    w = propagator.w[: len(propagator.generator)]
    slow, turning = -w[0].real, abs(w[0].imag)
    rest = w[2:] if turning else w[1:]
    gap = -rest[0].real - slow if len(rest) else inf
    alone = (patience / gap if gap > 0 else inf) + (pi / turning if turning else 0.0)
    end = max(1 / slow, first)
    while end < alone and propagator.norms(np.array([end]))[0] >= 1:
        end *= 2
    return max(min(end, alone), first)


def _times(propagator: Propagator, first: float, end: float) -> Array:
    """Times from `first` to `end` that resolve |exp(L t)|."""
    w = propagator.w[: len(propagator.generator)]
    times: list[float] = []
    t = first
    while t < end and len(times) < MOST_TIMES:
        times.append(t)
        fastest = np.abs(w.imag)[-w.real * t < ALIVE].max(initial=0.0)
        t += min(t * (2 ** (1 / TIMES_PER_OCTAVE) - 1), 1 / (TIMES_PER_RADIAN * fastest + 1e-300))
    return np.array([*times, end])


def _highest(propagator: Propagator, times: Array) -> tuple[float, float]:
    """(largest |exp(L t)|, t) between the first and the last of the times."""
    values = propagator.norms(times)
    padded = np.concatenate([[-inf], values, [-inf]])
    peaks = (values >= padded[:-2]) & (values >= padded[2:]) & (values >= CONTENDER * values.max())
    best = 0.0, 0.0
    for i in np.nonzero(peaks)[0]:
        best = max(best, _peak(propagator, times[max(i - 1, 0)], times[min(i + 1, len(times) - 1)]))
    return best


def _peak(propagator: Propagator, low: float, high: float) -> tuple[float, float]:
    """(|exp(L t)|, t) where its derivative changes sign between low and high: regula falsi, Illinois."""
    (at_low, rate_low), (at_high, rate_high) = propagator.norm(low), propagator.norm(high)
    if rate_low <= 0 or rate_high >= 0:
        return max((at_low, low), (at_high, high))
    best = (0.0, low)
    for _ in range(MOST_STEPS):
        t = (low * rate_high - high * rate_low) / (rate_high - rate_low)
        value, rate = propagator.norm(t)
        best = max(best, (value, t))
        if abs(rate) * t <= TIME_TOLERANCE or high - low <= TIME_TOLERANCE * t:
            break
        if rate > 0:
            low, rate_low, rate_high = t, rate, rate_high / 2
        else:
            high, rate_high, rate_low = t, rate, rate_low / 2
    return best
