"""Newton's method for a cycle together with a parameter; a condition on the branch closes the system.

The parameter does not distinguish cycles beside a fold. The condition prescribes a linear combination of
three numbers that mean the same on every mesh: the deflection at t = 0, in units of about its largest value
over the cycle; the logarithm of the period; the parameter's scaled coordinate. Arc length is measured in
these numbers too; at a Hopf point the deflection passes through 0 and keeps it regular.

The deflection is the integral of (1 - s) c m3 over the rod, which is linear in the state; c is the bending
compliance of the arm's profile. For small cycles of a rod without taper it is the tip's y. Without c it would
depend on the mesh: at a jump of rubber m3, the moment of a linear rod with the same strain, differs between
both sides, and a mesh has only the mean strain. A moment at one place of the rod may vanish on large cycles,
as the clamp's does, and steps along a branch would become short there.
"""

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np

from ...arrays import Array, Complex
from ...discretization.arm_on_mesh import profile_compliance_on
from ...discretization.elements.mesh import Mesh
from ...discretization.state_layout import StateLayout
from ...model.material.build import Build
from ...watch import report
from ..orbit.matrix.elimination import eliminate
from ..orbit.matrix.linearisation import (
    change_along,
    jump_of,
    over_period,
    partial_multipliers,
    reduced_residuals,
    reduced_variations,
)
from ..orbit.matrix.phase import phase, phase_change, phase_row
from ..orbit.matrix.right_sides import right_sides
from ..orbit.matrix.substitution import substitute
from ..orbit.matrix.workspace import MatrixMemory, NewtonWorkspace
from ..orbit.newton import ORBIT_NEWTON, Converged, relative_change
from ..orbit.orbit import Orbit
from ..orbit.orbit_mesh import OrbitMesh
from ..point import Unsolvable


@dataclass(frozen=True, slots=True)
class Scale:
    """Units of the deflection (at least `least`) and of the parameter's coordinate; name of the parameter."""

    name: str
    deflection: float
    coordinate: float
    least: float

    @classmethod
    def of(cls, orbit: Orbit, name: str, least: float) -> "Scale":
        """The scale at an orbit."""
        largest = float(np.abs(orbit.points @ deflection_row(orbit)).max())
        # The least unit keeps the scale finite beside a Hopf point, where the deflection vanishes.
        return cls(name, float(np.hypot(largest, least)), abs(orbit.form.rod.coordinate(name)), least)

    def place(self, orbit: Orbit) -> Array:
        """(deflection, log of the period, coordinate) in units of the scale, (3,)."""
        deflection = deflection_of(orbit) / self.deflection
        at = orbit.form.rod.coordinate(self.name) / self.coordinate
        return np.array([deflection, np.log(orbit.period), at])

    def moved(self, orbit: Orbit, change: Array) -> Array:
        """Change of `place`, (3,), for a change of an orbit and the coordinate, (N + 1,)."""
        deflection = float(deflection_row(orbit) @ change[: orbit.form.unknowns]) / self.deflection
        return np.array([deflection, change[-2] / orbit.period, change[-1] / self.coordinate])


def deflection_of(orbit: Orbit) -> float:
    """Deflection at t = 0, when the tip's y is largest."""
    return float(deflection_row(orbit) @ orbit.start)


def deflection_row(orbit: Orbit) -> Array:
    """Row that gives the deflection of a state, (n,)."""
    form = orbit.form
    return _deflection_row(form.layout, form.mesh, form.rod.build)


@lru_cache(maxsize=64)
def _deflection_row(layout: StateLayout, mesh: Mesh, build: Build) -> Array:
    """`deflection_row`, (n,), shared by all callers and not to be changed."""
    # Small deflection at the tip: the curvature at u acts with the lever 1 - u. Tip values drop out.
    weights = mesh.quadrature * profile_compliance_on(build, mesh)
    return layout.row({"m3": weights[:-1] * (1 - mesh.positions[:-1])})


