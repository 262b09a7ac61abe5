"""Every number of a solver's settings, halved and doubled: answers stay within the errors that they state.

A status in place of an answer is honest, but no answer: at most `MOST_WITHOUT_ANSWER` of a field's runs may
end so. Every field of every settings object is found by introspection, but for those of ANOTHER_START; an
object without a case fails. Compiled functions that read a changed field are compiled again. The suite takes
every sixty-second field, without the slow cases and those of `READ_BY_MOST`; RODSWEEP_RODS=1 takes all
(`make survey`).
"""

import importlib
import os
import pkgutil
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import fields, is_dataclass, replace
from functools import cache
from itertools import count, pairwise
from typing import Any, NamedTuple

import numpy as np
import pytest
from followed_lines import solve_stretch
from numba.core.bytecode import FunctionIdentity
from numba.core.caching import NullCache
from numba.core.ccallback import CFunc
from numba.core.dispatcher import Dispatcher

import rodsweep.determinant
import rodsweep.discretization
import rodsweep.solve
from rodsweep.determinant.certificate.box_of_all_eigenvalues import box_from_sqrt_frequency_bound
from rodsweep.determinant.parameter_path import ParameterPath
from rodsweep.determinant.parameter_plane import ParameterPlane, PlaneAxis
from rodsweep.determinant.stability_changes import crossings_between
from rodsweep.discretization.elements.mesh import uniform_mesh
from rodsweep.discretization.explicit_system import ExplicitSystem
from rodsweep.discretization.straight.longitudinal_modes import longitudinal_eigenvalues_and_errors
from rodsweep.model.compiled.digest import kernel_digest, kernel_of
from rodsweep.model.compiled.kernel_constants import KernelConstants
from rodsweep.model.material.profile import Profile
from rodsweep.model.material.rod_material import RodMaterial
from rodsweep.model.rod import Rod
from rodsweep.solve.backend.solver_pools import destroy_pooled_solvers
from rodsweep.solve.branch import branches
from rodsweep.solve.branch.branch_limits import BranchRequest
from rodsweep.solve.branch.branches import solve_branches
from rodsweep.solve.branch.special.curve_problem import SpecialCurveProblem
from rodsweep.solve.branch.special.special_point import SpecialPointKind
from rodsweep.solve.changes.diagram.boundaries import boundary_curves_through, seed_of
from rodsweep.solve.changes.diagram.boundary_curves import trace_boundary
from rodsweep.solve.changes.diagram.rows import RowRequest, solve_row
from rodsweep.solve.changes.thresholds import Thresholds, ThresholdsRequest, solve_thresholds
from rodsweep.solve.changes.thresholds_along_path import find_imaginary_axis_crossings
from rodsweep.solve.cycle.by_integration import solve_by_integration
from rodsweep.solve.cycle.limit_cycle import CycleOutcome, CycleRequest, CycleStatus, solve_cycle
from rodsweep.solve.cycle.straight_rod import (
    eigenvalues_to_follow,
    straight_rod_stability,
    straight_rod_stability_in_chain,
)
from rodsweep.solve.hopf.bautin_curves import BautinProblem, bautin_curve
from rodsweep.solve.hopf.bautin_points import curve_criticality
from rodsweep.solve.hopf.hopf_coefficients import hopf_coefficients
from rodsweep.solve.hopf.subcritical_hopf import subcritical_hopf_near
from rodsweep.solve.modes.leading_modes import ModesRequest, solve_modes
from rodsweep.solve.motion.integrator import EndReason, destroy_integrators, integrator
from rodsweep.solve.motion.time_scheme import TimeScheme
from rodsweep.solve.motion.tip_target import bent_state_with_tip_at
from rodsweep.solve.orbit.matrix.workspace import NewtonWorkspace
from rodsweep.solve.point_outcome import FAILURE_EXCEPTIONS
from rodsweep.solve.spectrum.krylov_schur_on_two_meshes import solve_on_two_meshes
from rodsweep.solve.spectrum.path.followed_leader import follow_leading_eigenvalue
from rodsweep.solve.spectrum.path.leader_in_range import next_range
from rodsweep.solve.spectrum.path.neighbouring_rods import NeighbouringRods
from rodsweep.solve.spectrum.search import Spectrum, SpectrumRequest, solve_spectrum

ALL = "RODSWEEP_RODS" in os.environ
FIRST, EACH = (0, 1) if ALL else (31, 62)
ROUNDING = 1e-11
"""Relative; of numbers whose stated error is smaller."""
SOFT_IN_SHEAR = Rod(F=0.0, k1=30.0, k2=0.5, gamma3=0.1)
BEATING = Rod(F=0.0, k1=1e4, k2=1e2, gamma3=1e-2)
STRONGLY_UNSTABLE = Rod(F=0.0, k1=251.35, k2=10.5379, gamma3=1.0956e-7, gamma1=0.91638)
NEAR_CLOSED_BRANCH = Rod(F=0.0, k1=133.3, k2=1e4, gamma3=0.006)
FIG_2C = Rod(F=0.0, k1=200.0, k2=1e4, gamma3=1e-4)
WITH_FOLD = Rod(F=0.0, k1=149.9, k2=1e4, gamma3=1e-4)
ANOTHER_START = {
    ("INTEGRATOR_SETTINGS", "relaxation_duration_over_period"),
    ("INTEGRATOR_SETTINGS", "relaxation_steps_per_period"),
    ("INTEGRATOR_SETTINGS", "relaxation_shortening_if_stored"),
    ("INTEGRATOR_SETTINGS", "relaxation_tolerance"),
}
"""Fields that define the state from which a motion starts: another value is another motion."""
GENERALISED_HOPF_AT = 75.3972626336484526, 147.921519683199662, 770.860809443855688
"""F, k1 and frequency of a fold of the Hopf curve, of which one branch has a generalised Hopf point."""

