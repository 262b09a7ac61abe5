"""The cycle to an accuracy that is asked for, on meshes of its own choice.

The tails of an orbit near by say which mesh reaches the accuracy (`orbit_mesh`). Where its errors, which are
measured (`finer_meshes`), are too large after all, they say which one does at least cost.
"""

from contextlib import suppress
from dataclasses import dataclass, replace
from math import inf, log

import numpy as np

from ....arrays import Complex
from ...orbit.matrix.workspace import NewtonWorkspace
from ...orbit.measures import CyclePath, Measures, measures_of
from ...orbit.newton import QUADRATIC, Converged, at_orbit, linearised, multipliers_of, newton
from ...orbit.orbit import Orbit
from ...orbit.orbit_mesh import OrbitMesh, finer_mesh, stages_for, wanted_mesh
from ...point import Unsolvable
from ..status import CycleStatus
from .calibration import Calibration
from .coarser_meshes import CoarserMeshes
from .cycle_errors import CycleErrors
from .finer_meshes import calibrated
from .minimal_period import PRESENT, common_divisor, shortened, undecided_divisor

MATRIX_SHARE, LEAST_DISTANCE, LARGEST_DISTANCE = 3.0, 1e-7, 1e-5
"""Relative distance of Newton's matrix from the orbit that leaves the multipliers right, in units of the
accuracy, and its bounds."""
MULTIPLIER_FACTOR = 10.0
"""Errors of multipliers in units of that distance, the trivial one's error, and what two meshes tell."""
LEAST_ACCURACY = 1e-12
FIRST_ACCURACY, NEAR, AIM_LOWERED = 1e-7, 1e-3, 1e-3
"""What the first mesh is chosen for at most, by the tails of an orbit near by, which do not tell more;
tolerance of that orbit; factor of the accuracy where a mesh is too coarse."""
FIRST_SHARE = 0.5
"""Of what the first mesh of a cycle alone is chosen for: another round costs more than a finer mesh."""
LEAST_PREDICTED = 6
"""Intervals of the coarsest mesh whose errors are predicted: with 4 and 5, of which the prediction is made,
errors in time do not yet fall as a power (largest y off by four times its estimate)."""
PREDICTED_WITHIN, LEAST_WITHIN = 30.0, 1e-9
"""Distance of a cycle from what coarser meshes predict beyond which their errors are no measure of its own,
in units of the accuracy, of which up to 4.4 were seen; and its least bound, for rounding."""
LEAST_SIZE, LARGEST_SIZE = 0.2, 5.0
"""Size of what Newton's method may find, in units of what it started from: it must be the same motion."""
LUCK = 10.0
"""How much larger an error may be on finer meshes: an extremum may have agreed by luck on coarser ones."""
MOST_ROUNDS = 8


@dataclass(frozen=True, eq=False)
class RefinedCycle:
    """A cycle, its measures, multipliers and errors.

    calibration: by which the errors are known. multipliers: by descending modulus, the trivial one taken out;
    trivial_error: its distance from 1.
    """

    fine: Converged
    calibration: Calibration
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
        return undecided_divisor(self.path, self.errors.extrema_error)

    @property
    def margin(self) -> float:
        """How far the largest multiplier's modulus must be from 1 to be told from it."""
        return max(self.trivial_error, self.errors.multiplier_error)

    @property
    def stable(self) -> bool | None:
        """Whether all but the trivial one lie inside the circle; None where the margin does not tell."""
        beyond = self.largest_multiplier - 1
        return None if abs(beyond) <= self.margin else beyond < 0

    def verdict(self, accuracy: float) -> tuple[CycleStatus, str]:
        """What the cycle is, and why it is no stable one."""
        if self.measures.least_stretch <= 0:
            return CycleStatus.left_the_model, f"h1 = {self.measures.least_stretch:.3g} on the cycle"
        if self.errors.largest > accuracy:
            return CycleStatus.not_settled, "the cycle is less accurate than asked for"
        if self.divisor != 1:
            shorter = f"that its period is {self.divisor} times shorter cannot be excluded"
            return CycleStatus.not_settled, shorter
        if self.stable is None:
            return CycleStatus.not_settled, f"its multiplier is 1 within {self.margin:.0e}"
        return (CycleStatus.cycle if self.stable else CycleStatus.unstable), ""


def judged_by(calibration: Calibration, found: Converged, accuracy: float) -> RefinedCycle:
    """The cycle on a mesh that is calibrated."""
    path, errors = CyclePath(found.orbit), calibration.errors(accuracy)
    multipliers, trivial_error = multipliers_of(found)
    largest = max(float(np.abs(multipliers[0])), 1.0) if len(multipliers) else 1.0
    by_matrix = MULTIPLIER_FACTOR * largest * (found.distance + trivial_error)
    at_least = errors.amplitude_error * _by_exponent(multipliers)
    errors = replace(errors, multiplier_error=max(errors.multiplier_error, at_least) + by_matrix)
    measures = measures_of(path)
    return RefinedCycle(found, calibration, path, measures, multipliers, trivial_error, errors)


def _by_exponent(multipliers: Complex) -> float:
    """Change of the largest multiplier with a relative change of its exponent, |mu ln |mu||.

    Exponents are relatively as inaccurate as amplitudes, also where two meshes have one multiplier by luck.
    """
    modulus = float(np.abs(multipliers[0])) if len(multipliers) else 0.0
    return modulus * abs(log(modulus)) if modulus else 0.0


