"""Cycles near a Hopf point: the branch is followed from the Hopf point to the cycle at a given force.

No motion is integrated. The Hopf point is the nearest one below the force. Its normal form gives amplitude,
frequency and shape of the small cycles. Close to the Hopf point the normal form's orbit starts Newton's
method directly, on the mesh for the requested accuracy. Farther away the branch is followed on a coarse mesh.
A coarse mesh shifts the Hopf point, perhaps beyond a very close force, and is not used there.
"""

from dataclasses import dataclass, replace
from math import isfinite, isnan

import numpy as np

from ...determinant.parameter_path import Path
from ...discretization.at_jumps import carried_stress
from ...discretization.elements.mesh import transfer
from ...discretization.stress.form import StressForm
from ...model.rod import Rod
from ..changes.arm.path import path_problem
from ..changes.path_problem import PathProblem
from ..hopf.normal_form import NormalForm, accurate_normal_form
from ..orbit.matrix.workspace import NewtonWorkspace
from ..orbit.newton import at_orbit, newton
from ..orbit.orbit import Orbit, node_times
from ..orbit.symmetry import REFLECTION
from ..point import Unsolvable
from ..spectrum.candidates import CANDIDATES
from ..spectrum.problem import problem_of
from .along_parameter import orbit_in_steps, predictor_from
from .straight_rod import straight_rod
from .transient.motion_mesh import coarse_mesh


@dataclass(frozen=True, slots=True, kw_only=True)
class HopfStartSettings:
    """Settings for finding the Hopf point below a force and starting Newton's method beside it."""

    scan_step: float = 0.07
    """Relative decrease of successive forces at which the scan evaluates the leading growth rate."""
    min_force: float = 1e-2
    """Force below which no rod of finite length oscillates: F nu (nu + F c2) must exceed the order of
    pi^2."""
    tolerance: float = 1e-6
    """Convergence tolerance of the Hopf point: growth rate of the leading mode in units of its frequency."""
    max_steps: int = 15
    """Maximum number of Newton steps to a Hopf point."""
    converged_growth: float = 4.0
    """Growth rate, in units of its error, at which Newton's method for the Hopf point ends."""
    converged_step: float = 1e-15
    """Relative step of the force at which Newton's method for the Hopf point ends."""
    normal_form_accuracy: float = 1e-3
    """Relative accuracy of the normal form's coefficients, finer than its own error at any start."""
    distances: tuple[float, ...] = (0.3, 0.12, 0.03, 0.006)
    """Relative distances from the Hopf point at which the normal form starts Newton's method, tried in this
    order. In most rods the normal form's amplitude is off by a quarter at the first, by a tenth at the
    second."""
    squared_ratios: tuple[float, float] = 0.3, 3.0
    """Allowed range of the squared largest y of the orbit found, in units of the normal form's."""
    direct_distance: float = 1e-2
    """Relative distance from the Hopf point within which the normal form's orbit starts Newton's method for
    the rod itself: the amplitude is off by 1 percent there in most rods."""
    intervals: int = 8
    """Time intervals over half a period of the coarse mesh."""
    stages: int = 3
    """Collocation stages of the coarse mesh."""
    branch_tolerance: float = 3e-3
    """Newton tolerance of the intermediate orbits on the branch, relative."""


HOPF_START = HopfStartSettings()


@dataclass(frozen=True, slots=True)
class HopfPointBelow:
    """A Hopf point: force F in k3/L^2, and frequency of the leading mode in 1/tau2."""

    F: float
    frequency: float


def leading_eigenvalue(rod: Rod, near: complex | None = None) -> complex:
    """The leading eigenvalue of the straight rod, Im >= 0; raises Unsolvable if the spectrum fails.

    near: leading eigenvalue of a similar rod, from which the search starts.
    """
    found = straight_rod(rod, None if near is None else np.array([near]), certify=False)
    if isnan(found.error):
        raise Unsolvable(f"the spectrum at F = {rod.F:g} is not known: {found.message}")
    return found.w


def hopf_point_below(rod: Rod) -> HopfPointBelow | None:
    """The nearest Hopf point of the leading mode below the rod's force; None without a Hopf point."""
    F = rod.F
    above = leading_eigenvalue(rod)
    while HOPF_START.min_force < F:
        # In ratios: thresholds of one rod are far apart at large forces.
        lower = F * (1 - HOPF_START.scan_step)
        below = leading_eigenvalue(replace(rod, F=lower), above)
        if below.real < 0 <= above.real:
            return _crossing(rod, (lower, below), (F, above))
        F = lower
        above = below
    return None


def _crossing(rod: Rod, low: tuple[float, complex], high: tuple[float, complex]) -> HopfPointBelow:
    """The Hopf point between two forces, each with its leading eigenvalue; raises Unsolvable.

    Newton's method on D, from a secant start, proposes the Hopf point. Bisection continues where the proposal
    belongs to another eigenvalue.
    """
    problem = path_problem(Path(rod, "F"))
    (a, below), (b, above) = low, high
    while b - a > HOPF_START.tolerance * b:
        share = below.real / (below.real - above.real)
        found = _on_the_axis(problem, a + share * (b - a), below + share * (above - below), (a, b))
        if found is not None:
            # The eigenvalue on the axis must be the leading one; otherwise another mode has become unstable
            # below.
            w = leading_eigenvalue(replace(rod, F=found.F))
            tolerance = HOPF_START.tolerance * abs(w)
            if abs(w.real) <= tolerance and abs(w.imag - found.frequency) <= tolerance:
                return found
        middle = (a + b) / 2
        w = leading_eigenvalue(replace(rod, F=middle))
        if w.real < 0:
            a = middle
            below = w
        else:
            b = middle
            above = w
    raise Unsolvable(f"the mode that grows above F = {a:g} does not oscillate there")