Answer = dict[str, tuple[float, float]] | None
"""Numbers with their errors, both absolute; None: a status or an exception says that the request failed."""


def branch_answer(
    rod: Rod, start: float, stop: float, accuracy: float, known: tuple[Any, ...] = ()
) -> Answer:
    """Special points of all branches, also through the points `known`: where they are, their period and size,
    and where a branch ends."""
    request = BranchRequest("F", start, stop, accuracy, False, 500, 50)
    found = solve_branches(rod, request, starts=known)
    if found.status.value:
        return None
    answer: dict[str, tuple[float, float]] = {}
    for number, curve in enumerate(found.curves):
        for place, point in enumerate(curve.special_points):
            name = f"branch {number}, special point {place}, {point.kind.name}: "
            answer[name + "at"] = point.parameter_value, point.error
            answer[name + "period"] = point.period, point.period_error * point.period
            answer[name + "size"] = point.tip_y_max, point.tip_y_max_error * abs(point.tip_y_max)
    return answer


@contextmanager
def within_range_only() -> Iterator[None]:
    """Turns the search for branches beyond the range off."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(branches, "regions_beyond_range", lambda *_: [])
        yield


def small_branches(accuracy: float) -> Answer:
    return branch_answer(WITH_FOLD, 60.0, 110.0, accuracy)


def lopsided_branches(accuracy: float) -> Answer:
    return branch_answer(SOFT_IN_SHEAR, 0.0, 20.5, accuracy)


def branch_of_legs(accuracy: float) -> Answer:
    """Cycles with multipliers of 1e20, whose orbits are divided into legs; no branches from beyond."""
    with within_range_only():
        return branch_answer(STRONGLY_UNSTABLE, 181.0, 182.8, accuracy)


@cache
def fold() -> Any:
    """The fold of a branch, from which a curve of folds is followed."""
    request = BranchRequest("F", 60.0, 110.0, 1e-7, False, 500, 50)
    points = [point for curve in solve_branches(WITH_FOLD, request).curves for point in curve.special_points]
    return next(point for point in points if point.kind is SpecialPointKind.fold)


def detached_branch(accuracy: float) -> Answer:
    """The branch through a known fold, whose Hopf points lie outside the range; not followed from there."""
    with within_range_only():
        return branch_answer(WITH_FOLD, 85.3, 85.5, accuracy, (fold(),))


def branch_from_beyond(accuracy: float) -> Answer:
    """The branch between two Hopf points, at F = 49.76 and 155.6, that both lie outside the range."""
    return branch_answer(FIG_2C, 160.0, 180.0, accuracy)


def curve_of_folds(accuracy: float) -> Answer:
    """End of a curve of folds on an edge of the plane; the curve's accuracy is a setting itself."""
    plane = PlaneAxis("F", 60.0, 110.0), PlaneAxis("k1", 149.5, 150.0)
    try:
        points, end = SpecialCurveProblem(SpecialPointKind.fold, *plane, NewtonWorkspace(), 1.0).follow_from(
            fold(), 149.9
        )
    except FAILURE_EXCEPTIONS:
        return None
    last = points[-1]
    return {
        f"{end.name} at": (last.branch_parameter_value, last.branch_parameter_error),
        "row": (last.row_parameter_value, ROUNDING),
    }


@cache
def fold_near_closed_branch() -> Any:
    """The fold at k1 = 133.3, from which a curve of folds passes its smallest k1."""
    request = BranchRequest("F", 60.0, 120.0, 1e-7, False, 500, 50)
    curves = solve_branches(NEAR_CLOSED_BRANCH, request).curves
    points = (point for curve in curves for point in curve.special_points)
    return next(point for point in points if point.kind is SpecialPointKind.fold)


def extremum_of_folds(accuracy: float) -> Answer:
    """Smallest k1 of a curve of folds, where both parameters exchange their roles."""
    plane = PlaneAxis("F", 60.0, 120.0), PlaneAxis("k1", 133.0, 134.0)
    problem = SpecialCurveProblem(SpecialPointKind.fold, *plane, NewtonWorkspace(), -1.0)
    try:
        points, _ = problem.follow_from(fold_near_closed_branch(), NEAR_CLOSED_BRANCH.k1)
    except FAILURE_EXCEPTIONS:
        return None
    answer = {}
    for number, point in enumerate(p for p in points if p.row_parameter_error_at_extremum):
        answer[f"extremum {number}, F"] = point.branch_parameter_value, point.branch_parameter_error
        answer[f"extremum {number}, k1"] = point.row_parameter_value, point.row_parameter_error_at_extremum
    return answer


def coefficients(accuracy: float) -> Answer:
    """Normal form of a Hopf point of a rod that is soft in shear, at a high force."""
    crossing = find_imaginary_axis_crossings(ParameterPath(SOFT_IN_SHEAR, "F"), 0.0, 25.0).thresholds[-1]
    try:
        found = hopf_coefficients(SOFT_IN_SHEAR.with_values(F=crossing.value), crossing, accuracy)
    except FAILURE_EXCEPTIONS:
        return None
    c, slope = found.landau, found.growth_slope
    return {
        "Re c": (c.real, found.landau_error * abs(c)),
        "Im c": (c.imag, found.landau_error * abs(c)),
        "Re dw/dF": (slope.real, found.growth_slope_error * abs(slope)),
        "Im dw/dF": (slope.imag, found.growth_slope_error * abs(slope)),
    }


