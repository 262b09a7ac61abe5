"""How fine a mesh in space and time a cycle needs, and how accurate it is.

A cycle is solved on two meshes. What the coarse one differs by is its own error, measured; the error that the
fine one leaves is this times the ratio of what the two are expected to leave. That is judged by the last
coefficients of the polynomials in space and time, whose squares the errors follow: period and extrema
converge twice as fast as states do.
"""

from dataclasses import dataclass, replace
from math import ceil, inf, log, nan

import numpy as np
from numpy.polynomial import legendre

from ...arrays import Array, Complex
from ...discretization.mesh import Mesh, mesh
from ...discretization.resolution import LARGEST_ORDER
from ..point import Unsolvable
from .measures import CyclePath, Measures, measures_of
from .minimal_period import PRESENT, common_divisor, shortened, undecided_divisor
from .orbit import Converged, Orbit, at_orbit, newton

SPACE_FACTOR, TIME_FACTOR = 1.0, 50.0
"""Largest errors of period and extrema in units of the squared tails: 0.1 to 1.3 and 10 to 80 were seen."""
EXPECTED_SHARE = 1 / 3
"""Share of the accuracy that a mesh is chosen for, in space and in time each."""
AIM, MOST_SLACK = 0.35, 30.0
"""Share of the accuracy that a mesh is chosen for where an error is known, and how much smaller this is than
the tails let expect, at most."""
LEAST_RATIO, LARGEST_RATIO = 1e-3, 0.5
"""Bounds of the ratio of the fine mesh's error to the coarse one's."""
SPACE_POWER = 0.75
"""Power of the ratio of the expected errors in space that bounds that of the true ones: far beyond the Hopf
point they were seen to fall so slowly."""
SAFETY, PERIOD_SAFETY = 2.0, 4.0
PATH_SHARE, PERIOD_SHARE = 0.25, 0.05
"""What the coarse mesh's errors of an extremum and of the period are multiplied with; the share of the
largest distance between the tip's paths that counts at least as an error of an extremum, and of that one as
an error of the period: a number may happen to agree on both meshes."""
COARSER_ORDER, TIME_RATIO = 2, 0.03
"""The coarse mesh has so much less order in each element, and intervals for which this is left of its error
in time, as about is of the one in space: then it hardly matters which of the two it comes from."""
LEAST_ORDER, LEAST_INTERVALS, MOST_INTERVALS = 8, 4, 256
LEAST_DECAY, LARGEST_DECAY = 0.3, 1.2
"""Bounds of the decay of the coefficients in space, per order, natural logarithm."""
ROUNDING = 2e-14
"""Relative error that is left of period and extrema however fine the mesh."""
MATRIX_DISTANCE = 1e-7
"""Relative distance of Newton's matrix from the orbit that leaves the multipliers right."""
MULTIPLIER_FACTOR = 10.0
"""Errors of multipliers in units of that distance, the trivial one's error, and what two meshes tell."""
LEAST_ACCURACY = 1e-12
NEAR, AIM_LOWERED = 1e-3, 1e-3
"""Tolerance of the first orbit; factor of the accuracy that a mesh is chosen for, where one is too coarse."""
LEAST_SIZE, LARGEST_SIZE = 0.2, 5.0
"""Size of what Newton's method may find, in units of what it started from: it must be the same motion."""
LUCK = 10.0
"""How much larger an error may be on finer meshes: an extremum may have agreed by luck on coarser ones."""
MOST_ROUNDS = 8
MOST_STATE_UNKNOWNS = 400
"""Unknowns of a state beyond which a cycle is given up: a second for each of Newton's steps."""


@dataclass(frozen=True, slots=True)
class OrbitMesh:
    """Equal elements of an order in space, equal intervals with Radau stages in time."""

    elements: int
    order: int
    intervals: int
    stages: int

    @property
    def grid(self) -> Mesh:
        return mesh(self.elements, self.order)

    @property
    def coarser(self) -> "OrbitMesh":
        """The mesh that the error of this one is measured by."""
        order = max(LEAST_ORDER - COARSER_ORDER, self.order - COARSER_ORDER)
        share = TIME_RATIO ** (1 / (2 * self.stages - 1))
        intervals = max(LEAST_INTERVALS - 1, ceil(share * self.intervals))
        return replace(self, order=order, intervals=intervals)

    @property
    def allowed(self) -> bool:
        return 3 * self.elements * self.order <= MOST_STATE_UNKNOWNS and self.intervals <= MOST_INTERVALS

    def carry(self, orbit: Orbit) -> Orbit:
        """The orbit's polynomials on this mesh."""
        return orbit.on(self.grid, self.intervals, self.stages)


