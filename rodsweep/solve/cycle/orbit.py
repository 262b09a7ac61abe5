"""A periodic orbit on one mesh in space and time, and Newton's method for it.

Unknown are the state at t = 0, the stages of a Radau collocation and the period T. A symmetric orbit has
x(T/2) = R x(0), R the reflection on the line of the straight rod, and is solved over half its period; any
other over the whole. At t = 0 the tip's y is at an extremum: its velocity, by the reaction at the tip,
vanishes there, so that the largest y is as accurate as the period. One elimination gives Newton's step, the
tangent of the branch along any parameter and the flow's derivative, whose eigenvalues are the Floquet
multipliers.
"""

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np

from ...arrays import Array, Complex
from ...discretization.collocation import Collocation, radau
from ...discretization.mesh import Mesh, transfer
from ...discretization.stress_balance import BeamParameters, balance, jacobian
from ...discretization.stress_form import StressForm
from ...model.parameters import PARAMETERS
from ..point import Unsolvable
from .condensation import PANEL, Factors, Semidiscrete, eliminate, invert, residuals, substitute

SLUGGISH = 0.1
"""Decrease of the steps in one iteration from which Newton's matrix is made anew."""
LONGEST_STEP = 0.5
"""Largest change of state or period in one iteration, relative; what asks for more is far from any orbit."""
QUADRATIC = 1e5
"""What Newton's method leaves, in units of the square of its step, where the orbit is nearly neutral."""
DIFFERENCE = 1e-5
LEAST_COORDINATE = {"F": 1.0, "c1": 1e-4, "c2": 1e-4, "gamma1": 0.1, "gamma3": 1e-4}
"""Relative step of a difference by a parameter, and the least size of the parameter for it."""
NEGLIGIBLE = 1e-17
"""Share of the derivative of the flow below which it is rounding."""


@dataclass(frozen=True, eq=False)
class Orbit:
    """start: x(0), (n,); states: at the stages of all intervals, (K, s, n); period in tau2."""

    form: StressForm
    symmetric: bool
    period: float
    start: Array
    states: Array

    @property
    def method(self) -> Collocation:
        return radau(self.states.shape[1])

    @property
    def duration(self) -> float:
        """Of what is solved: half the period or the whole."""
        return self.period / 2 if self.symmetric else self.period

    @property
    def step(self) -> float:
        """Length of an interval in tau2."""
        return self.duration / len(self.states)

    @property
    def return_signs(self) -> Array:
        """What the state is multiplied with after the duration, shape (n,)."""
        return self.form.reflection if self.symmetric else np.ones(self.form.unknowns)

    @cached_property
    def semidiscrete(self) -> Semidiscrete:
        form = self.form
        return Semidiscrete(form.parameters, form.mesh.matrices, form.mass, self.method.differentiation)

    @cached_property
    def node_states(self) -> Array:
        """The states at the starts of all intervals of the whole period, equal in time, shape (m, n)."""
        ends = np.concatenate([self.start[None], self.states[:-1, -1]])
        return np.concatenate([ends, ends * self.form.reflection]) if self.symmetric else ends

    @property
    def size(self) -> float:
        """The largest amplitude of the motion, in units of sqrt(energy)."""
        return float(self.form.size(self.node_states).max())

    def moved(self, change: "Change", share: float = 1.0) -> "Orbit":
        """The orbit changed by a share of a change."""
        return replace(
            self,
            start=self.start + share * change.start,
            states=self.states + share * change.states,
            period=self.period + share * change.period,
        )

    def at(self, times: Array) -> Array:
        """The states at times in [0, 1] in units of the duration, shape (len(times), n)."""
        values = np.concatenate([self.start[None], self.states.reshape(-1, len(self.start))])
        K, s, _ = self.states.shape
        at: Array = piecewise((K, s), times) @ values
        return at

    def on(self, grid: Mesh, intervals: int, stages: int) -> "Orbit":
        """The orbit's polynomials on another mesh and other intervals."""
        form, states = replace(self.form, mesh=grid), self.states
        here = len(states), states.shape[1]
        if (intervals, stages) != here:
            matrix = between_intervals(here, (intervals, stages))
            values = np.concatenate([self.start[None], states.reshape(-1, len(self.start))])
            states = (matrix @ values).reshape(intervals, stages, -1)
        start = self.start
        if grid is not self.form.mesh:
            start, states = (moved_to(self.form, form, x) for x in (start, states))
        return replace(self, form=form, start=start, states=states)