@cache
def hopf_curve() -> tuple[ParameterPlane, Any]:
    axes = PlaneAxis("F", 60.0, 110.0), PlaneAxis("k1", 145.0, 160.0)
    plane = ParameterPlane(Rod(F=0.0, k1=200.0, k2=1e4, gamma3=1e-4), axes)
    start = tuple(
        axis.scaled_coordinate(value) for axis, value in zip(axes, GENERALISED_HOPF_AT[:2], strict=True)
    )
    return plane, trace_boundary(0.0, plane, start, GENERALISED_HOPF_AT[2])


def generalised_hopf(accuracy: float) -> Answer:
    found = curve_criticality(*hopf_curve(), accuracy)
    if found.unlocated_sign_change_count or len(found.bautin_points) != 1:
        return None
    (point,) = found.bautin_points
    return {
        name: (point.parameter_values[i], point.parameter_errors[i]) for i, name in enumerate(("F", "k1"))
    }


def curve_of_generalised_hopf(accuracy: float) -> Answer:
    """Where the curve of generalised Hopf points over k2 has the values that are asked for."""
    plane, curve = hopf_curve()
    (point,) = curve_criticality(plane, curve, 1e-10).bautin_points
    asked = np.array([8e3, 1.2e4, 1e4])
    space = BautinProblem(plane.rod, (*plane.axes, PlaneAxis("k2", 8e3, 1.2e4)), asked, accuracy)
    found = bautin_curve(space, space.as_curve_point(point, 2, 1e4))
    answer = {}
    for value in asked[:2]:
        at = [each for each in found.points if abs(each.parameter_values[2] / value - 1) < 1e-12]
        if not at:
            return None
        for i, name in enumerate(("F", "k1")):
            answer[f"{name} at k2 = {value}"] = at[0].parameter_values[i], at[0].parameter_errors[i]
    return answer


def beside(accuracy: float) -> Answer:
    """The subcritical Hopf point above a force; its search states no error, only the digits it needs."""
    found = subcritical_hopf_near(WITH_FOLD.with_values(k1=200.0, F=156.0))
    if found is None:
        return None
    return {
        "F": (found.F, 1e-9 * found.F),
        "unstable y": (found.unstable_cycle_y, 2e-3 * found.unstable_cycle_y),
    }


def modes(accuracy: float) -> Answer:
    """Condition numbers and transient growth of a stable rod with a boundary layer at the tip."""
    return modes_answer(Rod(F=20.0, k1=30.0, k2=1e2, gamma3=1e-2), accuracy)


def modes_answer(rod: Rod, accuracy: float) -> Answer:
    found = solve_modes(rod, ModesRequest(4, accuracy, 9, computes_growth=True))
    if found.status.value:
        return None
    growth, vectors = found.growth, found.mode_vectors
    answer = {
        f"condition {i}": (value, vectors.condition_error[i] * value)
        for i, value in enumerate(vectors.condition)
    }
    answer["growth"] = growth.transient_growth, growth.growth_error * growth.transient_growth
    answer["abscissa"] = growth.numerical_abscissa, growth.abscissa_error
    return answer


def eigenvalues_of(found: Spectrum, name: str) -> dict[str, tuple[float, float]]:
    """Eigenvalues with errors. The estimate is at least a tenth of the error."""
    return {
        f"{name}, {part} w{i}": (float(value), 10 * float(error))
        for i, (w, error) in enumerate(zip(found.eigenvalues, found.error_estimate, strict=True))
        for part, value in (("Re", w.real), ("Im", w.imag))
    }


def spectra(accuracy: float) -> Answer:
    """Spectra by search and by two meshes, of a fluttering rod, one that is soft in shear, and an arm."""
    answer: dict[str, tuple[float, float]] = {}
    arm = Rod(F=15.0, k1=1e3, k2=1e2, gamma3=1e-3, taper=0.5)
    for rod in (Rod(F=120.0, k1=200.0, k2=1e4, gamma3=1e-4), Rod(F=20.0, k1=30.0, k2=1e2, gamma3=0.0), arm):
        for solve, certify in ((solve_spectrum, True), (solve_on_two_meshes, False)):
            found = solve(rod, SpectrumRequest(4, accuracy, certify))
            if found.status.value:
                return None
            answer |= eigenvalues_of(found, f"{solve.__name__} at F = {rod.F}")
    return answer


def followed_cones(accuracy: float) -> Answer:
    """Cones beyond flutter, where counts are carried from cone to cone."""
    path = ParameterPath(Rod(F=40.0, k1=1e4, k2=1e2, gamma3=1e-2, taper=0.5), "F")
    return spectra_along(path, np.linspace(40.0, 42.0, 40), SpectrumRequest(4, accuracy, certify=True))


def spectra_along(path: ParameterPath, forces: np.ndarray, request: SpectrumRequest) -> dict[str, Any] | None:
    found = solve_stretch(NeighbouringRods(path, forces), request)
    if found.status.any():
        return None
    answer = {}
    for i, F in enumerate(forces):
        here = replace(found, eigenvalues=found.eigenvalues[i], error_estimate=found.error_estimate[i])
        answer |= eigenvalues_of(here, f"F = {F}")
        answer[f"growing modes at F = {F}"] = float(found.unstable_count[i]), 0.1
    return answer


def leaders_of_a_range(accuracy: float) -> Answer:
    """Leading eigenvalues along a chain of cones; the accuracy is that of Newton's method."""
    rods = [Rod(F=12.0 + 0.1 * k, k1=1e4, k2=1e3, gamma3=1e-3, taper=0.8) for k in range(12)]
    near, arm_range, answer = eigenvalues_to_follow(rods[0], straight_rod_stability(rods[0])), None, {}
    for previous, rod in pairwise(rods):
        found = straight_rod_stability_in_chain(rod, near, "F", arm_range)
        near = eigenvalues_to_follow(rod, found)
        arm_range = next_range(rod, previous, "F", found.arm_range, near)
        answer[f"F = {rod.F}, real part"] = found.w.real, found.eigenvalue_error
        answer[f"F = {rod.F}, imaginary part"] = found.w.imag, found.eigenvalue_error
    return answer


