"""Every number of a solver's settings, halved and doubled: answers stay within the errors that they state.

An honest status in place of an answer counts too. Every field of every settings object is found by
introspection, but for those of ANOTHER_START; an object without a case fails. The suite takes every
nineteenth field, without the slow cases; RODSWEEP_RODS=1 takes all (`make survey`).
"""

import importlib
import os
import pkgutil
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import fields, is_dataclass, replace
from functools import cache
from typing import Any, NamedTuple

import numpy as np
import pytest

import rodsweep.determinant
import rodsweep.solve
from rodsweep.determinant.parameter_path import Path
from rodsweep.determinant.parameter_plane import Plane, PlaneAxis
from rodsweep.discretization.beam import Beam
from rodsweep.discretization.elements.mesh import mesh
from rodsweep.model.rod import Rod
from rodsweep.solve.branch.branches import BranchRequest, solve_branches
from rodsweep.solve.branch.special.curves import CurveLimits
from rodsweep.solve.branch.special.point import SpecialKind
from rodsweep.solve.changes.along_path import pair_crossings
from rodsweep.solve.changes.boundary_curves import trace
from rodsweep.solve.cycle.limit_cycle import Cycle, CycleRequest, CycleStatus, solve_cycle
from rodsweep.solve.cycle.marched import solve_by_integration
from rodsweep.solve.hopf.bautin_curves import BautinSpace, bautin_curve, on_curve
from rodsweep.solve.hopf.coefficient_errors import hopf_coefficients
from rodsweep.solve.hopf.generalised import curve_criticality
from rodsweep.solve.hopf.hopf_beside import subcritical_hopf_beside
from rodsweep.solve.modes.leading_modes import ModesRequest, solve_modes
from rodsweep.solve.motion.integrator import Ending, forget_integrators, integrator
from rodsweep.solve.motion.time_scheme import TimeScheme
from rodsweep.solve.orbit.matrix.workspace import NewtonWorkspace
from rodsweep.solve.point import FAILURES

ALL = "RODSWEEP_RODS" in os.environ
EACH = 1 if ALL else 19
ROUNDING = 1e-11
"""Relative; of numbers whose stated error is smaller."""
SOFT_IN_SHEAR = Rod(F=0.0, k1=30.0, k2=0.5, gamma3=0.1)
BEATING = Rod(F=0.0, k1=1e4, k2=1e2, gamma3=1e-2)
WITH_FOLD = Rod(F=0.0, k1=149.9, k2=1e4, gamma3=1e-4)
ANOTHER_START = {("INTEGRATOR", "relaxation_share"), ("INTEGRATOR", "relaxation_steps")}
"""Fields that define the state from which a motion starts: another value is another motion."""
GENERALISED_HOPF_AT = 75.3972626336484526, 147.921519683199662, 770.860809443855688
"""F, k1 and frequency of a fold of the Hopf curve, of which one branch has a generalised Hopf point."""

Answer = dict[str, tuple[float, float]] | None
"""Numbers with their errors, both absolute; None: a status or an exception says that the request failed."""


def branch_answer(rod: Rod, start: float, stop: float, accuracy: float) -> Answer:
    """Special points of all branches: where they are, their period and size, and where a branch ends."""
    request = BranchRequest("F", start, stop, accuracy, False, 500, 50)
    found = solve_branches(rod, request)
    if found.status.value:
        return None
    answer: dict[str, tuple[float, float]] = {}
    for number, curve in enumerate(found.curves):
        for place, point in enumerate(curve.special):
            name = f"branch {number}, special point {place}, {point.kind.name}: "
            answer[name + "at"] = point.at, point.error
            answer[name + "period"] = point.period, point.period_error * point.period
            answer[name + "size"] = point.tip_y_max, point.size_error * abs(point.tip_y_max)
    return answer


def small_branches(accuracy: float) -> Answer:
    return branch_answer(WITH_FOLD, 60.0, 110.0, accuracy)


