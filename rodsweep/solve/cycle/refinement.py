"""Newton's method on ever finer meshes and steps, until the numbers of a cycle stop changing.

The mesh comes first, at few steps, for equal steps the errors of time cancel between two meshes; then the
steps are doubled on the mesh found. The energy of a cycle has to balance too, whatever the accuracy.
"""

from dataclasses import dataclass, replace
from math import ceil, inf, nan

import numpy as np

from ...arrays import Array
from ...discretization.beam import Beam, Mesh, mesh
from ...discretization.resolution import LARGEST_ORDER
from ..motion.integrator import Ending, integrator, relaxed
from ..motion.time_scheme import TimeScheme
from .floquet import monodromy
from .measures import Measures, measures_of
from .minimal_period import shortened, undecided_divisor
from .shooting import FIRST_STEPS, Orbit, shoot

TRANSIENT = TimeScheme("arkimex", "4", tolerance=1e-5)
"""The way to a cycle needs no accuracy: Newton's method supplies it."""
CAREFUL = TimeScheme("arkimex", "5", tolerance=1e-9)
"""Where the growth per period is small its sign has to be right."""
MOST_FIRST_STEPS, MOST_LAST_STEPS = 256, 2048
"""Steps per return to the section."""
FINER_ORDER, FINER_SHARE = 4, 1.25
"""Of one element the order grows by this much; of several the unknowns by this share."""
MOST_CYCLE_UNKNOWNS = 600
REDUCED_ORDER = 3
"""Order that stiffness leaves at least of the five: twice the steps leave 1/7 of what they change."""
BALANCE = 1e-8
"""What the energy of a cycle may miss, relative."""
MONODROMY_ERROR, MONODROMY_STEPS = 1e-6, 128
"""Error of the trivial multiplier above which the matrix is made again, and the most steps for that."""
NEUTRAL = 3e-8
"""Distance of the largest multiplier from 1 below which a closed orbit says nothing of its amplitude."""
LEAST_SIZE, LARGEST_SIZE = 0.2, 5.0
"""Size of what Newton's method may find, in units of what it started from: it must be the same motion."""


@dataclass(frozen=True)
class CycleErrors:
    """Relative estimates: of the period, of the tip's extrema (in units of its largest y), of the balance."""

    period_error: float
    amplitude_error: float
    balance_error: float

    def within(self, accuracy: float, balance: float = BALANCE) -> bool:
        return max(self.period_error, self.amplitude_error) <= accuracy and self.balance_error <= balance

    @property
    def largest(self) -> float:
        return max(self.period_error, self.amplitude_error, self.balance_error)


UNKNOWN_ERRORS, INFINITE_ERRORS = CycleErrors(nan, nan, nan), CycleErrors(inf, inf, inf)


@dataclass(frozen=True, eq=False)
class RefinedOrbit:
    """An orbit with its measures and the errors of both.

    divisor: how many times shorter its period may be for all that is known; 1 proves that it is minimal.
    """

    orbit: Orbit
    measures: Measures
    errors: CycleErrors
    divisor: int = 0