@lru_cache(maxsize=256)
def between_intervals(source: tuple[int, int], target: tuple[int, int]) -> Array:
    """Matrix from the start and the stages of (intervals, stages) to the stages of others.

    Shape (target stages in all, 1 + source stages in all).
    """
    intervals, stages = target
    times = ((np.arange(intervals)[:, None] + radau(stages).nodes) / intervals).ravel()
    return piecewise(source, times)


def piecewise(source: tuple[int, int], times: Array) -> Array:
    """Matrix from the start and the stages of (intervals, stages) to values at times in [0, 1], (m, ...)."""
    K, s = source
    k = np.minimum((times * K).astype(int), K - 1)
    matrix = np.zeros((len(times), 1 + K * s))
    for interval in np.unique(k):
        here = k == interval
        first = interval * s  # the end of the interval before is the start of this one
        matrix[here, first : first + s + 1] = radau(s).evaluation(times[here] * K - interval)
    return matrix


def moved_to(source: StressForm, target: StressForm, x: Array) -> Array:
    """States (..., n) of one mesh on another."""
    E = transfer(source.mesh, target.mesh)
    n = source.mesh.nodes
    parts = [x[..., a * n : (a + 1) * n] @ E[:-1, :-1].T for a in range(3)]
    if target.omega_unknown:
        parts.append(x[..., 3 * n :] @ E.T)
    return np.ascontiguousarray(np.concatenate(parts, axis=-1))


@lru_cache(maxsize=4)
def _workspace(intervals: int, stages: int, unknowns: int) -> Factors:
    """Memory that is used again."""
    blocks = np.zeros((intervals, stages, stages, unknowns, unknowns))
    return Factors(blocks, np.zeros((unknowns, unknowns)))


@dataclass(frozen=True, eq=False)
class Change:
    """A change of an orbit, or its derivative: of the start, (n,), the stages, (K, s, n), and the period."""

    start: Array
    states: Array
    period: float

    def times(self, factor: float) -> "Change":
        return Change(factor * self.start, factor * self.states, factor * self.period)

    def plus(self, other: "Change", factor: float) -> "Change":
        """The sum with a multiple of another."""
        return Change(
            self.start + factor * other.start,
            self.states + factor * other.states,
            self.period + factor * other.period,
        )


