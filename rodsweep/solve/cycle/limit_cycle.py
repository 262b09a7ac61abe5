"""The limit cycle of one rod, from a start to its numbers (paper, Sec. VII).

The rod starts from its leading eigenmode, or from a neighbour's cycle. From the mode its motion is followed
until it comes near a cycle (`transient`), just above a Hopf point the normal form predicts it (`hopf_start`);
a neighbour predicts the cycle (`neighbour`). Newton's method then
solves for the periodic orbit (`orbit`, `condensation`) on meshes of its own choice (`refinement`), and it is
measured (`measures`). It is called a cycle only if it is proved stable by its multipliers; that two peaks are
close proves nothing near the Hopf point, where motions decay slowly.
"""

from contextlib import suppress
from dataclasses import dataclass, replace
from math import nan
from typing import Any

import numpy as np

from ...arrays import Array, Complex
from ...discretization.beam import Beam
from ...discretization.mesh import mesh
from ...discretization.resolution import expected_wave_number, resolution_for
from ...discretization.stress_form import StressForm
from ...errors import EnvironmentLacks
from ...model.dispersion import most_amplified_wave
from ...model.rod import Rod
from ..backend.petsc import options
from ..hopf.normal_form import accurate_normal_form
from ..motion.integrator import forget_integrators
from ..motion.time_scheme import CYCLE_PREFIX
from ..orbit.measures import Measures
from ..point import Unsolvable, solved
from ..status import PointStatus
from .accuracy.cycle_errors import UNKNOWN_ERRORS, CycleErrors
from .accuracy.refinement import RefinedCycle, refined_cycle
from .hopf_start import hopf_point_below, orbit_from_hopf, small_orbit
from .neighbour import Neighbour, followed_cycle
from .second_state import SecondState, second_state
from .status import CycleStatus
from .straight_rod import StraightRod, straight_rod
from .transient.torus import torus_or
from .transient.transient import NEUTRAL, Transient, TransientOutcome

__all__ = ["Cycle", "CycleRequest", "CycleStatus", "solve_cycle", "warm_up"]


EXPECTED_MODES = 3
"""Modes by whose wave number the first mesh is chosen; the cycle says whether it is fine enough."""
FOLDS = 2.5
"""Largest wave number of a cycle in units of sqrt(F), the inverse of the length to which F bends a rod."""
KNOWN_PERIOD, KNOWN_WITHIN = 0.04204870, 1e-3
"""Period in tau2 of the rod (40, 1e4, 1e2, 1e-2, 1), which a displacement-form code confirms, and how far
off it may come out at the accuracy that is asked of it here."""
MOTION_ACCURACY = 1e-5
"""Of the mesh on which the motion is followed: it decides the basin, Newton's method supplies the digits."""
STIFFEST, LEAST_DRAG = 1e8, 1e-6
"""Largest stiffness and least gamma3 in a motion: what is beyond moves like these, to 1e-6 at least."""
STORED_MULTIPLIERS, LEAST_MULTIPLIER = 6, 1e-6
"""Floquet multipliers that are stored, and the least modulus of one."""
UNTOLD = complex(nan, nan)
"""What is stored instead of one that is less."""
FADING = 0.02
"""Cubic part of the growth rate, relative, below which a small motion decays as the linear one does."""


@dataclass(frozen=True, slots=True)
class CycleRequest:
    """What is asked of every rod.

    accuracy: relative, of period and extrema. amplitude: the tip's y of the start, in L. start: "mode" for
    the leading mode, "neighbour" for it where there is no neighbour, "hopf" for the Hopf point. harmonics:
    how many. samples: of the tip and of the energy over a period; shapes, nodes: shapes over a period and
    Lobatto nodes of each; 0 for none. most_periods: returns of the tip to wait for. transient: times of the
    tip's path from the start; 0 for none. A path that is wanted has no jumps, and is followed where its end
    is known without it.
    """

    accuracy: float
    amplitude: float
    harmonics: int
    samples: int
    shapes: int
    nodes: int
    most_periods: int
    start: str = "mode"
    transient: int = 0


