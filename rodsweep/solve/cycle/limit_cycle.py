"""The limit cycle of one rod, from a start to its numbers (paper, Sec. VII).

The rod starts from its leading eigenmode, or from a neighbour's cycle. Its motion is followed until it comes
near a cycle (`transient`), for which Newton's method solves on ever finer meshes and steps (`refinement`,
`shooting`), and which is then measured (`measures`). It is called a cycle only if it closes and is proved
stable by its multipliers (`floquet`); that two peaks are close proves nothing near the Hopf point, where
motions decay slowly.
"""

from dataclasses import dataclass, replace
from math import nan

import numpy as np

from ...arrays import Array
from ...discretization.beam import Beam, mesh
from ...discretization.quadrature import lobatto_points
from ...discretization.resolution import expected_wave_number, resolution_for
from ...errors import EnvironmentLacks
from ...model.dispersion import most_amplified_wave
from ...model.rod import Rod
from ..backend.petsc import options
from ..motion.integrator import forget_integrators
from ..motion.time_scheme import CYCLE_PREFIX
from ..point import solved
from .measures import Measures, shapes, traces
from .refinement import UNKNOWN_ERRORS, CycleErrors, RefinedOrbit
from .status import CycleStatus
from .transient import Transient

__all__ = ["Cycle", "CyclePoint", "CycleRequest", "CycleStatus", "solve_cycle", "warm_up"]


EXPECTED_MODES = 3
"""Modes by whose wave number the first mesh is chosen; the cycle says whether it is fine enough."""
FOLDS = 2.5
"""Largest wave number of a cycle in units of sqrt(F), the inverse of the length to which F bends a rod."""
KNOWN_PERIOD, KNOWN_WITHIN = 0.04204870, 1e-3
"""Period in tau2 of the rod (40, 1e4, 1e2, 1e-2, 1), which a displacement-form code confirms, and how far
off it may come out at the accuracy that is asked of it here."""
STATE_NODES = 65
"""Lobatto nodes on which a state is handed to a neighbour."""


@dataclass(frozen=True, slots=True)
class CyclePoint:
    """One rod: k1, k2 finite, gamma3 > 0. Its F need not be below k1: what crushes the rod is an outcome."""

    F: float
    k1: float
    k2: float
    gamma3: float
    gamma1: float


@dataclass(frozen=True, slots=True)
class CycleRequest:
    """What is asked of every rod.

    accuracy: relative, of period and extrema. amplitude: the tip's y of the start, in L. harmonics: how many.
    samples: of the tip and of the energy over a period; shapes, nodes: shapes over a period and Lobatto
    nodes of each; 0 for none. most_periods: returns of the tip to wait for.
    """

    accuracy: float
    amplitude: float
    harmonics: int
    samples: int
    shapes: int
    nodes: int
    most_periods: int


@dataclass(frozen=True, kw_only=True)
class Cycle:
    """What became of one rod, and the numbers of its cycle: NaN or None where there is none.

    linear_growth_rate and linear_frequency of the leading mode about the straight rod, 1/tau2; periods:
    returns waited for. multiplier: the largest nontrivial Floquet multiplier's modulus; closure:
    |z(T) - z(0)|/|z|.

    tip: x, y, theta at equidistant times, (3, samples); energy: U in k3/L, injection, dissipation, (3,
    samples); shape: x, y, theta, (3, shapes, nodes). Time starts where the tip's y rises through its mean.
    state: the stresses (n + F, s, m) in k3/L^2 and k3/L on Lobatto nodes, (3, STATE_NODES), from which a
    neighbour can start, whatever its mesh and stiffness.
    """

    status: CycleStatus
    message: str = ""
    seconds: float = 0.0
    linear_growth_rate: float = nan
    linear_frequency: float = nan
    periods: int = 0
    elements: int = 0
    order: int = 0
    measures: Measures = Measures()
    errors: CycleErrors = UNKNOWN_ERRORS
    multiplier: float = nan
    closure: float = nan
    tip: Array | None = None
    energy: Array | None = None
    shape: Array | None = None
    state: Array | None = None


