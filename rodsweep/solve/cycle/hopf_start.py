"""Start of Newton's method for the cycle at a given force, from the nearest Hopf point below this force.

No motion is integrated. The normal form of the Hopf point gives amplitude, frequency and shape of small
cycles. Close to the Hopf point the normal form's orbit starts Newton's method directly, on the mesh of the
normal form. Farther away the branch is followed along the force on a coarse mesh. A coarse mesh is not used
close to the Hopf point, because the mesh may displace the Hopf point beyond the given force.
"""

from dataclasses import dataclass, replace
from functools import partial
from math import isfinite, isnan

import numpy as np

from ...determinant.parameter_path import ParameterPath
from ...discretization.elements.mesh import interpolation_matrix
from ...discretization.stress.form import StressForm
from ...discretization.stresses_at_jumps import interpolate_stress
from ...model.rod import Rod
from ..changes.arm.path import path_problem
from ..changes.path_problem import PathEigenproblem
from ..hopf.normal_form import NormalForm, normal_form_by_mesh_rule
from ..orbit.matrix.workspace import NewtonWorkspace
from ..orbit.newton import ConvergedOrbit, newton_step_if_matrix_distant, solve_by_newton
from ..orbit.orbit import Orbit, node_time_fractions
from ..orbit.symmetry import REFLECTION
from ..spectrum.candidates import EIGENVALUE_CANDIDATE_SETTINGS
from ..spectrum.problem import transverse_problem
from ..unsolvable import Unsolvable
from .cycles_along_parameter import orbit_followed_in_parameter_steps, predictor_from
from .hopf_start_settings import HOPF_START_SETTINGS, normal_form_accuracy
from .straight_rod import straight_rod_stability
from .transient.motion_mesh import coarse_mesh_for_branch_to_cycle


@dataclass(frozen=True, slots=True)
class HopfPointBelowForce:
    """The Hopf point below a rod's force: force F in k3/L^2, frequency of the leading mode in 1/tau2."""

    F: float
    frequency: float


def leading_eigenvalue(rod: Rod, guess: complex | None = None) -> complex:
    """The leading eigenvalue of the straight rod, in 1/tau2 with Im >= 0; raises Unsolvable if the spectrum
    fails. guess: leading eigenvalue of a similar rod, which is followed to this rod; None for a search."""
    stability = straight_rod_stability(rod, None if guess is None else np.array([guess]), certify=False)
    if isnan(stability.eigenvalue_error):
        raise Unsolvable(f"the spectrum at F = {rod.F:g} is not known: {stability.message}")
    return stability.w


def hopf_point_below_force(rod: Rod) -> HopfPointBelowForce | None:
    """The nearest Hopf point below the force of the rod at which the leading mode becomes unstable; None if
    not found. The leading growth rate is evaluated at decreasing forces (`relative_force_decrease_in_scan`),
    so two Hopf points between successive forces are missed. Raises Unsolvable if a leading eigenvalue is
    unknown, or if the unstable mode does not oscillate."""
    F = rod.F
    upper_w = leading_eigenvalue(rod)
    while HOPF_START_SETTINGS.min_force < F:
        # Successive forces have a constant ratio: thresholds of a rod are far apart at large forces.
        lower_F = F * (1 - HOPF_START_SETTINGS.relative_force_decrease_in_scan)
        lower_w = leading_eigenvalue(replace(rod, F=lower_F), upper_w)
        if lower_w.real < 0 <= upper_w.real:
            return _hopf_point_between(rod, (lower_F, lower_w), (F, upper_w))
        F = lower_F
        upper_w = lower_w
    return None


def _hopf_point_between(
    rod: Rod, low: tuple[float, complex], high: tuple[float, complex]
) -> HopfPointBelowForce:
    """The Hopf point between `low` and `high`, (force, leading eigenvalue) each; raises Unsolvable.
    Newton's method on the characteristic determinant, started by linear interpolation, finds a candidate. If
    Newton's method fails or another eigenvalue leads at the candidate, the interval is bisected."""
    problem = path_problem(ParameterPath(rod, "F"))
    (lower_F, lower_w), (upper_F, upper_w) = low, high
    while upper_F - lower_F > HOPF_START_SETTINGS.relative_hopf_eigenvalue_tolerance * upper_F:
        fraction = lower_w.real / (lower_w.real - upper_w.real)
        start_F = lower_F + fraction * (upper_F - lower_F)
        start_w = lower_w + fraction * (upper_w - lower_w)
        hopf = _newton_hopf_point(problem, start_F, start_w, (lower_F, upper_F))
        if hopf is not None:
            # The eigenvalue on the axis must lead; otherwise another mode is already unstable.
            w = leading_eigenvalue(replace(rod, F=hopf.F))
            tolerance = HOPF_START_SETTINGS.relative_hopf_eigenvalue_tolerance * abs(w)
            if abs(w.real) <= tolerance and abs(w.imag - hopf.frequency) <= tolerance:
                return hopf
        middle_F = (lower_F + upper_F) / 2
        w = leading_eigenvalue(replace(rod, F=middle_F))
        if w.real < 0:
            lower_F = middle_F
            lower_w = w
        else:
            upper_F = middle_F
            upper_w = w
    raise Unsolvable(f"the mode that becomes unstable at F = {lower_F:g} does not oscillate there")


