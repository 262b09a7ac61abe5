"""Periodic orbit on one mesh in space and time.

Unknowns are the state at t = 0, the stages of a Radau collocation, and the period T. A symmetric orbit,
x(T/p) = S x(0), is solved over the part T/p of its period; an orbit without symmetry (p = 1) is solved over
the whole period. At t = 0 the velocity of the tip's y, computed from the reaction at the tip, is zero.
Therefore the largest y is at a time node, where y is as accurate as T.
"""

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
from scipy.sparse import csr_array

from ...arrays import Array
from ...discretization.elements.elements import ELEMENT_SETTINGS
from ...discretization.elements.mesh import Mesh
from ...discretization.elements.time_collocation import CollocationMethod, radau_method
from ...discretization.stress.form import StressForm
from .compiled_measures import MeanPowersAndLeastStretch, mean_powers_and_least_stretch
from .equations import OrbitEquations
from .symmetry import Symmetry
from .time_grading import UNIFORM_TIME_GRADING, TimeGrading

TimeMesh = tuple[int, int, TimeGrading]
"""Number of time intervals, number of stages of each interval, and grading of the intervals."""


@dataclass(frozen=True, eq=False)
class Orbit:
    """A periodic orbit of the rod and space mesh of `form`, with K = `interval_count` time intervals and s =
    `stage_count` collocation stages in each interval.

    values: states at t = 0 and at the stages of all intervals, in order, then the period in tau2, (N,), N =
    (1 + K s) n + 1, n: unknowns of a state. grading: grading of the lengths of the intervals.
    """

    form: StressForm
    symmetry: Symmetry
    """Symmetry by which the solved part of the period gives the whole period."""
    interval_count: int
    stage_count: int
    values: Array
    grading: TimeGrading = UNIFORM_TIME_GRADING

    @classmethod
    def from_states(
        cls, form: StressForm, symmetry: Symmetry, period: float, states: Array, stage_count: int
    ) -> "Orbit":
        """The orbit with the period `period`, in tau2. states: states at t = 0 and at all stages, (1 + K s,
        n). stage_count: number s of stages of an interval."""
        values = np.append(states.ravel(), period)
        return cls(form, symmetry, (len(states) - 1) // stage_count, stage_count, values)

    @property
    def period(self) -> float:
        return float(self.values[-1])

    @property
    def all_states(self) -> Array:
        """States at t = 0 and at the stages of all intervals, (1 + K s, n)."""
        return self.values[:-1].reshape(1 + self.interval_count * self.stage_count, -1)

    @property
    def start_state(self) -> Array:
        """State at t = 0, (n,)."""
        return self.all_states[0]

    @property
    def stage_states(self) -> Array:
        """States at the stages of each interval, (K, s, n)."""
        return self.all_states[1:].reshape(self.interval_count, self.stage_count, -1)

    @property
    def states_at_interval_starts(self) -> Array:
        """States at the starts of the intervals, (K, n)."""
        # The last stage of an interval is the start of the next.
        return self.all_states[: -1 : self.stage_count]

    @property
    def states_equidistant_in_mesh_time(self) -> Array:
        """States at the starts of all intervals except the last, (K - 1, n). They are equidistant in the mesh
        time, the variable that `grading` maps to the time, and divide the solved duration into K - 1
        parts."""
        return self.states_at_interval_starts[:-1]

    @property
    def time_mesh(self) -> TimeMesh:
        """Number of time intervals, number of stages of each, and grading."""
        return self.interval_count, self.stage_count, self.grading

    @property
    def time_slopes_by_mesh_time(self) -> Array:
        """dt/dtau at the equidistant mesh times tau of `states_equidistant_in_mesh_time`, (K - 1,)."""
        full_length_interval_count = self.interval_count - 1
        return self.grading.time_slopes(np.arange(full_length_interval_count) / full_length_interval_count)

    @property
    def collocation_method(self) -> CollocationMethod:
        return radau_method(self.stage_count)

    @property
    def solved_duration(self) -> float:
        """Duration of the solved part of the period in tau2: half the period or the whole period."""
        return self.period / self.symmetry.solved_parts_per_period

    @property
    def is_symmetric(self) -> bool:
        """Whether the solved part is shorter than the period (`symmetry.solved_parts_per_period` > 1)."""
        return self.symmetry.solved_parts_per_period > 1

    @cached_property
    def orbit_equations(self) -> OrbitEquations:
        return _orbit_equations(self.form, self.symmetry, self.interval_count, self.stage_count, self.grading)

    @cached_property
    def mean_powers_and_least_stretch(self) -> MeanPowersAndLeastStretch:
        """Mean powers over a period, and the smallest h1."""
        return mean_powers_and_least_stretch(
            np.ascontiguousarray(self.stage_states), self.collocation_method.weights, self.orbit_equations
        )

    @property
    def max_energy_norm(self) -> float:
        """Largest energy norm of the states at equidistant mesh times, in units of sqrt(energy): the size of
        the motion."""
        # The norm is the same in the part of the period that follows by symmetry.
        return float(self.form.energy_norm(self.states_equidistant_in_mesh_time).max())

    def plus_change(self, change: Array, fraction: float = 1.0) -> "Orbit":
        """The orbit with the values `values` + `fraction` * `change`; change: (N,)."""
        return replace(self, values=self.values + fraction * change)

    def states_at_time_fractions(self, times: Array) -> Array:
        """Interpolated states, (m, n), at `times`, (m,), in [0, 1], as fractions of the solved duration."""
        states: Array = matrix_to_time_fractions(self.time_mesh, times) @ self.all_states
        return states

    def on_mesh(
        self, target: Mesh, interval_count: int, stage_count: int, grading: TimeGrading | None = None
    ) -> "Orbit":
        """The orbit interpolated to the space mesh `target` and to `interval_count` time intervals with
        `stage_count` stages each and the grading `grading`, or the grading of this orbit."""
        grading = grading or self.grading
        points = self._values_at_times_of(self.values, (interval_count, stage_count, grading))
        if target != self.form.mesh:
            points = self.form.states_on_mesh(target, points)
        return replace(
            self,
            form=replace(self.form, mesh=target),
            interval_count=interval_count,
            stage_count=stage_count,
            values=np.append(points.ravel(), self.period),
            grading=grading,
        )

    def change_on_mesh(self, change: Array, target: Mesh, time_mesh: TimeMesh) -> Array:
        """The change `change` of the values, (N,), interpolated by a linear map to the space mesh `target`
        and the time intervals `time_mesh`, (N on these meshes,)."""
        points = self._values_at_times_of(change, time_mesh)
        if target != self.form.mesh:
            points = self.form.increments_on_mesh(target, points)
        return np.append(points.ravel(), change[-1])

    def _values_at_times_of(self, values: Array, target: TimeMesh) -> Array:
        """Orbit values, (N,), interpolated to the start and the stages of the time intervals `target`, (1 + K
        s, n)."""
        source = self.time_mesh
        points: Array = values[:-1].reshape(1 + self.interval_count * self.stage_count, -1)
        return points if target == source else time_interpolation_matrix(source, target) @ points


@lru_cache(maxsize=ELEMENT_SETTINGS.max_cached_pencils)
def _orbit_equations(
    form: StressForm, symmetry: Symmetry, interval_count: int, stage_count: int, grading: TimeGrading
) -> OrbitEquations:
    """Data of the discretised equations of an orbit with the given form, symmetry, and time intervals;
    cached."""
    d = radau_method(stage_count).differentiation_matrix
    lengths = time_interval_lengths(interval_count, grading)
    S = symmetry.matrix(form.layout)
    period_parts = float(symmetry.solved_parts_per_period)
    return OrbitEquations(
        form.nodal_rod, form.mesh.node_matrices, form.mass_diagonal, d, lengths, S, period_parts
    )


@lru_cache(maxsize=ELEMENT_SETTINGS.max_cached_mesh_pairs)
def time_interval_lengths(interval_count: int, grading: TimeGrading = UNIFORM_TIME_GRADING) -> Array:
    """Lengths of the time intervals as fractions of the solved duration, (intervals,). Without grading the
    last two intervals are half as long as each of the others; `grading` distorts the times of all interval
    ends.

    Because modes decay within an interval, the error at the end of an interval depends mainly on the length
    of this interval. The largest y is taken at the end of the last interval, which is therefore short.
    """
    lengths = np.append(np.ones(interval_count - 2), (0.5, 0.5)) / (interval_count - 1)
    if grading.is_uniform:
        return lengths
    # The last edge is exactly 1, not a rounded sum.
    edges = np.append(np.append(0.0, np.cumsum(lengths[:-1])), 1.0)
    return np.diff(grading.times(edges))


def time_interval_start_fractions(interval_count: int, grading: TimeGrading = UNIFORM_TIME_GRADING) -> Array:
    """Start times of the time intervals as fractions of the solved duration, (intervals,)."""
    return np.append(0.0, np.cumsum(time_interval_lengths(interval_count, grading)[:-1]))


def node_time_fractions(
    interval_count: int, stage_count: int, grading: TimeGrading = UNIFORM_TIME_GRADING
) -> Array:
    """Times of the start and of all stages as fractions of the solved duration, (1 + K s,), for K =
    `interval_count` intervals with s = `stage_count` stages each and the grading `grading`."""
    starts = time_interval_start_fractions(interval_count, grading)[:, None]
    lengths = time_interval_lengths(interval_count, grading)[:, None]
    return np.append(0.0, starts + lengths * radau_method(stage_count).nodes)


@lru_cache(maxsize=ELEMENT_SETTINGS.max_cached_mesh_pairs)
def time_interpolation_matrix(source: TimeMesh, target: TimeMesh) -> csr_array:
    """Matrix that interpolates states from the time nodes of `source` to the time nodes of `target`. Shape:
    (1 + K s of target, 1 + K s of source), for K intervals with s stages each."""
    return matrix_to_time_fractions(source, node_time_fractions(*target))


def matrix_to_time_fractions(source: TimeMesh, times: Array) -> csr_array:
    """Matrix, (m, 1 + K s), that interpolates states from the time nodes of `source`, K intervals with s
    stages each, to `times` in [0, 1], (m,).

    A value depends on the nodes of one interval only. Therefore the matrix is sparse; a dense matrix of an
    orbit with many intervals would fill the memory.
    """
    K, s, grading = source
    starts = time_interval_start_fractions(K, grading)
    lengths = time_interval_lengths(K, grading)
    interval_indices = np.searchsorted(starts, times, side="right") - 1
    weights = np.empty((len(times), s + 1))
    for interval in np.unique(interval_indices):
        indices = interval_indices == interval
        fractions = (times[indices] - starts[interval]) / lengths[interval]
        weights[indices] = radau_method(s).evaluation_matrix(fractions)
    first_nodes = interval_indices * s  # the end of the previous interval is the start of this interval
    columns = first_nodes[:, None] + np.arange(s + 1)
    row_starts = np.arange(0, weights.size + 1, s + 1)
    return csr_array((weights.ravel(), columns.ravel(), row_starts), shape=(len(times), 1 + K * s))