def followed(accuracy: float) -> Answer:
    """Spectra of neighbours through flutter, and the leader of one from that of the other."""
    forces = np.linspace(40.0, 170.0, 12)
    path = ParameterPath(Rod(F=0.0, k1=200.0, k2=1e4, gamma3=1e-4), "F")
    answer = spectra_along(path, forces, SpectrumRequest(3, accuracy, certify=True))
    if answer is None:
        return None
    near = complex(
        solve_spectrum(path.rod_at(forces[0]), SpectrumRequest(3, accuracy, certify=True)).eigenvalues[0]
    )
    leader = follow_leading_eigenvalue(
        path.rod_at(forces[0] + 0.1), np.array([complex(near.real, abs(near.imag))]), 1e-10
    )
    if leader is None:
        return None
    return answer | {"leader": (leader.w.real, 1e-9 * abs(leader.w))}


def changes_of(found: Thresholds) -> Answer:
    if found.status.value:
        return None
    answer = {}
    for place, crossing in enumerate(found.thresholds):
        name = f"{place}, {crossing.kind.name}: "
        answer[name + "at"] = crossing.value, crossing.error
        answer[name + "unstable after"] = crossing.unstable_after, 0.0
    return answer


def thresholds(accuracy: float) -> Answer:
    """All changes of a rod that is soft in shear, up to where it is crushed, but for the last millionths."""
    return changes_of(solve_thresholds(SOFT_IN_SHEAR, ThresholdsRequest(29.0, accuracy, True, 40)))


def thresholds_of_a_cone(accuracy: float) -> Answer:
    rod = Rod(F=0.0, k1=1e3, k2=1e2, gamma3=1e-3, taper=0.5)
    return changes_of(solve_thresholds(rod, ThresholdsRequest(40.0, accuracy, True, 20)))


def thresholds_of_a_slender_cone(accuracy: float) -> Answer:
    """With so many growing modes that a place knows those beside the axis alone."""
    rod = Rod(F=0.0, k1=1e5, k2=1e2, gamma3=1e-3, taper=0.117)
    return changes_of(solve_thresholds(rod, ThresholdsRequest(15.0, accuracy, True, 20)))


def curves_of_changes(accuracy: float) -> Answer:
    """Curves through the changes of two rows of a plane, and their folds."""
    rod = Rod(F=60.0, k1=155.0, k2=1e4, gamma3=1e-4)
    plane = ParameterPlane(rod, (PlaneAxis("F", 60.0, 110.0), PlaneAxis("k1", 145.0, 160.0)))
    request = RowRequest("F", np.linspace(60.0, 110.0, 5), accuracy, True, 10)
    seeds = []
    for k1 in (150.0, 155.0):
        row = solve_row(rod.with_values(k1=k1), request)
        if row.status.value:
            return None
        found = (
            seed_of((c.value, k1), c.kind, c.frequency, c.growth_rate) for c in row.thresholds.thresholds
        )
        seeds += [seed for seed in found if seed is not None]
    curves = boundary_curves_through(plane, seeds)
    if curves.untraced_seed_count:
        return None
    answer: dict[str, tuple[float, float]] = {"curves": (len(curves.curves), 0.0)}
    for number, curve in enumerate(curves.curves):
        for place, fold in enumerate(curve.folds):
            for axis, value, error in zip(
                plane.axes, fold.parameter_values, fold.parameter_errors, strict=True
            ):
                answer[f"curve {number}, fold {place}: {axis.parameter_name}"] = value, error
    return answer


def segments(accuracy: float) -> Answer:
    """Spectra of an arm of two segments, the second softer, before its flutter and far beyond it."""
    stiff = (1.0,) * 6
    soft = (0.36, 0.36, 0.1296, 0.36, 0.36, 0.36)
    material = RodMaterial(profile=Profile((0.0, 0.4, 0.4, 1.0), (stiff, stiff, soft, soft)))
    answer: dict[str, tuple[float, float]] = {}
    for F in (3.0, 25.0):
        rod = Rod(F=F, k1=1e3, k2=1e3, gamma3=1e-3, material=material)
        found = solve_spectrum(rod, SpectrumRequest(4, accuracy, True))
        if found.status.value:
            return None
        answer |= eigenvalues_of(found, f"F = {F}")
        answer[f"F = {F}, unstable"] = found.unstable_count, 0.0
    return answer


def changes_between(accuracy: float) -> Answer:
    """Crossings between two spectra, whose accuracy is that of Newton's method."""
    rod = Rod(F=0.0, k1=200.0, k2=1e4, gamma3=1e-4)
    before, after = (
        solve_spectrum(rod.with_values(F=F), SpectrumRequest(4, 1e-10, True)) for F in (20.0, 30.0)
    )
    zeros = crossings_between(
        20.0, 30.0, before.eigenvalues, after.eigenvalues, rod.coefficients, rod.coefficient_derivative("F")
    )
    return {f"zero {i}": (float(F), float(error)) for i, (F, _, error) in enumerate(sorted(zeros.tolist()))}


def modes_of_a_cone(accuracy: float) -> Answer:
    """Condition numbers and growth of an arm without rotational drag, which has a layer at the tip."""
    return modes_answer(Rod(F=8.0, k1=1e3, k2=1e2, gamma3=0.0, taper=0.6), accuracy)


