"""Newton's matrix at an orbit: its step, the tangents of the branch, and all Floquet multipliers.

One elimination of the intervals (`condensation`) leaves a system for the state at t = 0 and the period, with
the phase condition as its last row.
"""

from math import prod

import numpy as np

from ...arrays import Array, Complex
from ...discretization.stress_balance import (
    BeamParameters,
    NodeMatrices,
    balance,
    balance_change,
    jacobian,
    torque_change,
)
from ...model.compilation import compiled_for_vectors
from ...model.parameters import PARAMETERS
from .condensation import (
    PANEL,
    Factors,
    Semidiscrete,
    eliminate,
    equations,
    forward,
    invert,
    residuals,
    substitute,
)
from .multipliers import nonzero_eigenvalues
from .orbit import Orbit

_memory: list[Array] = [np.empty(0)]


class Linearisation:
    """Newton's matrix at an orbit; it corrects others until the next one is made.

    step: Newton's step there; tangent: the derivative of the orbit by the parameter, where one is given. Both
    are arrays like `Orbit.values`.
    """

    def __init__(self, orbit: Orbit, parameter: str | None = None) -> None:
        self.orbit = orbit
        K, s, n = orbit.intervals, orbit.stages, orbit.form.unknowns
        self._factors = workspace(K, s, n)
        columns = np.empty((K, s, 2 if parameter is None else 3, n))
        shifts = np.zeros(columns.shape[2] - 2)
        if parameter is not None:
            columns[:, :, 2], shifts[0] = parameter_derivative(orbit, parameter)
        steps = linearise(orbit.values, columns, shifts, orbit.semidiscrete, self._factors)
        self._by_period = np.ascontiguousarray(columns[:, :, 0])
        self.step, self.tangent = steps[0], None if parameter is None else steps[1]

    def correction(self, orbit: Orbit) -> Array:
        """Newton's step at another orbit near by, (N,)."""
        step: Array = correct(orbit.values, self._by_period, orbit.semidiscrete, self._factors)
        return step

    def multipliers(self) -> Complex:
        """All Floquet multipliers but rounding, (rank,), by descending modulus, the trivial one too."""
        return multipliers_by(self._factors.propagator, self.orbit)


def multipliers_by(propagator: Array, orbit: Orbit) -> Complex:
    """All Floquet multipliers but rounding, (rank,), by descending modulus, of an orbit with P, (n, n)."""
    values = nonzero_eigenvalues(orbit.return_signs[:, None] * propagator)
    values = values**2 if orbit.symmetric else values
    return values[np.argsort(-np.abs(values), kind="stable")]


def workspace(intervals: int, stages: int, unknowns: int) -> Factors:
    """Memory that every matrix uses again: new pages take as long as half an elimination."""
    shape = (intervals, stages, stages, unknowns, unknowns)
    if len(_memory[0]) < prod(shape):
        _memory[0] = np.empty(prod(shape))
    blocks = _memory[0][: prod(shape)].reshape(shape)
    return Factors(blocks, np.zeros((unknowns, unknowns)), np.zeros((unknowns + 1, unknowns + 1)))


def coordinate(name: str, value: float) -> float:
    """In what a branch is followed: 1/value of a stiffness, for cycles are smooth up to inf, or the value."""
    return 1 / value if PARAMETERS[name].by_compliance else value


def parameter_derivative(orbit: Orbit, name: str) -> tuple[Array, float]:
    """Right sides of the stages, (K, s, n), and of the phase for the derivative by a `coordinate`."""
    form, p = orbit.form, orbit.semidiscrete
    c = form.parameters
    field = {"k1": "c1", "k2": "c2"}.get(name, name)
    change = BeamParameters(*(float(field == other) for other in c._fields))
    change = change._replace(nu=-change.F * c.c1 - c.F * change.c1)
    by_mass = form.mass_of(change.c1, change.c2)
    by_mass[2 * form.mesh.nodes :] = 0.0
    return change_along(orbit.values, change, by_mass, p, orbit.stages)