def mesh_of(orbit: Orbit) -> OrbitMesh:
    """The mesh of an orbit."""
    grid = orbit.form.mesh
    return OrbitMesh(grid.elements, grid.order, *orbit.states.shape[:2])


def stages_for(accuracy: float) -> int:
    """Stages of the method in time with which an accuracy costs least."""
    return 3 if accuracy > 3e-6 else 4 if accuracy > 3e-9 else 5 if accuracy > 3e-11 else 6


@dataclass(frozen=True, slots=True)
class CycleErrors:
    """Estimates, relative: of the period and of the tip's extrema, in units of its largest y.

    multiplier_error: absolute, of the largest nontrivial multiplier.
    """

    period_error: float
    amplitude_error: float
    multiplier_error: float = nan

    @property
    def largest(self) -> float:
        return max(self.period_error, self.amplitude_error)


UNKNOWN_ERRORS = CycleErrors(nan, nan, nan)


@dataclass(frozen=True, slots=True)
class Tails:
    """The last coefficients of the polynomials in space and in time in units of the largest ones.

    decay: of those in space, per order, natural logarithm.
    """

    space: float
    time: float
    decay: float

    @property
    def expected_errors(self) -> tuple[float, float]:
        """In space and in time, of period and extrema."""
        return SPACE_FACTOR * self.space**2, TIME_FACTOR * self.time**2


def tails_of(orbit: Orbit) -> Tails:
    """The tails of an orbit."""
    grid, p = orbit.form.mesh, orbit.form.mesh.order
    stresses = orbit.form.stresses(orbit.states[:, -1])  # (3, K, nodes + 1)
    here = [stresses[..., e * p : (e + 1) * p + 1] for e in range(grid.elements)]
    from_nodes = legendre_analysis(tuple(2 * mesh(1, p).positions - 1))
    c = np.abs(np.stack(here) @ from_nodes.T).max(axis=(0, 2))  # (3, p + 1)
    sizes = np.maximum(c.max(axis=1), 1e-300)
    last, before = (np.hypot(c[:, k], c[:, k - 1]) / sizes for k in (p - 1, p - 5))
    worst = int(np.argmax(last[1:])) + 1  # n1 is quadratic in the deflection: it follows the others
    decay = log(max(before[worst], 1e-300) / max(last[worst], 1e-300)) / 4
    return Tails(float(last.max()), _tail_in_time(orbit), float(np.clip(decay, LEAST_DECAY, LARGEST_DECAY)))


def _tail_in_time(orbit: Orbit) -> float:
    """Of n1, n2 and m3 the worst."""
    K, s, _ = orbit.states.shape
    n = orbit.form.mesh.nodes
    ends = np.concatenate([orbit.start[None], orbit.states[:-1, -1]])
    values = np.concatenate([ends[:, None], orbit.states], axis=1)[..., : 3 * n]
    row = legendre_analysis(tuple(2 * np.append(0.0, orbit.method.nodes) - 1))[-1]
    top = np.einsum("j,kjr->kr", row, values).reshape(K, 3, n)
    sizes = np.linalg.norm(values.reshape(K, s + 1, 3, n), axis=-1).max(axis=(0, 1))
    return float((np.linalg.norm(top, axis=-1).max(axis=0) / np.maximum(sizes, 1e-300)).max())


_analyses: dict[tuple[float, ...], Array] = {}


def legendre_analysis(nodes: tuple[float, ...]) -> Array:
    """Matrix from values at n nodes in [-1, 1] to Legendre coefficients, shape (n, n)."""
    if nodes not in _analyses:
        _analyses[nodes] = np.linalg.inv(legendre.legvander(np.array(nodes), len(nodes) - 1))
    return _analyses[nodes]


def wanted_mesh(orbit: Orbit, accuracy: float) -> OrbitMesh:
    """The smallest mesh that is expected to reach an accuracy, by the tails of an orbit near by."""
    here, tails, stages = mesh_of(orbit), tails_of(orbit), stages_for(accuracy)
    aim_space = (EXPECTED_SHARE * accuracy / SPACE_FACTOR) ** 0.5
    aim_time = (EXPECTED_SHARE * accuracy / TIME_FACTOR) ** 0.5
    order = here.order + ceil(log(max(tails.space, 1e-15) / aim_space) / tails.decay / here.elements)
    elements = here.elements
    while order > LARGEST_ORDER:
        order, elements = ceil(0.6 * order), 2 * elements
    # A tail falls as the power `stages` of the intervals; of other stages' tails little more is known.
    tail = max(tails.time, 1e-15) ** (stages / here.stages)
    intervals = ceil(here.intervals * (tail / aim_time) ** (1 / stages))
    order = min(max(order, LEAST_ORDER), here.order + 12)
    intervals = min(max(intervals, LEAST_INTERVALS), 4 * here.intervals)
    # Even numbers, for which matrices and memory are more often there already.
    return OrbitMesh(elements, order + order % 2, intervals + intervals % 2, stages)