def on_mesh(accuracy: float) -> Answer:
    """Tip, its velocity and the energy of a rod that turns by two radians in one element."""
    system = ExplicitSystem(Rod(F=50.0, k1=1e4, k2=1e2, gamma3=1e-2), uniform_mesh(1, 16))
    u = system.mesh.node_positions
    rest = system.strains(np.zeros(system.layout.unknown_count))
    z = system.state_of_strains(rest + (1 - u) * np.array([0 * u, 0.1 * np.sin(2 * u), 4 * np.cos(u)]))
    tip = np.concatenate(system.tip_position_and_velocity(z, 0.1 * z))
    numbers = [*tip, system.elastic_energy(z)]
    return {f"number {i}": (float(value), 1e-12) for i, value in enumerate(numbers)}


def longitudinal(accuracy: float) -> Answer:
    """Longitudinal eigenvalues of a cone, whose accuracy is a setting itself."""
    w, error = longitudinal_eigenvalues_and_errors(Rod(F=8.0, k1=1e3, k2=1e2, gamma3=1e-3, taper=0.3), 5)
    return {f"w{i}": (float(value), float(error[i] * abs(value))) for i, value in enumerate(w)}


def held_tip(accuracy: float) -> Answer:
    """Energy and tip of a rod bent by its tip, which Newton's method places far better than asked here."""
    system = ExplicitSystem(Rod(F=20.0, k1=1e4, k2=1e2, gamma3=1e-2), uniform_mesh(1, 16))
    z = bent_state_with_tip_at(system, 0.5, 0.4)
    x, y, _ = system.tip_coordinates(z)
    if np.hypot(x - 0.5, y - 0.4) > 1e-6:
        return None
    return {"x": (x, 1e-8), "y": (y, 1e-8), "energy": (system.elastic_energy(z), 1e-6)}


def small_drag(accuracy: float) -> Answer:
    """Branches of a rod whose rotational drag is near the least that is eliminated."""
    return branch_answer(replace(WITH_FOLD, gamma3=1.4e-5), 60.0, 110.0, accuracy)


def motion(accuracy: float) -> Answer:
    """State after a free motion. Its error is that of the scheme's tolerance, some steps' worth."""
    system = ExplicitSystem(Rod(F=50.0, k1=1e4, k2=1e2, gamma3=1e-2), uniform_mesh(1, 16))
    u = system.mesh.node_positions
    rest = system.strains(np.zeros(system.layout.unknown_count))
    wave = np.array([0 * u, 0.1 * np.sin(2 * u), np.cos(4 * u)])
    start = system.state_of_strains(rest + 0.1 * (1 - u) * wave)
    destroy_integrators()
    run = integrator(system.mesh, TimeScheme(tolerance=accuracy)).run(system, start, 0.05)
    if run.end_reason is not EndReason.reached:
        return None
    size = float(np.abs(run.states[0]).max())
    return {f"z{i}": (float(z), 30 * accuracy * size) for i, z in enumerate(run.states[-1])}


def cycle_answer(cycle: CycleOutcome) -> Answer:
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
    return cycle_answer(solve_cycle(BEATING.with_values(F=60.0), request(accuracy)))


def cycle_of_segments(accuracy: float) -> Answer:
    """A cycle of an arm whose base is stiff, on elements of unequal orders."""
    soft = (0.36, 0.36, 0.1296, 0.36, 0.36, 0.36)
    profile = Profile((0.0, 0.4, 0.4, 1.0), ((1.0,) * 6,) * 2 + (soft,) * 2)
    rod = Rod(F=14.0, k1=1e4, k2=1e4, gamma3=1e-3, material=RodMaterial(profile=profile))
    return cycle_answer(solve_cycle(rod, request(accuracy), None, "F"))


def cycle_of_a_cone(accuracy: float) -> Answer:
    """A cycle of a cone, on an element whose nodes are closer at the tip."""
    rod = Rod(F=20.0, k1=1e4, k2=1e2, gamma3=1e-2, taper=0.5)
    return cycle_answer(solve_cycle(rod, request(accuracy), None, "F"))


def cycles_of_a_chain(accuracy: float) -> Answer:
    """The last of three cycles, of which each predicts the next."""
    last = None
    for F in (60.0, 64.0, 72.0):
        cycle = solve_cycle(
            BEATING.with_values(F=F),
            request(accuracy, start="neighbour"),
            last.start_for_next_rod if last else None,
            "F",
        )
        last = cycle
    return cycle_answer(last)


def cycle_beside_the_hopf_point(accuracy: float) -> Answer:
    """From the leading mode and from the Hopf point, of which the second answer is taken with its errors."""
    rod = BEATING.with_values(F=27.6)
    slow = cycle_answer(solve_cycle(rod, request(accuracy, 0.01)))
    found = cycle_answer(solve_cycle(rod, request(accuracy, start="hopf")))
    if slow is None or found is None:
        return None
    return {f"slow {name}": value for name, value in slow.items()} | found


def cycle_by_integration(accuracy: float) -> Answer:
    cycle = solve_by_integration(BEATING.with_values(F=60.0), request(accuracy))
    found = cycle_answer(cycle)
    return found and {name: value for name, value in found.items() if name != "multiplier"}


def torus(accuracy: float) -> Answer:
    return cycle_answer(solve_cycle(BEATING.with_values(F=207.0), request(accuracy)))


class Case(NamedTuple):
    """A problem and the accuracies of the answer and of the reference."""

    solve: Callable[[float], Answer]
    accuracy: float
    finer: float


