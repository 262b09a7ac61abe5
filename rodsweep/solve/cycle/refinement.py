"""A cycle resolved: Newton's method on ever finer meshes and steps, until numbers stop changing.

The mesh comes first, at few steps, for equal steps the errors of time cancel between two meshes; then the
steps are doubled on the mesh found. The energy of a cycle has to balance too, whatever the accuracy.
"""

from dataclasses import dataclass, replace
from math import ceil

import numpy as np
from numpy.typing import NDArray

from ...discretization.beam import Beam, Mesh, mesh
from ...discretization.resolution import LARGEST_ORDER
from ..motion.integrator import Ending, integrator, relaxed
from ..motion.time_scheme import Method
from .floquet import tangent
from .measures import Measures, measure
from .minimal_period import in_doubt, shortened
from .shooting import FIRST_STEPS, Orbit, shoot

Array = NDArray[np.float64]

TRANSIENT = Method("arkimex", "4", tolerance=1e-5)
"""The way to a cycle needs no accuracy: Newton's method supplies it."""
CAREFUL = Method("arkimex", "5", tolerance=1e-9)
"""Where the growth per period is small its sign has to be right."""
MOST_FIRST_STEPS, MOST_STEPS = 256, 2048
"""Steps per return to the section."""
FINER_ORDER, FINER_SHARE = 4, 1.25
"""Of one element the order grows by this much; of several the unknowns by this share."""
MOST_UNKNOWNS = 600
REDUCED_ORDER = 3
"""Order that stiffness leaves at least of the five: twice the steps leave 1/7 of what they change."""
BALANCE = 1e-8
"""What the energy of a cycle may miss, relative."""
TANGENT_ERROR, TANGENT_STEPS = 1e-6, 128
"""Error of the trivial multiplier above which the tangent is made again, and the most steps for it."""
UNSTABLE = 1e-6
"""How far beyond 1 the modulus of a multiplier is not its error."""
NEUTRAL = 3e-8
"""Distance of the largest multiplier from 1 below which a closed orbit says nothing of its amplitude."""
LEAST_SIZE, LARGEST_SIZE = 0.2, 5.0
"""What Newton's method finds, in units of what it started from: neither rest nor another world."""


@dataclass(frozen=True, slots=True)
class Errors:
    """Relative estimates: of the period, of the tip's extrema (in units of its largest y), of the balance."""

    period: float
    amplitude: float
    balance: float

    def within(self, accuracy: float) -> bool:
        return max(self.period, self.amplitude) <= accuracy and self.balance <= BALANCE

    @property
    def largest(self) -> float:
        return max(self.period, self.amplitude, self.balance)

    def __add__(self, other: "Errors") -> "Errors":
        return Errors(
            self.period + other.period, self.amplitude + other.amplitude, self.balance + other.balance
        )


@dataclass(frozen=True, eq=False)
class Resolved:
    """An orbit with its measures and the errors of both.

    in_doubt: how many times shorter its period may be for all that is known; 1 is a proof that it is minimal.
    """

    orbit: Orbit
    measures: Measures
    errors: Errors
    in_doubt: int = 0


