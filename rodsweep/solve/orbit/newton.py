"""Newton's method for a periodic orbit on one mesh."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ...arrays import Array, Complex
from ...discretization.state_layout import SE2_DIMENSION, stress_index
from ...model.compiled.compilation import compiled_with_reordered_sums
from ...solve_progress import report
from ..unsolvable import Unsolvable
from .matrix.linearisation import Linearisation
from .matrix.workspace import NewtonWorkspace
from .orbit import Orbit


@dataclass(frozen=True, slots=True, kw_only=True)
class OrbitNewtonSettings:
    """Settings of Newton's method for a periodic orbit, with or without a parameter among the unknowns."""

    max_step_ratio_with_old_matrix: float = 0.1
    """A new Newton matrix is assembled and eliminated if the relative change in a Newton step exceeds this
    number times the change in the previous step; without a parameter among the unknowns, also if it exceeds
    this number itself."""
    max_relative_step: float = 0.5
    """Largest relative change of state, period or parameter in one iteration. If the parameter is unknown, a
    longer step is a failure. Otherwise a longer step is shortened; the iteration fails if a step after the
    first is longer than this number and longer than the step before."""
    max_iterations: int = 12
    """Maximum number of iterations; slower convergence means that there is no orbit near the start."""
    max_error_per_squared_step: float = 1e5
    """Bound of the relative error after a Newton step with the matrix at the iterate, divided by the squared
    relative step. Nearly neutral orbits come close to this bound."""


ORBIT_NEWTON_SETTINGS = OrbitNewtonSettings()


class NewtonMatrix(Protocol):
    """Newton's matrix of an orbit with a method for the Floquet multipliers. tangent: derivative of the orbit
    values with respect to a parameter coordinate, (N,), or None. workspace: memory of the matrix."""

    @property
    def tangent(self) -> Array | None: ...

    @property
    def workspace(self) -> NewtonWorkspace: ...

    @property
    def multipliers_over_solved_time_interval(self) -> Complex:
        """Multipliers over the solved part of the period, half of it for a symmetric orbit, with the trivial
        multiplier: (multipliers,)."""

    def multipliers(self) -> Complex:
        """Floquet multipliers larger than rounding error, by descending modulus, (multipliers,), with the
        trivial multiplier."""


@dataclass(frozen=True, eq=False)
class ConvergedOrbit:
    """Result of Newton's method. matrix: the last Newton matrix. distance_from_matrix_orbit: relative
    distance of `orbit` from the iterate at which `matrix` was assembled."""

    orbit: Orbit
    matrix: NewtonMatrix
    distance_from_matrix_orbit: float

    @property
    def workspace(self) -> NewtonWorkspace:
        """Memory of the matrix."""
        return self.matrix.workspace


def solve_by_newton(
    orbit: Orbit, tolerance: float, workspace: NewtonWorkspace, parameter_name: str | None = None
) -> ConvergedOrbit:
    """The periodic orbit near the start `orbit`, by Newton's method; raises Unsolvable if the method does not
    converge.

    tolerance: relative tolerance of states and period. workspace: memory of the matrices. parameter_name:
    name of the parameter for the `tangent` of the matrix, or None. A matrix is used again as long as the
    Newton steps decrease fast.
    """
    matrix = Linearisation(orbit, workspace, parameter_name)
    distance_from_matrix_orbit = 0.0
    previous_change = np.inf
    step = matrix.step
    for iteration in range(1, ORBIT_NEWTON_SETTINGS.max_iterations + 1):
        report()
        change = relative_change(orbit, step)
        if not np.isfinite(change):
            raise Unsolvable("Newton's method for the cycle diverges: its step is not finite")
        # A long first step may come from a poor start; a long later step that is not shorter is divergence.
        if iteration > 1 and change > max(previous_change, ORBIT_NEWTON_SETTINGS.max_relative_step):
            raise Unsolvable("Newton's method for the cycle diverges: its steps grow")
        # A full step from a poor start may leave the neighbourhood of the orbit, so long steps are shortened.
        damping_factor = min(1.0, ORBIT_NEWTON_SETTINGS.max_relative_step / change) if change > 0 else 1.0
        orbit = orbit.plus_change(step, damping_factor)
        distance_from_matrix_orbit += damping_factor * change
        if not orbit.period > 0:
            raise Unsolvable("Newton's method for the cycle diverges: the period is not positive")
        # The matrix is new if this step is the first one made with it.
        is_matrix_new = distance_from_matrix_orbit == damping_factor * change
        # Expected error after this step: quadratic in the step if the matrix is new, otherwise by the ratio
        # of the last two steps.
        expected_error = (
            ORBIT_NEWTON_SETTINGS.max_error_per_squared_step * change**2
            if is_matrix_new
            else change * min(1.0, change / previous_change)
        )
        if expected_error <= tolerance:
            return ConvergedOrbit(orbit, matrix, distance_from_matrix_orbit)
        # A correction with the old factors is far cheaper than a new elimination.
        if change > ORBIT_NEWTON_SETTINGS.max_step_ratio_with_old_matrix * min(previous_change, 1.0):
            matrix = Linearisation(orbit, workspace, parameter_name)
            distance_from_matrix_orbit = 0.0
            step = matrix.step
        else:
            step = matrix.newton_step_at_nearby_orbit(orbit)
        previous_change = change
    raise Unsolvable(
        f"Newton's method for the cycle does not converge in {ORBIT_NEWTON_SETTINGS.max_iterations} "
        f"iterations; its last relative step is {change:.0e}"
    )


