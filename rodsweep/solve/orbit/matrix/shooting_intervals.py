"""Shooting intervals of a strongly unstable orbit, for multiple shooting; each consists of several time
intervals.

The linearised map P from the start to the end of all time intervals multiplies rounding errors by the growth
of perturbations. This growth is 1e15 for cycles with many unstable modes, whose Newton steps would have no
correct digit. With the state at the start of every shooting interval as an unknown (Ascher, Mattheij &
Russell 1995, ch. 4), errors grow over one shooting interval only.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.linalg import schur

from ....arrays import Array, Complex
from ..equations import OrbitEquations
from ..orbit import Orbit
from .substitution import map_start_to_end, substitute_stages
from .workspace import INTERVAL_MAP, NewtonFactors


@dataclass(frozen=True, slots=True, kw_only=True)
class ShootingIntervalSettings:
    """Settings for the shooting intervals of an orbit."""

    max_flow_map_norm: float = 1e7
    """Largest norm of the map of a shooting interval; a Newton step then has nine correct digits. Stable
    cycles have norms below 1e3 and a single shooting interval."""
    orthogonal_iteration_sweep_count: int = 2
    """Number of sweeps of the orthogonal iteration over all shooting intervals. The first sweep orders the
    directions by their growth; the second starts with ordered directions."""
    negligible_multiplier: float = 1e-17
    """Multipliers with at most this modulus are treated as 0."""


SHOOTING_INTERVAL_SETTINGS = ShootingIntervalSettings()


@dataclass(frozen=True, eq=False)
class ShootingIntervals:
    """The m shooting intervals of an orbit. first_time_interval_indices: index of the first time interval of
    each shooting interval, and the number of time intervals, m + 1 numbers. flow_maps: derivative of the
    state at the end of each shooting interval with respect to the state at its start, (m, n, n)."""

    first_time_interval_indices: tuple[int, ...]
    flow_maps: Array

    def end_increments_for_fixed_starts(
        self, factors: NewtonFactors, columns: Array, end_increments: Array, p: OrbitEquations
    ) -> Array:
        """Increments of the states at the ends of the m shooting intervals for fixed starts, (m, k, n), for k
        right-hand sides.

        columns: reduced right-hand sides of the s stages of each of the K time intervals, (K, s, k, n).
        end_increments: increments of the state at the end of the last time interval for a fixed start of the
        first time interval, (k, n): the result for a single shooting interval. factors: eliminated matrix. p:
        equations of the orbit.
        """
        ends = np.zeros((len(self.flow_maps), *end_increments.shape))
        if len(ends) == 1:
            return end_increments[None]
        columns = np.ascontiguousarray(columns)
        for end, (first, last) in zip(ends, pairwise(self.first_time_interval_indices), strict=True):
            for k in range(first, last):
                map_start_to_end(factors.eliminated_blocks[k], columns[k], p, end)
        return ends

    def stage_increments(
        self, factors: NewtonFactors, starts: Array, columns: Array, p: OrbitEquations
    ) -> Array:
        """Increments of the s stages of each of the K time intervals, (K, s, 1, n). starts: increments of the
        states at the starts of the m shooting intervals, (m, n). columns: reduced right-hand sides of the
        stages, (K, s, 1, n). factors: eliminated matrix. p: equations of the orbit."""
        out = np.empty_like(columns)
        for start, (first, last) in zip(starts, pairwise(self.first_time_interval_indices), strict=True):
            part = factors._replace(eliminated_blocks=factors.eliminated_blocks[first:last])
            substitute_stages(start[None], columns[first:last], p, part, out[first:last])
        return out

    def multipliers(self, orbit: Orbit) -> Complex:
        """Nonzero eigenvalues of S^-1 P, the multipliers over the solved part of the period (half a period
        for a symmetric orbit, else the whole period), (multipliers,). P: product of the maps of all shooting
        intervals. S: symmetry. Raises LinAlgError if the map is not finite.

        P itself is not formed, because multipliers far below its norm would lose all digits. Orthogonal
        iteration gives a triangular matrix whose rows are ordered by their growth.
        """
        *earlier_maps, last_map = self.flow_maps
        basis = np.eye(len(last_map))
        triangle = basis
        for _ in range(SHOOTING_INTERVAL_SETTINGS.orthogonal_iteration_sweep_count):
            # Directions that decay to nothing over a period are dropped, to save time.
            kept_columns = np.flatnonzero(
                np.abs(np.diag(triangle)) > SHOOTING_INTERVAL_SETTINGS.negligible_multiplier
            )
            if len(kept_columns):
                basis = basis[:, : kept_columns[-1] + 1]
            start = basis
            triangle = np.eye(start.shape[1])
            for A in (*earlier_maps, orbit.symmetry.apply_inverse_to_flow(last_map, orbit.form.layout)):
                basis, R = np.linalg.qr(A @ basis)
                triangle = R @ triangle
        # The map is `basis triangle start^T`, which has the nonzero eigenvalues of this matrix.
        triangular_map = triangle @ (start.T @ basis)
        if not np.isfinite(triangular_map).all():
            raise np.linalg.LinAlgError("the flow derivative of the cycle is not finite")
        # `eigvals` balances the matrix, which destroys the grading: multipliers near 1 would lose nine
        # digits.
        values = np.diag(schur(triangular_map, output="complex")[0])
        return values[np.abs(values) > SHOOTING_INTERVAL_SETTINGS.negligible_multiplier]


def shooting_intervals_of(factors: NewtonFactors, mass: Array) -> ShootingIntervals:
    """The shooting intervals of an orbit, from its eliminated matrix. There is a single shooting interval
    unless the norm of P, the linearised map over all time intervals, exceeds
    `SHOOTING_INTERVAL_SETTINGS.max_flow_map_norm`. Otherwise a time interval is joined to the current
    shooting interval if the norm of the joined map is at most this number. mass: diagonal of M, (n,)."""
    blocks = factors.eliminated_blocks
    if (
        not np.linalg.norm(factors.propagator) > SHOOTING_INTERVAL_SETTINGS.max_flow_map_norm
    ):  # also true for nan
        return ShootingIntervals((0, len(blocks)), factors.propagator[None])
    firsts = [0]
    # The eliminated map of an interval acts on M x_0, not on x_0.
    maps = [blocks[0, INTERVAL_MAP] * mass]
    for k in range(1, len(blocks)):
        next_map = blocks[k, INTERVAL_MAP] @ (mass[:, None] * maps[-1])
        if np.linalg.norm(next_map) <= SHOOTING_INTERVAL_SETTINGS.max_flow_map_norm:
            maps[-1] = next_map
        else:
            firsts.append(k)
            maps.append(blocks[k, INTERVAL_MAP] * mass)
    return ShootingIntervals((*firsts, len(blocks)), np.array(maps))