def resolve(beam: Beam, z: Array, period: float, turns: int, accuracy: float) -> Resolved | None:
    """The stable cycle near z, a state of a run, as accurate as the limits allow; None where there is none.

    turns: returns to the section in one period.
    """
    size, steps = float(np.linalg.norm(z)), FIRST_STEPS * turns
    orbit = shoot(beam, z, period, steps)
    while orbit is None and steps < MOST_FIRST_STEPS * turns:
        steps *= 2  # Newton's method fails in a stage of a step too long, or of the period map
        orbit = shoot(beam, z, period, steps)
    if orbit is None or drifted(orbit, size):
        return None
    orbit = shortened(orbit)
    if orbit is None or drifted(orbit, size) or not stable(orbit) or 1 - orbit.tangent.largest < NEUTRAL:
        return None
    turns = max(1, round(turns * orbit.period / period))
    orbit, space = _in_space(orbit, accuracy / 2, MOST_STEPS * turns // 2)
    if drifted(orbit, size):
        return None
    found = _in_time(orbit, space, accuracy, MOST_STEPS * turns)
    if not stable(found.orbit):
        return None
    return replace(found, in_doubt=in_doubt(found.orbit, found.errors.amplitude))


def stable(orbit: Orbit) -> bool:
    """Whether all multipliers but the trivial one lie inside the circle, within their error."""
    return orbit.tangent.largest <= 1 + max(UNSTABLE, orbit.tangent.trivial_error)


def _in_space(orbit: Orbit, accuracy: float, most_steps: int) -> tuple[Orbit, Errors]:
    """The orbit on the first mesh whose numbers the next one leaves alone, and what that one changes.

    Where a finer mesh no longer changes less, what is left is of time: the steps are doubled.
    """
    here = measure(orbit.beam, orbit.run)
    errors, size = Errors(np.inf, np.inf, np.inf), float(np.linalg.norm(orbit.state))
    last = np.inf
    while (grid := finer(orbit.beam.mesh)).unknowns <= MOST_UNKNOWNS:
        fine = _on_mesh(orbit, grid)
        if fine is None:  # the finer mesh is stiffer and needs shorter steps
            stagnates = True
        else:
            there = measure(fine.beam, fine.run)
            errors = difference(here, there)
            if replace(errors, balance=2 * errors.balance).within(accuracy):
                break
            stagnates = errors.largest > last / 2
            orbit, here, last = fine, there, errors.largest
        if stagnates:
            shorter = shoot(orbit.beam, orbit.state, orbit.period, 2 * orbit.steps, orbit.tangent)
            if shorter is None or shorter.steps > most_steps:
                break
            orbit, here, last = shorter, measure(orbit.beam, shorter.run), np.inf
        if drifted(orbit, size):
            return orbit, Errors(np.inf, np.inf, np.inf)
    return orbit, errors


def drifted(orbit: Orbit, size: float) -> bool:
    """Whether Newton's method went to rest or to another world from a state of that size."""
    return not LEAST_SIZE * size < np.linalg.norm(orbit.state) < LARGEST_SIZE * size


def _in_time(orbit: Orbit, space: Errors, accuracy: float, most_steps: int) -> Resolved:
    """The orbit with steps so small that the errors of space and time together are within the accuracy."""
    best = Resolved(orbit, measure(orbit.beam, orbit.run), Errors(np.inf, np.inf, np.inf))
    size, last, steps = float(np.linalg.norm(orbit.state)), np.inf, 2 * orbit.steps
    while steps <= most_steps:
        finer_orbit = shoot(orbit.beam, orbit.state, orbit.period, steps, orbit.tangent)
        steps *= 2
        if finer_orbit is None:  # Newton's method failed in a stage of one of the steps
            continue
        if drifted(finer_orbit, size):
            break
        orbit = finer_orbit
        if orbit.tangent.trivial_error > TANGENT_ERROR and orbit.steps <= TANGENT_STEPS:
            orbit = replace(orbit, tangent=tangent(orbit.beam, orbit.run))
        here = measure(orbit.beam, orbit.run)
        change = difference(best.measures, here)
        share, last = _left(change.largest, last), change.largest
        time = Errors(change.period * share, change.amplitude * share, abs(here.energy_imbalance))
        best = Resolved(orbit, here, space + replace(time, balance=0.0))
        if replace(best.errors, balance=time.balance).within(accuracy):
            break
    return best


def _left(change: float, last: float) -> float:
    """Error that is left, in units of the last change: by the ratio of two changes, or by the least order."""
    ratio = change / last if last > 0 else 0.0
    seen = min(ratio / (1 - ratio), 1.0) if ratio < 1 else 1.0
    return max(seen, 1 / (2**REDUCED_ORDER - 1))


def difference(a: Measures, b: Measures) -> Errors:
    """How far the measures a are from b."""
    names = ("tip_x_min", "tip_x_max", "tip_y_max", "tip_theta_max")
    largest = max(abs(getattr(a, name) - getattr(b, name)) for name in names)
    return Errors(
        abs(a.period / b.period - 1),
        largest / abs(b.tip_y_max) if b.tip_y_max else np.inf,
        abs(a.energy_imbalance - b.energy_imbalance),
    )


def finer(grid: Mesh) -> Mesh:
    """The next finer mesh."""
    order = grid.order + FINER_ORDER
    if order <= LARGEST_ORDER:
        return mesh(grid.elements, order)
    elements = grid.elements + 1
    return mesh(elements, ceil(FINER_SHARE * grid.nodes / elements))


def moved(beam: Beam, z: Array, to: Mesh) -> tuple[Beam, Array]:
    """The same rod and state on another mesh."""
    there = replace(beam, mesh=to)
    return there, there.unknown(beam.strains(z) @ beam.mesh.evaluation(to.positions).T)


def _on_mesh(orbit: Orbit, grid: Mesh) -> Orbit | None:
    """The orbit on another mesh; a period of transient brings what was interpolated to the slow manifold."""
    beam, z = moved(orbit.beam, orbit.state, grid)
    z = relaxed(beam, z, orbit.period)
    run = integrator(grid, TRANSIENT).run(beam, z, orbit.period, orbit.period / 1000)
    if run.ending != Ending.reached:
        return None
    return shoot(beam, run.states[-1], orbit.period, orbit.steps)