class Linearisation:
    """Newton's matrix at an orbit; it corrects others until the next one of the same extents is made.

    step: Newton's step there; tangent: the derivative of the orbit by the parameter, where one is given.
    """

    def __init__(self, orbit: Orbit, parameter: str | None = None) -> None:
        self.orbit, p = orbit, orbit.semidiscrete
        n = len(orbit.start)
        self.factors = _workspace(*orbit.states.shape)
        slopes, right = np.empty_like(orbit.states), np.empty_like(orbit.states)
        residuals(orbit.start, orbit.states, orbit.step, p, slopes, right)
        eliminate(orbit.states, orbit.step, p, self.factors)
        offset = phase(orbit)
        columns = [slopes * (orbit.step / orbit.period), right]
        jumps, shifts = [orbit.return_signs * orbit.start - orbit.states[-1, -1]], [-offset]
        if parameter is not None:
            by_parameter, shift = parameter_derivative(orbit, parameter)
            columns.append(by_parameter)
            jumps.append(np.zeros(n))
            shifts.append(shift)
        rights = np.stack(columns, axis=2)
        change = np.empty_like(rights)
        substitute(np.zeros((len(columns), n)), rights, p, self.factors, change)
        ends, self.propagator = change[-1, -1], self.factors.propagator.copy()
        matrix = np.zeros((n + 1, n + 1))
        matrix[:n, :n] = self.propagator
        matrix[range(n), range(n)] -= orbit.return_signs
        matrix[:n, n], matrix[n, :n] = ends[0], phase_row(orbit)
        invert(matrix, np.empty(n + 1, np.int64), np.empty(n + 1), np.empty((n + 1, PANEL)))
        self.inverse = matrix
        self.by_period = rights[:, :, :1]
        x = self.inverse @ np.vstack([(np.array(jumps) - ends[1:]).T, shifts])
        self.step, *tangents = self._changes(x, rights[:, :, 1:])
        self.tangent = tangents[0] if tangents else None

    def _changes(self, x: Array, rights: Array) -> "list[Change]":
        """The changes of the orbit for changes of start and period, (n + 1, columns), and right sides."""
        n = len(self.orbit.start)
        out = np.empty_like(rights)
        whole = rights + self.by_period * x[n][:, None]
        starts = np.ascontiguousarray(x[:n].T)
        substitute(starts, whole, self.orbit.semidiscrete, self.factors, out)
        return [
            Change(starts[m], np.ascontiguousarray(out[:, :, m]), float(x[n, m])) for m in range(x.shape[1])
        ]

    def correction(self, orbit: Orbit) -> "Change":
        """Newton's step at another orbit near by."""
        slopes, right = np.empty_like(orbit.states), np.empty_like(orbit.states)
        residuals(orbit.start, orbit.states, orbit.step, orbit.semidiscrete, slopes, right)
        jump = orbit.return_signs * orbit.start - orbit.states[-1, -1]
        rights, n = right[:, :, None], len(jump)
        change = np.empty_like(rights)
        substitute(np.zeros((1, n)), rights, self.orbit.semidiscrete, self.factors, change)
        x = self.inverse @ np.append(jump - change[-1, -1, 0], -phase(orbit))
        return self._changes(x[:, None], rights)[0]

    def multipliers(self) -> Complex:
        """All Floquet multipliers but rounding, (rank,), by descending modulus, the trivial one too."""
        half = self.orbit.return_signs[:, None] * self.propagator
        values = nonzero_eigenvalues(half)
        values = values**2 if self.orbit.symmetric else values
        return values[np.argsort(-np.abs(values), kind="stable")]


def nonzero_eigenvalues(A: Array) -> Complex:
    """The eigenvalues, (rank,), of a matrix (n, n) of low rank, without those that are 0 to rounding."""
    from scipy.linalg import qr

    Q, R, order = qr(A, pivoting=True, check_finite=False)
    diagonal = np.abs(np.diag(R))
    rank = max(1, int((diagonal > NEGLIGIBLE * diagonal[0]).sum()))
    compressed = R[:rank] @ Q[order, :rank]
    values: Complex = np.linalg.eigvals(compressed).astype(complex)
    return values


def phase(orbit: Orbit, parameters: BeamParameters | None = None) -> float:
    """The tip's dy/dt at t = 0 by the reaction there."""
    form, c = orbit.form, parameters or orbit.form.parameters
    V, G = np.empty((2, 3, form.mesh.nodes + 1))
    balance(orbit.start, V, G, c, form.mesh.matrices)
    sin, cos = _direction(orbit)
    return float(-(sin * G[0, -1] + cos * G[1, -1]))


