"""The limit cycle of one rod (paper, Sec. VII): task `limit_cycle` with `method: collocation`.

The search starts from the leading eigenmode or from the cycle of a neighbour, the previous rod of a chain.
From the eigenmode the motion is integrated until the motion approaches a cycle (`transient_integration`);
near a Hopf point the normal form predicts the cycle instead (`small_motion`). The cycle of a neighbour
predicts the cycle of this rod by continuation (`cycle_of_neighbouring_rod`). Newton's method then solves for
the periodic orbit on meshes chosen for the requested accuracy (`accuracy`). An orbit is accepted as a stable
cycle only by its Floquet multipliers: near a Hopf point, where motions decay slowly, two successive peaks of
the motion may agree although no cycle exists.
"""

from contextlib import suppress
from dataclasses import replace

from ...discretization.stress.form import StressForm
from ...model.rod import Rod
from ..motion.integrator import destroy_integrators
from ..motion.tip_target import bent_state_with_tip_at
from ..orbit.matrix.workspace import NewtonWorkspace
from ..point_outcome import outcome_or_failure
from ..spectrum.path.leader_in_range import next_range
from ..unsolvable import Unsolvable
from .accuracy.refined_cycle import RefinedCycle
from .accuracy.refinement import refined_cycle
from .cycle_of_neighbouring_rod import CycleStart, cycle_from_neighbour
from .cycle_outcome import (
    CycleOutcome,
    CycleRequest,
    MotionShapes,
    TransientOutcome,
    with_cycle_quantities,
    with_multipliers,
)
from .hopf_start import hopf_point_below_force, orbit_from_hopf
from .second_state import second_state_force_and_message
from .small_motion import reason_for_decay, stable_cycle_near_hopf
from .status import CycleStatus
from .straight_rod import (
    StraightRodStability,
    eigenvalues_to_follow,
    straight_rod_stability,
    straight_rod_stability_in_chain,
)
from .transient.motion_mesh import MOTION_MESH_SETTINGS, motion_mesh, motion_meshes_by_refinement
from .transient.shape_trace import ShapeTrace
from .transient.tip_trace import TipTrace
from .transient.torus import classify_quasiperiodic
from .transient.transient_integration import TransientIntegration

__all__ = ["CycleOutcome", "CycleRequest", "CycleStatus", "CycleStart", "solve_cycle"]


def solve_cycle(
    rod: Rod,
    request: CycleRequest,
    start: CycleStart | None = None,
    parameter_name: str | None = None,
    workspace: NewtonWorkspace | None = None,
) -> CycleOutcome:
    """Outcome of the search for the cycle of a rod from its leading mode, a neighbour's cycle or a Hopf
    point; a failure becomes a status, never an exception.

    start: `CycleOutcome.start_for_next_rod` of the previous rod of a chain, or None. parameter_name: name of
    the parameter that varies along the chain. workspace: memory of Newton's matrices, or None for new memory.
    """
    memory = workspace or NewtonWorkspace()

    def failed(cause: str) -> CycleOutcome:
        destroy_integrators()  # after an error inside PETSc its objects are unusable
        return CycleOutcome(status=CycleStatus.failed, message=cause)

    def solve() -> CycleOutcome:
        stability = (
            straight_rod_stability(rod)
            if start is None
            else straight_rod_stability_in_chain(rod, start.eigenvalues, parameter_name, start.arm_range)
        )
        cycle = _solve_cycle_or_raise(rod, request, stability, start, parameter_name, memory)
        return _with_second_state(rod, _with_status_by_spectrum(cycle, stability), stability)

    return outcome_or_failure(solve, failed)


