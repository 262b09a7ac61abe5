"""From the motion of a rod near a cycle to an orbit from which Newton's method can start."""

import numpy as np

from ...arrays import Array
from ...discretization.beam import Beam
from ...discretization.stress_balance import balance
from ...discretization.stress_form import StressForm
from ..motion.integrator import Trajectory
from .orbit import Orbit, node_times

STAGES, INTERVALS = 3, 20
"""Of the first orbit, over its period."""
PHASES = 128
"""Times at which the largest y is sought."""
SYMMETRIC = 0.2
"""Largest relative distance of a motion from its reflection, half a period on, if it is symmetric."""


def orbit_from_motion(beam: Beam, form: StressForm, run: Trajectory, period: float, turns: int) -> Orbit:
    """The last period of a run as an orbit of the rod `form`, on the beam's mesh.

    turns: returns of the tip in a period. form may be the limit of a rod that the beam is near.
    """
    from scipy.interpolate import CubicSpline  # a tenth of a second of every start

    spline = CubicSpline(run.times, run.states)
    begin = float(run.times[-1]) - period
    times = begin + period * np.arange(PHASES) / PHASES
    turn = spline(times)
    top = float(times[int(np.argmax(beam.tip(turn)[1]))])
    symmetric = asymmetry(beam, turn) < SYMMETRIC
    intervals = INTERVALS * turns // (2 if symmetric else 1)
    duration = period / 2 if symmetric else period
    at = top + duration * node_times(intervals, STAGES)
    at = np.where(at > run.times[-1], at - period, at)
    states = stressed(beam, form, spline(at))
    return Orbit.of(form, symmetric, period, states, STAGES)


def asymmetry(beam: Beam, states: Array) -> float:
    """Relative distance of the bending moments of states (m, n) over a period from their reflection."""
    moments = states[:, 2 * beam.mesh.nodes :]
    mirrored = -np.roll(moments, len(moments) // 2, axis=0)
    return float(np.linalg.norm(moments - mirrored) / np.linalg.norm(moments))


def stressed(beam: Beam, form: StressForm, z: Array) -> Array:
    """States of `form`, (m, unknowns), of the time stepper's z, (m, 3 nodes), on the same mesh."""
    S = (z.reshape(len(z), 3, -1) / beam.roots[:, None]).reshape(z.shape)
    if not form.omega_unknown:
        return S
    size = form.mesh.nodes + 1
    V, G = np.empty((3, size)), np.empty((3, size))
    Omega = np.empty((len(z), size))
    for k, state in enumerate(S):
        balance(np.ascontiguousarray(state), V, G, beam.parameters, beam.mesh.matrices)
        Omega[k] = V[2]
    return np.hstack([S, Omega])
