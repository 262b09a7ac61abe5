"""Newton's method for a cycle together with a parameter: a condition on the branch closes the system.

At a fold the parameter does not tell cycles apart. What is prescribed instead is a combination of three
numbers that no mesh changes the meaning of: the bending moment at the clamp at t = 0, in units of about its
largest over the cycle, the logarithm of the period, and the parameter's `Parameter.coordinate` in units
of a scale. So a branch has a length, and steps along it; at a Hopf point it has a length too, for
there the moment goes through 0 as any other number does.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ...arrays import Array, Complex
from ...watch import report
from ..orbit.matrix.elimination import eliminate
from ..orbit.matrix.linearisation import (
    change_along,
    jump_of,
    over_period,
    reduced_residuals,
    reduced_variations,
    returns_of,
)
from ..orbit.matrix.phase import phase, phase_change, phase_row
from ..orbit.matrix.right_sides import right_sides
from ..orbit.matrix.substitution import substitute
from ..orbit.matrix.workspace import MatrixMemory, NewtonWorkspace
from ..orbit.newton import MOST_ITERATIONS, Converged, relative_change
from ..orbit.orbit import Orbit
from ..orbit.orbit_mesh import OrbitMesh
from ..point import Unsolvable

LONGEST_STEP = 0.5
"""Largest relative change of an orbit in one iteration."""
SLUGGISH = 0.1
"""Ratio of a correction to the one before from which the matrix is made anew."""


@dataclass(frozen=True, slots=True)
class Scale:
    """What moments at the clamp and the parameter's coordinate are measured in, and the parameter's name.

    least: the least unit of moments, for small cycles.
    """

    name: str
    moment: float
    coordinate: float
    least: float

    @classmethod
    def of(cls, orbit: Orbit, name: str, least: float) -> "Scale":
        """The one at an orbit."""
        largest = float(np.abs(orbit.form.layout.at(orbit.points, "m3")).max())
        return cls(name, float(np.hypot(largest, least)), abs(orbit.form.rod.coordinate(name)), least)

    def place(self, orbit: Orbit) -> Array:
        """(moment at the clamp, log of the period, coordinate), in these units, (3,)."""
        moment = moment_of(orbit) / self.moment
        at = orbit.form.rod.coordinate(self.name) / self.coordinate
        return np.array([moment, np.log(orbit.period), at])

    def moved(self, orbit: Orbit, change: Array) -> Array:
        """What a change of an orbit and the coordinate, (N + 1,), moves `place` by, (3,)."""
        moment = change[orbit.form.layout.place("m3")] / self.moment
        return np.array([moment, change[-2] / orbit.period, change[-1] / self.coordinate])


def moment_of(orbit: Orbit) -> float:
    """The bending moment at the clamp at t = 0, when the tip's y is largest."""
    return float(orbit.form.layout.at(orbit.start, "m3"))


