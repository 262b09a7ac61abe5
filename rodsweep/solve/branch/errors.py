"""Errors of a cycle of a branch at the stored value of the parameter.

Two finer meshes, one in space and one in time, have the cycle at the same arc length, which is regular at a
fold. The cycles on the finer meshes lie at slightly different values of the parameter; slid along the branch
to the stored value, they give the errors of period, extrema and multiplier. The difference of the parameter
at an equal deflection is the error of the parameter. It stays small beside a Hopf point and beside a fold,
where all other numbers vary steeply with the parameter.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ...arrays import Array, Complex
from ...determinant.exponents import EXPONENTS
from ..cycle.accuracy.calibration import MULTIPLIER, Calibration, calibration_of
from ..cycle.accuracy.calibration_settings import CALIBRATION
from ..cycle.accuracy.cycle_errors import CYCLE_ERRORS, CycleErrors
from ..cycle.accuracy.finer_meshes import COMPARISON, finer_meshes
from ..cycle.along_parameter import carried_change
from ..orbit.measures import CyclePath
from ..orbit.newton import ConvergedOrbit, multiplier_change, multipliers_of
from ..orbit.orbit import Orbit
from ..orbit.orbit_mesh import OrbitMesh, mesh_of
from ..orbit.path_differences import LARGEST_Y, PERIOD_CHANGE, WHOLE_PATH, WORST_EXTREMUM, path_differences
from .bordered.condition import BorderCondition, moved
from .bordered.scale import Scale


@dataclass(frozen=True, slots=True, kw_only=True)
class BranchErrorSettings:
    """Settings of the error estimates of the cycles of a branch."""

    steep_slope: float = 120.0
    """Sensitivity |(p/y) dy/dp| of the largest y to the parameter p, above which errors at an equal p may
    exceed the accuracy in proportion, as beside a Hopf point or a fold: p itself has an error. It is a fifth
    above the promised 100, since slopes are taken between cycles."""
    min_deflection_share: float = 0.1
    """Smallest derivative of the deflection along the branch, in units of the parameter's derivative, used
    for the parameter's error at an equal deflection; where the deflection is stationary that error is
    undefined."""
    interpolation_factor: float = 2.0
    """Safety factor on interpolated errors."""
    negligible_error: float = 1e-16
    """Smallest error; smaller differences are rounding."""
    newton_share: float = 0.01
    """Tolerance of Newton's method on the finer meshes, in units of the accuracy."""
    slope_step: float = 1e-4
    """Arc length of the difference quotient that gives the slope of the largest y."""


BRANCH_ERRORS = BranchErrorSettings()


@dataclass(frozen=True, eq=False)
class CyclePlace:
    """A cycle's scale and tangent, and how fast both and the multiplier change along the branch."""

    scale: Scale
    tangent: Array
    """Tangent of the branch, of unit length in the scale, (N + 1,)."""
    ahead: Array
    """The tangent as a direction of `Scale.place`, (3,)."""
    curvature: float
    """Second derivative of the parameter along the branch, in the scale's units."""
    multiplier_rate: float
    """Derivative of the largest multiplier along the branch."""

    @property
    def rate(self) -> float:
        """Derivative of the parameter along the branch, in the scale's units."""
        return float(self.ahead[2])

    def slide(self, off: float) -> float:
        """Arc length over which the parameter changes by `off`, in the scale's units.

        Beside a fold the parameter may not reach that change; the result is then twice the length to the
        fold.
        """
        # Away from a fold the quadratic term changes the linear solution by an eighth at most.
        if self.rate**2 >= 4 * abs(self.curvature * off):
            return off / self.rate
        way = np.copysign(1.0, off * self.rate)
        # At a fold off is quadratic in the length: rate s + curvature s^2/2 = off; the root is bounded from
        # above.
        return float(way * 2 * (abs(off) / max(abs(self.curvature), EXPONENTS.least_divisor)) ** 0.5)


