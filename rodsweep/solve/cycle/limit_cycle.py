"""The limit cycle of one rod, from a start to its numbers (paper, Sec. VII).

The rod starts from its leading eigenmode, or from a neighbour's cycle. From the mode its motion is followed
until it comes near a cycle (`transient`); beside a Hopf point the normal form predicts where it goes
(`small_motion`), and a neighbour predicts the cycle (`neighbour`). Newton's method then solves for the
periodic orbit on meshes of its own choice (`accuracy`). It is called a cycle only if it is proved stable by
its multipliers; that two peaks are close proves nothing near the Hopf point, where motions decay slowly.
"""

from contextlib import suppress
from dataclasses import replace
from math import nan

import numpy as np

from ...discretization.elements.mesh import mesh
from ...discretization.stress.form import StressForm
from ...errors import EnvironmentIncomplete
from ...model.rod import Rod
from ..backend.petsc import options
from ..motion.integrator import forget_integrators
from ..motion.time_scheme import CYCLE_PREFIX
from ..orbit.matrix.workspace import NewtonWorkspace
from ..point import Unsolvable, solved
from .accuracy.refinement import RefinedCycle, refined_cycle
from .cycle import Cycle, CycleRequest, first_of, measured
from .hopf_start import hopf_point_below, orbit_from_hopf
from .neighbour import Neighbour, followed_cycle
from .second_state import second_state
from .small_motion import decay, small_cycle
from .status import CycleStatus
from .straight_rod import StraightRod, straight_rod
from .transient.stepped_rod import motion_resolution
from .transient.torus import torus_or
from .transient.transient import Transient, TransientOutcome

__all__ = ["Cycle", "CycleRequest", "CycleStatus", "Neighbour", "solve_cycle", "warm_up"]

KNOWN_PERIOD, KNOWN_WITHIN = 0.04204870, 1e-3
"""Period in tau2 of the rod (40, 1e4, 1e2, 1e-2, 1), which a displacement-form code confirms, and how far
off it may come out at the accuracy that is asked of it here."""
MOTION_ACCURACY = 1e-5
"""Of the mesh on which the motion is followed: it decides the basin, Newton's method supplies the digits."""
STORED_MULTIPLIERS, LEAST_MULTIPLIER = 6, 1e-6
"""Floquet multipliers that are stored, and the least modulus of one."""
NO_MULTIPLIER = complex(nan, nan)
"""Stored for multipliers below LEAST_MULTIPLIER."""


def solve_cycle(
    rod: Rod,
    request: CycleRequest,
    start: Neighbour | None = None,
    along: str | None = None,
    workspace: NewtonWorkspace | None = None,
) -> Cycle:
    """The cycle that the rod reaches from its leading mode, or that a neighbour's `Cycle.neighbour` leads to.

    start: the neighbour. along: the parameter by which neighbours differ. workspace: memory of Newton's
    matrices that rods share; without it the rod has its own. Failures are a status, never an exception.
    """
    memory = workspace or NewtonWorkspace()

    def failed(cause: str) -> Cycle:
        forget_integrators()  # a PETSc object is not usable after an error inside it
        return Cycle(status=CycleStatus.failed, message=cause)

    def solve() -> Cycle:
        stability = straight_rod(rod, start.leading if start else None)
        cycle = _solve(rod, request, stability, start, along, memory)
        return _with_second_state(rod, _by_the_spectrum(cycle, stability), stability)

    return solved(solve, failed)


def warm_up() -> None:
    """Loads what is compiled and created at first use, so that no point pays for it.

    Raises EnvironmentIncomplete if options of the prefix cycle_ lose the cycle of a rod whose cycle is known.
    """
    rod = Rod(F=40.0, k1=1e4, k2=1e2, gamma3=1e-2, gamma1=1.0)
    request = CycleRequest(1e-3, 0.1, 1, 4, 1, 4, 50)
    cycle = solve_cycle(rod, request, None, "F")
    if cycle.neighbour is not None:
        solve_cycle(replace(rod, F=1.01 * rod.F), request, cycle.neighbour, "F")
    off = abs(cycle.measures.period / KNOWN_PERIOD - 1)
    known = cycle.status == CycleStatus.cycle and off < KNOWN_WITHIN
    given = options(CYCLE_PREFIX)
    if given and not known:
        said = f"{cycle.status.name} {cycle.message}".strip()
        raise EnvironmentIncomplete(
            f"with the PETSc options '{given}' a rod whose cycle is known ends as '{said}', so the task "
            "limit_cycle cannot run; remove them"
        )