BRANCH = Case(small_branches, 1e-6, 1e-8)
DETACHED = Case(detached_branch, 1e-6, 1e-8)
BEYOND = Case(branch_from_beyond, 1e-5, 1e-7)
LOPSIDED = Case(lopsided_branches, 1e-4, 1e-6)
CURVE = Case(curve_of_folds, 1e-7, 1e-7)
EXTREMUM = Case(extremum_of_folds, 1e-7, 1e-7)
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
UNSTABLE = Case(branch_of_legs, 1e-4, 1e-6)
SPECTRA = Case(spectra, 1e-8, 1e-10)
FOLLOWED = Case(followed, 1e-8, 1e-10)
THRESHOLDS = Case(thresholds, 1e-8, 1e-10)
CONE = Case(thresholds_of_a_cone, 1e-6, 1e-8)
SLENDER_CONE = Case(thresholds_of_a_slender_cone, 1e-6, 1e-8)
CHANGES = Case(curves_of_changes, 1e-8, 1e-10)
CONE_MODES = Case(modes_of_a_cone, 1e-6, 1e-8)
MESH = Case(on_mesh, 1.0, 1.0)
SMALL_DRAG = Case(small_drag, 1e-6, 1e-8)
LONGITUDINAL = Case(longitudinal, 1.0, 1.0)
HELD = Case(held_tip, 1.0, 1.0)
CONES = Case(followed_cones, 1e-8, 1e-10)
SEGMENT_CYCLE = Case(cycle_of_segments, 1e-6, 1e-9)
CONE_CYCLE = Case(cycle_of_a_cone, 1e-6, 1e-9)
SEGMENTS = Case(segments, 1e-8, 1e-10)
RANGE = Case(leaders_of_a_range, 1.0, 1.0)
BETWEEN = Case(changes_between, 1.0, 1.0)
SLOW = (LOPSIDED, TORUS, UNSTABLE, SLENDER_CONE)
"""Cases that take seconds."""
CASES = {
    "BRANCH_MESH_SETTINGS": BRANCH,
    "LINEARISATION_CORRECTION_SETTINGS": BRANCH,
    "BRANCH_ERROR_SETTINGS": BRANCH,
    "MULTIPLIER_SENSITIVITY_SETTINGS": BRANCH,
    "BRANCH_PREDICTION_SETTINGS": BRANCH,
    "BRANCH_END_SETTINGS": LOPSIDED,
    "DETACHED_BRANCH_SETTINGS": DETACHED,
    "BEYOND_RANGE_SETTINGS": BEYOND,
    "ASYMMETRIC_START_SETTINGS": LOPSIDED,
    "BRANCH_START_SETTINGS": BRANCH,
    "BRANCH_SETTINGS": BRANCH,
    "COMPUTING_TIME_MODEL_SETTINGS": BRANCH,
    "SPECIAL_POINT_SETTINGS": BRANCH,
    "SHOOTING_INTERVAL_SETTINGS": UNSTABLE,
    "LEAST_STRETCH_SETTINGS": BRANCH,
    "ARC_STEP_CONTROL": BRANCH,
    "ORBIT_NEWTON_SETTINGS": BRANCH,
    "ORBIT_MESH_SETTINGS": BRANCH,
    "ROD_ELEMENT_ORDER_RATIO_SETTINGS": SEGMENT_CYCLE,
    "NODE_SPACING_SETTINGS": CONE_CYCLE,
    "WORKSPACE_SETTINGS": BRANCH,
    "FLOQUET_MULTIPLIER_SETTINGS": BRANCH,
    "CURVE_START_SETTINGS": CURVE,
    "CURVE_IDENTITY_SETTINGS": CURVE,
    "CURVE_SECANT_SETTINGS": CURVE,
    "MINIMALLY_AUGMENTED_SETTINGS": CURVE,
    "SPECIAL_CURVE_END_SETTINGS": CURVE,
    "PARAMETER_ROLE_SETTINGS": EXTREMUM,
    "ROW_EXTREMUM_SETTINGS": EXTREMUM,
    "CURVE_STEP_CONTROL": CURVE,
    "NORMAL_FORM_SETTINGS": HOPF,
    "HOPF_COEFFICIENT_SETTINGS": HOPF,
    "BAUTIN_POINT_SETTINGS": BAUTIN_POINT,
    "BOUNDARY_POINT_SETTINGS": BAUTIN_CURVE,
    "PLANE_DIFFERENCE_SETTINGS": BAUTIN_CURVE,
    "BAUTIN_SETTINGS": BAUTIN_CURVE,
    "BAUTIN_STEP_CONTROL": BAUTIN_CURVE,
    "SUBCRITICAL_HOPF_SEARCH_SETTINGS": BESIDE,
    "MODE_MESH_SETTINGS": MODES,
    "MODE_ITERATION_SETTINGS": MODES,
    "LEADING_MODE_SETTINGS": MODES,
    "GROWTH_SETTINGS": MODES,
    "NORM_MAXIMUM_SETTINGS": MODES,
    "NUMERICAL_ABSCISSA_SETTINGS": MODES,
    "PROPAGATOR_SETTINGS": MODES,
    "INTEGRATOR_SETTINGS": MOTION,
    "CYCLE_ERROR_SETTINGS": SINGLE,
    "COARSER_MESH_SETTINGS": SINGLE,
    "MINIMAL_PERIOD_SETTINGS": SINGLE,
    "MULTIPLIER_LIST_SETTINGS": SINGLE,
    "RADAU_SETTINGS": SINGLE,
    "REFINEMENT_SETTINGS": SINGLE,
    "NEWTON_FROM_MOTION_SETTINGS": SINGLE,
    "MOTION_MESH_SETTINGS": SINGLE,
    "RETURN_SETTINGS": SINGLE,
    "SHAPE_TRACE_SETTINGS": SINGLE,
    "TRANSIENT_SETTINGS": SINGLE,
    "MESH_ERROR_CALIBRATION_SETTINGS": CHAIN,
    "FINER_MESH_SETTINGS": CHAIN,
    "NEXT_MESH_SETTINGS": CHAIN,
    "CYCLE_PREDICTION_SETTINGS": CHAIN,
    "PARAMETER_STEP_CONTROL": CHAIN,
    "HOPF_START_SETTINGS": BESIDE_HOPF,
    "MOTION_DECAY_SETTINGS": BESIDE_HOPF,
    "STRAIGHT_ROD_SETTINGS": BESIDE_HOPF,
    "AMPLITUDE_EQUATION_SETTINGS": BESIDE_HOPF,
    "TIME_SCHEME_SETTINGS": BESIDE_HOPF,
    "INTEGRATION_SETTINGS": INTEGRATED,
    "TORUS_TEST_SETTINGS": TORUS,
    "KRYLOV_SETTINGS": SPECTRA,
    "EIGENVALUE_CANDIDATE_SETTINGS": SPECTRA,
    "SEARCH_SETTINGS": SPECTRA,
    "TWO_MESH_SETTINGS": SPECTRA,
    "RESOLUTION_SETTINGS": SPECTRA,
    "PENCIL_NORM_SETTINGS": SPECTRA,
    "ELEMENT_SETTINGS": SPECTRA,
    "ARM_RESOLUTION_SETTINGS": SPECTRA,
    "ARM_ELEMENT_SETTINGS": SPECTRA,
    "HULL_SETTINGS": SPECTRA,
    "NEIGHBOURING_RODS_SETTINGS": FOLLOWED,
    "WINDING_SETTINGS": THRESHOLDS,
    "COVERING_SETTINGS": THRESHOLDS,
    "THRESHOLD_SETTINGS": THRESHOLDS,
    "EXCHANGE_NEWTON_SETTINGS": THRESHOLDS,
    "LEADER_EXCHANGE_SETTINGS": THRESHOLDS,
    "UNSTABLE_MODE_COUNT_SETTINGS": THRESHOLDS,
    "SPECTRUM_SAMPLE_SETTINGS": CONE,
    "ARM_CROSSING_SETTINGS": CONE,
    "SEARCH_RANGE_SETTINGS": CONE,
    "CRUSHING_END_SETTINGS": THRESHOLDS,
    "TIP_TARGET_SETTINGS": HELD,
    "ARM_PATH_SETTINGS": CONE,
    "IMAGINARY_AXIS_MODE_SETTINGS": SLENDER_CONE,
    "NEAR_AXIS_SETTINGS": SLENDER_CONE,
    "ARM_FOLLOWING_SETTINGS": CONE,
    "ARM_FAMILY_SETTINGS": CONE,
    "ARM_RANGE_SETTINGS": RANGE,
    "NO_CROSSING_SETTINGS": CONES,
    "ARM_DOUBLE_EIGENVALUE_SETTINGS": CONE,
    "LONGITUDINAL_MODE_SETTINGS": LONGITUDINAL,
    "BOUNDARY_ASSIGNMENT_SETTINGS": CHANGES,
    "BOUNDARY_CURVE_SETTINGS": CHANGES,
    "BOUNDARY_STEP_CONTROL": CHANGES,
    "TIP_LAYER_SETTINGS": CONE_MODES,
    "EXPONENT_SETTINGS": SPECTRA,
    "EVEN_FUNCTION_SETTINGS": SPECTRA,
    "DETERMINANT_SETTINGS": SPECTRA,
    "ROOT_SETTINGS": SPECTRA,
    "DOMINANCE_SETTINGS": SPECTRA,
    "NODE_DISC_SETTINGS": SPECTRA,
    "SPECTRUM_ERROR_SETTINGS": SPECTRA,
    "SOLVER_POOL_SETTINGS": SPECTRA,
    "STABILITY_CHANGE_SETTINGS": BETWEEN,
    "ROOT_NEWTON_SETTINGS": THRESHOLDS,
    "BOX_SETTINGS": THRESHOLDS,
    "BOX_PROOF_SETTINGS": THRESHOLDS,
    "DISC_BOUND_SETTINGS": THRESHOLDS,
    "MOVING_LINE_SETTINGS": FOLLOWED,
    "CARRIED_COUNT_SETTINGS": FOLLOWED,
    "EIGENVALUE_FOLLOWING_SETTINGS": FOLLOWED,
    "EIGENVALUE_PREDICTION_SETTINGS": FOLLOWED,
    "AVERAGED_WEIGHT_SETTINGS": SEGMENTS,
    "COMPLETENESS_SETTINGS": SEGMENTS,
    "CONTOUR_SETTINGS": SEGMENTS,
    "ARM_DETERMINANT_SETTINGS": SEGMENTS,
    "ARM_ROOT_SETTINGS": SEGMENTS,
    "ARM_ROUNDING_SETTINGS": SEGMENTS,
    "STAGE_NEWTON_SETTINGS": MOTION,
    "STAGE_PREDICTOR_SETTINGS": MOTION,
    "STEP_RECORD_SETTINGS": MOTION,
    "TIP_EXTREMUM_SETTINGS": SINGLE,
    "TIME_GRADING_SETTINGS": CHAIN,
    "TRIGONOMETRIC_MAXIMUM_SETTINGS": SINGLE,
    "COEFFICIENT_TAIL_SETTINGS": SINGLE,
    "INVERSION_SETTINGS": SINGLE,
    "SMALL_EIGENVALUE_SETTINGS": SINGLE,
    "SHAPE_QUADRATURE_SETTINGS": MESH,
    "LOBATTO_SETTINGS": MESH,
    "TIP_VELOCITY_SETTINGS": MESH,
    "VELOCITY_ELIMINATION_SETTINGS": SMALL_DRAG,
}
READ_BY_MOST = ("EVEN_FUNCTION_SETTINGS", "STAGE_NEWTON_SETTINGS")
"""Settings whose change compiles so many functions again that a field takes 8 to 30 seconds."""
MOST_WITHOUT_ANSWER = 1
"""Of the two runs of a field: half or twice a limit of work may not be enough, but one of the two is."""
ROOMS = (
    "branch.",
    "cycle.",
    "orbit.",
    "hopf.",
    "modes.",
    "continuation.",
    "motion.",
    "spectrum.",
    "changes.",
    "backend.",
)
"""Subpackages of `rodsweep.solve` whose numbers are fields of settings."""