def refine(beam: Beam, z: Array, period: float, turns: int, accuracy: float) -> RefinedOrbit | None:
    """The stable cycle near z, a state of a run, as accurate as the limits allow; None where there is none.

    z: shape (unknowns,); turns: returns to the section in one period.
    """
    size, steps = float(np.linalg.norm(z)), FIRST_STEPS * turns
    orbit = shoot(beam, z, period, steps)
    while orbit is None and steps < MOST_FIRST_STEPS * turns:
        steps *= 2  # Newton's method fails in a stage of a step too long, or of the period map
        orbit = shoot(beam, z, period, steps)
    if orbit is None or drifted(orbit, size):
        return None
    orbit = shortened(orbit)
    if (
        orbit is None
        or drifted(orbit, size)
        or not orbit.monodromy.stable
        or 1 - orbit.monodromy.largest < NEUTRAL
    ):
        return None
    turns = max(1, round(turns * orbit.period / period))
    orbit, space = _in_space(orbit, accuracy / 2, MOST_LAST_STEPS * turns // 2)
    if drifted(orbit, size):
        return None
    found = _in_time(orbit, space, accuracy, MOST_LAST_STEPS * turns)
    if not found.orbit.monodromy.stable:
        return None
    return replace(found, divisor=undecided_divisor(found.orbit, found.errors.amplitude_error))


def _in_space(orbit: Orbit, accuracy: float, most_steps: int) -> tuple[Orbit, CycleErrors]:
    """The orbit on the first mesh whose numbers the next one leaves alone, and what that one changes.

    Where a finer mesh no longer changes less, what is left is of time: the steps are doubled.
    """
    here = measures_of(orbit.beam, orbit.run)
    errors, size = INFINITE_ERRORS, float(np.linalg.norm(orbit.state))
    last = inf
    while (grid := finer_mesh(orbit.beam.mesh)).unknowns <= MOST_CYCLE_UNKNOWNS:
        fine = _on_mesh(orbit, grid)
        if fine is None:  # the finer mesh is stiffer and needs shorter steps
            stagnates = True
        else:
            there = measures_of(fine.beam, fine.run)
            errors = change_of_measures(here, there)
            if errors.within(accuracy, BALANCE / 2):
                break
            stagnates = errors.largest > last / 2
            orbit, here, last = fine, there, errors.largest
        if stagnates:
            shorter = shoot(orbit.beam, orbit.state, orbit.period, 2 * orbit.steps, orbit.monodromy)
            if shorter is None or shorter.steps > most_steps:
                break
            orbit, here, last = shorter, measures_of(orbit.beam, shorter.run), inf
        if drifted(orbit, size):
            return orbit, INFINITE_ERRORS
    return orbit, errors


def drifted(orbit: Orbit, size: float) -> bool:
    """Whether Newton's method went to the straight rod or to another motion from a state of that size."""
    return not LEAST_SIZE * size < np.linalg.norm(orbit.state) < LARGEST_SIZE * size


def _in_time(orbit: Orbit, space: CycleErrors, accuracy: float, most_steps: int) -> RefinedOrbit:
    """The orbit with steps so small that the errors of space and time together are within the accuracy."""
    best = RefinedOrbit(orbit, measures_of(orbit.beam, orbit.run), INFINITE_ERRORS)
    size, last, steps = float(np.linalg.norm(orbit.state)), inf, 2 * orbit.steps
    while steps <= most_steps:
        fine = shoot(orbit.beam, orbit.state, orbit.period, steps, orbit.monodromy)
        steps *= 2
        if fine is None:  # Newton's method failed in a stage of one of the steps
            continue
        if drifted(fine, size):
            break
        orbit = fine
        if orbit.monodromy.trivial_error > MONODROMY_ERROR and orbit.steps <= MONODROMY_STEPS:
            orbit = replace(orbit, monodromy=monodromy(orbit.beam, orbit.run))
        here = measures_of(orbit.beam, orbit.run)
        change = change_of_measures(best.measures, here)
        share, last = _left(change.largest, last), change.largest
        errors = CycleErrors(
            space.period_error + change.period_error * share,
            space.amplitude_error + change.amplitude_error * share,
            abs(here.energy_imbalance),
        )
        best = RefinedOrbit(orbit, here, errors)
        if errors.within(accuracy):
            break
    return best


def _left(change: float, last: float) -> float:
    """Error that is left, in units of the last change: by the ratio of two changes, or by the least order."""
    ratio = change / last if last > 0 else 0.0
    seen = min(ratio / (1 - ratio), 1.0) if ratio < 1 else 1.0
    return max(seen, 1 / (2**REDUCED_ORDER - 1))


def change_of_measures(a: Measures, b: Measures) -> CycleErrors:
    """How far the measures a are from b."""
    names = ("tip_x_min", "tip_x_max", "tip_y_max", "tip_theta_max")
    largest = max(abs(getattr(a, name) - getattr(b, name)) for name in names)
    return CycleErrors(
        abs(a.period / b.period - 1),
        largest / abs(b.tip_y_max) if b.tip_y_max else inf,
        abs(a.energy_imbalance - b.energy_imbalance),
    )


def finer_mesh(grid: Mesh) -> Mesh:
    """The next finer mesh."""
    order = grid.order + FINER_ORDER
    if order <= LARGEST_ORDER:
        return mesh(grid.elements, order)
    elements = grid.elements + 1
    return mesh(elements, ceil(FINER_SHARE * grid.nodes / elements))


def _on_mesh(orbit: Orbit, grid: Mesh) -> Orbit | None:
    """The orbit on another mesh; a period of transient brings what was interpolated to the slow manifold."""
    coarse = orbit.beam
    beam = replace(coarse, mesh=grid)
    z = beam.unknown(coarse.strains(orbit.state) @ coarse.mesh.evaluation(grid.positions).T)
    z = relaxed(beam, z, orbit.period)
    run = integrator(grid, TRANSIENT).run(beam, z, orbit.period, orbit.period / 1000)
    if run.ending != Ending.reached:
        return None
    return shoot(beam, run.states[-1], orbit.period, orbit.steps)
