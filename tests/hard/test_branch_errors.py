"""The errors that cycles of branches state, against finer meshes at the stored value of the parameter.

The rods are those whose branches once lay outside their errors, and random ones in and out of every limit.
The suite takes a few of these, RODSWEEP_RODS as many as it says (`make survey`: 300).
"""

import os
from collections.abc import Iterator
from dataclasses import replace
from itertools import islice
from math import ceil, inf
from typing import NamedTuple

import numpy as np
import pytest
from surveyed import few

from rodsweep.determinant.parameter_path import ParameterPath
from rodsweep.model.rod import Rod
from rodsweep.solve.branch.arc_length_step import BranchCycle, next_cycle
from rodsweep.solve.branch.bordered.scale import deflection_at_time_zero
from rodsweep.solve.branch.branch_curve import StoredBranchCycle
from rodsweep.solve.branch.branch_mesh_choice import (
    cycles_with_errors_within_accuracy,
    is_error_measurement_due,
)
from rodsweep.solve.branch.start.first_cycle import first_cycle
from rodsweep.solve.branch.start.hopf_point import hopf_branch_start
from rodsweep.solve.changes.thresholds_along_path import find_imaginary_axis_crossings
from rodsweep.solve.orbit.matrix.workspace import NewtonWorkspace
from rodsweep.solve.orbit.measures import CycleMotion
from rodsweep.solve.orbit.newton import newton_step, nontrivial_multipliers_and_error, solve_by_newton
from rodsweep.solve.orbit.orbit_mesh import mesh_of_orbit
from rodsweep.solve.unsolvable import Unsolvable

RODS, BATCH = int(os.environ.get("RODSWEEP_RODS", "4")), 2
MOST_CYCLES, EACH = 40, 4
"""Cycles of a branch that are followed, and of how many one is compared."""
LARGEST_MESH = 6e7
"""Cost of a mesh, in its own unit, beyond which a branch is left: its cycles take seconds each."""
STEEP = 100.0
"""|(F/y) dy/dF| up to which all errors are promised to be within the accuracy."""
ROUNDING = 1e-11
"""Relative error of the reference."""


class Case(NamedTuple):
    """A rod whose first branch is followed in F up to a force, and the accuracy."""

    k1: float
    k2: float
    gamma3: float
    gamma1: float
    stop: float
    accuracy: float


CASES = {
    "soft in shear": Case(70.66930650719088, 7.475835067356657, 2.865170033984985e-4, 1.0, 30.0, 1e-6),
    "soft in shear, without drag, to 1e-4": Case(69.1488759661356, 10.400752159399405, 0.0, 1.0, 40.0, 1e-4),
    "soft in shear, without drag": Case(69.1488759661356, 10.400752159399405, 0.0, 1.0, 40.0, 1e-7),
    "errors that grow along the branch": Case(
        3166.00394470897, 10.7616966732189, 1.45290872997025e-05, 1.0, 16.0, 1e-4
    ),
    "Fig. 2c, through its fold": Case(200.0, 1e4, 1e-4, 1.0, 199.9, 1e-7),
    "a fold close to the Hopf point": Case(150.0, 1e4, 1e-4, 1.0, 110.0, 1e-6),
    "an error that changes its sign": Case(4722.88753, 443.06952, 1.724718966, 1.0, 24.0, 1e-6),
    "filament": Case(inf, inf, 0.0, 1.0, 80.0, 1e-6),
    "multipliers of 1e8": Case(1012.3, 21.16, 5.9886e-2, 4.72, 68.0, 1e-6),
}


def random_case(index: int) -> Case:
    """The case of that number, whatever others are asked for."""
    random = np.random.default_rng([30, index])
    k1 = inf if random.random() < 0.12 else 10 ** random.uniform(1.7, 5)
    k2 = inf if random.random() < 0.12 else 10 ** random.uniform(0.6, 5)
    gamma3 = 0.0 if random.random() < 0.1 else 10 ** random.uniform(-6, 0.3)
    gamma1 = 10 ** random.uniform(np.log10(0.02), 2) if random.random() < 0.6 else 1.0
    accuracy = float(random.choice([1e-4, 1e-5, 1e-6, 1e-7, 1e-8]))
    return Case(k1, k2, gamma3, gamma1, min(random.uniform(30, 130), 0.97 * k1), accuracy)