def _solve_cycle_or_raise(
    rod: Rod,
    request: CycleRequest,
    stability: StraightRodStability,
    neighbour: CycleStart | None,
    parameter_name: str | None,
    workspace: NewtonWorkspace,
) -> CycleOutcome:
    w = stability.w
    straight = _outcome_at_straight_rod(w)
    if request.start == "hopf":
        return _cycle_from_hopf(_form_on_motion_mesh(rod), request, straight, stability, workspace)
    refined = None
    if neighbour is not None and parameter_name is not None:
        form = StressForm(rod, neighbour.predictor.orbit.form.mesh)
        # A failed continuation is not a failure of the point: the motion is integrated instead.
        with suppress(Unsolvable):
            refined = cycle_from_neighbour(neighbour, form, parameter_name, request.accuracy, workspace)
    elif neighbour is None and not request.is_motion_recorded:
        refined = stable_cycle_near_hopf(_form_on_motion_mesh(rod), w, request, parameter_name, workspace)
    # A motion ends at a stable cycle only; an unstable one is a hint for the integration below.
    if refined is not None and refined.status_and_message(request.accuracy)[0] == CycleStatus.cycle:
        cycle = with_cycle_quantities(replace(straight, status=CycleStatus.cycle), refined, request)
        return _with_next_start(cycle, refined, neighbour, parameter_name, request.accuracy, stability)
    is_from_mode = neighbour is None and request.tip is None
    decay_reason = reason_for_decay(rod, w, request.amplitude) if is_from_mode else ""
    if decay_reason and not request.is_motion_recorded:
        return replace(straight, message=decay_reason)
    unstable_cycle = refined if refined is not None and refined.is_stable is False else None
    for form in (StressForm(rod, mesh) for mesh in motion_meshes_by_refinement(rod, request.transient > 0)):
        # On too coarse a mesh a motion may repeat where finer meshes have no cycle.
        transient = TransientIntegration(form, stability, request, parameter_name, unstable_cycle, workspace)
        end = _outcome_of_motion(transient, request, neighbour)
        if not transient.unsolved_message:
            break
    cycle = _with_motion_data(straight, transient, end, request)
    if decay_reason:
        return replace(cycle, message=decay_reason)
    cycle = replace(cycle, status=end.status, message=end.message, modulation_ratio=end.modulation_ratio)
    if end.cycle is None:
        return cycle if end.unstable_cycle is None else with_multipliers(cycle, end.unstable_cycle)
    cycle = with_cycle_quantities(cycle, end.cycle, request)
    return _with_next_start(cycle, end.cycle, None, parameter_name, request.accuracy, stability)


def _outcome_at_straight_rod(w: complex) -> CycleOutcome:
    """Outcome of a motion that ends at the straight rod, with the leading eigenvalue w of this rod."""
    return CycleOutcome(status=CycleStatus.straight, linear_growth_rate=w.real, linear_frequency=abs(w.imag))


def _form_on_motion_mesh(rod: Rod) -> StressForm:
    """Discretization of a rod on the first mesh for the integration of its motion."""
    return StressForm(rod, motion_mesh(rod, MOTION_MESH_SETTINGS.accuracy))


def _with_motion_data(
    outcome: CycleOutcome, transient: TransientIntegration, end: TransientOutcome, request: CycleRequest
) -> CycleOutcome:
    """The outcome `outcome` with the mesh, the number of returns and the requested path or shapes of the
    integrated motion `transient`. end: outcome of this motion."""
    trace = transient.record
    return replace(
        outcome,
        periods=end.return_count,
        elements=transient.form.mesh.element_count,
        order=transient.form.mesh.order,
        transient_tip_path=trace.path_at_equidistant_times(request.transient)
        if isinstance(trace, TipTrace)
        else None,
        motion_shapes=_motion_shapes(transient, trace, request) if isinstance(trace, ShapeTrace) else None,
    )


def _motion_shapes(transient: TransientIntegration, trace: ShapeTrace, request: CycleRequest) -> MotionShapes:
    """The shapes that `trace` recorded along the integrated motion `transient`, at the requested numbers of
    times and nodes."""
    return_times = [time for time, _ in transient.past_returns]
    return trace.motion_shapes(return_times, transient.leading_mode.period, request.frames, request.nodes)


