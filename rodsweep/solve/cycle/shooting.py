"""Newton's method on the period map: a cycle from a state near it.

    phi_T(z) - z = 0,   theta_tip(z) = constant              (unknowns z at the section, and T)

Waiting for a cycle costs 1/|1 - mu| periods per digit, mu the largest multiplier; this costs a few periods
whatever mu is. phi_T is `steps` equal steps of ARKIMEX 5 with stages solved to round-off, a smooth function
of (z, T), so the iteration closes to round-off; twice the steps tell the error.
"""

from dataclasses import dataclass

import numpy as np

from ...arrays import Array
from ...discretization.beam import Beam
from ..motion.integrator import Ending, RunLimit, Trajectory, integrator
from ..motion.time_scheme import TimeScheme
from .floquet import Monodromy, monodromy

PERIOD_MAP = TimeScheme("arkimex", "5", tolerance=1e-8, newton=1e-6, equal_steps=True, prefix="cycle_map_")
FIRST_STEPS = 64
"""Steps per return to the section to begin with."""
MOST_SHOTS = 12
CLOSURE_ROUNDED = 3e-12
"""Relative closure below which Newton's method has nothing left to gain."""
LEAST_CLOSURE = 1e-14
"""Relative closure that cannot be asked for, next to a Hopf point either."""
CLOSED = 1e-8
"""Closure above which Newton's method has not converged."""
SLOW_CLOSING, STALLED_CLOSING = 0.05, 0.3
"""Decrease of the closure in one iteration from which a new matrix is due; from which rounding is reached."""
LONGEST_STEP, LONGEST_STRETCH = 0.3, 0.1
"""Largest change of state and period in one iteration, relative."""


@dataclass(frozen=True, eq=False)
class Orbit:
    """A closed orbit of the discrete period map: z at the section, the run over the period from there.

    closure: |phi_T(z) - z|/|z|.
    """

    beam: Beam
    state: Array
    closure: float
    run: Trajectory
    monodromy: Monodromy

    @property
    def period(self) -> float:
        return float(self.run.times[-1])

    @property
    def steps(self) -> int:
        return len(self.run.times) - 1


def angle_weights(beam: Beam) -> Array:
    """The row c, shape (unknowns,), with c z = theta of the tip."""
    row = np.zeros(beam.mesh.unknowns)
    row[2 * beam.mesh.nodes :] = beam.mesh.quadrature[:-1]
    return row


def shoot(beam: Beam, z: Array, period: float, steps: int, known: Monodromy | None = None) -> Orbit | None:
    """The orbit near z, shape (unknowns,), or None where none is found.

    z: a state of a run. Off the slow manifold, as by interpolation, the first, explicit stage of ARKIMEX
    would see rates of 1e10/tau2 at gamma3 = 1e-6. known: a monodromy matrix to begin with, as that of half as
    many steps.
    """
    row = angle_weights(beam)
    section, closure, M, fresh = row @ z, np.inf, known, False
    run: Trajectory | None = None
    run_limit = RunLimit(most_steps=steps + 2)
    for _ in range(MOST_SHOTS):
        run = integrator(beam.mesh, PERIOD_MAP).run(beam, z, period, period / steps, run_limit)
        if run.ending != Ending.reached or len(run.times) != steps + 1:  # PETSc had to shorten one
            return None
        size, last = np.abs(run.states).max(), closure
        residual = np.append(run.states[-1] - z, row @ z - section)
        closure = float(np.abs(residual).max() / size)
        # An amplitude is off by the closure in units of 1 - mu.
        small = CLOSED if M is None else max(CLOSED * min(1.0, abs(1 - M.largest)), LEAST_CLOSURE)
        stalled = closure < (CLOSED if fresh else small) and closure > STALLED_CLOSING * last
        if stalled or closure <= min(CLOSURE_ROUNDED, small):
            break
        fresh = M is None or closure > SLOW_CLOSING * last
        if M is None or fresh:
            M = monodromy(beam, run)
        by_period = beam.rate(run.states[-1])[:, None]
        slope = np.block([[M.matrix - np.eye(len(row)), by_period], [row, np.zeros(1)]])
        step = np.linalg.solve(slope, -residual)
        bounds = LONGEST_STEP * size / np.abs(step[:-1]).max(), LONGEST_STRETCH * period / abs(step[-1])
        limit = min(1.0, *bounds)
        z, period = z + limit * step[:-1], period + limit * step[-1]
    if run is None or not closure < CLOSED:
        return None
    return Orbit(beam, z, closure, run, M if M is not None else monodromy(beam, run))