@compiled_for_vectors
def change_along(
    values: Array, change: BeamParameters, by_mass: Array, p: Semidiscrete, stages: int
) -> tuple[Array, float]:
    """The derivatives of residuals, (K, s, n), and phase of an orbit, (N,), along a change of the parameters.

    by_mass: of the mass, (n,). The phase's is a right side and has the sign of one.
    """
    K, n, size = len(p.lengths), len(p.mass), len(p.matrices.weights)
    points, duration = values[:-1].reshape(1 + K * stages, n), values[-1] / p.parts
    V, G, F, changes = np.empty((3, size)), np.empty((3, size)), np.empty(n), np.empty((2, 3, size))
    right, d = np.empty((K, stages, n)), p.differentiation
    for k in range(K):
        here, h = points[k * stages : (k + 1) * stages + 1], duration * p.lengths[k]
        for i in range(stages):
            equations(here[i + 1], F, V, G, p)
            equations_change(here[i + 1], F, V, changes, change, p)
            for r in range(n):
                slope = 0.0
                for j in range(stages + 1):
                    slope += d[i, j] * here[j, r]
                right[k, i, r] = h * F[r] - by_mass[r] * slope
    balance(points[0], V, G, p.parameters, p.matrices)
    balance_change(points[0], V, changes, change, p.parameters, p.matrices)
    return right, -lateral_velocity(changes[1], tip_angle(points[0], p.matrices))


@compiled_for_vectors
def equations_change(
    x: Array, F: Array, V: Array, out: Array, change: BeamParameters, p: Semidiscrete
) -> None:
    """The derivative of `condensation.equations` along a change of the parameters into F, (n,).

    V at the state x is known; out, (2, 3, nodes + 1), is made on the way.
    """
    nodes = V.shape[1] - 1
    balance_change(x, V, out, change, p.parameters, p.matrices)
    for a in range(3):
        for i in range(nodes):
            F[a * nodes + i] = out[1, a, i]
    if len(x) > 3 * nodes:
        torque_change(x, F[3 * nodes :], change, p.parameters, p.matrices)


@compiled_for_vectors
def phase(start: Array, c: BeamParameters, m: NodeMatrices) -> float:
    """The tip's dy/dt at the start, (n,), by the reaction there."""
    size = len(m.weights)
    V, G = np.empty((3, size)), np.empty((3, size))
    balance(start, V, G, c, m)
    return float(lateral_velocity(G, tip_angle(start, m)))


@compiled_for_vectors
def lateral_velocity(G: Array, theta: float) -> float:
    """dy/dt of the tip at an angle, by G at all nodes, (3, nodes + 1)."""
    return -(np.sin(theta) * G[0, -1] + np.cos(theta) * G[1, -1])


@compiled_for_vectors
def tip_angle(x: Array, m: NodeMatrices) -> float:
    """theta at the tip of a state, (n,)."""
    theta, nodes = 0.0, len(m.weights) - 1
    for i in range(nodes):
        theta += m.weights[i] * x[2 * nodes + i]
    return theta


@compiled_for_vectors
def phase_row(start: Array, c: BeamParameters, m: NodeMatrices, row: Array) -> None:
    """The derivative of `phase` by the start into row, both (n,)."""
    n, size = len(start), len(m.weights)
    V, G, J, tip = np.empty((3, size)), np.empty((3, size)), np.empty((n, n)), np.empty((3, n))
    balance(start, V, G, c, m)
    jacobian(start, V, J, tip, c, m)
    theta, nodes = tip_angle(start, m), size - 1
    sin, cos = np.sin(theta), np.cos(theta)
    for i in range(n):
        row[i] = -(sin * tip[0, i] + cos * tip[1, i])
    for i in range(nodes):
        row[2 * nodes + i] += (sin * G[1, nodes] - cos * G[0, nodes]) * m.weights[i]