@dataclass(frozen=True, eq=False)
class RefinedCycle:
    """A cycle on two meshes, its measures, multipliers and errors.

    multipliers: by descending modulus, the trivial one taken out; trivial_error: its distance from 1.
    """

    fine: Converged
    coarse: Converged
    path: CyclePath
    measures: Measures
    multipliers: Complex
    trivial_error: float
    errors: CycleErrors

    @property
    def orbit(self) -> Orbit:
        return self.fine.orbit

    @property
    def largest_multiplier(self) -> float:
        """Modulus of the largest one but the trivial."""
        return float(np.abs(self.multipliers[0])) if len(self.multipliers) else 0.0

    @property
    def divisor(self) -> int:
        """How many times shorter its period may be for all that is known; 1 proves that it is minimal."""
        return undecided_divisor(self.path, self.errors.amplitude_error)

    @property
    def margin(self) -> float:
        """How far the largest multiplier's modulus must be from 1 to be told from it."""
        return max(self.trivial_error, self.errors.multiplier_error)

    @property
    def stable(self) -> bool | None:
        """Whether all but the trivial one lie inside the circle; None where the margin does not tell."""
        beyond = self.largest_multiplier - 1
        return None if abs(beyond) <= self.margin else beyond < 0


def multipliers_of(found: Converged) -> tuple[Complex, float]:
    """The multipliers, (rank - 1,), by descending modulus, and how far the trivial one is from 1."""
    values = found.matrix.multipliers()
    one = int(np.argmin(np.abs(values - 1)))
    return np.delete(values, one), float(abs(values[one] - 1))


def judged(coarse: Converged, fine: Converged) -> RefinedCycle:
    """The cycle with the errors that two meshes tell.

    An extremum may happen to agree on both: the whole paths of the tip are compared too.
    """
    path, rough = CyclePath(fine.orbit), CyclePath(coarse.orbit)
    measures, extrema = measures_of(path), rough.extrema()
    ratio = error_ratio(coarse.orbit, fine.orbit)
    (multipliers, trivial_error), (before, _) = multipliers_of(fine), multipliers_of(coarse)
    apart = np.abs(path.tip_samples - rough.resampled_tip(len(path.tip_samples))).max()
    extremum = max(abs(value - getattr(measures, name)) for name, value in extrema.items())
    amplitude = max(SAFETY * extremum, PATH_SHARE * apart) / abs(measures.tip_y_max)
    period = PERIOD_SAFETY * abs(coarse.orbit.period / fine.orbit.period - 1)
    # The nearest, not that of the same place, nor the moduli: two may change places, or happen to agree.
    moved = float(np.abs(before - multipliers[0]).min()) if len(before) and len(multipliers) else 0.0
    errors = CycleErrors(
        ratio * max(period, PERIOD_SHARE * amplitude) + ROUNDING,
        ratio * amplitude + ROUNDING,
        MULTIPLIER_FACTOR * (ratio * moved + fine.distance + trivial_error),
    )
    return RefinedCycle(fine, coarse, path, measures, multipliers, trivial_error, errors)


def error_ratio(coarse: Orbit, fine: Orbit) -> float:
    """The error that the fine mesh leaves in units of that of the coarse one.

    In space by the tails; in time of order s + 1, what stiffness leaves at least of the 2 s - 1. Which of the
    two the error comes from is not known, for the tails tell what they are at most: the larger one counts.
    """
    space, fine_space = (tails_of(orbit).expected_errors[0] for orbit in (coarse, fine))
    K, s, _ = fine.states.shape
    in_space = (fine_space / max(space, 1e-300)) ** SPACE_POWER
    in_time = (len(coarse.states) / K) ** (s + 1)
    return float(np.clip(max(in_space, in_time), LEAST_RATIO, LARGEST_RATIO))