class BorderedMatrix:
    """Newton's matrix at an orbit, with a parameter as a further unknown and one row still to be given.

    Steps are arrays like `Orbit.values`, (N,), with the parameter's coordinate behind them. They raise
    RuntimeError once another matrix was made in the same workspace; the multipliers stay.
    """

    def __init__(self, orbit: Orbit, scale: Scale, workspace: NewtonWorkspace) -> None:
        self.orbit, self.scale, self.workspace = orbit, scale, workspace
        self.tangent: Array | None = None  # by which parameter is for the branch to say
        p, (K, s, n) = orbit.semidiscrete, orbit.states.shape
        along, V = change_along(orbit.form, scale.name), np.empty((K, s, 3, len(p.matrices.weights)))
        self._columns, self._memory = np.empty((K, s, 3, n)), MatrixMemory(workspace, K, s, n)
        right_sides(orbit.points, orbit.duration, p, along, V, self._columns)
        ends = eliminate(orbit.points, V, orbit.duration, p, self._memory.factors, self._columns)
        shift = phase_change(orbit.start, along.change, p.rod, p.matrices)
        self._matrix = np.zeros((n + 2, n + 2))
        self._matrix[:n, :n] = self._memory.propagator - p.symmetry
        self._matrix[:n, n], self._matrix[:n, n + 1] = ends[0], ends[2]
        row = np.empty(n)
        phase_row(orbit.start, p.rod, p.matrices, row)
        self._matrix[n, :n], self._matrix[n, n + 1] = row, -shift
        self._right = self._jump(orbit, ends[1])

    def step(self, border: Array, length: float) -> Array:
        """Newton's step along which `border` . place, (3,), grows by a length, (N + 1,)."""
        return self.solved(border, np.append(self._right, length), self._columns[:, :, 1], 1.0)

    def correction(self, orbit: Orbit, border: Array, length: float) -> Array:
        """The same at another orbit near by, whose parameter may be another one."""
        factors, p = self._memory.factors, self.orbit.semidiscrete
        columns, ends = reduced_residuals(orbit.points, orbit.duration, orbit.semidiscrete, p, factors)
        right = np.append(self._jump(orbit, ends[0]), length)
        return self.solved(border, right, columns[:, :, 0], 1.0)

    def direction(self, border: Array) -> Array:
        """The tangent of the branch, of unit length in `Scale.place`, on the side of a border, (N + 1,)."""
        right = np.append(np.zeros(len(self._right)), 1.0)
        change = self.solved(border, right, self._columns[:, :, 1], 0.0)
        return change / np.linalg.norm(self.scale.moved(self.orbit, change))

    def varied(self, orbit: Orbit, variations: Array) -> tuple[Array, Array]:
        """The changes, (K, s, m, n), of another orbit's residuals along variations, (m, N + 1), reduced.

        With what they make of its end where its start stays, (m, n).
        """
        along, rod, p = change_along(orbit.form, self.scale.name), orbit.semidiscrete, self.orbit.semidiscrete
        changed: tuple[Array, Array] = reduced_variations(
            orbit.values, rod, along, variations, p, self._memory.factors
        )
        return changed

    def spread(self, starts: Array, columns: Array) -> Array:
        """The changes of states, (m, N + 1), from those of the start, (m, n), and reduced right sides."""
        out = np.empty_like(columns)
        substitute(starts, columns, self.orbit.semidiscrete, self._memory.factors, out)
        stages = out.transpose(2, 0, 1, 3).reshape(len(starts), -1)
        return np.hstack([starts, stages, np.zeros((len(starts), 2))])

    @property
    def propagator(self) -> Array:
        """P, (n, n)."""
        return self._memory.propagator

    @cached_property
    def returns(self) -> Complex:
        """The multipliers of the map over what is solved, half a period and the reflection, (rank,)."""
        return returns_of(self.propagator, self.orbit)

    def multipliers(self) -> Complex:
        """All Floquet multipliers but rounding, (rank,), by descending modulus, the trivial one too."""
        return over_period(self.returns, self.orbit)

    def other_way(self) -> Array:
        """The change at a fixed parameter that the matrix all but ignores, (N + 1,), of any length and sign.

        Where branches cross it leads along the one that the tangent does not.
        """
        matrix = self._matrix.copy()
        matrix[-1, -1] = 1.0
        return self._spread(np.linalg.svd(matrix)[2][-1], self._columns[:, :, 1], 0.0)

    def _jump(self, orbit: Orbit, end: Array) -> Array:
        """Right side for an orbit's start and phase, (n + 1,), and what its stages make of its end, (n,)."""
        p = orbit.semidiscrete
        jump = jump_of(orbit.points, p) - end
        return np.append(jump, -phase(orbit.start, p.rod, p.matrices))

    def solved(self, border: Array, right: Array, sides: Array, share: float) -> Array:
        """The change for right sides of the ends and a share of those of the stages, (K, s, n)."""
        n = len(self.orbit.start)
        matrix = self._matrix.copy()
        matrix[-1, self.orbit.form.layout.place("m3")] = border[0] / self.scale.moment
        matrix[-1, n:] = border[1] / self.orbit.period, border[2] / self.scale.coordinate
        return self._spread(np.linalg.solve(matrix, right), sides, share)

    def _spread(self, found: Array, sides: Array, share: float) -> Array:
        """The change of all, (N + 1,), from that of the ends, (n + 2,), and a share of the right sides."""
        n = len(self.orbit.start)
        stages = found[n] * self._columns[:, :, 0] + share * sides + found[n + 1] * self._columns[:, :, 2]
        stages = np.ascontiguousarray(stages[:, :, None])
        out = np.empty_like(stages)
        factors, start = self._memory.factors, found[None, :n].copy()
        substitute(start, stages, self.orbit.semidiscrete, factors, out)
        return np.concatenate([found[:n], out.ravel(), found[n:]])