def _newton_hopf_point(
    problem: PathEigenproblem, F: float, guess: complex, end_forces: tuple[float, float]
) -> HopfPointBelowForce | None:
    """The Hopf point with a force between `end_forces`, by Newton's method from the force `F` and the
    eigenvalue `guess`; None if not found."""
    for _ in range(HOPF_START_SETTINGS.max_newton_steps):
        w, slope, error = problem.eigenvalue_with_slope_and_error(guess, F)
        if not (slope.real and isfinite(slope.real)):
            return None
        step = -w.real / slope.real
        if abs(w.real) <= HOPF_START_SETTINGS.converged_growth_in_errors * error or abs(
            step
        ) <= HOPF_START_SETTINGS.relative_converged_force_step * abs(F):
            return HopfPointBelowForce(F, w.imag) if w.imag > 0 else None
        F += step
        guess = w + step * slope
        if not end_forces[0] <= F <= end_forces[1]:
            return None
    return None


def orbit_from_hopf(form: StressForm, hopf: HopfPointBelowForce, workspace: NewtonWorkspace) -> Orbit:
    """Approximate orbit of the rod in `form`, on the branch from the Hopf point `hopf` below the rod's
    force, on a mesh that is chosen here.
    workspace: memory of Newton's matrices. Raises Unsolvable if no normal form is found, or if the branch
    starts towards smaller forces or cannot be followed."""
    rod = form.rod
    normal = _normal_form(replace(form, rod=replace(rod, F=hopf.F)), 1j * hopf.frequency)
    if not normal.amplitude_coefficient > 0:
        reason = "starts towards smaller forces: follow it with the task `branch`"
        raise Unsolvable(f"the branch from the Hopf point at F = {hopf.F:g} {reason}")
    is_near = hopf.F * (1 + HOPF_START_SETTINGS.max_direct_start_force_distance) >= rod.F
    if is_near and normal.squared_y_and_frequency(rod.F)[0] <= HOPF_START_SETTINGS.max_direct_start_tip_y**2:
        return orbit_by_normal_form(normal, replace(form, mesh=normal.mixed_form.mesh))
    coarse_form = replace(form, mesh=coarse_mesh_for_branch_to_cycle(rod))
    forces = [min(rod.F, hopf.F * (1 + distance)) for distance in HOPF_START_SETTINGS.start_force_distances]
    attempts = [partial(_orbit_along_force, normal, F, coarse_form, workspace) for F in forces]
    fine_form = replace(form, mesh=normal.mixed_form.mesh)
    distances = [(y / normal.amplitude_coefficient) ** 2 for y in HOPF_START_SETTINGS.start_amplitudes]
    attempts += [
        partial(_orbit_followed_in_force_stages, normal, each, fine_form, workspace) for each in distances
    ]
    for attempt in attempts:
        try:
            return attempt()
        except Unsolvable as error:
            failure = error
    raise failure


def predicted_orbit_near_hopf(form: StressForm, w: complex, amplitude: float) -> Orbit:
    """Approximate orbit, by the normal form, to which a motion from the leading mode converges near a Hopf
    point. w: leading eigenvalue of the straight rod. amplitude: tip's y at the start, in L. Raises Unsolvable
    if w is not a growing eigenvalue of a pair, if no normal form is found, or if the normal form is not
    valid: no Hopf point is near, the start is too large, a second pair may grow, or the Hopf point is
    subcritical."""
    if not (w.real > 0 and w.imag > 0):
        raise Unsolvable("the leading eigenvalues are not a growing complex pair")
    slope = path_problem(ParameterPath(form.rod, "F")).eigenvalue_with_slope_and_error(w, form.rod.F)[1]
    rate = form.rod.F * slope.real
    if not w.real <= HOPF_START_SETTINGS.max_direct_start_force_distance * rate:
        raise Unsolvable(f"F = {form.rod.F:g} is too far from a Hopf point for the normal form")
    normal = _normal_form(form, w)
    if not normal.is_supercritical:
        raise Unsolvable("the nearby Hopf point is subcritical")
    if not amplitude**2 <= HOPF_START_SETTINGS.max_direct_start_force_distance * rate / -normal.landau.real:
        raise Unsolvable(f"the amplitude {amplitude:g} of the start is too large for the normal form")
    line = -EIGENVALUE_CANDIDATE_SETTINGS.relative_line_distance_from_last_w * abs(w)
    if transverse_problem(form.rod).count_right_of(line).number != 2:
        raise Unsolvable(
            f"at F = {form.rod.F:g} a second pair of modes may be unstable, so the normal form does not apply"
        )
    return orbit_by_normal_form(normal, replace(form, mesh=normal.mixed_form.mesh))