class BorderedMatrix:
    """Newton's matrix at an orbit with the parameter as a further unknown; the caller gives the last row.

    Steps, (N + 1,), are an orbit's values and the parameter's coordinate. Solving raises RuntimeError once
    another matrix was assembled in the same workspace; the multipliers stay valid.
    """

    def __init__(self, orbit: Orbit, scale: Scale, workspace: NewtonWorkspace) -> None:
        self.orbit = orbit
        self.scale = scale
        self.workspace = workspace
        self.tangent: Array | None = None  # the branch orients its own tangent, see `tangent_at`
        p = orbit.semidiscrete
        along = change_along(orbit.form, scale.name)
        K, s, n = orbit.states.shape
        V = np.empty((K, s, 3, len(p.matrices.weights)))
        self._columns = np.empty((K, s, 3, n))
        self._memory = MatrixMemory(workspace, K, s, n)
        right_sides(orbit.points, orbit.duration, p, along, V, self._columns)
        ends = eliminate(orbit.points, V, orbit.duration, p, self._memory.factors, self._columns)
        shift = phase_change(orbit.start, along.change, p.rod, p.matrices)
        self._matrix = np.zeros((n + 2, n + 2))
        self._matrix[:n, :n] = self._memory.propagator - p.symmetry
        self._matrix[:n, n] = ends[0]
        self._matrix[:n, n + 1] = ends[2]
        row = np.empty(n)
        phase_row(orbit.start, p.rod, p.matrices, row)
        self._matrix[n, :n] = row
        # `phase_change` is negated as a right side; here it is a column of the matrix.
        self._matrix[n, n + 1] = -shift
        self._right = self._jump(orbit, ends[1])

    def step(self, border: Array, length: float) -> Array:
        """Newton's step under the condition that `border` . place, (3,), grows by a length, (N + 1,)."""
        return self.solved(border, np.append(self._right, length), self._columns[:, :, 1], 1.0)

    def correction(self, orbit: Orbit, border: Array, length: float) -> Array:
        """`step` at a neighbouring orbit, of any nearby parameter, by the factors of this matrix."""
        factors = self._memory.factors
        p = self.orbit.semidiscrete
        columns, ends = reduced_residuals(orbit.points, orbit.duration, orbit.semidiscrete, p, factors)
        right = np.append(self._jump(orbit, ends[0]), length)
        return self.solved(border, right, columns[:, :, 0], 1.0)

    def direction(self, border: Array) -> Array:
        """Tangent, (N + 1,), of unit length in `Scale.place`, on the side of a border, (3,)."""
        # The null vector of the first n + 1 rows, normalised by the border: residuals do not enter.
        right = np.append(np.zeros(len(self._right)), 1.0)
        change = self.solved(border, right, self._columns[:, :, 1], 0.0)
        return change / np.linalg.norm(self.scale.moved(self.orbit, change))

    def residual_variations(self, orbit: Orbit, variations: Array) -> tuple[Array, Array]:
        """Derivatives of residuals along variations, (m, N + 1), reduced, (K, s, m, n); of the end, (m,
        n)."""
        along = change_along(orbit.form, self.scale.name)
        rod = orbit.semidiscrete
        p = self.orbit.semidiscrete
        changed: tuple[Array, Array] = reduced_variations(
            orbit.values, rod, along, variations, p, self._memory.factors
        )
        return changed

    def back_substitute(self, starts: Array, columns: Array) -> Array:
        """Changes of states, (m, N + 1), from those of the start, (m, n), and reduced sides, (K, s, m, n)."""
        out = np.empty_like(columns)
        substitute(starts, columns, self.orbit.semidiscrete, self._memory.factors, out)
        stages = out.transpose(2, 0, 1, 3).reshape(len(starts), -1)
        # Eigenvectors of the flow change neither the period nor the parameter.
        return np.hstack([starts, stages, np.zeros((len(starts), 2))])

    @property
    def propagator(self) -> Array:
        """Monodromy matrix P over the solved interval, (n, n)."""
        return self._memory.propagator

    @cached_property
    def partial_multipliers(self) -> Complex:
        """Multipliers over the solved interval: half a period and the reflection if symmetric, (rank,)."""
        return partial_multipliers(self.propagator, self.orbit)

    def multipliers(self) -> Complex:
        """Floquet multipliers above rounding, the trivial one included, by descending modulus, (rank,)."""
        return over_period(self.partial_multipliers, self.orbit)

    def approximate_null_vector(self) -> Array:
        """Singular vector of the least singular value at a fixed parameter, (N + 1,), of any length and sign.

        At a crossing of branches it points along the branch that the tangent does not follow.
        """
        matrix = self._matrix.copy()
        # The last row fixes the parameter: the least singular vector then is a direction of cycles at one
        # parameter.
        matrix[-1, -1] = 1.0
        return self._back_substitute(np.linalg.svd(matrix)[2][-1], self._columns[:, :, 1], 0.0)

    def _jump(self, orbit: Orbit, end: Array) -> Array:
        """Right side of an orbit's start and phase, (n + 1,); `end`: contribution of its stages, (n,)."""
        p = orbit.semidiscrete
        jump = jump_of(orbit.points, p) - end
        return np.append(jump, -phase(orbit.start, p.rod, p.matrices))

    def solved(self, border: Array, right: Array, sides: Array, share: float) -> Array:
        """Change, (N + 1,), for right sides of the ends, (n + 2,), and a share of those of the stages, (K, s,
        n)."""
        n = len(self.orbit.start)
        matrix = self._matrix.copy()
        matrix[-1, :n] = border[0] / self.scale.deflection * deflection_row(self.orbit)
        # The border acts on log T, whose derivative is 1/T.
        matrix[-1, n:] = border[1] / self.orbit.period, border[2] / self.scale.coordinate
        return self._back_substitute(np.linalg.solve(matrix, right), sides, share)

    def _back_substitute(self, found: Array, sides: Array, share: float) -> Array:
        """Change of all, (N + 1,), from that of the ends, (n + 2,), and a share of right sides, (K, s, n)."""
        n = len(self.orbit.start)
        stages = found[n] * self._columns[:, :, 0] + share * sides + found[n + 1] * self._columns[:, :, 2]
        stages = np.ascontiguousarray(stages[:, :, None])
        out = np.empty_like(stages)
        factors = self._memory.factors
        start = found[None, :n].copy()
        substitute(start, stages, self.orbit.semidiscrete, factors, out)
        return np.concatenate([found[:n], out.ravel(), found[n:]])