def solver_modules() -> Iterator[str]:
    """Names of all modules of the solvers, of the determinant and of the discretization."""
    for package in (rodsweep.solve, rodsweep.determinant, rodsweep.discretization):
        for found in pkgutil.walk_packages(package.__path__, package.__name__ + "."):
            short = found.name.removeprefix("rodsweep.solve.")
            if short.startswith((*ROOMS, "rodsweep.determinant", "rodsweep.discretization")):
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


FunctionIdentity._unique_ids = count(10**6)
"""Numbers in the names of machine code: those of functions that are loaded from disk are smaller."""
FIELDS = [
    (name, field.name)
    for name, value in settings().items()
    for field in fields(value)
    if ALL or CASES.get(name) not in SLOW
    if (name, field.name) not in ANOTHER_START
]


def factors(name: str, field: str) -> list[float]:
    """Factors that change a field, which 1 and inf cannot be, to a value that the settings do not refuse."""
    found = []
    for factor in (0.5, 2.0):
        with suppress(ValueError):
            changed(name, field, factor)
            found.append(factor)
    return found


def changed(name: str, field: str, factor: float) -> Any:
    """A settings object with another value of one field; ValueError if the value cannot change so."""
    old = settings()[name]
    value = scaled(getattr(old, field), factor)
    if value == getattr(old, field):
        raise ValueError(f"{name}.{field} = {value} cannot be scaled by {factor}")
    return replace(old, **{field: value})