def lopsided_branches(accuracy: float) -> Answer:
    return branch_answer(SOFT_IN_SHEAR, 0.0, 20.5, accuracy)


@cache
def fold() -> Any:
    """The fold of a branch, from which a curve of folds is followed."""
    request = BranchRequest("F", 60.0, 110.0, 1e-7, False, 500, 50)
    points = [point for curve in solve_branches(WITH_FOLD, request).curves for point in curve.special]
    return next(point for point in points if point.kind is SpecialKind.fold)


def curve_of_folds(accuracy: float) -> Answer:
    """End of a curve of folds on an edge of the plane; the curve's accuracy is a setting itself."""
    plane = PlaneAxis("F", 60.0, 110.0), PlaneAxis("k1", 149.5, 150.0)
    try:
        points, end = CurveLimits(SpecialKind.fold, *plane, NewtonWorkspace(), 1.0).followed(fold(), 149.9)
    except FAILURES:
        return None
    last = points[-1]
    return {f"{end.name} at": (last.at, last.error), "row": (last.row, ROUNDING)}


def coefficients(accuracy: float) -> Answer:
    """Normal form of a Hopf point of a rod that is soft in shear, at a high force."""
    crossing = pair_crossings(Path(SOFT_IN_SHEAR, "F"), 0.0, 25.0).crossings[-1]
    try:
        found = hopf_coefficients(SOFT_IN_SHEAR.changed(F=crossing.at), crossing, accuracy)
    except FAILURES:
        return None
    c, slope = found.landau, found.growth_slope
    return {
        "Re c": (c.real, found.landau_error * abs(c)),
        "Im c": (c.imag, found.landau_error * abs(c)),
        "Re dw/dF": (slope.real, found.growth_slope_error * abs(slope)),
        "Im dw/dF": (slope.imag, found.growth_slope_error * abs(slope)),
    }


@cache
def hopf_curve() -> tuple[Plane, Any]:
    axes = PlaneAxis("F", 60.0, 110.0), PlaneAxis("k1", 145.0, 160.0)
    plane = Plane(Rod(F=0.0, k1=200.0, k2=1e4, gamma3=1e-4), axes)
    start = tuple(axis.scaled(value) for axis, value in zip(axes, GENERALISED_HOPF_AT[:2], strict=True))
    return plane, trace(0.0, plane, start, GENERALISED_HOPF_AT[2])


def generalised_hopf(accuracy: float) -> Answer:
    found = curve_criticality(*hopf_curve(), accuracy)
    if found.unlocated or len(found.points) != 1:
        return None
    (point,) = found.points
    return {name: (point.values[i], point.errors[i]) for i, name in enumerate(("F", "k1"))}


def curve_of_generalised_hopf(accuracy: float) -> Answer:
    """Where the curve of generalised Hopf points over k2 has the values that are asked for."""
    plane, curve = hopf_curve()
    (point,) = curve_criticality(plane, curve, 1e-10).points
    asked = np.array([8e3, 1.2e4, 1e4])
    space = BautinSpace(plane.rod, (*plane.axes, PlaneAxis("k2", 8e3, 1.2e4)), asked, accuracy)
    found = bautin_curve(space, on_curve(point, 1e4))
    answer = {}
    for value in asked[:2]:
        at = [each for each in found.points if abs(each.values[2] / value - 1) < 1e-12]
        if not at:
            return None
        for i, name in enumerate(("F", "k1")):
            answer[f"{name} at k2 = {value}"] = at[0].values[i], at[0].errors[i]
    return answer


def beside(accuracy: float) -> Answer:
    """The subcritical Hopf point above a force; its search states no error, only the digits it needs."""
    found = subcritical_hopf_beside(WITH_FOLD.changed(k1=200.0, F=156.0))
    if found is None:
        return None
    return {"F": (found.F, 1e-9 * found.F), "unstable y": (found.unstable_y, 2e-3 * found.unstable_y)}


