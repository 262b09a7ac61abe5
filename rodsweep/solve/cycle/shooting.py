"""Newton's method on the period map: a cycle from a state near it.

    phi_T(z) - z = 0,   theta_tip(z) = constant              (unknowns z at the section, and T)

Waiting for a cycle costs 1/|1 - mu| periods per digit, mu the largest multiplier; this costs a few periods
whatever mu is. phi_T is `steps` equal steps of ARKIMEX 5 with stages solved to round-off, a smooth function
of (z, T), so the iteration closes to round-off; twice the steps tell the error. Whether a period is the
minimal one the harmonics of its orbit say.
"""

from dataclasses import dataclass
from math import gcd

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
PRESENT = 1e-3
"""Share of the largest harmonic from which another one is taken for present before errors are known."""
CERTAIN = 10.0
"""Share of the largest harmonic, in units of the relative error of the extrema, that is no error for sure."""
LEAST_PRESENT = 1e-6
"""What is asked of a harmonic at least, whatever the error estimate, which is the tip's."""


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


def common_divisor(orbit: Orbit, present: float) -> int:
    """g of the harmonics larger than `present` times the largest; 1 proves that the period is minimal.

    An orbit that closes after T has the minimal period T/g, where g is the greatest common divisor of the
    numbers of all its harmonics; those of the bending moments that stand out of its error are there for sure.
    """
    moments = orbit.run.states[:-1, 2 * orbit.beam.mesh.nodes :]
    sizes = np.linalg.norm(np.fft.rfft(moments, axis=0)[1:], axis=1)
    return gcd(*map(int, np.nonzero(sizes > present * sizes.max())[0] + 1))


def undecided_divisor(orbit: Orbit, error: float) -> int:
    """How many times shorter than the orbit's its period may be for all that is known; 1 is a proof.

    error: relative, of the extrema.
    """
    return common_divisor(orbit, max(CERTAIN * error, LEAST_PRESENT))


def shortened(orbit: Orbit) -> Orbit | None:
    """The orbit with the period that its harmonics have in common; None where it does not close then."""
    while (g := common_divisor(orbit, PRESENT)) > 1:
        steps = max(FIRST_STEPS, orbit.steps // g)
        shorter = shoot(orbit.beam, orbit.state, orbit.period / g, steps)
        if shorter is None:
            return None
        orbit = shorter
    return orbit