def _on_the_axis(
    problem: PathProblem, F: float, guess: complex, ends: tuple[float, float]
) -> HopfPointBelow | None:
    """The force between `ends`, near F, at which the eigenvalue near a guess is imaginary; or None."""
    for _ in range(HOPF_START.max_steps):
        w, slope, error = problem.eigenvalue(guess, F)
        if not (slope.real and isfinite(slope.real)):
            return None
        step = -w.real / slope.real
        if abs(w.real) <= HOPF_START.converged_growth * error or abs(step) <= HOPF_START.converged_step * abs(
            F
        ):
            return HopfPointBelow(F, w.imag) if w.imag > 0 else None
        F += step
        guess = w + step * slope
        if not ends[0] <= F <= ends[1]:
            return None
    return None


def orbit_from_hopf(form: StressForm, hopf: HopfPointBelow, workspace: NewtonWorkspace) -> Orbit:
    """The orbit of a rod on the branch from a Hopf point below its force, on a coarse mesh.

    workspace: memory of Newton's matrices. Raises Unsolvable if the branch leads to smaller forces or cannot
    be followed.
    """
    rod = form.rod
    at = replace(rod, F=hopf.F)
    normal = _normal_form(replace(form, rod=at), 1j * hopf.frequency)
    if not normal.amplitude > 0:
        raise Unsolvable(f"the branch from the Hopf point at F = {hopf.F:g} leads to smaller forces")
    if hopf.F * (1 + HOPF_START.direct_distance) >= rod.F:
        return orbit_by_normal_form(normal, replace(form, mesh=normal.form.mesh))
    coarse = replace(form, mesh=coarse_mesh(rod))
    for distance in HOPF_START.distances:
        try:
            return _orbit_from(normal, min(rod.F, hopf.F * (1 + distance)), coarse, workspace)
        except Unsolvable as error:
            why = error
    raise why


def small_orbit(form: StressForm, w: complex, amplitude: float) -> Orbit:
    """The small orbit at which a motion from a small tip deflection in the leading mode settles.

    The normal form gives the orbit. w: the leading eigenvalue of the straight rod. Raises Unsolvable where
    the normal form is not valid: the rod is far from a Hopf point, the start is too large, another mode may
    grow, or the Hopf point is subcritical.
    """
    if not (w.real > 0 and w.imag > 0):
        raise Unsolvable("the leading eigenvalues are not a growing complex pair")
    slope = path_problem(Path(form.rod, "F")).eigenvalue(w, form.rod.F)[1]
    rate = form.rod.F * slope.real
    if not w.real <= HOPF_START.direct_distance * rate:
        raise Unsolvable(f"F = {form.rod.F:g} is too far from a Hopf point for the normal form")
    normal = _normal_form(form, w)
    if not normal.supercritical:
        raise Unsolvable("the nearby Hopf point is subcritical")
    if not amplitude**2 <= HOPF_START.direct_distance * rate / -normal.c.real:
        raise Unsolvable(f"the amplitude {amplitude:g} of the start is too large for the normal form")
    if problem_of(form.rod).count(-CANDIDATES.behind * abs(w)).number != 2:
        raise Unsolvable("a second pair of modes may be unstable, for which the normal form does not hold")
    return orbit_by_normal_form(normal, replace(form, mesh=normal.form.mesh))


def _normal_form(form: StressForm, w: complex) -> NormalForm:
    """The normal form with the exact eigenvalue in place of the mesh's approximation."""
    normal = accurate_normal_form(form.rod, w, HOPF_START.normal_form_accuracy)
    return replace(normal, w=w)


def _orbit_from(normal: NormalForm, F: float, form: StressForm, workspace: NewtonWorkspace) -> Orbit:
    """The orbit of a rod, followed from the normal form's orbit at the force F; raises Unsolvable."""
    start = orbit_by_normal_form(normal, replace(form, rod=replace(form.rod, F=F)))
    found = at_orbit(
        newton(start, HOPF_START.branch_tolerance, workspace, "F"), HOPF_START.branch_tolerance, "F"
    )
    squared = normal.cycle(F)[0]
    least, most = HOPF_START.squared_ratios
    if not least < found.orbit.form.tip(found.orbit.start)[1] ** 2 / squared < most:
        raise Unsolvable(f"no cycle near the prediction from the Hopf point at F = {normal.F:g}")
    if form.rod.F == F:
        return found.orbit
    return orbit_in_steps(
        predictor_from(found, None, "F"), form, "F", HOPF_START.branch_tolerance, workspace
    ).orbit


def orbit_by_normal_form(normal: NormalForm, form: StressForm) -> Orbit:
    """The cycle predicted by the normal form for a rod at a nearby force."""
    squared, frequency = normal.cycle(form.rod.F)
    return orbit_of_amplitude(normal, form, squared**0.5, frequency)


def orbit_of_amplitude(normal: NormalForm, form: StressForm, amplitude: float, frequency: float) -> Orbit:
    """The orbit of a rod from a normal form. amplitude: largest y of the tip, in L; frequency: in 1/tau2."""
    X = normal.motion(amplitude, np.pi * node_times(HOPF_START.intervals, HOPF_START.stages))
    S, V = normal.form.fields(X)
    source = normal.form.mesh
    target = form.mesh
    states = form.layout.state(carried_stress(form.rod, S, source, target), V @ transfer(source, target).T)
    return Orbit.of(form, REFLECTION, 2 * np.pi / frequency, states, HOPF_START.stages)
