"""The limit cycle of one rod, from a start to its numbers (paper, Sec. VII).

The rod starts from its leading eigenmode, or from a neighbour's cycle (`rodsweep.solve.cycle.transient`); the
cycle is solved for by Newton's method and refined (`resolved`, `orbit`, `floquet`), then measured
(`measures`). It is called a cycle only if it closes and is proved stable by its multipliers; that two peaks
are close proves nothing near the Hopf point, where motions decay slowly.
"""

from dataclasses import dataclass, replace
from math import nan

import numpy as np
from numpy.typing import NDArray

from ...discretization.beam import Beam, mesh
from ...discretization.quadrature import lobatto_points
from ...discretization.resolution import expected_wave_number, resolution_for
from ...errors import EnvironmentLacks
from ...model.dispersion import most_amplified_wave
from ...model.rod import Rod
from ..backend.petsc import options
from ..motion.integrator import forget_integrators
from ..motion.leading_mode import Mode
from ..motion.time_scheme import PREFIX
from ..point import solved
from .measures import shapes, traces
from .refinement import Resolved
from .status import CycleStatus
from .transient import Approach, Arrival

__all__ = ["Cycle", "CycleRequest", "CycleStatus", "solve_cycle", "warm_up"]

Array = NDArray[np.float64]

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


@dataclass(frozen=True)
class Cycle:
    """What became of one rod, and the numbers of its cycle: NaN or None where there is none.

    period in tau2, frequency = 2 pi/period; linear_growth_rate and linear_frequency of the leading mode
    about the straight rod, 1/tau2. Tip in L and rad. period_error, amplitude_error: relative estimates for
    steps and mesh, the latter of the extrema in units of the largest y. harmonics: amplitudes in L of the
    tip's y from the first, (H,). Injection and dissipation: mean and rms of the fluctuation, k3/(L tau2);
    energy_imbalance: of their means, relative. multiplier: the largest nontrivial Floquet multiplier's
    modulus; closure: |z(T) - z(0)|/|z|; least_stretch: min h1. periods: returns waited for.

    tip: x, y, theta at equidistant times, (3, samples); energy: U in k3/L, injection, dissipation, (3,
    samples); shape: x, y, theta, (3, shapes, nodes). Time starts where the tip's y rises through its mean.
    state: the stresses (n + F, s, m) in k3/L^2 and k3/L on Lobatto nodes, (3, STATE_NODES), from which a
    neighbour can start, whatever its mesh and stiffness.
    """

    status: CycleStatus
    harmonics: Array
    period: float = nan
    frequency: float = nan
    linear_growth_rate: float = nan
    linear_frequency: float = nan
    tip_x_min: float = nan
    tip_x_max: float = nan
    tip_y_max: float = nan
    tip_theta_max: float = nan
    period_error: float = nan
    amplitude_error: float = nan
    injection_mean: float = nan
    injection_rms: float = nan
    dissipation_mean: float = nan
    dissipation_rms: float = nan
    energy_imbalance: float = nan
    multiplier: float = nan
    closure: float = nan
    least_stretch: float = nan
    periods: int = 0
    elements: int = 0
    order: int = 0
    seconds: float = 0.0
    message: str = ""
    tip: Array | None = None
    energy: Array | None = None
    shape: Array | None = None
    state: Array | None = None


def solve_cycle(  # noqa: PLR0913, PLR0917
    F: float,
    k1: float,
    k2: float,
    gamma3: float,
    gamma1: float,
    request: CycleRequest,
    start: Array | None = None,
) -> Cycle:
    """The cycle that the rod reaches from its leading mode, or from a neighbour's `state`.

    k1, k2 are finite and gamma3 > 0. Failures are a status, never an exception.
    """
    if not k1 > F:
        crushed = f"F = {F:g} crushes a rod of k1 = {k1:g} at rest"
        return _nothing(CycleStatus.left_the_model, request, crushed)

    def failed(cause: str) -> Cycle:
        forget_integrators()  # a PETSc object is not usable after an error inside it
        return _nothing(CycleStatus.failed, request, cause)

    return solved(lambda: _solve(Rod(F, k1, k2, gamma3), gamma1, request, start), failed)