def _normal_form(form: StressForm, w: complex) -> NormalForm:
    """Normal form of the rod in `form`, with the exact eigenvalue `w` instead of the eigenvalue of the
    mesh."""
    normal = normal_form_by_mesh_rule(form.rod, w, normal_form_accuracy(form.rod))
    return replace(normal, w=w)


def _orbit_along_force(normal: NormalForm, F: float, form: StressForm, workspace: NewtonWorkspace) -> Orbit:
    """Orbit of the rod in `form`, followed along the force from the normal form's orbit at the force F;
    raises Unsolvable if the first orbit is far from the normal form or the branch cannot be followed."""
    solved_orbit = _orbit_near_normal_form(normal, F, form, workspace)
    if form.rod.F == F:
        return solved_orbit.orbit
    tolerance = HOPF_START_SETTINGS.intermediate_orbit_tolerance
    predictor = predictor_from(solved_orbit, None, "F")
    return orbit_followed_in_parameter_steps(predictor, form, "F", tolerance, workspace).orbit


def _orbit_followed_in_force_stages(
    normal: NormalForm, distance: float, form: StressForm, workspace: NewtonWorkspace
) -> Orbit:
    """Orbit of the rod in `form`, followed along the force from the normal form's orbit at the relative
    distance `distance` above the Hopf point, in stages that grow with the distance: near the Hopf point y is
    the square root of the distance. Raises Unsolvable for the reasons of `_orbit_along_force`."""
    F = min(form.rod.F, normal.F * (1 + distance))
    tolerance = HOPF_START_SETTINGS.intermediate_orbit_tolerance
    solved_orbit = _orbit_near_normal_form(normal, F, form, workspace)
    while form.rod.F > F:
        distance *= HOPF_START_SETTINGS.force_distance_ratio_of_stage
        F = min(form.rod.F, normal.F * (1 + distance))
        end_form = replace(form, rod=replace(form.rod, F=F))
        predictor = predictor_from(solved_orbit, None, "F")
        end = orbit_followed_in_parameter_steps(predictor, end_form, "F", tolerance, workspace)
        solved_orbit = newton_step_if_matrix_distant(end, tolerance, "F")
    return solved_orbit.orbit


def _orbit_near_normal_form(
    normal: NormalForm, F: float, form: StressForm, workspace: NewtonWorkspace
) -> ConvergedOrbit:
    """Orbit of the rod in `form` at the force F, with its tangent, near the normal form's orbit; raises
    Unsolvable."""
    start = orbit_by_normal_form(normal, replace(form, rod=replace(form.rod, F=F)))
    tolerance = HOPF_START_SETTINGS.intermediate_orbit_tolerance
    solved_orbit = solve_by_newton(start, tolerance, workspace, "F")
    solved_orbit = newton_step_if_matrix_distant(solved_orbit, tolerance, "F")
    orbit = solved_orbit.orbit
    tip_y = orbit.form.tip_coordinates(orbit.start_state)[1]
    min_ratio, max_ratio = HOPF_START_SETTINGS.allowed_squared_amplitude_ratios
    if not min_ratio < tip_y**2 / normal.squared_y_and_frequency(F)[0] < max_ratio:
        raise Unsolvable(f"the orbit is not near the prediction from the Hopf point at F = {normal.F:g}")
    return solved_orbit


def orbit_by_normal_form(normal: NormalForm, form: StressForm) -> Orbit:
    """The orbit that a normal form predicts for the rod in `form`, whose force is near the Hopf point; raises
    Unsolvable if the normal form has no cycle at this force."""
    squared_y, frequency = normal.squared_y_and_frequency(form.rod.F)
    if not squared_y > 0:
        raise Unsolvable(f"no cycle is born from the Hopf point at F = {normal.F:.15g} for this force")
    return orbit_of_amplitude(normal, form, squared_y**0.5, frequency)


def orbit_of_amplitude(normal: NormalForm, form: StressForm, amplitude: float, frequency: float) -> Orbit:
    """The orbit of the rod in `form` with the motion of a normal form. amplitude: largest tip y, in L.
    frequency: in 1/tau2."""
    stage_count = HOPF_START_SETTINGS.coarse_stage_count
    times = node_time_fractions(HOPF_START_SETTINGS.coarse_time_interval_count, stage_count)
    X = normal.cycle_states(amplitude, np.pi * times)
    S, V = normal.mixed_form.stresses_and_velocities(X)
    source = normal.mixed_form.mesh
    target = form.mesh
    velocities = V @ interpolation_matrix(source, target).T
    states = form.layout.state(interpolate_stress(form.rod, S, source, target), velocities)
    return Orbit.from_states(form, REFLECTION, 2 * np.pi / frequency, states, stage_count)
