"""Where a small motion about the straight rod goes, by the normal form of its leading mode.

No motion is followed: beside a supercritical Hopf point it grows or decays to the small cycle there, and it
decays where the cubic part of its growth rate is small beside the linear one.
"""

from ...discretization.stress.form import StressForm
from ...model.rod import Rod
from ..hopf.normal_form import accurate_normal_form
from ..orbit.matrix.workspace import NewtonWorkspace
from ..point import Unsolvable
from .accuracy.refinement import RefinedCycle, refined_cycle
from .cycle import CycleRequest
from .hopf_start import small_orbit
from .status import CycleStatus
from .transient.transient import NEUTRAL

FADING = 0.02
"""Cubic part of the growth rate, relative, below which a small motion decays as the linear one does."""


def small_cycle(
    form: StressForm, w: complex, request: CycleRequest, along: str | None, workspace: NewtonWorkspace
) -> RefinedCycle | None:
    """The stable cycle just above a Hopf point to which the start grows or decays; None where it is not one.

    w: the leading eigenvalue of the straight rod. workspace: memory of Newton's matrices.
    """
    try:
        found = refined_cycle(small_orbit(form, w, request.amplitude), request.accuracy, workspace, along)
    except Unsolvable:
        return None
    settled = found.verdict(request.accuracy)[0] == CycleStatus.cycle
    return found if settled and 1 - found.largest_multiplier >= NEUTRAL else None


def decay(rod: Rod, w: complex, amplitude: float) -> str:
    """Why a small motion in the leading mode decays; empty where only the motion itself can tell."""
    if not (w.real < 0 < w.imag):
        return ""
    try:
        normal = accurate_normal_form(rod, w, FADING)
    except Unsolvable:
        return ""
    share = abs(normal.c.real) * amplitude**2 / -w.real
    return (
        f"decays: what bends its growth rate is {share:.0e} of it at this amplitude" if share < FADING else ""
    )