def warm_up() -> None:
    """Loads what is compiled and created at first use, so that no point pays for it.

    Raises EnvironmentLacks where options of the prefix cycle_ lose the cycle of a rod whose cycle is known.
    """
    cycle = solve_cycle(40.0, 1e4, 1e2, 1e-2, 1.0, CycleRequest(1e-3, 0.1, 1, 4, 1, 4, 50))
    known = cycle.status == CycleStatus.cycle and abs(cycle.period / KNOWN_PERIOD - 1) < KNOWN_WITHIN
    given = options(PREFIX)
    if given and not known:
        said = f"{cycle.status.name} {cycle.message}".strip()
        raise EnvironmentLacks(
            f"with the PETSc options '{given}' a rod whose cycle is known ends as '{said}', so the task "
            "limit_cycle cannot run; remove them"
        )


def _solve(rod: Rod, gamma1: float, request: CycleRequest, start: Array | None) -> Cycle:
    wave = max(expected_wave_number(EXPECTED_MODES, most_amplified_wave(rod)[1]), FOLDS * abs(rod.F) ** 0.5)
    resolution = resolution_for(wave, request.accuracy)
    beam = Beam(rod, gamma1, mesh(resolution.elements, resolution.order))
    approach = Approach(beam, request.accuracy, request.most_periods)
    z = request.amplitude * approach.mode.z.real if start is None else received(beam, start)
    arrival = approach.arrive(z)
    cycle = _about_rest(_nothing(arrival.status, request, arrival.message), arrival, approach.mode, beam)
    return cycle if arrival.found is None else _measured(cycle, arrival.found, request)


def received(beam: Beam, state: Array) -> Array:
    """z of a `Cycle.state`; its tip is free of stress beyond the straight rod's, whatever the force."""
    there = mesh(1, state.shape[1] - 1).evaluation(beam.mesh.positions[:-1])
    return (state @ there.T / beam.stiffness_roots[:, None]).ravel()


def handed_on(beam: Beam, z: Array) -> Array:
    """`Cycle.state` of z, shape (3, STATE_NODES)."""
    stresses = np.zeros((3, beam.mesh.nodes + 1))
    stresses[:, :-1] = z.reshape(3, -1) * beam.stiffness_roots[:, None]
    return stresses @ beam.mesh.evaluation(lobatto_points(STATE_NODES)).T


def _about_rest(cycle: Cycle, arrival: Arrival, mode: Mode, beam: Beam) -> Cycle:
    """The cycle with what is known wherever the rod went."""
    return replace(
        cycle,
        linear_growth_rate=mode.w.real,
        linear_frequency=mode.w.imag,
        periods=arrival.periods,
        elements=beam.mesh.elements,
        order=beam.mesh.order,
    )


def _measured(cycle: Cycle, found: Resolved, request: CycleRequest) -> Cycle:
    """The cycle with its numbers, and what is stored of it where it is asked for."""
    orbit, m = found.orbit, found.measures
    harmonics = np.zeros(request.harmonics)  # those that the steps do not resolve are below its error
    kept = min(len(harmonics), len(m.harmonics))
    harmonics[:kept] = m.harmonics[:kept]
    tip, energy = traces(orbit.beam, orbit.run, request.samples) if request.samples else (None, None)
    wanted = request.shapes and request.nodes
    return replace(
        cycle,
        period=m.period,
        frequency=2 * np.pi / m.period,
        tip_x_min=m.tip_x_min,
        tip_x_max=m.tip_x_max,
        tip_y_max=m.tip_y_max,
        tip_theta_max=m.tip_theta_max,
        period_error=found.errors.period,
        amplitude_error=found.errors.amplitude,
        harmonics=harmonics,
        injection_mean=float(m.mean[0]),
        injection_rms=float(m.rms[0]),
        dissipation_mean=float(m.mean[1]),
        dissipation_rms=float(m.rms[1]),
        energy_imbalance=m.energy_imbalance,
        multiplier=orbit.tangent.largest,
        closure=orbit.closure,
        least_stretch=m.least_stretch,
        elements=orbit.beam.mesh.elements,
        order=orbit.beam.mesh.order,
        tip=tip,
        energy=energy,
        shape=shapes(orbit.beam, orbit.run, request.shapes, request.nodes) if wanted else None,
        state=handed_on(orbit.beam, orbit.state),
    )


def _nothing(status: CycleStatus, request: CycleRequest, message: str) -> Cycle:
    return Cycle(status, np.full(request.harmonics, np.nan), message=message)