@dataclass(frozen=True, eq=False)
class BranchCalibration:
    """Errors of a mesh at a cycle of a branch.

    known: at an equal parameter. parameter: relative error of the parameter at an equal deflection, in space
    and in time, (2,). slope: |(p/y) dy/dp|.
    """

    known: Calibration
    parameter: Array
    slope: float

    @property
    def mesh(self) -> OrbitMesh:
        return self.known.mesh

    def errors(self, accuracy: float) -> CycleErrors:
        """Errors of the cycle at the stored value of the parameter."""
        return self.known.errors(accuracy)

    def parameter_error(self, accuracy: float) -> float:
        """Relative error of the parameter at an equal deflection."""
        return max(
            CALIBRATION.safety * float(self.parameter.sum()),
            CYCLE_ERRORS.min_claim * accuracy,
            CYCLE_ERRORS.rounding,
        )

    def largest(self, accuracy: float) -> float:
        """The error that must not exceed the accuracy."""
        return self._demanded.errors(accuracy).largest

    def planned(self, accuracy: float) -> OrbitMesh:
        """The cheapest mesh that is expected to reach the accuracy."""
        return self._demanded.planned(accuracy)

    def planned_for_parameter(self, accuracy: float) -> OrbitMesh:
        """The cheapest mesh whose parameter at an equal deflection is expected to have the accuracy."""
        return self._of_parameter.planned(accuracy)

    @cached_property
    def _demanded(self) -> Calibration:
        """Errors that determine the mesh; the parameter's error counts like the period's."""
        # Where y is steep in p, errors at equal p grow with the slope although the mesh is as good as
        # elsewhere.
        steep = max(1.0, self.slope / BRANCH_ERRORS.steep_slope)
        parts = [self.known.space / steep, self.known.time / steep]
        for part, own in zip(parts, self.parameter, strict=True):
            part[PERIOD_CHANGE] = max(part[PERIOD_CHANGE], own)
        return replace(self.known, space=parts[0], time=parts[1])

    @cached_property
    def _of_parameter(self) -> Calibration:
        """A calibration with the parameter's error in place of every error."""
        numbers = [PERIOD_CHANGE, LARGEST_Y, WORST_EXTREMUM, WHOLE_PATH]
        parts = [self.known.space.copy(), self.known.time.copy()]
        for part, own in zip(parts, self.parameter, strict=True):
            part[numbers] = own
        return replace(self.known, space=parts[0], time=parts[1])

    def towards(self, other: "BranchCalibration", share: float, slope: float) -> "BranchCalibration":
        """Errors of a cycle between two cycles with measured errors on one mesh. share: fraction of the way
        to `other`; slope: slope at the cycle.

        Each error is interpolated geometrically and multiplied by BRANCH_ERRORS.interpolation_factor.
        """
        mean = [
            _interpolated(one, another, share)
            for one, another in (
                (self.known.space, other.known.space),
                (self.known.time, other.known.time),
                (self.parameter, other.parameter),
            )
        ]
        known = replace(self.known, space=mean[0], time=mean[1], growth=np.ones(2))
        return BranchCalibration(known, mean[2], slope)


def _interpolated(one: Array, other: Array, share: float) -> Array:
    """Errors at a share of the way, times `interpolation_factor`, at most the larger; of any shape."""
    # Errors of a mesh change by factors along a branch, so their logarithms are interpolated.
    logarithms = np.log(np.maximum([one, other], BRANCH_ERRORS.negligible_error))
    means = np.exp(logarithms[0] + share * (logarithms[1] - logarithms[0]))
    bounded: Array = np.minimum(BRANCH_ERRORS.interpolation_factor * means, np.maximum(one, other))
    return bounded


def measured_errors(
    found: ConvergedOrbit, place: CyclePlace, accuracy: float, before: Calibration | None
) -> BranchCalibration:
    """Errors of a cycle's mesh, from two finer meshes; raises Unsolvable. before: errors of a neighbouring
    cycle."""
    mesh = mesh_of(found.orbit)
    orbit = found.orbit
    finer, share = finer_meshes(mesh)
    condition = BorderCondition.at(place.scale, place.ahead, orbit)
    rough = CyclePath(orbit)
    multipliers = multipliers_of(found)[0]
    parts = np.empty((2, MULTIPLIER + 2))
    for part, target in zip(parts, finer, strict=True):
        fine = condition.on(target, found, BRANCH_ERRORS.newton_share * accuracy, COMPARISON.matrix_distance)
        part[:] = _difference(rough, multipliers, fine, place)
    # The mesh finer in time removes only this share of the error in time.
    parts[1] /= share
    known = calibration_of(mesh, parts[0, :-1], parts[1, :-1], orbit, before)
    return BranchCalibration(known, parts[:, -1], slope_at(rough, place))


def _difference(rough: CyclePath, multipliers: Complex, fine: ConvergedOrbit, place: CyclePlace) -> Array:
    """Differences of a cycle from the same cycle on a finer mesh, (6,).

    The first five, as in `Calibration.space`, are differences at the rough mesh's value of the parameter; the
    last is the difference of the parameter at an equal deflection.
    """
    orbit = rough.orbit
    scale = place.scale
    deflection, _, off = scale.place(orbit) - scale.place(fine.orbit)
    length = place.slide(off)
    target = mesh_of(fine.orbit)
    along = np.append(carried_change(orbit, place.tangent[:-1], target), place.tangent[-1])
    # The two cycles differ in the parameter; the finer one is moved along the branch to the same value.
    slid = moved(fine.orbit, scale.name, length * along)
    change = multiplier_change(multipliers, multipliers_of(fine)[0]) + abs(length * place.multiplier_rate)
    by_deflection = abs(place.ahead[0])
    by_parameter = abs(place.rate)
    # Distance of the two branches across their common tangent, in (deflection, parameter).
    apart = abs(off * place.ahead[0] - deflection * place.rate)
    own = apart / max(by_deflection, BRANCH_ERRORS.min_deflection_share * by_parameter)
    return np.array([*path_differences(rough, CyclePath(slid)), change, own])


def slope_at(path: CyclePath, place: CyclePlace) -> float:
    """Sensitivity |(p/y) dy/dp| of the largest y to the parameter p along a branch."""
    orbit: Orbit = path.orbit
    ahead = CyclePath(moved(orbit, place.scale.name, BRANCH_ERRORS.slope_step * place.tangent))
    y = path.extrema["tip_y_max"]
    other = ahead.extrema["tip_y_max"]
    return abs((other - y) / (BRANCH_ERRORS.slope_step * y)) / max(abs(place.rate), EXPONENTS.least_divisor)