def refine(orbit: Orbit, accuracy: float, parameter: str | None = None) -> RefinedCycle:
    """The cycle near an orbit that is no more than near one, as accurate as asked for or as the limits allow.

    Raises Unsolvable where there is none. parameter: along which the matrices have tangents.

    Next to a Hopf point a coarse mesh has no cycle at all, for its own Hopf point is beyond: finer ones are
    tried then.
    """
    aim, start = accuracy, orbit
    while True:
        try:
            near = same_motion(newton(start, NEAR), orbit.size).orbit
            return _refined(near, accuracy, wanted_mesh(near, aim), parameter)
        except Unsolvable:
            if aim <= LEAST_ACCURACY:
                raise
            aim = max(AIM_LOWERED * aim, LEAST_ACCURACY)
            start = wanted_mesh(orbit, aim).carry(orbit)


def _refined(near: Orbit, accuracy: float, aim: OrbitMesh, parameter: str | None) -> RefinedCycle:
    """The cycle near an orbit, from a mesh on."""
    tolerance, size, last = max(1e-2 * accuracy, 1e-13), near.size, inf
    best: RefinedCycle | None = None
    for _ in range(MOST_ROUNDS):
        coarse = same_motion(newton(aim.coarser.carry(near), tolerance, parameter), size)
        coarse = at_orbit(coarse, 1e-4, parameter)
        fine = same_motion(fine_cycle(aim.carry(coarse.orbit), tolerance, parameter), size)
        found = judged(coarse, fine)
        if best is None or found.errors.largest < best.errors.largest:
            best = found
        if found.errors.largest <= accuracy:
            break
        near = found.orbit
        finer = finer_mesh(aim, mesh_by_error(near, found.errors.largest, accuracy))
        if not finer.allowed or found.errors.largest > last:
            break
        aim, last = finer, LUCK * found.errors.largest
    if best is None:
        raise Unsolvable("no mesh was fine enough")
    return best


def refined_from(found: RefinedCycle, accuracy: float, parameter: str | None) -> RefinedCycle:
    """A cycle that is less accurate than asked for, on finer meshes."""
    wanted = mesh_by_error(found.orbit, found.errors.largest, accuracy)
    return _refined(found.orbit, accuracy, finer_mesh(mesh_of(found.orbit), wanted), parameter)


def mesh_by_error(orbit: Orbit, error: float, accuracy: float) -> OrbitMesh:
    """The smallest mesh that is expected to reach an accuracy, by an orbit's tails and its known error."""
    expected = sum(tails_of(orbit).expected_errors)
    return wanted_mesh(orbit, AIM * accuracy * float(np.clip(expected / error, 1.0, MOST_SLACK)))


def same_motion(found: Converged, size: float) -> Converged:
    """What was found, if its size is near that of the motion it was sought from; Unsolvable otherwise."""
    if not LEAST_SIZE * size < found.orbit.size < LARGEST_SIZE * size:
        raise Unsolvable("Newton's method left the motion that it started from")
    return found


def refined_cycle(orbit: Orbit, accuracy: float, parameter: str | None = None) -> RefinedCycle:
    """The cycle near an orbit, over its minimal period; raises Unsolvable where there is none.

    Where it does not tell whether it is stable, its multipliers are taken at the orbit itself, and if they
    do not tell either, on meshes for a hundredth of the accuracy.
    """
    found = refine(shortened(orbit), accuracy, parameter)
    if common_divisor(found.path, PRESENT) > 1:
        found = refine(shortened(found.orbit), accuracy, parameter)
    if found.stable is None:
        found = _sharpened(found, parameter)
    if found.stable is None:
        found = _sharpened(refine(found.orbit, max(accuracy / 100, LEAST_ACCURACY), parameter), parameter)
    return found


def _sharpened(found: RefinedCycle, parameter: str | None) -> RefinedCycle:
    """The same with matrices made at the orbits themselves."""
    return judged(at_orbit(found.coarse, 0.0, parameter), at_orbit(found.fine, 0.0, parameter))


def fine_cycle(orbit: Orbit, tolerance: float, parameter: str | None) -> Converged:
    """The orbit near this one with a matrix that has the right multipliers."""
    return at_orbit(newton(orbit, tolerance, parameter), MATRIX_DISTANCE, parameter)


def finer_mesh(mesh: OrbitMesh, wanted: OrbitMesh) -> OrbitMesh:
    """At least the wanted mesh, and finer than the present one."""
    order = max(wanted.order, mesh.order) if wanted.elements == mesh.elements else wanted.order
    intervals, stages = max(wanted.intervals, mesh.intervals), max(wanted.stages, mesh.stages)
    finer = replace(wanted, order=order, intervals=intervals, stages=stages)
    if finer != mesh:
        return finer
    return replace(mesh, order=mesh.order + 2, intervals=ceil(1.2 * mesh.intervals))
