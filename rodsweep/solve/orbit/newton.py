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


@dataclass(frozen=True, slots=True, kw_only=True)
class OrbitNewtonSettings:
    """Settings of Newton's method for a periodic orbit, with or without a parameter."""

    new_matrix_ratio: float = 0.1
    """Ratio of successive Newton steps above which a new matrix is made."""
    longest_step: float = 0.5
    """Largest relative change of state, period or parameter in one iteration: a larger first step without a
    parameter is shortened; another larger step means that no orbit is near."""
    max_iterations: int = 12
    """Maximum number of iterations: a slower convergence means that no orbit is near the start."""
    quadratic_error: float = 1e5
    """Error after a step with a matrix at the iterate of a nearly neutral orbit, in units of the squared
    step."""


ORBIT_NEWTON = OrbitNewtonSettings()


class HasMultipliers(Protocol):
    """Newton's matrix of an orbit, with the orbit's multipliers.

    tangent: derivative of the orbit by a parameter, (N,), or None. workspace: memory of the matrix.
    """

    tangent: Array | None
    workspace: NewtonWorkspace

    def multipliers(self) -> Complex:
        """Floquet multipliers above rounding errors, (rank,), trivial one included, by descending modulus."""


@dataclass(frozen=True, eq=False)
class ConvergedOrbit:
    """Solution of Newton's method: the orbit, its last matrix, and the relative distance between the two."""

    orbit: Orbit
    matrix: HasMultipliers
    distance: float

    @property
    def workspace(self) -> NewtonWorkspace:
        """Workspace in which the matrix was made."""
        return self.matrix.workspace


def newton(
    orbit: Orbit, tolerance: float, workspace: NewtonWorkspace, parameter: str | None = None
) -> ConvergedOrbit:
    """The orbit near a start; raises Unsolvable.

    tolerance: relative, of states and period. workspace: memory of the matrices. parameter: parameter of the
    matrix's tangent. A matrix is used again as long as the steps decrease fast.
    """
    matrix = Linearisation(orbit, workspace, parameter)
    distance = 0.0
    last = np.inf
    step = matrix.step
    for iteration in range(1, ORBIT_NEWTON.max_iterations + 1):
        report()
        change = relative_change(orbit, step)
        if not np.isfinite(change):
            raise Unsolvable("Newton's method for the orbit broke down: its step is not finite")
        # A long first step may come from a poor start; a long later step that did not shrink is divergence.
        if iteration > 1 and change > max(last, ORBIT_NEWTON.longest_step):
            raise Unsolvable("Newton's method for the orbit diverges from its start")
        # A full step from a poor start may leave the neighbourhood of the orbit, so long steps are shortened.
        share = min(1.0, ORBIT_NEWTON.longest_step / change) if change > 0 else 1.0
        orbit = orbit.moved(step, share)
        distance += share * change
        if not orbit.period > 0:
            raise Unsolvable("Newton's method for the orbit broke down: the period is not positive")
        fresh = distance == share * change
        # Expected error after this step: quadratic for a matrix at the iterate, else linear at the rate of
        # the last two steps.
        left = ORBIT_NEWTON.quadratic_error * change**2 if fresh else change * min(1.0, change / last)
        if left <= tolerance:
            return ConvergedOrbit(orbit, matrix, distance)
        # A correction by the old factors is far cheaper than a new elimination, so a matrix is kept while it
        # contracts.
        if change > ORBIT_NEWTON.new_matrix_ratio * min(last, 1.0):
            matrix = Linearisation(orbit, workspace, parameter)
            distance = 0.0
            step = matrix.step
        else:
            step = matrix.correction(orbit)
        last = change
    raise Unsolvable(
        f"Newton's method for the orbit does not converge in {ORBIT_NEWTON.max_iterations} iterations; its "
        f"last step is {change:.0e}"
    )


def at_orbit(found: ConvergedOrbit, distance: float, parameter: str | None = None) -> ConvergedOrbit:
    """The solution with a matrix at most at this relative distance from the orbit."""
    if found.distance <= distance:
        return found
    return linearised(found, parameter)


def linearised(found: ConvergedOrbit, parameter: str | None = None) -> ConvergedOrbit:
    """The solution after one more Newton step, with a matrix at the orbit before this step."""
    orbit = found.orbit
    matrix = Linearisation(orbit, found.workspace, parameter)
    return ConvergedOrbit(orbit.moved(matrix.step), matrix, relative_change(orbit, matrix.step))


def multipliers_of(found: ConvergedOrbit) -> tuple[Complex, float]:
    """(nontrivial multipliers, (rank - 1,), by descending modulus; distance of the trivial one from 1)."""
    values = found.matrix.multipliers()
    # The derivative of the orbit by time is an eigenvector with multiplier 1; its computed distance from 1
    # shows the error of all.
    trivial = int(np.argmin(np.abs(values - 1)))
    others = np.concatenate([values[:trivial], values[trivial + 1 :]])
    return others, float(abs(values[trivial] - 1))


def multiplier_change(multipliers: Complex, others: Complex) -> float:
    """Distance of the largest of the multipliers, (m,), from the nearest of another mesh's multipliers, (l,),
    at least the difference of the largest moduli; both by descending modulus.

    The multiplier of the same index is not compared, nor are the moduli alone: on another mesh two
    multipliers may exchange their places, or two moduli may agree by coincidence.
    """
    if not (len(multipliers) and len(others)):
        return 0.0
    nearest = np.abs(others - multipliers[0]).min()
    # Of strongly unstable cycles the largest multiplier changes by factors, and the nearest one is another.
    return float(max(nearest, abs(abs(others[0]) - abs(multipliers[0]))))


def relative_change(orbit: Orbit, step: Array) -> float:
    """Largest change of n2, m3 and the period by a step, (N,), each in units of its largest value."""
    return float(largest_change(orbit.values, step, orbit.form.unknowns, orbit.form.mesh.nodes))
