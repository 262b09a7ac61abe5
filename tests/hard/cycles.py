"""Cycles of random rods in and out of every limit, and their true errors by a mesh that is far finer."""

from dataclasses import replace
from functools import cache
from math import ceil, inf, log10
from typing import NamedTuple

import numpy as np

from rodsweep.discretization.elements.mesh import mesh_with_edges, uniform_mesh
from rodsweep.discretization.stress.form import StressForm
from rodsweep.model.rod import Rod
from rodsweep.solve.changes.thresholds import ThresholdsRequest, solve_thresholds
from rodsweep.solve.cycle.accuracy.refined_cycle import RefinedCycle
from rodsweep.solve.cycle.accuracy.refinement import refined_cycle
from rodsweep.solve.cycle.cycle_of_neighbouring_rod import CycleStart, cycle_from_neighbour
from rodsweep.solve.cycle.hopf_start import hopf_point_below_force, orbit_from_hopf
from rodsweep.solve.orbit.matrix.workspace import NewtonWorkspace
from rodsweep.solve.orbit.measures import CycleMotion
from rodsweep.solve.orbit.newton import (
    newton_step_if_matrix_distant,
    nontrivial_multipliers_and_error,
    solve_by_newton,
)
from rodsweep.solve.orbit.orbit_mesh import mesh_of_orbit
from rodsweep.solve.unsolvable import Unsolvable

MOST_FORCE = 200.0
FINER_ORDER, FINER_SHARE, FINER_STAGES, LEAST_INTERVALS = 8, 1.2, 6, 10
"""What the reference has more of: order, intervals and stages. It differs from a finer one by at most a tenth
of the error that it is to tell, or by what rounding leaves."""
ROUNDING, MULTIPLIERS_ROUNDING = 2e-12, 10.0
"""Of the reference, relative; of its multipliers, in units of what its trivial one is off."""
EXTREMA = ("tip_x_min", "tip_x_max", "tip_y_max", "tip_theta_max")


class Case(NamedTuple):
    """A rod, its force in units of the first Hopf point's, and the accuracy asked for."""

    k1: float
    k2: float
    gamma3: float
    gamma1: float
    beyond: float
    accuracy: float


def random_case(index):
    """The case of that number, whatever others are asked for."""
    random = np.random.default_rng([14, index])
    k1, k2 = (inf if random.random() < 0.1 else 10 ** random.uniform(log10(30), 8) for _ in range(2))
    gamma3 = 0.0 if random.random() < 0.12 else 10 ** random.uniform(-8, 0)
    gamma1, above = random.uniform(0.5, 1), 10 ** random.uniform(-4, log10(4))
    return Case(k1, k2, gamma3, gamma1, 1 + above, float(random.choice([1e-4, 1e-6, 1e-7, 1e-9])))


@cache
def first_hopf(k1, k2, gamma3):
    """The force of the first Hopf point, None where there is none."""
    found = solve_thresholds(
        Rod(F=0.0, k1=k1, k2=k2, gamma3=gamma3),
        ThresholdsRequest(min(0.9999 * k1, MOST_FORCE), 1e-11, False, 6),
    )
    return next((c.value for c in found.thresholds if c.kind.name == "hopf"), None)


def cycle_of(case) -> RefinedCycle | None:
    """The cycle from the Hopf point; None where the rod has none or is crushed; raises Unsolvable."""
    hopf = first_hopf(case.k1, case.k2, case.gamma3)
    if hopf is None or hopf * case.beyond >= case.k1:
        return None
    rod = Rod(F=hopf * case.beyond, k1=case.k1, k2=case.k2, gamma3=case.gamma3, gamma1=case.gamma1)
    start = orbit_from_hopf(
        StressForm(rod, uniform_mesh(1, 16)), hopf_point_below_force(rod), NewtonWorkspace()
    )
    return refined_cycle(start, case.accuracy, NewtonWorkspace())


def chain_of(case, parameter, ratio, points):
    """The cycles of a chain in steps of a parameter, from the one of the case on, as far as it goes."""
    hopf = first_hopf(case.k1, case.k2, case.gamma3)
    rod = Rod(F=hopf * case.beyond, k1=case.k1, k2=case.k2, gamma3=case.gamma3, gamma1=case.gamma1)
    yield from chain_from(StressForm(rod, uniform_mesh(1, 16)), case.accuracy, parameter, ratio, points)


def chain_from(form, accuracy, parameter, ratio, points):
    """The cycles of a chain in steps of a parameter, behind that of the rod of a form, as far as it goes."""
    rod, memory = form.rod, NewtonWorkspace()
    start = orbit_from_hopf(form, hopf_point_below_force(rod), memory)
    found = refined_cycle(start, accuracy, memory, parameter)
    neighbour = CycleStart.from_cycle(found, None, parameter, accuracy)
    for _ in range(points):
        rod = replace(rod, **{parameter: ratio * getattr(rod, parameter)})
        try:
            found = cycle_from_neighbour(neighbour, replace(form, rod=rod), parameter, accuracy, memory)
        except Unsolvable:
            return
        yield found
        neighbour = CycleStart.from_cycle(found, neighbour, parameter, accuracy)


def finer(orbit):
    """The same cycle on a mesh that is far finer, converged to rounding, with its matrix."""
    here = mesh_of_orbit(orbit)
    grid = mesh_with_edges(here.element_edges, here.order + ceil(FINER_ORDER / here.element_count))
    intervals = max(LEAST_INTERVALS, ceil(FINER_SHARE * here.interval_count))
    return newton_step_if_matrix_distant(
        solve_by_newton(orbit.on_mesh(grid, intervals, FINER_STAGES), 1e-13, NewtonWorkspace()), 0.0
    )


def broken_promises(found, accuracy):
    """What of a cycle is less accurate than its estimates say, or than asked for: sentences."""
    exact = finer(found.orbit)
    extrema, measures, errors = CycleMotion(exact.orbit).tip_extrema, found.measures, found.errors
    period = abs(measures.period / exact.orbit.period - 1)
    off = {name: abs(getattr(measures, name) - extrema[name]) / extrema["tip_y_max"] for name in EXTREMA}
    multipliers, rounding = nontrivial_multipliers_and_error(exact)
    multiplier = abs(found.largest_multiplier_modulus - abs(multipliers[0])) - MULTIPLIERS_ROUNDING * rounding
    promised = {
        "period": (period, errors.period_error),
        "multiplier": (multiplier, errors.multiplier_error),
        **{name: (error, errors.extrema_error) for name, error in off.items()},
        "tip_y_max": (off["tip_y_max"], errors.amplitude_error),
    }
    beyond = {k: (true, said) for k, (true, said) in promised.items() if true > said + ROUNDING}
    broken = [f"{k}: {true:.1e} > {said:.1e}" for k, (true, said) in beyond.items()]
    if max(errors.period_error, errors.amplitude_error) > accuracy:
        broken.append(f"estimate {errors.largest_weighted_error:.1e} > {accuracy:.0e}")
    return broken