def _with_next_start(
    cycle: CycleOutcome,
    refined: RefinedCycle,
    previous: CycleStart | None,
    parameter_name: str | None,
    accuracy: float,
    stability: StraightRodStability,
) -> CycleOutcome:
    """The outcome `cycle` with the data of the solved cycle `refined` from which the next rod of a chain
    starts; unchanged outside a chain (`parameter_name` is None). previous: data of the previous rod, or None.
    parameter_name: parameter that varies along the chain. accuracy: requested relative accuracy. stability:
    leading eigenvalue of the straight rod."""
    if parameter_name is None:
        return cycle
    rod = refined.orbit.form.rod
    eigenvalues = eigenvalues_to_follow(rod, stability)
    start = CycleStart.from_cycle(refined, previous, parameter_name, accuracy, eigenvalues)
    if previous is not None:
        previous_rod = previous.predictor.orbit.form.rod
        arm_range = next_range(rod, previous_rod, parameter_name, stability.arm_range, eigenvalues)
        start = replace(start, arm_range=arm_range)
    return replace(cycle, start_for_next_rod=start)


def _with_status_by_spectrum(cycle: CycleOutcome, stability: StraightRodStability) -> CycleOutcome:
    """The outcome `cycle`. The status `straight` is replaced by `not_settled`, with a reason as message,
    unless the spectrum, `stability`, proves the straight rod stable."""
    if cycle.status != CycleStatus.straight or stability.is_stable:
        return cycle
    return replace(cycle, status=CycleStatus.not_settled, message=stability.unproved_stability_text)


def _with_second_state(rod: Rod, cycle: CycleOutcome, stability: StraightRodStability) -> CycleOutcome:
    """The outcome `cycle` with the second stable state of the rod, as far as known, and a message about this
    state."""
    state, F, reason = second_state_force_and_message(rod, cycle.status, stability.is_stable)
    message = "; ".join(filter(None, (cycle.message, reason)))
    return replace(cycle, second_state=int(state), subcritical_F=F, message=message)


def _cycle_from_hopf(
    form: StressForm,
    request: CycleRequest,
    outcome: CycleOutcome,
    stability: StraightRodStability,
    workspace: NewtonWorkspace,
) -> CycleOutcome:
    """The outcome of the search for the cycle on the branch from the Hopf point below the force of the rod.

    outcome: outcome to which the quantities of the cycle are added, or only a status and a message if no
    cycle is found. stability: stability of the straight rod, for the status if there is no Hopf point. form:
    the discretized rod.
    """
    try:
        hopf = hopf_point_below_force(form.rod)
        if hopf is None:
            status = CycleStatus.straight if stability.is_stable else CycleStatus.not_settled
            return replace(outcome, status=status, message="there is no Hopf point at a smaller force")
        refined = refined_cycle(orbit_from_hopf(form, hopf, workspace), request.accuracy, workspace)
    except Unsolvable as reason:
        return replace(outcome, status=CycleStatus.not_settled, message=str(reason))
    status, message = refined.status_and_message(request.accuracy)
    return with_cycle_quantities(replace(outcome, status=status, message=message), refined, request)


def _outcome_of_motion(
    transient: TransientIntegration, request: CycleRequest, neighbour: CycleStart | None
) -> TransientOutcome:
    """Outcome of the motion that `transient` integrates from the requested tip position, from the leading
    mode, or from a state of the neighbour's cycle; a quasiperiodic motion is recognised."""
    system = transient.system
    if request.tip is not None:
        start = bent_state_with_tip_at(system, *request.tip)
    elif neighbour is None:
        start = transient.leading_mode.state(request.amplitude)
    else:
        orbit = neighbour.predictor.orbit
        start = system.state_of_stresses(orbit.form.stresses_on_mesh(system.mesh, orbit.start_state))
    return classify_quasiperiodic(transient.integrate_to_outcome(start), transient)