def refine(
    orbit: Orbit, accuracy: float, workspace: NewtonWorkspace, parameter: str | None = None
) -> RefinedCycle:
    """The cycle near an orbit that is no more than near one, as accurate as asked for or as the limits allow.

    Raises Unsolvable where there is none. workspace: memory of the matrices; parameter: along which they have
    tangents. A cycle without it stands alone: finer meshes measure its errors where coarser ones do not.

    Next to a Hopf point a coarse mesh has no cycle at all, for its own Hopf point is beyond: finer ones are
    tried then.
    """
    aim, start = max(accuracy, FIRST_ACCURACY), orbit
    while True:
        try:
            rough = same_motion(newton(start, NEAR, workspace), orbit.size)
            near = rough.orbit
            stages = stages_for(accuracy)
            if parameter is None:
                first = wanted_mesh(near, FIRST_SHARE * aim, stages)
                first = replace(first, intervals=max(first.intervals, LEAST_PREDICTED))
                with suppress(Unsolvable):
                    return _predicted_cycle(first, near, accuracy, workspace)
            found = _on(wanted_mesh(near, aim, stages), rough, aim, parameter)
            return calibrated_cycle(found, None, accuracy, parameter)
        except Unsolvable:
            if aim <= LEAST_ACCURACY or not orbit.symmetric:  # those born at Hopf points are
                raise
            aim = max(AIM_LOWERED * aim, LEAST_ACCURACY)
            start = wanted_mesh(orbit, aim, orbit.stages).carry(orbit)


def _predicted_cycle(
    mesh: OrbitMesh, near: Orbit, accuracy: float, workspace: NewtonWorkspace
) -> RefinedCycle:
    """A cycle that stands alone, on the first mesh or a finer one, as coarser meshes predict it.

    The best is returned where limits do not allow the accuracy. Raises Unsolvable where a coarser mesh has no
    such cycle, where their errors do not fall as they should, or where they do not predict it.
    """
    coarser, last = CoarserMeshes(mesh, near, accuracy, workspace), inf
    orbit, known = best = coarser.predicted(mesh)
    for _ in range(MOST_ROUNDS):
        error = known.errors(accuracy).largest
        if error < best[1].errors(accuracy).largest:
            best = orbit, known
        if error <= accuracy:
            break
        if error > last:
            raise Unsolvable("the errors do not fall on finer meshes")
        mesh, last = finer_mesh(mesh, known.planned(accuracy)), LUCK * error
        if not mesh.allowed:
            break
        if not coarser.serve(mesh):
            coarser = CoarserMeshes(mesh, orbit, accuracy, workspace)
        orbit, known = coarser.predicted(mesh)
    orbit, known = best
    found = same_motion(newton(orbit, newton_tolerance(accuracy), workspace), near.size)
    if found.distance > max(PREDICTED_WITHIN * accuracy, LEAST_WITHIN):
        raise Unsolvable("coarser meshes do not predict the cycle")
    return judged_by(known, at_orbit(found, min(accuracy, LARGEST_DISTANCE)), accuracy)


def calibrated_cycle(
    found: Converged, before: Calibration | None, accuracy: float, parameter: str | None
) -> RefinedCycle:
    """A cycle with errors that are measured, on finer meshes if need be; raises Unsolvable.

    before: the calibration of one near by. The best is returned where limits do not allow the accuracy.
    """
    best, last = None, inf
    for _ in range(MOST_ROUNDS):
        before = calibrated(found, accuracy, before)
        cycle = judged_by(before, found, accuracy)
        if best is None or cycle.errors.largest < best.errors.largest:
            best = cycle
        if cycle.errors.largest <= accuracy or cycle.errors.largest > last:
            break
        finer, last = finer_mesh(before.mesh, before.planned(accuracy)), LUCK * cycle.errors.largest
        if not finer.allowed:
            break
        found = _on(finer, found, accuracy, parameter)
    if best is None:
        raise Unsolvable("no mesh was fine enough")
    return best


def _on(mesh: OrbitMesh, found: Converged, accuracy: float, parameter: str | None) -> Converged:
    """An orbit on another mesh, with the matrix at itself, whose multipliers are right to rounding."""
    last = (newton_tolerance(accuracy) / QUADRATIC) ** 0.5  # the matrix at the orbit makes one step more
    there = newton(mesh.carry(found.orbit), last, found.workspace)
    return linearised(same_motion(there, found.orbit.size), parameter)


def same_motion(found: Converged, size: float) -> Converged:
    """What was found, if its size is near that of the motion it was sought from; Unsolvable otherwise."""
    if not LEAST_SIZE * size < found.orbit.size < LARGEST_SIZE * size:
        raise Unsolvable("Newton's method left the motion that it started from")
    return found


def refined_cycle(
    orbit: Orbit, accuracy: float, workspace: NewtonWorkspace, parameter: str | None = None
) -> RefinedCycle:
    """The cycle near an orbit, over its minimal period; raises Unsolvable where there is none.

    workspace and parameter: as in `refine`. Where its multipliers do not tell whether it is stable, those
    for a hundredth of the accuracy may.
    """
    found = refine(shortened(orbit), accuracy, workspace, parameter)
    if common_divisor(found.path, PRESENT) > 1:
        found = refine(shortened(found.orbit), accuracy, workspace, parameter)
    if found.stable is None:
        found = refine(found.orbit, max(accuracy / 100, LEAST_ACCURACY), workspace, parameter)
    return found


def newton_tolerance(accuracy: float) -> float:
    """What Newton's method may leave, relative."""
    return max(1e-2 * accuracy, 1e-13)


def matrix_distance(accuracy: float) -> float:
    """Relative distance from an orbit at which a matrix still has the right multipliers."""
    return min(max(MATRIX_SHARE * accuracy, LEAST_DISTANCE), LARGEST_DISTANCE)