def modes(accuracy: float) -> Answer:
    """Condition numbers and transient growth of a stable rod with a boundary layer at the tip."""
    found = solve_modes(Rod(F=20.0, k1=30.0, k2=1e2, gamma3=1e-2), ModesRequest(4, accuracy, 9, growth=True))
    if found.status.value:
        return None
    growth, vectors = found.growth, found.vectors
    answer = {
        f"condition {i}": (value, vectors.condition_error[i] * value)
        for i, value in enumerate(vectors.condition)
    }
    answer["growth"] = growth.transient_growth, growth.growth_error * growth.transient_growth
    answer["abscissa"] = growth.numerical_abscissa, growth.abscissa_error
    return answer


def motion(accuracy: float) -> Answer:
    """State after a free motion. Its error is that of the scheme's tolerance, some steps' worth."""
    beam = Beam(Rod(F=50.0, k1=1e4, k2=1e2, gamma3=1e-2), mesh(1, 16))
    u = beam.mesh.positions
    rest = beam.strains(np.zeros(beam.layout.unknowns))
    wave = np.array([0 * u, 0.1 * np.sin(2 * u), np.cos(4 * u)])
    start = beam.unknown(rest + 0.1 * (1 - u) * wave)
    forget_integrators()
    run = integrator(beam.mesh, TimeScheme(tolerance=accuracy)).run(beam, start, 0.05)
    if run.ending is not Ending.reached:
        return None
    size = float(np.abs(run.states[0]).max())
    return {f"z{i}": (float(z), 30 * accuracy * size) for i, z in enumerate(run.states[-1])}


def cycle_answer(cycle: Cycle) -> Answer:
    """Period, extrema and largest multiplier of a cycle; of a torus the multiplier of the cycle inside."""
    if not cycle.status.succeeded:
        return None
    errors = cycle.errors
    if cycle.status is CycleStatus.torus:
        return {"multiplier": (cycle.multiplier, errors.multiplier_error)}
    size = abs(cycle.measures.tip_y_max)
    return {
        "period": (cycle.measures.period, errors.period_error * cycle.measures.period),
        "tip y": (cycle.measures.tip_y_max, errors.amplitude_error * size),
        "tip x": (cycle.measures.tip_x_min, errors.extrema_error * size),
        "multiplier": (cycle.multiplier, errors.multiplier_error),
    }


def request(accuracy: float, amplitude: float = 0.1, start: str = "mode") -> CycleRequest:
    return CycleRequest(accuracy, amplitude, 3, 16, 4, 5, 400, start)


def single_cycle(accuracy: float) -> Answer:
    return cycle_answer(solve_cycle(BEATING.changed(F=60.0), request(accuracy)))


def cycles_of_a_chain(accuracy: float) -> Answer:
    """The last of three cycles, of which each predicts the next."""
    last = None
    for F in (60.0, 64.0, 72.0):
        cycle = solve_cycle(
            BEATING.changed(F=F), request(accuracy, start="neighbour"), last.neighbour if last else None, "F"
        )
        last = cycle
    return cycle_answer(last)


def cycle_beside_the_hopf_point(accuracy: float) -> Answer:
    """From the leading mode and from the Hopf point, of which the second answer is taken with its errors."""
    rod = BEATING.changed(F=27.6)
    slow = cycle_answer(solve_cycle(rod, request(accuracy, 0.01)))
    found = cycle_answer(solve_cycle(rod, request(accuracy, start="hopf")))
    if slow is None or found is None:
        return None
    return {f"slow {name}": value for name, value in slow.items()} | found


def cycle_by_integration(accuracy: float) -> Answer:
    cycle = solve_by_integration(BEATING.changed(F=60.0), request(accuracy))
    found = cycle_answer(cycle)
    return found and {name: value for name, value in found.items() if name != "multiplier"}


