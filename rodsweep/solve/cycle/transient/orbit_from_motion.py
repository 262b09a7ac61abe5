"""Start of Newton's method for a cycle: an approximate orbit from an integrated motion near the cycle."""

from dataclasses import dataclass

import numpy as np

from ....arrays import Array
from ....discretization.explicit_system import ExplicitSystem
from ....discretization.plane_equations import write_balance
from ....discretization.stress.form import StressForm
from ...motion.integrator import Trajectory
from ...orbit.matrix.workspace import require_enough_stages
from ...orbit.orbit import Orbit, node_time_fractions
from ...orbit.symmetry import NO_SYMMETRY, REFLECTION


@dataclass(frozen=True, slots=True, kw_only=True)
class NewtonFromMotionSettings:
    """Settings for starting Newton's method from an integrated motion."""

    collocation_stage_count: int = 3
    """Number of collocation stages per interval of the approximate orbit."""
    time_intervals_per_return: int = 20
    """Number of time intervals of the approximate orbit per return of the tip."""
    peak_search_time_count: int = 128
    """Number of equidistant times per period from which the time of the largest y is chosen."""
    max_asymmetry_of_symmetric_orbit: float = 0.2
    """The orbit is solved as symmetric if the `relative_bending_moment_asymmetry` of the motion is less than
    this number."""

    def __post_init__(self) -> None:
        require_enough_stages(self.collocation_stage_count)


NEWTON_FROM_MOTION_SETTINGS = NewtonFromMotionSettings()


def orbit_from_motion(
    system: ExplicitSystem, form: StressForm, run: Trajectory, period: float, return_count: int
) -> Orbit:
    """Approximate orbit of the rod in `form` from the last period of the motion `run` of `system`; both have
    the same mesh. The orbit starts at the largest y of the tip, and is symmetric if the
    `relative_bending_moment_asymmetry` of the motion is small.

    period: in tau2. return_count: number of returns of the tip to theta = 0 per period. If the rod in `form`
    is a limiting rod, for example an inextensible rod, `system` is a nearby rod.
    """
    from scipy.interpolate import CubicSpline  # slow import: 0.1 s, for few runs

    # The integrator's own steps do not fall on the nodes of the collocation.
    spline = CubicSpline(run.times, run.states)
    start_time = float(run.times[-1]) - period
    times = (
        start_time
        + period
        * np.arange(NEWTON_FROM_MOTION_SETTINGS.peak_search_time_count)
        / NEWTON_FROM_MOTION_SETTINGS.peak_search_time_count
    )
    period_states = spline(times)
    # The cycle's phase condition holds at the largest y, so the orbit starts near it.
    time_of_largest_y = float(times[int(np.argmax(system.tip_coordinates(period_states)[1]))])
    symmetry = (
        REFLECTION
        if relative_bending_moment_asymmetry(system, period_states)
        < NEWTON_FROM_MOTION_SETTINGS.max_asymmetry_of_symmetric_orbit
        else NO_SYMMETRY
    )
    # The number of intervals is proportional to the number of returns of the tip.
    interval_count = (
        NEWTON_FROM_MOTION_SETTINGS.time_intervals_per_return
        * return_count
        // symmetry.solved_parts_per_period
    )
    duration = period / symmetry.solved_parts_per_period
    times_of_nodes = time_of_largest_y + duration * node_time_fractions(
        interval_count, NEWTON_FROM_MOTION_SETTINGS.collocation_stage_count
    )
    # Times after the end of the run are moved back by one period.
    times_of_nodes = np.where(times_of_nodes > run.times[-1], times_of_nodes - period, times_of_nodes)
    states = collocation_states(system, form, spline(times_of_nodes))
    return Orbit.from_states(
        form, symmetry, period, states, NEWTON_FROM_MOTION_SETTINGS.collocation_stage_count
    )


def relative_bending_moment_asymmetry(system: ExplicitSystem, states: Array) -> float:
    """Norm of the difference between m3(t) and the reflection -m3(t + T/2), divided by the norm of m3; m3:
    bending moments, T: period. states: states at m equidistant times over a period, (m, n)."""
    moments = system.layout.stress_field(states, "m3")
    # m3 changes its sign under the reflection.
    mirrored = -np.roll(moments, len(moments) // 2, axis=0)
    return float(np.linalg.norm(moments - mirrored) / np.linalg.norm(moments))


def collocation_states(system: ExplicitSystem, form: StressForm, z: Array) -> Array:
    """States of the collocation problem `form`, (m, unknowns), from states z of `system`, (m, unknowns of the
    system); both have the same mesh."""
    S = system.stresses(z)
    velocities = np.empty(S.shape)
    G = np.empty((len(S), S.shape[-1]))
    if form.unknown_velocity_components:
        for k, state in enumerate(system.layout.state(S, S)):
            # The collocation has velocities as unknowns where a drag is small; the integrator has none.
            velocity = np.empty(G.shape)
            write_balance(state, velocity, G, system.nodal_rod, system.mesh.node_matrices)
            velocities[:, k] = velocity
    return form.layout.state(S, velocities)


def state_with_scaled_deflection(system: ExplicitSystem, z: Array, factor: float) -> Array:
    """The state z, (unknowns,), with the deflection multiplied by `factor`, and n1 by its square; z is not
    changed."""
    scaled = factor * z
    system.layout.stress_field(scaled, "n1")[...] *= factor  # quadratic in the deflection
    return scaled