@dataclass(frozen=True, kw_only=True)
class Cycle:
    """What became of one rod, and the numbers of its cycle: NaN or None where there is none.

    linear_growth_rate and linear_frequency of the leading mode about the straight rod, 1/tau2; periods:
    returns waited for. second_state: a SecondState, subcritical_F: the force of the Hopf point that makes a
    cycle possible. multiplier: the largest nontrivial Floquet multiplier's modulus; multipliers: the
    largest ones, complex, (STORED_MULTIPLIERS,); trivial_multiplier_error: distance of the trivial one from
    1. On a torus these are all that is known, and those of the unstable cycle that it surrounds.

    tip: x, y, theta at equidistant times, (3, samples); energy: U in k3/L, injection, dissipation, (3,
    samples); shape: x, y, theta, (3, shapes, nodes). Time starts where the tip's y rises through its mean.
    transient: time in tau2, x, y, theta of the tip from the start to where the motion was left, (4,
    transient); None where no motion was followed.
    neighbour: what the next point of a chain starts from.
    """

    status: PointStatus
    message: str = ""
    seconds: float = 0.0
    linear_growth_rate: float = nan
    linear_frequency: float = nan
    periods: int = 0
    second_state: int = SecondState.not_told
    subcritical_F: float = nan
    elements: int = 0
    order: int = 0
    measures: Measures = Measures()
    errors: CycleErrors = UNKNOWN_ERRORS
    multiplier: float = nan
    multipliers: Complex | None = None
    trivial_multiplier_error: float = nan
    tip: Array | None = None
    energy: Array | None = None
    shape: Array | None = None
    transient: Array | None = None
    neighbour: Array | None = None


def solve_cycle(
    rod: Rod, request: CycleRequest, start: Array | None = None, along: str | None = None
) -> Cycle:
    """The cycle that the rod reaches from its leading mode, or that a neighbour's `Cycle.neighbour` leads to.

    start: flat, (any length,). along: the parameter by which neighbours differ. Failures are a status, never
    an exception.
    """

    def failed(cause: str) -> Cycle:
        forget_integrators()  # a PETSc object is not usable after an error inside it
        return Cycle(status=CycleStatus.failed, message=cause)

    def solve() -> Cycle:
        neighbour = Neighbour.unpack(start) if start is not None else None
        stability = straight_rod(rod, neighbour.leading if neighbour else None)
        cycle = _solve(rod, request, stability, neighbour, along)
        return _with_second_state(rod, _by_the_spectrum(cycle, stability), stability)

    return solved(solve, failed)