def torus(accuracy: float) -> Answer:
    return cycle_answer(solve_cycle(BEATING.changed(F=207.0), request(accuracy)))


class Case(NamedTuple):
    """A problem and the accuracies of the answer and of the reference."""

    solve: Callable[[float], Answer]
    accuracy: float
    finer: float


BRANCH = Case(small_branches, 1e-6, 1e-8)
LOPSIDED = Case(lopsided_branches, 1e-4, 1e-6)
CURVE = Case(curve_of_folds, 1e-7, 1e-7)
HOPF = Case(coefficients, 1e-6, 1e-11)
BAUTIN_POINT = Case(generalised_hopf, 1e-10, 1e-12)
BAUTIN_CURVE = Case(curve_of_generalised_hopf, 1e-10, 1e-12)
BESIDE = Case(beside, 1e-3, 1e-3)
MODES = Case(modes, 1e-8, 1e-10)
MOTION = Case(motion, 1e-6, 1e-9)
SINGLE = Case(single_cycle, 1e-6, 1e-9)
CHAIN = Case(cycles_of_a_chain, 1e-6, 1e-9)
BESIDE_HOPF = Case(cycle_beside_the_hopf_point, 1e-6, 1e-9)
INTEGRATED = Case(cycle_by_integration, 1e-4, 1e-5)
TORUS = Case(torus, 1e-6, 1e-7)
SLOW = (LOPSIDED, TORUS)
"""Cases that take seconds."""
CASES = {
    "SETTLING": BRANCH,
    "BRANCH_ERRORS": BRANCH,
    "ENDINGS": LOPSIDED,
    "ASYMMETRIC_START": LOPSIDED,
    "BEGINNING": BRANCH,
    "BRANCHES": BRANCH,
    "BRANCH_WORK": BRANCH,
    "LOCATING": BRANCH,
    "LEAST_STRETCH": BRANCH,
    "ARC_STEPS": BRANCH,
    "ORBIT_NEWTON": BRANCH,
    "ORBIT_MESH": BRANCH,
    "WORKSPACE": BRANCH,
    "MULTIPLIERS": BRANCH,
    "CURVE_START": CURVE,
    "CURVE_IDENTITY": CURVE,
    "ACROSS_CURVE": CURVE,
    "AUGMENTED": CURVE,
    "CYCLE_CURVES": CURVE,
    "CURVE_STEPS": CURVE,
    "NORMAL_FORM": HOPF,
    "COEFFICIENT": HOPF,
    "GENERALISED_HOPF": BAUTIN_POINT,
    "BOUNDARY": BAUTIN_CURVE,
    "PLANE": BAUTIN_CURVE,
    "BAUTIN": BAUTIN_CURVE,
    "BAUTIN_STEPS": BAUTIN_CURVE,
    "HOPF_BESIDE": BESIDE,
    "MODE_MESH": MODES,
    "MODE_ITERATION": MODES,
    "LEADING_MODES": MODES,
    "GROWTH": MODES,
    "MODE_PROBLEM": MODES,
    "NORM_MAXIMUM": MODES,
    "ABSCISSA": MODES,
    "PROPAGATOR": MODES,
    "INTEGRATOR": MOTION,
    "CYCLE_ERRORS": SINGLE,
    "COARSER_MESHES": SINGLE,
    "MINIMAL_PERIOD": SINGLE,
    "REFINEMENT": SINGLE,
    "FROM_MOTION": SINGLE,
    "MOTION_MESH": SINGLE,
    "RETURNS": SINGLE,
    "SHAPE_TRACE": SINGLE,
    "TRANSIENT": SINGLE,
    "CALIBRATION": CHAIN,
    "COMPARISON": CHAIN,
    "NEIGHBOUR": CHAIN,
    "PREDICTION": CHAIN,
    "PARAMETER_STEPS": CHAIN,
    "HOPF_START": BESIDE_HOPF,
    "SMALL_MOTION": BESIDE_HOPF,
    "STRAIGHT_ROD": BESIDE_HOPF,
    "AMPLITUDE_EQUATION": BESIDE_HOPF,
    "SCHEMES": BESIDE_HOPF,
    "MARCHING": INTEGRATED,
    "TORUS_TEST": TORUS,
}
ROOMS = (
    "branch.",
    "cycle.",
    "orbit.",
    "hopf.",
    "modes.",
    "continuation.",
    "motion.",
)
"""Subpackages of `rodsweep.solve` whose numbers are fields of settings."""


