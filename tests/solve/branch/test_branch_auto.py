"""AUTO-07p on the same semi-discrete rod, with its own bifurcation detection, beside branches of cycles."""

import re
from functools import partial
from pathlib import Path as CyclePlace

import numpy as np
import pytest
from surveyed import survey_only

from benchmarks.auto import auto_program, run_auto, table_lines
from benchmarks.limit_cycle.auto_cycles import rod_file, start_file
from benchmarks.limit_cycle.auto_equations import EQUATIONS
from rodsweep.determinant.parameter_path import ParameterPath
from rodsweep.discretization.elements.mesh import uniform_mesh
from rodsweep.discretization.stress.form import StressForm
from rodsweep.model.rod import Rod
from rodsweep.solve.branch.arc_length_step import cycle_at_length, next_cycle
from rodsweep.solve.branch.branch_mesh_choice import is_error_measurement_due, solve_on_sufficient_mesh
from rodsweep.solve.branch.range_end import cycle_at_range_end, range_end_condition
from rodsweep.solve.branch.special.detection import special_points_and_completeness
from rodsweep.solve.branch.special.special_point import SpecialPointKind
from rodsweep.solve.branch.start.first_cycle import first_cycle
from rodsweep.solve.branch.start.hopf_point import hopf_branch_start
from rodsweep.solve.changes.thresholds_along_path import find_imaginary_axis_crossings
from rodsweep.solve.cycle.accuracy.refinement import refined_cycle
from rodsweep.solve.cycle.hopf_start import hopf_point_below_force, orbit_from_hopf
from rodsweep.solve.orbit.matrix.workspace import NewtonWorkspace
from rodsweep.solve.orbit.newton import solve_by_newton

CONSTANTS = """NDIM={unknowns}, IPS=2, IRS=0, ILP=1, ISP=2, ISW=1, MXBF=0, JAC=1, IID=2
ICP=[1, 11], SP=['BP0', 'PD0'], NTST={intervals}, NCOL=4, IAD=3
NMX={most}, NPR={most}, ITMX=30, ITNW=20, NWTN=3, EPSL=1e-8, EPSU=1e-8, EPSS=1e-7
DS={step!r}, DSMIN=1e-6, DSMAX={longest!r}, IADS=1
"""
"""Pseudo-arclength in all unknowns, folds and torus points located by AUTO's own test functions."""
FOLD, TORUS = "5", "8"
"""Third word of a line of fort.7."""
ACCURACY = 1e-7


@pytest.fixture(scope="module")
def auto(tmp_path_factory):
    program = auto_program(tmp_path_factory.mktemp("auto"), EQUATIONS)
    if program is None:
        pytest.skip("AUTO-07p or gfortran is not installed")
    return program


def branch_of_auto(program, rod, setting, place):
    """Lines of fort.7 as (kind, F), and the multipliers of the last cycle; by order, intervals, ..."""
    order, intervals, step, most = setting
    form = StressForm(rod, uniform_mesh(1, 16))
    memory = NewtonWorkspace()
    near = refined_cycle(orbit_from_hopf(form, hopf_point_below_force(rod), memory), 1e-6, memory).orbit
    first = solve_by_newton(near.on_mesh(uniform_mesh(1, order), 40, 5), 1e-10, memory).orbit
    (place / "rod").write_bytes(rod_file(first.form))
    (place / "start").write_bytes(start_file(first, 4 * intervals))
    unknowns = first.form.unknown_count
    constants = CONSTANTS.format(
        unknowns=unknowns, intervals=intervals, most=most, step=step, longest=4 * step
    )
    run_auto(program, place, constants)
    lines = [(words[2], float(words[4])) for words in table_lines(place)]
    pairs = re.findall(r"Multiplier +\d+ +(\S+) +(\S+) ", CyclePlace(place / "fort.9").read_text())
    return lines, np.array([complex(*map(float, pair)) for pair in pairs[-unknowns:]])


def branch_of_this(rod, kind, F):
    """The special point of a kind on the branch from the first Hopf point, and the cycle at F beyond it."""
    straight = Rod(F=0.0, k1=rod.k1, k2=rod.k2, gamma3=rod.gamma3)
    crossing = find_imaginary_axis_crossings(ParameterPath(straight, "F"), 0.0, rod.F).thresholds[0]
    here, special = (
        first_cycle(hopf_branch_start(ParameterPath(straight, "F"), crossing), ACCURACY, NewtonWorkspace()),
        None,
    )
    while True:
        there = next_cycle(here, ACCURACY)
        for point in special_points_and_completeness(
            here, there, partial(cycle_at_length, accuracy=ACCURACY), ACCURACY
        )[0]:
            if point.kind == kind:
                special = point
        if special is not None and (there.parameter_coordinate - F) * (here.parameter_coordinate - F) <= 0:
            edge = range_end_condition(here, F)
            return special, solve_on_sufficient_mesh(
                cycle_at_range_end(here, there, edge, ACCURACY), ACCURACY, edge
            )
        here = (
            solve_on_sufficient_mesh(there, ACCURACY) if is_error_measurement_due(there, ACCURACY) else there
        )


@pytest.mark.long
def test_auto_has_the_same_fold_and_the_same_unstable_cycle_beyond(auto, tmp_path):
    rod = Rod(F=85.5, k1=150.0, k2=1e4, gamma3=1e-4)
    lines, multipliers = branch_of_auto(auto, rod, (14, 15, 0.05, 16), tmp_path)
    (place,) = [F for kind, F in lines if kind == FOLD]
    fold, cycle = branch_of_this(rod, SpecialPointKind.fold, lines[-1][1])
    assert fold.parameter_value == pytest.approx(place, rel=1e-8)
    largest = multipliers[np.argmax(np.abs(multipliers))]
    assert largest.real > 1.0004
    assert cycle.cycle.multipliers[0] == pytest.approx(largest, abs=2e-5)


@survey_only
def test_auto_has_the_same_torus_point_and_the_same_pair_beyond(auto, tmp_path):
    rod = Rod(F=205.2, k1=1e4, k2=1e2, gamma3=1e-2)
    lines, multipliers = branch_of_auto(auto, rod, (24, 34, 0.1, 4), tmp_path)
    (place,) = [F for kind, F in lines if kind == TORUS]
    torus, cycle = branch_of_this(rod, SpecialPointKind.torus, lines[-1][1])
    assert torus.parameter_value == pytest.approx(place, rel=1e-6)
    pair = multipliers[np.argmax(np.abs(multipliers))]
    assert abs(pair) > 1.005
    ours = cycle.cycle.multipliers[0]
    assert abs(complex(ours.real, abs(ours.imag)) - complex(pair.real, abs(pair.imag))) < 3e-5