def solve_cycle(point: CyclePoint, request: CycleRequest, start: Array | None = None) -> Cycle:
    """The cycle that the rod reaches from its leading mode, or from a neighbour's `state`, (3, STATE_NODES).

    Failures are a status, never an exception.
    """
    if not point.k1 > point.F:
        crushed = f"F = {point.F:g} crushes a rod of k1 = {point.k1:g} at rest"
        return Cycle(status=CycleStatus.left_the_model, message=crushed)

    def failed(cause: str) -> Cycle:
        forget_integrators()  # a PETSc object is not usable after an error inside it
        return Cycle(status=CycleStatus.failed, message=cause)

    return solved(lambda: _solve(point, request, start), failed)


def warm_up() -> None:
    """Loads what is compiled and created at first use, so that no point pays for it.

    Raises EnvironmentLacks where options of the prefix cycle_ lose the cycle of a rod whose cycle is known.
    """
    rod = CyclePoint(40.0, 1e4, 1e2, 1e-2, 1.0)
    cycle = solve_cycle(rod, CycleRequest(1e-3, 0.1, 1, 4, 1, 4, 50))
    off = abs(cycle.measures.period / KNOWN_PERIOD - 1)
    known = cycle.status == CycleStatus.cycle and off < KNOWN_WITHIN
    given = options(CYCLE_PREFIX)
    if given and not known:
        said = f"{cycle.status.name} {cycle.message}".strip()
        raise EnvironmentLacks(
            f"with the PETSc options '{given}' a rod whose cycle is known ends as '{said}', so the task "
            "limit_cycle cannot run; remove them"
        )


def _solve(point: CyclePoint, request: CycleRequest, start: Array | None) -> Cycle:
    rod = Rod(point.F, point.k1, point.k2, point.gamma3)
    wave = max(expected_wave_number(EXPECTED_MODES, most_amplified_wave(rod)[1]), FOLDS * abs(rod.F) ** 0.5)
    resolution = resolution_for(wave, request.accuracy)
    beam = Beam(rod, point.gamma1, mesh(resolution.elements, resolution.order))
    transient = Transient(beam, request.accuracy, request.most_periods)
    mode = transient.mode
    z = request.amplitude * mode.z.real if start is None else state_from_neighbour(beam, start)
    end = transient.follow(z)
    cycle = Cycle(
        status=end.status,
        message=end.message,
        linear_growth_rate=mode.w.real,
        linear_frequency=mode.w.imag,
        periods=end.periods,
        elements=beam.mesh.elements,
        order=beam.mesh.order,
    )
    return cycle if end.found is None else _measured(cycle, end.found, request)


def _measured(cycle: Cycle, found: RefinedOrbit, request: CycleRequest) -> Cycle:
    """The cycle with its numbers, and what is stored of it where it is asked for."""
    orbit, amplitudes = found.orbit, found.measures.harmonic_amplitude[: request.harmonics]
    beam, run = orbit.beam, orbit.run
    unresolved = request.harmonics - len(amplitudes)  # they are below the error of the cycle
    tip, energy = traces(beam, run, request.samples) if request.samples else (None, None)
    wanted = request.shapes and request.nodes
    return replace(
        cycle,
        elements=beam.mesh.elements,
        order=beam.mesh.order,
        measures=replace(found.measures, harmonic_amplitude=np.pad(amplitudes, (0, unresolved))),
        errors=found.errors,
        multiplier=orbit.monodromy.largest,
        closure=orbit.closure,
        tip=tip,
        energy=energy,
        shape=shapes(beam, run, request.shapes, request.nodes) if wanted else None,
        state=state_for_neighbour(beam, orbit.state),
    )


def state_from_neighbour(beam: Beam, state: Array) -> Array:
    """z, shape (unknowns,), of a `Cycle.state`; its tip has the straight rod's stress, whatever the force."""
    there = mesh(1, state.shape[1] - 1).evaluation(beam.mesh.positions[:-1])
    return (state @ there.T / beam.stiffness_roots[:, None]).ravel()


def state_for_neighbour(beam: Beam, z: Array) -> Array:
    """`Cycle.state` of z, shape (3, STATE_NODES)."""
    stresses = np.zeros((3, beam.mesh.nodes + 1))
    stresses[:, :-1] = z.reshape(3, -1) * beam.stiffness_roots[:, None]
    return stresses @ beam.mesh.evaluation(lobatto_points(STATE_NODES)).T
