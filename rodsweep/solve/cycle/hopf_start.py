"""From the Hopf point to the cycle at a force: the branch that is born there, without following a motion.

The Hopf point is the nearest below the force at which the straight rod starts to oscillate. Its normal form
gives amplitude, frequency and shape of the cycles near it. Very near that is the start of Newton's method on
the mesh that the accuracy asks for; farther away the branch is followed on a coarse mesh, which has a Hopf
point of its own, perhaps on the other side of a force that is very near.
"""

from dataclasses import dataclass, replace
from math import isnan

import numpy as np

from ...determinant.certificate.winding_number import count_right_of
from ...determinant.newton import crossing_newton, eigenvalue_newton
from ...determinant.parameter_path import Path
from ...discretization.elements.mesh import mesh
from ...discretization.stress.form import StressForm
from ...model.rod import Rod
from ..hopf.normal_form import NormalForm, accurate_normal_form
from ..orbit.matrix.workspace import NewtonWorkspace
from ..orbit.newton import at_orbit, newton
from ..orbit.orbit import Orbit, node_times
from ..orbit.symmetry import REFLECTION
from ..point import Unsolvable
from ..spectrum.candidates import BEHIND
from ..spectrum.spectrum import SpectrumRequest
from .along_parameter import followed_from, in_steps
from .straight_rod import straight_rod

LEADING = SpectrumRequest(1, 1e-9, False)
SCAN = 0.93
"""Ratio of the forces at which the sign of the leading growth rate is looked at."""
LEAST_FORCE = 1e-2
"""Force below which no rod of finite length oscillates: F nu (nu + F c2) must exceed the order of pi^2."""
FOUND = 1e-6
"""Growth rate of the leading mode at the Hopf point, in units of its frequency."""
NORMAL_FORM_ACCURACY = 1e-3
STARTS = (0.3, 0.12, 0.03, 0.006)
"""Relative distances from the Hopf point at which the normal form starts Newton's method, one after the
other: in most rods its orbit's size is off by a quarter at the first, by a tenth at the second."""
NEAREST = 1e-2
"""Relative distance from the Hopf point within which the normal form's cycle is near enough to the one of
the rod: its amplitude is then off by 1 percent in most rods."""
ORDER_PER_WAVE, LEAST_ORDER = 0.55, 12
INTERVALS, STAGES = 8, 3
"""In time, over half a period, of the mesh on which the branch is followed."""
TOLERANCE = 3e-3
"""To which the orbits on the way are solved."""


@dataclass(frozen=True, slots=True)
class Onset:
    """F in k3/L^2 and the frequency of the leading mode there in 1/tau2."""

    F: float
    frequency: float


def leading_eigenvalue(rod: Rod, near: complex | None = None) -> complex:
    """The leading eigenvalue of the straight rod, Im >= 0; raises Unsolvable where it is not found.

    near: the one of a rod near by.
    """
    found = straight_rod(rod, near, LEADING)
    if isnan(found.error):
        raise Unsolvable(f"the spectrum at F = {rod.F:g} is not known: {found.message}")
    return found.w


def hopf_point_below(rod: Rod) -> Onset | None:
    """The nearest force below the rod's own at which the leading mode starts to grow, if there is one."""
    above, F = leading_eigenvalue(rod), rod.F
    while F > LEAST_FORCE:
        lower = F * SCAN
        below = leading_eigenvalue(replace(rod, F=lower), above)
        if below.real < 0 <= above.real:
            return _crossing(rod, (lower, below), (F, above))
        F, above = lower, below
    return None


def _crossing(rod: Rod, low: tuple[float, complex], high: tuple[float, complex]) -> Onset:
    """The Hopf point between two forces, each with the leading eigenvalue there; raises Unsolvable."""
    path = Path(rod, "F")
    (a, below), (b, above) = low, high
    while b - a > FOUND * b:
        share = below.real / (below.real - above.real)
        eta, F = below.imag + share * (above.imag - below.imag), a + share * (b - a)
        zero = crossing_newton(eta, F, path.origin, path.direction, (eta, F))
        if a <= zero.p <= b:
            w = leading_eigenvalue(replace(rod, F=zero.p))
            if abs(w.real) <= FOUND * abs(w) and abs(w.imag - zero.eta_or_x) <= FOUND * abs(w):
                return Onset(zero.p, zero.eta_or_x)
        middle = (a + b) / 2
        w = leading_eigenvalue(replace(rod, F=middle))
        if w.real < 0:
            a, below = middle, w
        else:
            b, above = middle, w
    raise Unsolvable(f"what grows from F = {a:g} on does not oscillate there")