@compiled_for_vectors
def linearise(values: Array, columns: Array, shifts: Array, p: Semidiscrete, factors: Factors) -> Array:
    """Newton's matrix at an orbit, and what it makes of right sides: steps of the orbit, (columns - 1, N).

    values: (N,), the points, (1 + K s, n), one after the other, and the period. columns: (K, s, columns, n);
    the first becomes the derivative by the period, the second Newton's own right side, others are given, with
    the right sides of the phase condition in shifts, (columns - 2,).
    """
    K, s, count, n = columns.shape
    points, duration = values[:-1].reshape(1 + K * s, n), values[-1] / p.parts
    slopes, right = np.empty((K, s, n)), np.empty((K, s, n))
    residuals(points, duration, p, slopes, right)
    for k in range(K):
        for i in range(s):
            columns[k, i, 0] = slopes[k, i] * (p.lengths[k] / p.parts)
            columns[k, i, 1] = right[k, i]
    ends = eliminate(points, duration, p, factors, columns)
    inverse = factors.inverse
    inverse[:, :] = 0.0
    inverse[:n, :n] = factors.propagator
    for i in range(n):
        inverse[i, i] -= p.signs[i]
        inverse[i, n] = ends[0, i]
    phase_row(points[0], p.parameters, p.matrices, inverse[n, :n])
    invert(inverse, np.empty(n + 1, np.int64), np.empty((n + 1, PANEL)))
    rights = np.zeros((count - 1, n + 1))
    for m in range(1, count):
        for i in range(n):
            jump = p.signs[i] * points[0, i] - points[K * s, i] if m == 1 else 0.0
            rights[m - 1, i] = jump - ends[m, i]
        rights[m - 1, n] = shifts[m - 2] if m > 1 else -phase(points[0], p.parameters, p.matrices)
    by_period = np.ascontiguousarray(columns[:, :, 0])
    return steps_of(rights, by_period, np.ascontiguousarray(columns[:, :, 1:]), p, factors)


@compiled_for_vectors
def steps_of(rights: Array, by_period: Array, columns: Array, p: Semidiscrete, factors: Factors) -> Array:
    """The steps, (columns, N), for right sides at the ends, (columns, n + 1), and of the stages.

    by_period: (K, s, n), columns: (K, s, columns, n).
    """
    K, s, count, n = columns.shape
    starts, periods = np.zeros((count, n)), np.zeros(count)
    for m in range(count):
        for i in range(n + 1):
            total = 0.0
            for j in range(n + 1):
                total += factors.inverse[i, j] * rights[m, j]
            if i < n:
                starts[m, i] = total
            else:
                periods[m] = total
    whole, out = np.empty((K, s, count, n)), np.empty((K, s, count, n))
    for k in range(K):
        for i in range(s):
            for m in range(count):
                whole[k, i, m] = columns[k, i, m] + periods[m] * by_period[k, i]
    substitute(starts, whole, p, factors, out)
    steps = np.empty((count, (1 + K * s) * n + 1))
    for m in range(count):
        steps[m, :n], steps[m, -1] = starts[m], periods[m]
        for k in range(K):
            for i in range(s):
                first = (1 + k * s + i) * n
                steps[m, first : first + n] = out[k, i, m]
    return steps


@compiled_for_vectors
def correct(values: Array, by_period: Array, p: Semidiscrete, factors: Factors) -> Array:
    """Newton's step at an orbit, values and result (N,), by the matrix of another one near by."""
    K, s, n = by_period.shape
    points, duration = values[:-1].reshape(1 + K * s, n), values[-1] / p.parts
    slopes, columns, ends = np.empty((K, s, n)), np.empty((K, s, 1, n)), np.zeros((1, n))
    right = np.empty((K, s, n))
    residuals(points, duration, p, slopes, right)
    for k in range(K):
        for i in range(s):
            columns[k, i, 0] = right[k, i]
        forward(factors.blocks[k], columns[k], p, ends)
    rights = np.empty((1, n + 1))
    for i in range(n):
        rights[0, i] = p.signs[i] * points[0, i] - points[K * s, i] - ends[0, i]
    rights[0, n] = -phase(points[0], p.parameters, p.matrices)
    return steps_of(rights, by_period, columns, p, factors)[0]


@compiled_for_vectors
def largest_change(values: Array, step: Array, unknowns: int, nodes: int) -> float:
    """The largest change of n2, m3 and the period by a step, (N,), each in units of its largest value."""
    largest = abs(step[-1]) / abs(values[-1])
    for change in step:
        if not np.isfinite(change):
            return np.inf
    for a in range(1, 3):
        most, size = 0.0, 0.0
        for first in range(unknowns + a * nodes, len(values) - 1, unknowns):
            for i in range(first, first + nodes):
                most, size = max(most, abs(step[i])), max(size, abs(values[i]))
        largest = max(largest, most / size)
    return largest
