"""The errors of a cycle of a branch, at the value of the parameter that is stored with it.

Two finer meshes, one in space and one in time, have the cycle at the same place of the branch: there a fold
is a place like any other. The cycles found there lie at other values of the parameter. Slid along the branch
to the stored value they tell the errors of period, extrema and multiplier at that value. What the parameter
is off by where the moment at the clamp is the same is its own error: it is small beside a Hopf point and
beside a fold, where all other numbers change fast with the parameter.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ...arrays import Array, Complex
from ..cycle.accuracy.calibration import MULTIPLIER, SAFETY, Calibration, calibration_of
from ..cycle.accuracy.cycle_errors import LEAST_CLAIM, ROUNDING, CycleErrors
from ..cycle.accuracy.finer_meshes import DISTANCE, finer_meshes
from ..cycle.along_parameter import carried
from ..orbit.measures import CyclePath
from ..orbit.newton import Converged, multiplier_change, multipliers_of
from ..orbit.orbit import Orbit
from ..orbit.orbit_mesh import OrbitMesh, mesh_of
from ..orbit.path_differences import APART, HEIGHT, OTHERS, PERIOD, path_differences
from .bordered import Condition, Scale, moved

STEEP = 120.0
"""|(p/y) dy/dp| of the parameter p and the largest y from which errors at an equal p may exceed the accuracy,
beside a Hopf point or a fold: in proportion to it, since p itself cannot be known better. That is a fifth
above the 100 that is promised, for slopes that are taken between cycles."""
LEAST_SHARE = 0.1
"""The least rate of the moment at the clamp, in units of the parameter's, both relative, with which errors at
an equal moment are stated: where the moment is stationary the parameter at an equal moment means nothing."""
BETWEEN, LEAST_ERROR = 2.0, 1e-16
"""Factor on errors that are interpolated, and the least error that counts: below, it is rounding."""
TOLERANCE = 0.01
"""What Newton's method leaves on finer meshes, in units of the accuracy."""
SLOPE_STEP = 1e-4
"""Length along the branch over which the rate of the largest y is measured, as a difference quotient."""


@dataclass(frozen=True, eq=False)
class Place:
    """Where a cycle stands on its branch: tangent, (N + 1,), of unit length in the scale; ahead: the same as
    a direction of the scale's place, (3,); curvature: of the parameter along the branch, in the scale's
    units; multiplier_rate: of the largest multiplier along the branch.
    """

    scale: Scale
    tangent: Array
    ahead: Array
    curvature: float
    multiplier_rate: float

    @property
    def rate(self) -> float:
        """Of the parameter along the branch, in the scale's units."""
        return float(self.ahead[2])

    def slide(self, off: float) -> float:
        """Length along the branch over which the parameter changes by off, in the scale's units.

        Beside a fold it may change by no more than the curvature allows: then the length to the fold and as
        far beyond it.
        """
        if self.rate**2 >= 4 * abs(self.curvature * off):
            return off / self.rate
        way = np.copysign(1.0, off * self.rate)
        return float(way * 2 * (abs(off) / max(abs(self.curvature), 1e-300)) ** 0.5)


