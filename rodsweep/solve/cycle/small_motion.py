"""Outcome of a small motion about the straight rod, from the normal form of the leading mode, without
integration.

Slightly beyond a supercritical Hopf point the motion converges to the small cycle of the normal form. If the
leading mode decays, and the cubic term of its growth rate is small compared with the linear term, the motion
decays to the straight rod.
"""

from dataclasses import dataclass

from ...discretization.stress.form import StressForm
from ...model.rod import Rod
from ..hopf.normal_form import normal_form_by_mesh_rule
from ..orbit.matrix.workspace import NewtonWorkspace
from ..unsolvable import Unsolvable
from .accuracy.refined_cycle import RefinedCycle
from .accuracy.refinement import refined_cycle
from .cycle_outcome import CycleRequest
from .hopf_start import predicted_orbit_near_hopf
from .status import CycleStatus
from .transient.transient_settings import TRANSIENT_SETTINGS


@dataclass(frozen=True, slots=True, kw_only=True)
class MotionDecaySettings:
    """Settings for the proof that a small motion decays to the straight rod."""

    max_cubic_to_linear_growth_ratio: float = 0.02
    """A motion decays if Re w < 0 and |Re c| a^2 < max_cubic_to_linear_growth_ratio |Re w|. a: tip's y at the
    start, w: leading eigenvalue, c: cubic coefficient of the normal form, computed to this relative
    accuracy."""


MOTION_DECAY_SETTINGS = MotionDecaySettings()


def stable_cycle_near_hopf(
    form: StressForm,
    w: complex,
    request: CycleRequest,
    parameter_name: str | None,
    workspace: NewtonWorkspace,
) -> RefinedCycle | None:
    """The stable small cycle near a Hopf point to which the motion from the requested start converges; None
    if no such cycle is found, or if the modulus of its largest nontrivial multiplier is close to 1.

    form: the discretized rod. w: leading eigenvalue of the straight rod. parameter_name: parameter along
    which the tangent of the cycle is computed, or None. workspace: memory of Newton's matrices.
    """
    try:
        cycle = refined_cycle(
            predicted_orbit_near_hopf(form, w, request.amplitude), request.accuracy, workspace, parameter_name
        )
    except Unsolvable:
        return None
    is_stable = cycle.status_and_message(request.accuracy)[0] == CycleStatus.cycle
    return (
        cycle
        if is_stable and 1 - cycle.largest_multiplier_modulus >= TRANSIENT_SETTINGS.min_unit_circle_distance
        else None
    )


def reason_for_decay(rod: Rod, w: complex, amplitude: float) -> str:
    """Message that explains why a motion from the leading mode decays to the straight rod; "" if the normal
    form does not prove the decay.

    w: leading eigenvalue of the straight rod. amplitude: tip's y at the start, in L.
    """
    if not (w.real < 0 < w.imag):
        return ""
    try:
        normal = normal_form_by_mesh_rule(rod, w, MOTION_DECAY_SETTINGS.max_cubic_to_linear_growth_ratio)
    except Unsolvable:
        return ""
    # d|z|/dt = (Re w + Re c |z|^2) |z|: while the cubic term is small, the motion can only decay.
    cubic_ratio = abs(normal.landau.real) * amplitude**2 / -w.real
    if cubic_ratio >= MOTION_DECAY_SETTINGS.max_cubic_to_linear_growth_ratio:
        return ""
    return (
        f"the motion decays: at its start the cubic term is only {cubic_ratio:.0e} of the linear decay rate"
    )