def bordered(found: Converged) -> BorderedMatrix:
    """The bordered matrix of an orbit solved on a branch; TypeError if the orbit has another matrix."""
    if not isinstance(found.matrix, BorderedMatrix):
        raise TypeError("the orbit was solved without the parameter as an unknown")
    return found.matrix


@dataclass(frozen=True, eq=False)
class Condition:
    """The equation that closes the system: border . place, (3,), in a scale, has a prescribed value."""

    scale: Scale
    border: Array
    value: float

    @classmethod
    def at(cls, scale: Scale, border: Array, orbit: Orbit, length: float = 0.0) -> "Condition":
        """Condition at an arc length along a border, (3,), from an orbit."""
        return cls(scale, border, float(border @ scale.place(orbit)) + length)

    def residual(self, orbit: Orbit) -> float:
        """Prescribed value minus an orbit's value."""
        return self.value - float(self.border @ self.scale.place(orbit))

    def solved(
        self, orbit: Orbit, tolerance: float, workspace: NewtonWorkspace, distance: float = np.inf
    ) -> Converged:
        """The cycle near an orbit; raises Unsolvable.

        tolerance: relative error of the orbit. workspace: memory of the matrices. distance: largest relative
        distance of the matrix from the cycle, an error of its multipliers and tangent.
        """
        matrix = BorderedMatrix(orbit, self.scale, workspace)
        off = 0.0
        last = np.inf
        step = matrix.step(self.border, self.residual(orbit))
        for _ in range(ORBIT_NEWTON.max_iterations):
            report()
            change = max(relative_change(orbit, step[:-1]), abs(step[-1]) / self.scale.coordinate)
            if not change <= ORBIT_NEWTON.longest_step:
                raise Unsolvable("no cycle of the branch is near the start of Newton's method")
            orbit = moved(orbit, self.scale.name, step)
            off = off + change
            rate = change / last if off > change else np.inf  # known from the second step with one matrix on
            # The next step would be smaller by the contraction; it is predicted instead of made.
            settled = change * min(rate, 1.0) <= tolerance and rate <= ORBIT_NEWTON.new_matrix_ratio
            if (settled or change <= tolerance) and off <= distance:
                return Converged(orbit, matrix, off)
            if settled or change <= tolerance or (off > change and rate > ORBIT_NEWTON.new_matrix_ratio):
                matrix = BorderedMatrix(orbit, self.scale, workspace)
                off = 0.0
                step = matrix.step(self.border, self.residual(orbit))
                last = np.inf
            else:
                step = matrix.correction(orbit, self.border, self.residual(orbit))
                last = change
        raise Unsolvable(f"Newton's method on the branch does not converge; last step {change:.0e}")

    def on(self, mesh: OrbitMesh, found: Converged, tolerance: float, distance: float = np.inf) -> Converged:
        """A known cycle solved on another mesh; raises Unsolvable. Other arguments as in `solved`."""
        return self.solved(mesh.carry(found.orbit), tolerance, found.workspace, distance)


def moved(orbit: Orbit, name: str, change: Array) -> Orbit:
    """An orbit after a change of its values and the parameter's coordinate, (N + 1,); raises Unsolvable."""
    try:
        form = orbit.form.with_coordinate(name, orbit.form.rod.coordinate(name) + float(change[-1]))
    except (ValueError, ZeroDivisionError) as error:
        raise Unsolvable(f"the branch leaves the range of possible rods: {error}") from error
    result = replace(orbit, form=form, values=orbit.values + change[:-1])
    # Where gamma3 passes the least eliminated drag, states have other unknowns and cannot be compared.
    if form.omega_unknown != orbit.form.omega_unknown:
        raise Unsolvable(f"gamma3 = {form.rod.gamma3:.3g} changes the unknowns of the discretization")
    if not result.period > 0:
        raise Unsolvable("Newton's method lost the cycle: its period is not positive")
    return result