def newton_step_if_matrix_distant(
    solved: ConvergedOrbit, distance: float, parameter_name: str | None = None
) -> ConvergedOrbit:
    """The orbit `solved`, after one more Newton step if its matrix was assembled at a relative distance of
    more than `distance` from the orbit. parameter_name: name of the parameter for the `tangent` of the
    matrix, or None."""
    if solved.distance_from_matrix_orbit <= distance:
        return solved
    return newton_step(solved, parameter_name)


def newton_step(solved: ConvergedOrbit, parameter_name: str | None = None) -> ConvergedOrbit:
    """The orbit `solved` after one more Newton step, with the matrix at the orbit before this step.
    parameter_name: name of the parameter for the `tangent` of the matrix, or None."""
    orbit = solved.orbit
    matrix = Linearisation(orbit, solved.workspace, parameter_name)
    return ConvergedOrbit(orbit.plus_change(matrix.step), matrix, relative_change(orbit, matrix.step))


def nontrivial_multipliers_and_error(solved: ConvergedOrbit) -> tuple[Complex, float]:
    """Returns (multipliers, trivial_error): nontrivial Floquet multipliers by descending modulus, (m,), and
    the distance of the computed trivial multiplier from 1."""
    multipliers = solved.matrix.multipliers()
    # The time derivative of the orbit is an eigenvector with the exact multiplier 1.
    trivial_index = int(np.argmin(np.abs(multipliers - 1)))
    nontrivial = np.concatenate([multipliers[:trivial_index], multipliers[trivial_index + 1 :]])
    return nontrivial, float(abs(multipliers[trivial_index] - 1))


def error_of_largest_multiplier(multipliers: Complex, other_multipliers: Complex) -> float:
    """Absolute error of the largest multiplier, from the multipliers on two meshes: the distance of
    `multipliers[0]` from the nearest of `other_multipliers`, or the difference of the two largest moduli,
    whichever is larger; 0 if a list is empty.

    multipliers, other_multipliers: by descending modulus, (m,) and (l,). Multipliers with the same index are
    not compared, because two multipliers may be in a different order on another mesh. The moduli alone may
    agree by coincidence.
    """
    if not (len(multipliers) and len(other_multipliers)):
        return 0.0
    nearest_distance = np.abs(other_multipliers - multipliers[0]).min()
    # The largest multiplier of a strongly unstable cycle may differ by a factor between meshes; the nearest
    # multiplier is then a different multiplier.
    return float(max(nearest_distance, abs(abs(other_multipliers[0]) - abs(multipliers[0]))))


def relative_change(orbit: Orbit, step: Array) -> float:
    """Largest relative change of n2, m3 and the period in the Newton step `step`, (N,): the largest change of
    each quantity, divided by the largest modulus of this quantity; inf if the step is not finite."""
    return float(
        largest_relative_change(orbit.values, step, orbit.form.unknown_count, orbit.form.mesh.node_count)
    )


@compiled_with_reordered_sums
def largest_relative_change(values: Array, step: Array, unknowns: int, nodes: int) -> float:
    """Largest relative change of n2, m3 and the period in a step, (N,): the largest change of each quantity,
    divided by its largest modulus; inf if the step is not finite. values: orbit values, (N,). unknowns:
    length of a state. nodes: number of nodes without the tip."""
    max_change = abs(step[-1]) / abs(values[-1])
    for change in step:
        # NaN would be lost in the comparisons below.
        if not np.isfinite(change):
            return np.inf
    max_steps = np.zeros(SE2_DIMENSION)
    size = np.zeros(SE2_DIMENSION)
    # The state at the start is left out: it is the last stage of the previous part of the period.
    for first in range(unknowns, len(values) - 1, unknowns):
        for a in range(1, SE2_DIMENSION):
            for i in range(nodes):
                index = first + stress_index(a, i, nodes)
                max_steps[a], size[a] = max(max_steps[a], abs(step[index])), max(size[a], abs(values[index]))
    for a in range(1, SE2_DIMENSION):
        max_change = max(max_change, max_steps[a] / size[a])
    return max_change