def forget() -> None:
    """Empties what solvers keep from point to point, which other settings may have made."""
    destroy_pooled_solvers()
    for title, module in list(sys.modules.items()):
        if title.startswith("rodsweep."):
            for value in list(vars(module).values()):
                if hasattr(value, "cache_clear"):
                    value.cache_clear()


def digests() -> dict[Any, str]:
    """Digest of every compiled function and C callback of the package, by the function."""
    found: dict[Any, str] = {}
    parts: dict[Any, Any] = {}
    for title, module in list(sys.modules.items()):
        for value in list(vars(module).values()) if title.startswith("rodsweep.") else ():
            if isinstance(value, Dispatcher):
                found[value] = kernel_digest(kernel_of(value.py_func, value.targetoptions), parts)
            elif isinstance(value, CFunc):
                found[value] = kernel_digest(kernel_of(value.__wrapped__, {"signature": "C"}), parts)
    return found


def compile_again(caches: dict[Any, Any]) -> None:
    """Forgets the machine code of compiled functions; caches: the disk cache that each has from now on."""
    for function, kept in caches.items():
        function._cache = kept
        if isinstance(function, Dispatcher):
            function._reset_overloads()
    for function in caches:  # a callback is compiled at once, after all functions that it may call
        if isinstance(function, CFunc):
            function.compile()


@contextmanager
def replaced(name: str, field: str, factor: float) -> Iterator[None]:
    """Another value of one field, in every module that has the settings object, and in compiled functions."""
    old = settings()[name]
    new = changed(name, field, factor)
    before = digests() if isinstance(old, KernelConstants) else {}
    users = [
        (vars(module), key)
        for title, module in list(sys.modules.items())
        if title.startswith("rodsweep.")
        for key, value in vars(module).items()
        if value is old
    ]
    for place, key in users:
        place[key] = new
    after = digests() if before else {}
    caches = {function: function._cache for function in before if after[function] != before[function]}
    compile_again(dict.fromkeys(caches, NullCache()))
    forget()
    try:
        yield
    finally:
        for place, key in users:
            place[key] = old
        compile_again(caches)
        forget()


@cache
def reference(case: Case) -> Answer:
    return case.solve(case.finer)


def differences(found: Answer, exact: Answer) -> list[str]:
    """Numbers that are further from the reference than both errors allow."""
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


def test_a_changed_setting_reaches_compiled_functions():
    before = box_from_sqrt_frequency_bound(0.0, 1.0)
    with replaced("BOX_SETTINGS", "padding_over_depth", 2.0):
        assert box_from_sqrt_frequency_bound(0.0, 1.0)[0] - before[0] == pytest.approx(
            settings()["BOX_SETTINGS"].padding_over_depth
        )
    assert box_from_sqrt_frequency_bound(0.0, 1.0) == before


@pytest.mark.long
@pytest.mark.parametrize(
    ("name", "field"), [each for each in FIELDS[FIRST::EACH] if ALL or each[0] not in READ_BY_MOST]
)
def test_a_setting_moves_no_answer_beyond_its_error(name, field):
    case = CASES[name]
    reference(case)
    without_answer = []
    for factor in factors(name, field):
        with replaced(name, field, factor):
            found = case.solve(case.accuracy)
        assert (factor, differences(found, reference(case))) == (factor, [])
        without_answer += [factor] if found is None else []
    assert len(without_answer) <= MOST_WITHOUT_ANSWER