def phase_row(orbit: Orbit) -> Array:
    """The derivative of `phase` by the state, shape (n,)."""
    form, x = orbit.form, orbit.start
    n = form.mesh.nodes
    V, G = np.empty((2, 3, n + 1))
    matrix, tip = np.empty((len(x), len(x))), np.empty((3, len(x)))
    balance(x, V, G, form.parameters, form.mesh.matrices)
    jacobian(x, V, matrix, tip, form.parameters, form.mesh.matrices)
    sin, cos = _direction(orbit)
    row = -(sin * tip[0] + cos * tip[1])
    row[2 * n : 3 * n] += (sin * G[1, -1] - cos * G[0, -1]) * form.mesh.quadrature[:-1]
    return row


def _direction(orbit: Orbit) -> tuple[float, float]:
    """Sine and cosine of theta at the tip at t = 0."""
    n = orbit.form.mesh.nodes
    theta = float(orbit.start[2 * n : 3 * n] @ orbit.form.mesh.quadrature[:-1])
    return np.sin(theta), np.cos(theta)


@dataclass(frozen=True, eq=False)
class Converged:
    """What Newton's method ended with: the orbit and its last matrix, made at a relative distance from it."""

    orbit: Orbit
    matrix: Linearisation
    distance: float


def newton(orbit: Orbit, tolerance: float, parameter: str | None = None, most: int = 12) -> Converged:
    """The orbit near this one; raises Unsolvable.

    tolerance: relative, of states and period. parameter: along which the matrix has the tangent. The matrix
    is kept while the steps shrink fast.
    """
    matrix, distance, last = Linearisation(orbit, parameter), 0.0, np.inf
    step = matrix.step
    for iteration in range(1, most + 1):
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
            matrix, distance = Linearisation(orbit, parameter), 0.0
            step = matrix.step
        else:
            step = matrix.correction(orbit)
        last = change
    raise Unsolvable(f"Newton's method for the orbit is at {change:.0e} after {most} iterations")


def at_orbit(found: Converged, distance: float, parameter: str | None = None) -> Converged:
    """The same with a matrix made at most at this distance from the orbit."""
    if found.distance <= distance:
        return found
    matrix = Linearisation(found.orbit, parameter)
    change = relative_change(found.orbit, matrix.step)
    return Converged(found.orbit.moved(matrix.step), matrix, change)


def relative_change(orbit: Orbit, step: Change) -> float:
    """The largest change of the shear force, the bending moment and the period, each in its largest value."""
    n = orbit.form.mesh.nodes
    parts = [abs(step.period) / orbit.period]
    for a in (1, 2):
        here = slice(a * n, (a + 1) * n)
        parts.append(float(np.abs(step.states[..., here]).max() / np.abs(orbit.states[..., here]).max()))
    return max(parts)


def coordinate(name: str, value: float) -> float:
    """In what a branch is followed: 1/value of a stiffness, for cycles are smooth up to inf, or the value."""
    return 1 / value if PARAMETERS[name].by_compliance else value


def parameter_derivative(orbit: Orbit, name: str) -> tuple[Array, float]:
    """Right sides of the stages, (K, s, n), and of the phase for the derivative by a `coordinate`.

    A central difference: a tangent needs few digits, and the equations are cubic in most coordinates.
    """
    form, p = orbit.form, orbit.semidiscrete
    c = form.parameters
    field = {"k1": "c1", "k2": "c2"}.get(name, name)
    here = getattr(c, field)
    step = DIFFERENCE * max(abs(here), LEAST_COORDINATE[field])
    ends = []
    for there in (here + step, here - step):
        moved = c._replace(**{field: there})
        moved = moved._replace(nu=1 - moved.F * moved.c1)
        mass = form.mass_of(moved.c1, moved.c2)
        slopes, right = np.empty_like(orbit.states), np.empty_like(orbit.states)
        residuals(
            orbit.start, orbit.states, orbit.step, p._replace(parameters=moved, mass=mass), slopes, right
        )
        ends.append((right, phase(orbit, moved)))
    (right, offset), (right_below, offset_below) = ends
    return (right - right_below) / (2 * step), (offset_below - offset) / (2 * step)