def warm_up() -> None:
    """Loads what is compiled and created at first use, so that no point pays for it.

    Raises EnvironmentLacks where options of the prefix cycle_ lose the cycle of a rod whose cycle is known.
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
        raise EnvironmentLacks(
            f"with the PETSc options '{given}' a rod whose cycle is known ends as '{said}', so the task "
            "limit_cycle cannot run; remove them"
        )


def _solve(
    rod: Rod,
    request: CycleRequest,
    stability: StraightRod,
    neighbour: Neighbour | None,
    along: str | None,
) -> Cycle:
    leading = stability.w
    straight = Cycle(
        status=CycleStatus.straight, linear_growth_rate=leading.real, linear_frequency=abs(leading.imag)
    )
    beam, form = _beam_and_form(rod)
    if request.start == "hopf":
        return _from_hopf(form, request, straight, stability)
    found = None
    if neighbour is not None and along is not None:
        with suppress(Unsolvable):
            found = followed_cycle(neighbour, form, along, request.accuracy)
    elif neighbour is None and not request.transient:
        found = _small_cycle(form, leading, request, along)
    if found is not None and found.verdict(request.accuracy)[0] == CycleStatus.cycle:
        cycle = _measured(replace(straight, status=CycleStatus.cycle), found, request)
        return _handed_on(cycle, found, neighbour, along, request.accuracy)
    faded = _fades(rod, leading, request.amplitude) if neighbour is None else ""
    traced = request.transient > 0
    if faded and not traced:
        return replace(straight, message=faded)
    unstable = found if found is not None and found.stable is False else None
    transient = Transient(
        beam, form, stability, request.accuracy, request.most_periods, along, traced=traced, unstable=unstable
    )
    end = _from_motion(transient, request, neighbour)
    cycle = _after_motion(straight, transient, end, faded, request)
    if faded or end.found is None:
        return cycle if faded or end.around is None else _with_multipliers(cycle, end.around)
    return _handed_on(_measured(cycle, end.found, request), end.found, None, along, request.accuracy)


def _after_motion(
    straight: Cycle, transient: Transient, end: TransientOutcome, faded: str, request: CycleRequest
) -> Cycle:
    """The outcome of a motion, without the numbers of its cycle; faded: why it decays, if that is known."""
    grid = transient.beam.mesh
    return replace(
        straight,
        status=CycleStatus.straight if faded else end.status,
        message=faded or end.message,
        periods=end.periods,
        elements=grid.elements,
        order=grid.order,
        transient=transient.trace.at_equal_times(request.transient) if transient.trace else None,
    )


def _handed_on(
    cycle: Cycle, found: RefinedCycle, before: Neighbour | None, along: str | None, accuracy: float
) -> Cycle:
    """The cycle with what the next point starts from, where points follow each other."""
    if along is None:
        return cycle
    leading = complex(cycle.linear_growth_rate, cycle.linear_frequency)
    return replace(cycle, neighbour=Neighbour.of(found, before, along, accuracy, leading).pack())


def _small_cycle(
    form: StressForm, w: complex, request: CycleRequest, along: str | None
) -> RefinedCycle | None:
    """The stable cycle just above a Hopf point to which the start grows or decays; None where it is not one.

    w: the leading eigenvalue of the straight rod.
    """
    try:
        found = refined_cycle(small_orbit(form, w, request.amplitude), request.accuracy, along)
    except Unsolvable:
        return None
    settled = found.verdict(request.accuracy)[0] == CycleStatus.cycle
    return found if settled and 1 - found.largest_multiplier >= NEUTRAL else None


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


def _from_hopf(form: StressForm, request: CycleRequest, straight: Cycle, stability: StraightRod) -> Cycle:
    """The cycle on the branch from the Hopf point; straight: the outcome where there is none below."""
    try:
        hopf = hopf_point_below(form.rod)
        if hopf is None:
            status = CycleStatus.straight if stability.stable else CycleStatus.not_settled
            return replace(straight, status=status, message="no Hopf point at any smaller force")
        found = refined_cycle(orbit_from_hopf(form, hopf), request.accuracy)
    except Unsolvable as why:
        return replace(straight, status=CycleStatus.not_settled, message=str(why))
    status, message = found.verdict(request.accuracy)
    return _measured(replace(straight, status=status, message=message), found, request)


def _fades(rod: Rod, w: complex, amplitude: float) -> str:
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


def _beam_and_form(rod: Rod) -> tuple[Beam, StressForm]:
    """The rod as the time stepper sees it, and as the orbit does, on one mesh."""
    resolution = resolution_for(motion_wave(rod), MOTION_ACCURACY)
    grid = mesh(resolution.elements, resolution.order)
    return Beam(near_rod(rod), grid), StressForm(rod, grid)


def motion_wave(rod: Rod) -> float:
    """The wave number by which the first mesh of a motion is chosen."""
    return max(expected_wave_number(EXPECTED_MODES, most_amplified_wave(rod)[1]), FOLDS * abs(rod.F) ** 0.5)


def near_rod(rod: Rod) -> Rod:
    """The rod itself, or one near the limit that it is: the time stepper takes no limits."""
    return replace(
        rod, k1=min(rod.k1, STIFFEST), k2=min(rod.k2, STIFFEST), gamma3=max(rod.gamma3, LEAST_DRAG)
    )


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


def _measured(cycle: Cycle, found: RefinedCycle, request: CycleRequest) -> Cycle:
    """The cycle with its numbers, and what is stored of it where it is asked for."""
    orbit, path = found.orbit, found.path
    # Harmonics that are not resolved are below the error of the cycle.
    amplitudes = first_of(found.measures.harmonic_amplitude, request.harmonics, 0.0)
    wanted = request.shapes and request.nodes
    return replace(
        cycle,
        **_stability(found),
        elements=orbit.form.mesh.elements,
        order=orbit.form.mesh.order,
        measures=replace(found.measures, harmonic_amplitude=amplitudes),
        errors=found.errors,
        tip=path.tip(request.samples) if request.samples else None,
        energy=path.energy(request.samples) if request.samples else None,
        shape=path.shapes(request.shapes, request.nodes) if wanted else None,
    )


def _with_multipliers(cycle: Cycle, found: RefinedCycle) -> Cycle:
    """The cycle with its multipliers and their error."""
    errors = replace(cycle.errors, multiplier_error=found.errors.multiplier_error)
    return replace(cycle, **_stability(found), errors=errors)


def _stability(found: RefinedCycle) -> dict[str, Any]:
    """What the multipliers tell, as `Cycle` names it."""
    mu = first_of(found.multipliers, STORED_MULTIPLIERS, UNTOLD)
    mu[np.abs(mu) < LEAST_MULTIPLIER] = UNTOLD
    return {
        "multiplier": found.largest_multiplier,
        "multipliers": mu,
        "trivial_multiplier_error": found.trivial_error,
    }


def first_of(values: Array | Complex, count: int, other: complex) -> Any:
    """So many of the values, (m,), and another one where there are none, (count,)."""
    first = np.full(count, other, values.dtype)
    first[: len(values)] = values[:count]
    return first
