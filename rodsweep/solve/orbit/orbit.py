"""Periodic orbit on one mesh in space and time.

Unknowns are the state at t = 0, the stages of a Radau collocation, and the period T. A symmetric orbit,
x(T/p) = S x(0), is solved over the part T/p of its period, any other orbit over the whole period. At t = 0
the velocity of the tip's y, by the reaction at the tip, vanishes: the largest y is at a time node, as
accurate as T.
"""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from scipy.sparse import csr_array

from ...arrays import Array
from ...discretization.elements.collocation import Collocation, radau_method
from ...discretization.elements.elements import ELEMENTS
from ...discretization.elements.mesh import Mesh
from ...discretization.stress.form import StressForm
from .semidiscrete import Semidiscrete
from .symmetry import Symmetry


@dataclass(frozen=True, eq=False)
class Orbit:
    """A periodic orbit of the rod and space mesh of `form`, on K time intervals with s collocation stages
    each.

    values: states at the start and at the stages of all intervals, one after the other, and the period in
    tau2, (N,) with N = (1 + K s) n + 1.
    """

    form: StressForm
    symmetry: Symmetry
    intervals: int
    stages: int
    values: Array

    @classmethod
    def of(cls, form: StressForm, symmetry: Symmetry, period: float, states: Array, stages: int) -> "Orbit":
        """The orbit with the given period, in tau2, and `states` at t = 0 and at all stages, (1 + K s, n)."""
        values = np.append(states.ravel(), period)
        return cls(form, symmetry, (len(states) - 1) // stages, stages, values)

    @property
    def period(self) -> float:
        return float(self.values[-1])

    @property
    def points(self) -> Array:
        """States at t = 0 and at the stages of all intervals, (1 + K s, n)."""
        return self.values[:-1].reshape(1 + self.intervals * self.stages, -1)

    @property
    def start(self) -> Array:
        """State at t = 0, (n,)."""
        return self.points[0]

    @property
    def states(self) -> Array:
        """States at the stages of each interval, (K, s, n)."""
        return self.points[1:].reshape(self.intervals, self.stages, -1)

    @property
    def states_at_starts(self) -> Array:
        """States at the starts of the intervals, (K, n)."""
        return self.points[: -1 : self.stages]

    @property
    def regular_states(self) -> Array:
        """States at the starts of all intervals but the last, equidistant in time, (K - 1, n)."""
        return self.states_at_starts[:-1]

    @property
    def method(self) -> Collocation:
        return radau_method(self.stages)

    @property
    def duration(self) -> float:
        """Duration of the solved part of the period in tau2: half the period or the whole period."""
        return self.period / self.symmetry.parts

    @property
    def symmetric(self) -> bool:
        """Whether the solved part is shorter than the period."""
        return self.symmetry.parts > 1

    @property
    def semidiscrete(self) -> Semidiscrete:
        return _semidiscrete(self.form, self.symmetry, self.intervals, self.stages)

    @property
    def size(self) -> float:
        """Size of the motion: the largest norm of its states, in units of sqrt(energy)."""
        # The reflected part of the period has the same amplitude.
        return float(self.form.amplitude(self.regular_states).max())

    def moved(self, change: Array, share: float = 1.0) -> "Orbit":
        """The orbit with the values changed by `share` times `change`, (N,)."""
        return replace(self, values=self.values + share * change)

    def at(self, times: Array) -> Array:
        """States at `times` in [0, 1], in units of the solved duration, shape (len(times), n)."""
        at: Array = piecewise((self.intervals, self.stages), times) @ self.points
        return at

    def on(self, grid: Mesh, intervals: int, stages: int) -> "Orbit":
        """The orbit interpolated to the space mesh `grid` and to other time intervals."""
        points = self.points
        source = self.intervals, self.stages
        target = intervals, stages
        if target != source:
            points = between_intervals(source, target) @ points
        if grid != self.form.mesh:
            points = self.form.states_on(grid, points)
        return replace(
            self,
            form=replace(self.form, mesh=grid),
            intervals=intervals,
            stages=stages,
            values=np.append(points.ravel(), self.period),
        )


@lru_cache(maxsize=ELEMENTS.max_pencils)
def _semidiscrete(form: StressForm, symmetry: Symmetry, intervals: int, stages: int) -> Semidiscrete:
    """Data of the equations for all orbits with the same form, symmetry and time intervals."""
    d = radau_method(stages).differentiation
    lengths = interval_lengths(intervals)
    S = symmetry.matrix(form.layout)
    parts = float(symmetry.parts)
    return Semidiscrete(form.nodal, form.mesh.matrices, form.mass, d, lengths, S, parts)


@lru_cache(maxsize=ELEMENTS.max_mesh_pairs)
def interval_lengths(intervals: int) -> Array:
    """Lengths of the time intervals in units of the solved duration, (intervals,): equal, but half for the
    last two.

    Where modes decay within an interval, the error at its end depends on the interval's own length, hardly on
    the others. The largest y is taken at the end of the last interval, which is therefore short.
    """
    return np.append(np.ones(intervals - 2), (0.5, 0.5)) / (intervals - 1)


def interval_starts(intervals: int) -> Array:
    """Start times of the time intervals in units of the solved duration, (intervals,)."""
    return np.append(0.0, np.cumsum(interval_lengths(intervals)[:-1]))


def node_times(intervals: int, stages: int) -> Array:
    """Times of the start and of all stages in units of the solved duration, (1 + K s,)."""
    starts = interval_starts(intervals)[:, None]
    lengths = interval_lengths(intervals)[:, None]
    return np.append(0.0, starts + lengths * radau_method(stages).nodes)


@lru_cache(maxsize=ELEMENTS.max_mesh_pairs)
def between_intervals(source: tuple[int, int], target: tuple[int, int]) -> csr_array:
    """Matrix that interpolates the states at the nodes of `source` = (intervals, stages) to the nodes of
    `target`, (1 + K s of target, 1 + K s of source)."""
    intervals, stages = target
    return piecewise(source, node_times(intervals, stages))


def piecewise(source: tuple[int, int], times: Array) -> csr_array:
    """Matrix, (m, 1 + K s), that interpolates the states at the nodes of `source` = (K, s) to `times` in [0,
    1], (m,).

    The matrix is sparse because each value depends on one interval only; a dense matrix of a long orbit would
    fill the memory.
    """
    K, s = source
    starts = interval_starts(K)
    lengths = interval_lengths(K)
    k = np.searchsorted(starts, times, side="right") - 1
    weights = np.empty((len(times), s + 1))
    for interval in np.unique(k):
        inside = k == interval
        within = (times[inside] - starts[interval]) / lengths[interval]
        weights[inside] = radau_method(s).evaluation(within)
    first = k * s  # the end of the interval before is the start of this interval
    columns = first[:, None] + np.arange(s + 1)
    rows = np.arange(0, weights.size + 1, s + 1)
    return csr_array((weights.ravel(), columns.ravel(), rows), shape=(len(times), 1 + K * s))
