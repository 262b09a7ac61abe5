"""The monodromy matrix of a cycle and its eigenvalues, the Floquet multipliers.

M(T) of M' = J(z(t)) M, M(0) = 1 is the derivative of the period map z -> phi_T(z). One of its eigenvalues is
1 (a shift along the cycle); the cycle is stable if all others lie inside the unit circle.
"""

from dataclasses import dataclass

import numpy as np

from ...arrays import Array, Complex
from ...discretization.beam import Beam
from ..motion.integrator import Trajectory

SDIRK = np.array(
    [
        [1 / 4, 0, 0, 0, 0],
        [1 / 2, 1 / 4, 0, 0, 0],
        [17 / 50, -1 / 25, 1 / 4, 0, 0],
        [371 / 1360, -137 / 2720, 15 / 544, 1 / 4, 0],
        [25 / 24, -49 / 48, 125 / 16, -85 / 12, 1 / 4],
    ]
)
"""Order 4, L-stable, stiffly accurate (Hairer & Wanner II, Table IV.6.5)."""
UNSTABLE = 1e-6
"""How far beyond 1 the modulus of a multiplier is not its error."""


@dataclass(frozen=True, eq=False)
class Monodromy:
    """matrix: M(T), (unknowns, unknowns); multipliers: by descending modulus, the trivial one taken out.

    trivial_error: the distance of the trivial one from 1, an estimate of the error of the others.
    """

    matrix: Array
    multipliers: Complex
    trivial_error: float

    @property
    def largest(self) -> float:
        """Modulus of the largest multiplier but the trivial one."""
        return float(abs(self.multipliers[0]))

    @property
    def stable(self) -> bool:
        """Whether all multipliers but the trivial one lie inside the circle, within their error."""
        return self.largest <= 1 + max(UNSTABLE, self.trivial_error)


def monodromy(beam: Beam, run: Trajectory) -> Monodromy:
    """The monodromy matrix of one period, by SDIRK on the steps of its run."""
    M = flow_derivative(beam, run)
    mu = np.linalg.eigvals(M)
    mu = mu[np.argsort(-np.abs(mu))]
    one = int(np.argmin(np.abs(mu - 1)))
    return Monodromy(M, np.delete(mu, one), float(abs(mu[one] - 1)))


def flow_derivative(beam: Beam, run: Trajectory) -> Array:
    """M(T), shape (unknowns, unknowns); between the steps z is the cubic through z and z' at both ends."""
    n, stages = beam.mesh.unknowns, len(SDIRK)
    identity, nodes = np.eye(n), SDIRK.sum(axis=1)
    rates = beam.rate(run.states)
    M, slopes = np.eye(n), np.zeros((stages, n, n))
    for k, h in enumerate(np.diff(run.times)):
        gamma, Z = SDIRK[0, 0] * h, M
        here = hermite(run.states[k : k + 2], h * rates[k : k + 2], nodes)
        matrices = identity - gamma * beam.jacobian(here)
        for i in range(stages):
            right = M + np.tensordot(h * SDIRK[i, :i], slopes[:i], 1)
            Z = np.linalg.solve(matrices[i], right)
            slopes[i] = (Z - right) / gamma
        M = Z
    return M


def hermite(ends: Array, slopes: Array, at: Array | float) -> Array:
    """The cubic with values and slopes (per unit of `at`) at 0 and 1, shapes (2, n), at `at`: (..., n)."""
    x = np.asarray(at)[..., None]
    value: Array = ends[0] + x * x * (3 - 2 * x) * (ends[1] - ends[0])
    return value + x * (1 - x) * ((1 - x) * slopes[0] - x * slopes[1])