def cycles_of(case: Case) -> Iterator[BranchCycle]:
    """The cycles of the first branch, with the errors that it states, as far as MOST_CYCLES."""
    rod = Rod(F=0.0, k1=case.k1, k2=case.k2, gamma3=case.gamma3)
    crossings = find_imaginary_axis_crossings(ParameterPath(rod, "F"), 0.0, case.stop).thresholds
    if not crossings:
        return
    here = last = first_cycle(
        hopf_branch_start(ParameterPath(rod.with_values(gamma1=case.gamma1), "F"), crossings[0]),
        case.accuracy,
        NewtonWorkspace(),
    )
    yield last
    waiting: list[BranchCycle] = []
    for _ in range(MOST_CYCLES):
        try:
            here = next_cycle(here, case.accuracy)
        except Unsolvable:
            return
        outside = (
            not 0 < here.parameter_coordinate < case.stop
            or deflection_at_time_zero(here.orbit) * deflection_at_time_zero(last.orbit) < 0
        )
        if outside or mesh_of_orbit(here.orbit).elimination_cost > LARGEST_MESH:
            return
        waiting.append(here)
        if is_error_measurement_due(here, case.accuracy):
            yield from (points := cycles_with_errors_within_accuracy(last, waiting, case.accuracy, None))
            here = last = points[-1]
            waiting = []


def broken_promises(case: Case) -> list[str]:
    """What of the cycles of a case is further off than it says, or than the accuracy."""
    wrong = []
    for point in islice(cycles_of(case), 0, None, EACH):
        stored, mesh = StoredBranchCycle.from_cycle(point, case.accuracy), mesh_of_orbit(point.orbit)
        longer = ceil(1.7 * mesh.interval_count) + 1
        fine = replace(
            mesh, order=mesh.order + 6, interval_count=longer, stage_count=min(mesh.stage_count + 1, 6)
        )
        exact = newton_step(solve_by_newton(fine.interpolated_orbit(point.orbit), 1e-11, NewtonWorkspace()))
        extrema, slope = CycleMotion(exact.orbit).tip_extrema, point.calibration.relative_tip_y_sensitivity
        y, multipliers = extrema["tip_y_max"], nontrivial_multipliers_and_error(exact)[0]
        others = max(abs(getattr(stored.measures, name) - value) for name, value in extrema.items())
        errors = stored.errors
        off = {
            "period": (abs(stored.measures.period / exact.orbit.period - 1), errors.period_error),
            "y": (abs(stored.measures.tip_y_max / y - 1), errors.amplitude_error),
            "others": (others / abs(y), errors.extrema_error),
            "multiplier": (abs(stored.multiplier - abs(multipliers[0])), errors.multiplier_error),
        }
        rounding = ROUNDING * max(1.0, slope)
        wrong += [
            f"{name} at {stored.parameter_value!r}: {a} > {b}"
            for name, (a, b) in off.items()
            if a > b + rounding
        ]
        if stored.parameter_value_error > case.accuracy or (
            slope <= STEEP and errors.largest_weighted_error > case.accuracy
        ):
            wrong.append(
                f"errors at {stored.parameter_value!r}: {stored.parameter_value_error}, {errors}, {slope}"
            )
    return wrong


@pytest.mark.parametrize("case", few([*CASES.values()], 2), ids=few([*CASES], 2))
def test_cycles_of_a_branch_are_as_near_to_the_true_ones_at_their_force_as_they_say(case):
    assert broken_promises(case) == []


@pytest.mark.long
@pytest.mark.parametrize("first", range(0, RODS, BATCH))
def test_branches_of_random_rods_keep_their_promises(first):
    wrong = {index: broken_promises(random_case(index)) for index in range(first, min(first + BATCH, RODS))}
    assert not any(wrong.values()), wrong


def test_branch_is_exercised_where_it_is_steep_and_where_it_is_not():
    """The fold and the Hopf point of Fig. 2c's branch are steep; the promise there is another one."""
    slopes = [
        point.calibration.relative_tip_y_sensitivity
        for point in cycles_of(CASES["a fold close to the Hopf point"])
    ]
    assert min(slopes) < 2
    assert max(slopes) > STEEP