def solver_modules() -> Iterator[str]:
    """Names of all modules of the solvers and of the determinant."""
    for package in (rodsweep.solve, rodsweep.determinant):
        for found in pkgutil.walk_packages(package.__path__, package.__name__ + "."):
            short = found.name.removeprefix("rodsweep.solve.")
            if short.startswith((*ROOMS, "rodsweep.determinant")):
                yield found.name


@cache
def settings() -> dict[str, Any]:
    """Settings objects by name: frozen data classes called `...Settings`, and the control of step lengths."""
    found = {}
    for module in solver_modules():
        for name, value in vars(importlib.import_module(module)).items():
            kind = type(value)
            if is_dataclass(kind) and (kind.__name__.endswith("Settings") or kind.__name__ == "StepControl"):
                found[name] = value
    return dict(sorted(found.items()))


def scaled(value: Any, factor: float) -> Any:
    """A field's value times a factor; whole numbers stay whole and positive."""
    if isinstance(value, tuple):
        return tuple(scaled(each, factor) for each in value)
    if isinstance(value, int):
        return max(1, round(value * factor))
    return value * factor


FIELDS = [
    (name, field.name, factor)
    for name, value in settings().items()
    for field in fields(value)
    for factor in (0.5, 2.0)
    if scaled(getattr(value, field.name), factor) != getattr(value, field.name)
    if ALL or CASES.get(name) not in SLOW
    if (name, field.name) not in ANOTHER_START
]


@contextmanager
def replaced(name: str, field: str, factor: float) -> Iterator[None]:
    """Another value of one field, in every module that has the settings object."""
    old = settings()[name]
    new = replace(old, **{field: scaled(getattr(old, field), factor)})
    users = [
        (vars(module), key)
        for title, module in list(sys.modules.items())
        if title.startswith("rodsweep.")
        for key, value in vars(module).items()
        if value is old
    ]
    for place, key in users:
        place[key] = new
    try:
        yield
    finally:
        for place, key in users:
            place[key] = old


@cache
def reference(case: Case) -> Answer:
    return case.solve(case.finer)


def differences(found: Answer, exact: Answer) -> list[str]:
    """Numbers that are further from the reference than both errors allow; an honest failure has none."""
    assert exact is not None
    if found is None:
        return []
    if found.keys() != exact.keys():
        return [f"other numbers: {sorted(found.keys() ^ exact.keys())}"]
    return [
        f"{key}: {value!r} +- {error:.1e} is not {exact[key][0]!r} +- {exact[key][1]:.1e}"
        for key, (value, error) in found.items()
        if not abs(value - exact[key][0]) <= error + exact[key][1] + ROUNDING * abs(exact[key][0])
    ]


def test_every_settings_object_has_a_case():
    assert CASES.keys() - settings().keys() == set()
    assert settings().keys() - CASES.keys() == set()


def test_settings_are_frozen_and_have_keywords_only():
    for value in settings().values():
        assert type(value).__dataclass_params__.frozen
        assert all(field.kw_only for field in fields(value))


@pytest.mark.parametrize(("name", "field", "factor"), FIELDS[::EACH])
def test_a_setting_moves_no_answer_beyond_its_error(name, field, factor):
    case = CASES[name]
    reference(case)
    with replaced(name, field, factor):
        found = case.solve(case.accuracy)
    assert differences(found, reference(case)) == []