def orbit_from_hopf(form: StressForm, hopf: Onset, workspace: NewtonWorkspace) -> Orbit:
    """The orbit of a rod on the branch from a Hopf point below its force, on a coarse mesh.

    workspace: memory of Newton's matrices. Raises Unsolvable where there is none: the branch goes to smaller
    forces, or cannot be followed.
    """
    rod = form.rod
    at = replace(rod, F=hopf.F)
    normal = _normal_form(replace(form, rod=at), 1j * hopf.frequency)
    if not normal.amplitude > 0:
        raise Unsolvable(f"the cycles from the Hopf point at F = {hopf.F:g} go to smaller forces")
    if rod.F <= hopf.F * (1 + NEAREST):
        return orbit_of(normal, replace(form, mesh=normal.form.mesh))
    order = max(LEAST_ORDER, int(ORDER_PER_WAVE * 2.5 * abs(rod.F) ** 0.5))
    coarse = replace(form, mesh=mesh(1, order))
    for part in STARTS:
        try:
            return _followed_from(normal, min(rod.F, hopf.F * (1 + part)), coarse, workspace)
        except Unsolvable as error:
            why = error
    raise why


def small_orbit(form: StressForm, w: complex, amplitude: float) -> Orbit:
    """The orbit to which a rod settles from a small tip deflection in its leading mode, by its normal form.

    w: the leading eigenvalue of the straight rod. Raises Unsolvable where the normal form does not tell: the
    rod is far from a Hopf point, the start too large, another mode grows, or the growth does not saturate.
    """
    if not (w.real > 0 and w.imag > 0):
        raise Unsolvable("the leading mode is no growing pair")
    slope = eigenvalue_newton(w, form.rod.coefficients, form.rod.direction("F"))[1]
    rate = form.rod.F * slope.real
    if not w.real <= NEAREST * rate:
        raise Unsolvable("no Hopf point is near")
    normal = _normal_form(form, w)
    if not normal.supercritical:
        raise Unsolvable("the Hopf point that is near is subcritical")
    if not amplitude**2 <= NEAREST * rate / -normal.c.real:
        raise Unsolvable("the start is too large for the normal form")
    if count_right_of(-BEHIND * abs(w), form.rod).number != 2:
        raise Unsolvable("another mode may grow")
    return orbit_of(normal, replace(form, mesh=normal.form.mesh))


def _normal_form(form: StressForm, w: complex) -> NormalForm:
    """Of an eigenvalue that is exact, which the mesh has only nearly."""
    normal = accurate_normal_form(form.rod, w, NORMAL_FORM_ACCURACY)
    return replace(normal, w=w)


def _followed_from(normal: NormalForm, F: float, form: StressForm, workspace: NewtonWorkspace) -> Orbit:
    """The orbit of a rod by way of the one that the normal form predicts at a force; raises Unsolvable."""
    start = orbit_of(normal, replace(form, rod=replace(form.rod, F=F)))
    found = at_orbit(newton(start, TOLERANCE, workspace, "F"), TOLERANCE, "F")
    squared = normal.cycle(F)[0]
    if not 0.3 < found.orbit.form.tip(found.orbit.start)[1] ** 2 / squared < 3.0:
        raise Unsolvable(f"no cycle near the one that the Hopf point at F = {normal.F:g} predicts")
    if form.rod.F == F:
        return found.orbit
    return in_steps(followed_from(found, None, "F"), form, "F", TOLERANCE, workspace).orbit


def orbit_of(normal: NormalForm, form: StressForm) -> Orbit:
    """The cycle that the normal form predicts for a rod at a force near its own."""
    squared, frequency = normal.cycle(form.rod.F)
    return orbit_with(normal, form, squared**0.5, frequency)


def orbit_with(normal: NormalForm, form: StressForm, amplitude: float, frequency: float) -> Orbit:
    """A motion of a normal form as an orbit of a rod; the largest tip y in L, frequency in 1/tau2."""
    X = normal.motion(amplitude, np.pi * node_times(INTERVALS, STAGES))
    S, V = normal.form.fields(X)
    E = normal.form.mesh.evaluation(form.mesh.positions)
    states = form.layout.state(S @ E.T, V @ E.T)
    return Orbit.of(form, REFLECTION, 2 * np.pi / frequency, states, STAGES)
