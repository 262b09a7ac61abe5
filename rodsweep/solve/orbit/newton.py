"""Newton's method for a periodic orbit on one mesh."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ...arrays import Array, Complex
from ...watch import report
from ..point import Unsolvable
from .matrix.linearisation import Linearisation, largest_change
from .matrix.workspace import NewtonWorkspace
from .orbit import Orbit

SLUGGISH = 0.1
"""Decrease of the steps in one iteration from which Newton's matrix is made anew."""
LONGEST_STEP = 0.5
"""Largest change of state or period in one iteration, relative; what asks for more is far from any orbit."""
MOST_ITERATIONS = 12
"""What takes longer than that converges too slowly to be near its orbit."""
QUADRATIC = 1e5
"""What Newton's method leaves, in units of the square of its step, where the orbit is nearly neutral."""


class HasMultipliers(Protocol):
    """Newton's matrix, as far as it tells the stability of its orbit.

    tangent: the derivative of the orbit by a parameter, if there is one. workspace: memory of its factors.
    """

    tangent: Array | None
    workspace: NewtonWorkspace

    def multipliers(self) -> Complex:
        """All Floquet multipliers but rounding, (rank,), by descending modulus, the trivial one too."""


@dataclass(frozen=True, eq=False)
class Converged:
    """What Newton's method ended with: the orbit and its last matrix, made at a relative distance from it."""

    orbit: Orbit
    matrix: HasMultipliers
    distance: float

    @property
    def workspace(self) -> NewtonWorkspace:
        """The solver's, in which its matrix was made."""
        return self.matrix.workspace


def newton(
    orbit: Orbit, tolerance: float, workspace: NewtonWorkspace, parameter: str | None = None
) -> Converged:
    """The orbit near this one; raises Unsolvable.

    tolerance: relative, of states and period. workspace: memory of the matrices. parameter: along which the
    matrix has the tangent. The matrix is kept while the steps shrink fast.
    """
    matrix, distance, last = Linearisation(orbit, workspace, parameter), 0.0, np.inf
    step = matrix.step
    for iteration in range(1, MOST_ITERATIONS + 1):
        report()
        change = relative_change(orbit, step)
        if not np.isfinite(change):
            raise Unsolvable("Newton's method for the orbit broke down")
        if iteration > 1 and change > max(last, LONGEST_STEP):
            raise Unsolvable("there is no orbit near the start of Newton's method")
        share = min(1.0, LONGEST_STEP / change) if change > 0 else 1.0
        orbit, distance = orbit.moved(step, share), distance + share * change
        if not orbit.period > 0:
            raise Unsolvable("Newton's method lost the orbit")
        fresh = distance == share * change
        left = QUADRATIC * change**2 if fresh else change * min(1.0, change / last)
        if left <= tolerance:
            return Converged(orbit, matrix, distance)
        if change > SLUGGISH * min(last, 1.0):
            matrix, distance = Linearisation(orbit, workspace, parameter), 0.0
            step = matrix.step
        else:
            step = matrix.correction(orbit)
        last = change
    raise Unsolvable(f"Newton's method for the orbit is at {change:.0e} after {MOST_ITERATIONS} iterations")


def at_orbit(found: Converged, distance: float, parameter: str | None = None) -> Converged:
    """The same with a matrix made at most at this distance from the orbit."""
    if found.distance <= distance:
        return found
    return linearised(found, parameter)


def linearised(found: Converged, parameter: str | None = None) -> Converged:
    """An orbit that was found, after one more step, with the matrix at itself."""
    orbit = found.orbit
    matrix = Linearisation(orbit, found.workspace, parameter)
    return Converged(orbit.moved(matrix.step), matrix, relative_change(orbit, matrix.step))


def multipliers_of(found: Converged) -> tuple[Complex, float]:
    """The multipliers, (rank - 1,), by descending modulus, and how far the trivial one is from 1."""
    values = found.matrix.multipliers()
    one = int(np.argmin(np.abs(values - 1)))
    return np.concatenate([values[:one], values[one + 1 :]]), float(abs(values[one] - 1))


def multiplier_change(multipliers: Complex, others: Complex) -> float:
    """How far the largest of multipliers, (m,), is from the nearest of others, (l,), of another mesh.

    Neither the one of the same place nor the moduli tell: two may change places, or happen to agree.
    """
    if not (len(multipliers) and len(others)):
        return 0.0
    return float(np.abs(others - multipliers[0]).min())


def relative_change(orbit: Orbit, step: Array) -> float:
    """The largest change of n2, m3 and the period by a step, (N,), each in units of its largest value."""
    return float(largest_change(orbit.values, step, orbit.form.unknowns, orbit.form.mesh.nodes))