def _solve(
    rod: Rod,
    request: CycleRequest,
    stability: StraightRod,
    neighbour: Neighbour | None,
    along: str | None,
    workspace: NewtonWorkspace,
) -> Cycle:
    w = stability.w
    straight = Cycle(status=CycleStatus.straight, linear_growth_rate=w.real, linear_frequency=abs(w.imag))
    resolution = motion_resolution(rod, MOTION_ACCURACY)
    form = StressForm(rod, mesh(resolution.elements, resolution.order))
    if request.start == "hopf":
        return _from_hopf(form, request, straight, stability, workspace)
    found = None
    if neighbour is not None and along is not None:
        with suppress(Unsolvable):
            found = followed_cycle(neighbour, form, along, request.accuracy, workspace)
    elif neighbour is None and not request.transient:
        found = small_cycle(form, w, request, along, workspace)
    if found is not None and found.verdict(request.accuracy)[0] == CycleStatus.cycle:
        cycle = _with_numbers(replace(straight, status=CycleStatus.cycle), found, request)
        return _handed_on(cycle, found, neighbour, along, request.accuracy)
    faded = decay(rod, w, request.amplitude) if neighbour is None else ""
    if faded and not request.transient:
        return replace(straight, message=faded)
    unstable = found if found is not None and found.stable is False else None
    transient = Transient(form, stability, request, along, unstable, workspace)
    end = _from_motion(transient, request, neighbour)
    cycle = _after_motion(straight, transient, end, request)
    if faded:
        return replace(cycle, message=faded)
    cycle = replace(cycle, status=end.status, message=end.message)
    if end.found is None:
        return cycle if end.around is None else _with_multipliers(cycle, end.around)
    return _handed_on(_with_numbers(cycle, end.found, request), end.found, None, along, request.accuracy)


def _after_motion(
    straight: Cycle, transient: Transient, end: TransientOutcome, request: CycleRequest
) -> Cycle:
    """The outcome with what the motion took, and its path where it is asked for."""
    return replace(
        straight,
        periods=end.periods,
        elements=transient.form.mesh.elements,
        order=transient.form.mesh.order,
        transient=transient.trace.at_equal_times(request.transient) if transient.trace else None,
    )


def _handed_on(
    cycle: Cycle, found: RefinedCycle, before: Neighbour | None, along: str | None, accuracy: float
) -> Cycle:
    """The cycle with what the next point starts from, where points follow each other."""
    if along is None:
        return cycle
    leading = complex(cycle.linear_growth_rate, cycle.linear_frequency)
    return replace(cycle, neighbour=Neighbour.of(found, before, along, accuracy, leading))


def _by_the_spectrum(cycle: Cycle, stability: StraightRod) -> Cycle:
    """The same, but straight only where the spectrum says that the straight rod is stable."""
    if cycle.status != CycleStatus.straight or stability.stable:
        return cycle
    return replace(cycle, status=CycleStatus.not_settled, message=stability.doubt)


def _with_second_state(rod: Rod, cycle: Cycle, stability: StraightRod) -> Cycle:
    """The same, and whether the rod has another stable state."""
    state, F, why = second_state(rod, cycle.status, stability.stable)
    message = "; ".join(filter(None, (cycle.message, why)))
    return replace(cycle, second_state=int(state), subcritical_F=F, message=message)


def _from_hopf(
    form: StressForm,
    request: CycleRequest,
    straight: Cycle,
    stability: StraightRod,
    workspace: NewtonWorkspace,
) -> Cycle:
    """The cycle on the branch from the Hopf point; straight: the outcome where there is none below."""
    try:
        hopf = hopf_point_below(form.rod)
        if hopf is None:
            status = CycleStatus.straight if stability.stable else CycleStatus.not_settled
            return replace(straight, status=status, message="no Hopf point at any smaller force")
        found = refined_cycle(orbit_from_hopf(form, hopf, workspace), request.accuracy, workspace)
    except Unsolvable as why:
        return replace(straight, status=CycleStatus.not_settled, message=str(why))
    status, message = found.verdict(request.accuracy)
    return _with_numbers(replace(straight, status=status, message=message), found, request)


def _from_motion(
    transient: Transient, request: CycleRequest, neighbour: Neighbour | None
) -> TransientOutcome:
    """Where the rod goes from its leading mode, or from a state of its neighbour's cycle."""
    beam = transient.beam
    if neighbour is None:
        return torus_or(transient.follow(request.amplitude * transient.mode.z.real), transient)
    orbit = neighbour.branch.orbit
    stresses = orbit.form.stresses(orbit.start) @ orbit.form.mesh.evaluation(beam.mesh.positions).T
    return torus_or(transient.follow(beam.scaled(stresses)), transient)


def _with_numbers(cycle: Cycle, found: RefinedCycle, request: CycleRequest) -> Cycle:
    """The outcome with the numbers of its cycle."""
    cycle = measured(cycle, request, found.path, found.measures, found.errors)
    return _with_multipliers(cycle, found)


def _with_multipliers(cycle: Cycle, found: RefinedCycle) -> Cycle:
    """The outcome with the multipliers of a cycle and their error."""
    mu = first_of(found.multipliers, STORED_MULTIPLIERS, NO_MULTIPLIER)
    mu[np.abs(mu) < LEAST_MULTIPLIER] = NO_MULTIPLIER
    return replace(
        cycle,
        multiplier=found.largest_multiplier,
        multipliers=mu,
        trivial_multiplier_error=found.trivial_error,
        errors=replace(cycle.errors, multiplier_error=found.errors.multiplier_error),
    )