def bordered(found: Converged) -> BorderedMatrix:
    """The matrix of an orbit that was found on a branch."""
    if not isinstance(found.matrix, BorderedMatrix):
        raise TypeError("the matrix does not know the parameter")
    return found.matrix


@dataclass(frozen=True, eq=False)
class Condition:
    """What closes the system: border . place, (3,), in a scale, is a number."""

    scale: Scale
    border: Array
    value: float

    @classmethod
    def at(cls, scale: Scale, border: Array, orbit: Orbit, length: float = 0.0) -> "Condition":
        """What holds at a length along a border from an orbit."""
        return cls(scale, border, float(border @ scale.place(orbit)) + length)

    def missed(self, orbit: Orbit) -> float:
        """By how much an orbit's is less."""
        return self.value - float(self.border @ self.scale.place(orbit))

    def solved(
        self, orbit: Orbit, tolerance: float, workspace: NewtonWorkspace, distance: float = np.inf
    ) -> Converged:
        """The cycle near an orbit; raises Unsolvable.

        tolerance: relative error that is left of the orbit. workspace: memory of the matrices. distance: the
        largest relative distance of its matrix from it, an error of its multipliers and of its tangent.
        """
        matrix, off, last = BorderedMatrix(orbit, self.scale, workspace), 0.0, np.inf
        step = matrix.step(self.border, self.missed(orbit))
        for _ in range(MOST_ITERATIONS):
            report()
            change = max(relative_change(orbit, step[:-1]), abs(step[-1]) / self.scale.coordinate)
            if not change <= LONGEST_STEP:
                raise Unsolvable("there is no cycle near on the branch")
            orbit, off = moved(orbit, self.scale.name, step), off + change
            rate = change / last if off > change else np.inf  # unknown before a second step of one matrix
            settled = change * min(rate, 1.0) <= tolerance and rate <= SLUGGISH
            if (settled or change <= tolerance) and off <= distance:
                return Converged(orbit, matrix, off)
            if settled or change <= tolerance or (off > change and rate > SLUGGISH):
                matrix, off = BorderedMatrix(orbit, self.scale, workspace), 0.0
                step, last = matrix.step(self.border, self.missed(orbit)), np.inf
            else:
                step, last = matrix.correction(orbit, self.border, self.missed(orbit)), change
        raise Unsolvable(f"Newton's method on the branch is at {change:.0e}")

    def on(self, mesh: OrbitMesh, found: Converged, tolerance: float, distance: float = np.inf) -> Converged:
        """A cycle that was found, on another mesh; raises Unsolvable. tolerance, distance: as in `solved`."""
        return self.solved(mesh.carry(found.orbit), tolerance, found.workspace, distance)


def moved(orbit: Orbit, name: str, change: Array) -> Orbit:
    """An orbit after a change of its values and the parameter's coordinate, (N + 1,); raises Unsolvable."""
    try:
        form = orbit.form.with_coordinate(name, orbit.form.rod.coordinate(name) + float(change[-1]))
    except (ValueError, ZeroDivisionError) as error:
        raise Unsolvable(f"the branch leaves the rods: {error}") from error
    there = replace(orbit, form=form, values=orbit.values + change[:-1])
    if form.omega_unknown != orbit.form.omega_unknown:
        raise Unsolvable(f"gamma3 = {form.rod.gamma3:.3g} needs other unknowns")
    if not there.period > 0:
        raise Unsolvable("Newton's method lost the cycle")
    return there