@dataclass(frozen=True, eq=False)
class BranchCalibration:
    """The errors of a mesh at a cycle of a branch.

    known: those at the stored value of the parameter. parameter: relative error of the parameter at an equal
    moment, in space and in time, (2,). slope: |(p/y) dy/dp|.
    """

    known: Calibration
    parameter: Array
    slope: float

    @property
    def mesh(self) -> OrbitMesh:
        return self.known.mesh

    def errors(self, accuracy: float) -> CycleErrors:
        """Of the cycle at the stored value of the parameter."""
        return self.known.errors(accuracy)

    def parameter_error(self, accuracy: float) -> float:
        """Relative, of the parameter at an equal moment."""
        return max(SAFETY * float(self.parameter.sum()), LEAST_CLAIM * accuracy, ROUNDING)

    def largest(self, accuracy: float) -> float:
        """What must not exceed the accuracy."""
        return self._demanded.errors(accuracy).largest

    def planned(self, accuracy: float) -> OrbitMesh:
        """The cheapest mesh that is expected to reach the accuracy."""
        return self._demanded.planned(accuracy)

    def planned_for_parameter(self, accuracy: float) -> OrbitMesh:
        """The cheapest mesh that is expected to have the parameter at an equal moment to the accuracy."""
        return self._of_parameter.planned(accuracy)

    @cached_property
    def _demanded(self) -> Calibration:
        """The errors that a mesh is chosen by: the parameter's counts as the period's does."""
        steep = max(1.0, self.slope / STEEP)
        parts = [self.known.space / steep, self.known.time / steep]
        for part, own in zip(parts, self.parameter, strict=True):
            part[PERIOD] = max(part[PERIOD], own)
        return replace(self.known, space=parts[0], time=parts[1])

    @cached_property
    def _of_parameter(self) -> Calibration:
        """The errors of the parameter alone, in the place of all others."""
        numbers = [PERIOD, HEIGHT, OTHERS, APART]
        parts = [self.known.space.copy(), self.known.time.copy()]
        for part, own in zip(parts, self.parameter, strict=True):
            part[numbers] = own
        return replace(self.known, space=parts[0], time=parts[1])

    def towards(self, other: "BranchCalibration", share: float, slope: float) -> "BranchCalibration":
        """The errors of a cycle of a slope at a share of the way to another one on the same mesh.

        Each falls or grows along the way by a constant factor, and BETWEEN times that is stated.
        """
        mean = [
            _interpolated(one, there, share)
            for one, there in (
                (self.known.space, other.known.space),
                (self.known.time, other.known.time),
                (self.parameter, other.parameter),
            )
        ]
        known = replace(self.known, space=mean[0], time=mean[1], growth=np.ones(2))
        return BranchCalibration(known, mean[2], slope)


def _interpolated(one: Array, other: Array, share: float) -> Array:
    """BETWEEN times the errors at a share of the way, of any shape, but no more than the larger ones."""
    logarithms = np.log(np.maximum([one, other], LEAST_ERROR))
    means = np.exp(logarithms[0] + share * (logarithms[1] - logarithms[0]))
    bounded: Array = np.minimum(BETWEEN * means, np.maximum(one, other))
    return bounded


def measured_errors(
    found: Converged, place: Place, accuracy: float, before: Calibration | None
) -> BranchCalibration:
    """The errors of the mesh of a cycle; raises Unsolvable. before: those of a cycle near by."""
    mesh, orbit = mesh_of(found.orbit), found.orbit
    finer, share = finer_meshes(mesh)
    condition = Condition.at(place.scale, place.ahead, orbit)
    rough = CyclePath(orbit)
    multipliers = multipliers_of(found)[0]
    parts = np.empty((2, MULTIPLIER + 2))
    for part, target in zip(parts, finer, strict=True):
        fine = condition.on(target, found, TOLERANCE * accuracy, DISTANCE)
        part[:] = _difference(rough, multipliers, fine, place)
    parts[1] /= share
    known = calibration_of(mesh, parts[0, :-1], parts[1, :-1], orbit, before)
    return BranchCalibration(known, parts[:, -1], slope_at(rough, place))


def _difference(rough: CyclePath, multipliers: Complex, fine: Converged, place: Place) -> Array:
    """What a cycle differs by from that of a finer mesh, (6,).

    First as `Calibration.space` says, at the value of the parameter that the rough mesh has; then of the
    parameter at an equal moment.
    """
    orbit, scale = rough.orbit, place.scale
    moment, _, off = scale.place(orbit) - scale.place(fine.orbit)
    length = place.slide(off)
    target = mesh_of(fine.orbit)
    along = np.append(carried(orbit, place.tangent[:-1], target), place.tangent[-1])
    slid = moved(fine.orbit, scale.name, length * along)
    change = multiplier_change(multipliers, multipliers_of(fine)[0]) + abs(length * place.multiplier_rate)
    by_moment, by_parameter = abs(place.ahead[0]), abs(place.rate)
    apart = abs(off * place.ahead[0] - moment * place.rate)
    own = apart / max(by_moment, LEAST_SHARE * by_parameter)
    return np.array([*path_differences(rough, CyclePath(slid)), change, own])


def slope_at(path: CyclePath, place: Place) -> float:
    """|(p/y) dy/dp| of the parameter p and the largest y along a branch."""
    orbit: Orbit = path.orbit
    there = CyclePath(moved(orbit, place.scale.name, SLOPE_STEP * place.tangent))
    y, other = path.extrema["tip_y_max"], there.extrema["tip_y_max"]
    return abs((other - y) / (SLOPE_STEP * y)) / max(abs(place.rate), 1e-300)
