"""A periodic orbit on one mesh in space and time.

Its unknowns are the state at t = 0, the stages of a Radau collocation and the period T. A symmetric orbit,
x(T/p) = S x(0), is solved over that part of its period; any other over the whole. At t = 0 the tip's y is at
an extremum: its velocity, by the reaction at the tip, vanishes there, so that the largest y is as accurate as
the period.
"""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from scipy.sparse import csr_array

from ...arrays import Array
from ...discretization.elements.collocation import Collocation, radau
from ...discretization.elements.mesh import Mesh, transfer
from ...discretization.stress.form import StressForm
from .semidiscrete import Semidiscrete
from .symmetry import Symmetry


@dataclass(frozen=True, eq=False)
class Orbit:
    """values: the states at the start and at the stages of all intervals, one after the other, and the period
    in tau2, (N,) with N = (1 + K s) n + 1."""

    form: StressForm
    symmetry: Symmetry
    intervals: int
    stages: int
    values: Array

    @classmethod
    def of(cls, form: StressForm, symmetry: Symmetry, period: float, states: Array, stages: int) -> "Orbit":
        """From the states at the start and at the stages of all intervals, (1 + K s, n)."""
        values = np.append(states.ravel(), period)
        return cls(form, symmetry, (len(states) - 1) // stages, stages, values)

    @property
    def period(self) -> float:
        return float(self.values[-1])

    @property
    def points(self) -> Array:
        """The states at the start and at the stages, (1 + K s, n)."""
        return self.values[:-1].reshape(1 + self.intervals * self.stages, -1)

    @property
    def start(self) -> Array:
        """The state at t = 0, (n,)."""
        return self.points[0]

    @property
    def states(self) -> Array:
        """The states at the stages, (K, s, n)."""
        return self.points[1:].reshape(self.intervals, self.stages, -1)

    @property
    def states_at_starts(self) -> Array:
        """The states at the starts of the intervals, (K, n)."""
        return self.points[: -1 : self.stages]

    @property
    def regular_states(self) -> Array:
        """The states at the starts of all intervals but the last, equal in time, (K - 1, n)."""
        return self.states_at_starts[:-1]

    @property
    def method(self) -> Collocation:
        return radau(self.stages)

    @property
    def duration(self) -> float:
        """Of what is solved: half the period or the whole."""
        return self.period / self.symmetry.parts

    @property
    def symmetric(self) -> bool:
        """Whether less than the whole period is solved."""
        return self.symmetry.parts > 1

    @property
    def semidiscrete(self) -> Semidiscrete:
        return _semidiscrete(self.form, self.symmetry, self.intervals, self.stages)

    @property
    def size(self) -> float:
        """The largest amplitude of the motion, in units of sqrt(energy)."""
        return float(self.form.size(self.regular_states).max())  # a reflection has the same

    def moved(self, change: Array, share: float = 1.0) -> "Orbit":
        """The orbit with a share of a change, (N,), added."""
        return replace(self, values=self.values + share * change)

    def at(self, times: Array) -> Array:
        """The states at times in [0, 1] in units of the duration, shape (len(times), n)."""
        at: Array = piecewise((self.intervals, self.stages), times) @ self.points
        return at

    def on(self, grid: Mesh, intervals: int, stages: int) -> "Orbit":
        """The orbit's polynomials on another mesh and other intervals."""
        form, points = replace(self.form, mesh=grid), self.points
        here, there = (self.intervals, self.stages), (intervals, stages)
        if there != here:
            points = between_intervals(here, there) @ points
        if grid != self.form.mesh:
            points = self.form.layout.carried(points, transfer(self.form.mesh, grid))
        return replace(
            self,
            form=form,
            intervals=intervals,
            stages=stages,
            values=np.append(points.ravel(), self.period),
        )


@lru_cache(maxsize=16)
def _semidiscrete(form: StressForm, symmetry: Symmetry, intervals: int, stages: int) -> Semidiscrete:
    """What all orbits of a form on one method have in common."""
    d, lengths = radau(stages).differentiation, interval_lengths(intervals)
    S, parts = symmetry.matrix(form.layout), float(symmetry.parts)
    return Semidiscrete(form.nodal, form.mesh.matrices, form.mass, d, lengths, S, parts)


@lru_cache(maxsize=256)
def interval_lengths(intervals: int) -> Array:
    """In units of the duration, (intervals,): equal, but for the last two, which are halves.

    What decays within an interval is as wrong at its end as that interval's length makes it, nearly whatever
    the others are; and the end of the last is where the largest y is taken.
    """
    return np.append(np.ones(intervals - 2), (0.5, 0.5)) / (intervals - 1)


def interval_starts(intervals: int) -> Array:
    """When they begin, in units of the duration, (intervals,)."""
    return np.append(0.0, np.cumsum(interval_lengths(intervals)[:-1]))


def node_times(intervals: int, stages: int) -> Array:
    """Of the start and the stages, in units of the duration, (1 + K s,)."""
    starts, lengths = interval_starts(intervals)[:, None], interval_lengths(intervals)[:, None]
    return np.append(0.0, starts + lengths * radau(stages).nodes)


@lru_cache(maxsize=256)
def between_intervals(source: tuple[int, int], target: tuple[int, int]) -> csr_array:
    """Matrix from the points of (intervals, stages) to those of others, (target points, source points)."""
    intervals, stages = target
    return piecewise(source, node_times(intervals, stages))


def piecewise(source: tuple[int, int], times: Array) -> csr_array:
    """Matrix from the start and the stages of (intervals, stages) to values at times in [0, 1], (m, ...).

    Sparse, for a value depends on one interval only: dense ones of long orbits would fill the memory.
    """
    K, s = source
    starts, lengths = interval_starts(K), interval_lengths(K)
    k = np.searchsorted(starts, times, side="right") - 1
    weights = np.empty((len(times), s + 1))
    for interval in np.unique(k):
        here = k == interval
        within = (times[here] - starts[interval]) / lengths[interval]
        weights[here] = radau(s).evaluation(within)
    first = k * s  # the end of the interval before is the start of this one
    columns = first[:, None] + np.arange(s + 1)
    rows = np.arange(0, weights.size + 1, s + 1)
    return csr_array((weights.ravel(), columns.ravel(), rows), shape=(len(times), 1 + K * s))
