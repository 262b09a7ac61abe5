"""Correction of a predicted point of a curve of folds or torus points over two parameters.

Cycles near a special point form a two-parameter family: arc length along the branch (`bordered`), and
position on the rows' axis. In the plane of these two variables the special points form a smooth curve, the
zeros of a test function, also at a cusp, where both parameters turn back. The secant method across the curve
finds a zero. All cycles and their test functions are corrected with the matrix factors of one cycle
(`augmented`). The first derivatives across the curve come from the previous point. The error is the
difference between two meshes, measured at about every third point.
"""

from dataclasses import dataclass, replace
from math import ceil, inf
from typing import NamedTuple

import numpy as np

from ....arrays import Array
from ....determinant.parameter_plane import PlaneAxis
from ...orbit.matrix.workspace import NewtonWorkspace
from ...orbit.orbit import Orbit
from ...orbit.orbit_mesh import mesh_of
from ...orbit.tails import smooth_tails
from ...point import Unsolvable
from ..arc import tangent_at
from ..bordered.condition import BorderCondition, moved_orbit
from ..bordered.matrix import BorderedMatrix
from ..bordered.scale import Scale
from .augmented.functions import AUGMENTED, FoldFunction, TorusFunction
from .augmented.nearby_cycles import NearbyCycleSolver
from .on_curve import ACROSS_CURVE, CurveErrors, NormalDerivatives, SolvedPoint, orbit_with_parameters
from .point import SpecialKind


class _CycleAcross(NamedTuple):
    """A cycle solved by the secant method. at: distance from the predicted point in the direction across the
    curve. vectors: tangent or eigenvector of the test function. test: value of the test function."""

    orbit: Orbit
    vectors: Array
    test: float
    at: float


@dataclass(frozen=True, slots=True)
class CycleFamily:
    """Two-parameter family of the cycles near a point of a curve of special points.

    kind: fold or torus. rows: axis of the rows' parameter. border: direction of the branch in components
    (deflection, log period, parameter), (3,). small: whether the fold test function is divided by the
    deflection, because a Hopf point is near. workspace: memory of Newton's matrices.
    """

    kind: SpecialKind
    rows: PlaneAxis
    scale: Scale
    border: Array
    small: bool
    workspace: NewtonWorkspace

    @classmethod
    def about(
        cls, kind: SpecialKind, rows: PlaneAxis, point: SolvedPoint, workspace: NewtonWorkspace
    ) -> "CycleFamily":
        """The family of the cycles near the point `point` of a curve of special points. Other arguments as in
        the class."""
        small = kind == SpecialKind.fold and point.tip_y_max < ACROSS_CURVE.small_fold_cycle
        return cls(kind, rows, point.scale, point.ahead, small, workspace)

    def placed(self, orbit: Orbit, place: float) -> Orbit:
        """The orbit with unchanged values, for the rod at the position `place` on the rows' axis; raises
        Unsolvable."""
        return orbit_with_parameters(orbit, {self.rows.name: self.rows.value(place)})

    def function(self, matrix: BorderedMatrix) -> FoldFunction | TorusFunction:
        """The test function that is zero at special points of this kind, for cycles near the orbit of
        `matrix`."""
        if self.kind == SpecialKind.fold:
            return FoldFunction(matrix, self.border, self.small)
        return TorusFunction(matrix)

    def nearest(
        self,
        start: Orbit,
        place: float,
        across: Array,
        rates: NormalDerivatives | None = None,
        same: bool = False,
    ) -> SolvedPoint:
        """The point of the curve near the orbit `start`, found by the secant method across the curve; raises
        Unsolvable.

        place: position of `start` on the rows' axis, from 0 to 1. across: direction of the search, (2,), in
        components (along the branch, along the rows' axis). rates: approximate derivatives across the curve.
        same: whether `rates` were computed at the same point on another mesh.
        """
        # Derivatives along another direction across the curve would mislead the secant method.
        known = rates if rates and rates.direction @ across >= ACROSS_CURVE.min_cosine else None
        search = _SecantAcross(self, start, place, across, known, same)
        for _ in range(ACROSS_CURVE.max_secants):
            found = search.next()
            if found is not None:
                return found
        raise Unsolvable("the secant method across the curve does not converge")

    def point(
        self,
        start: Orbit,
        place: float,
        across: Array,
        slope: float = 0.0,
        rates: NormalDerivatives | None = None,
        before: SolvedPoint | None = None,
    ) -> SolvedPoint:
        """The point of the curve near `start` with an error estimate, on a finer mesh if necessary; raises
        Unsolvable.

        start, place, across, rates: as in `nearest`. slope: `chord_slope` of the curve, with which a
        displacement along the curve is removed from the error. before: previous point of the curve, whose
        measured error is used if it still applies.
        """
        last = self.nearest(start, place, across, rates)
        if before and before.errors and before.errors.hold_at(last):
            return replace(last, errors=before.errors.carried)
        for _ in range(ACROSS_CURVE.max_finer_meshes):
            mesh = mesh_of(last.orbit)
            longer = ceil(ACROSS_CURVE.more_intervals * mesh.intervals)
            finer = replace(mesh, order=mesh.order + ACROSS_CURVE.more_orders, intervals=longer)
            if not finer.allowed:
                break
            fine = self.nearest(finer.carry(last.orbit), last.place, across, last.rates, same=True)
            # The solutions on both meshes may be displaced along the curve; the slope removes this
            # displacement from the error.
            off = abs(fine.at - last.at - slope * (fine.place - last.place))
            error = ACROSS_CURVE.error_factor * off + ACROSS_CURVE.secant_error * abs(fine.at)
            if error <= ACROSS_CURVE.accuracy * abs(fine.at):
                return replace(last, errors=CurveErrors(error / abs(last.at), smooth_tails(last.orbit), mesh))
            last = fine
        raise Unsolvable("no mesh of allowed size reaches the requested accuracy")


class _SecantAcross:
    """State of the secant method across a curve. All cycles are corrected with the matrix factors of the
    first cycle."""

    def __init__(
        self,
        family: CycleFamily,
        start: Orbit,
        place: float,
        direction: Array,
        rates: NormalDerivatives | None,
        same: bool,
    ) -> None:
        self.family = family
        self.place = place
        self.direction = direction
        self.rates = rates
        self.orbit = family.placed(start, place)
        self.at = 0.0
        self.before: _CycleAcross | None = None
        self.length = float(family.border @ family.scale.components(start))
        self.trusted = ACROSS_CURVE.max_linear_step if same else ACROSS_CURVE.max_carried_step
        """Largest length of the last secant step, as long as `rates` are not from two cycles of this
        search."""
        contraction = rates.contraction if rates and not family.small else inf
        self.near = NearbyCycleSolver(family, self.orbit, contraction)

    def next(self) -> SolvedPoint | None:
        """Makes one secant step and returns the point of the curve, or None if more steps are needed; raises
        Unsolvable."""
        present = self._solved_here()
        enough = self.trusted
        if own := self._rates_since(present):
            self.rates = own
            self.trusted = ACROSS_CURVE.max_linear_step
            enough = ACROSS_CURVE.max_linear_product / own.span
        rates = self.rates
        # Without derivatives any small step suffices: the two cycles then give derivatives.
        step = -present.test / rates.test if rates else ACROSS_CURVE.first_secant
        if not abs(step) <= ACROSS_CURVE.longest_secant:
            raise Unsolvable("the secant method leaves the curve")
        if rates and abs(step) <= enough:
            return self._point(step, replace(rates, contraction=self.near.contraction))
        if self.before:  # the vectors are extrapolated along a line, like the cycle
            change = (present.vectors - self.before.vectors) / (present.at - self.before.at)
            self.near.predict(present.vectors + step * change)
        if rates:
            self.orbit = self._moved(step, rates)
        self.before = present
        self.at += step
        return None

    def _solved_here(self) -> _CycleAcross:
        """The cycle at the present distance `at` across the curve, with its test function; raises
        Unsolvable."""
        family = self.family
        rates = self.rates
        length = self.length + self.at * float(self.direction[0])
        self.orbit = family.placed(self.orbit, self.place + self.at * float(self.direction[1]))
        slope = abs(rates.test) if rates else 1.0
        enough = AUGMENTED.tolerance if rates else AUGMENTED.tolerance_share * ACROSS_CURVE.first_secant
        condition = BorderCondition(family.scale, family.border, length)
        self.orbit, test = self.near.solved(self.orbit, condition, slope, enough)
        return _CycleAcross(self.orbit, self.near.function.vectors, test, self.at)

    def _rates_since(self, present: _CycleAcross) -> NormalDerivatives | None:
        """Derivatives across the curve from the last cycle and the cycle `present`; None if `present` is the
        first cycle, or if the two cycles are too close or have equal test functions."""
        before = self.before
        if before is None or present.test == before.test:
            return None
        if abs(present.at - before.at) < ACROSS_CURVE.min_cycle_distance:
            return None
        name = self.family.scale.name
        # The test function is nearly linear here, so that difference quotients are as good as derivatives.
        span = present.at - before.at
        one = before.orbit
        other = present.orbit
        change = other.form.rod.coordinate(name) - one.form.rod.coordinate(name)
        orbit = np.append(other.values - one.values, change) / span
        return NormalDerivatives(
            self.direction, (present.test - before.test) / span, orbit, mesh_of(one), abs(span)
        )

    def _moved(self, step: float, rates: NormalDerivatives) -> Orbit:
        """The last cycle, moved by `step` across the curve along the derivatives `rates`."""
        return moved_orbit(self.orbit, self.family.scale.name, step * rates.on(self.orbit))

    def _point(self, step: float, rates: NormalDerivatives) -> SolvedPoint:
        """The point of the curve: the last cycle, moved by the short step `step` across the curve along the
        derivatives `rates`."""
        family = self.family
        matrix = self.near.matrix
        tangent = tangent_at(matrix.orbit, family.scale, family.border, matrix)
        place = self.place + (self.at + step) * float(self.direction[1])
        orbit = family.placed(self._moved(step, rates), place)
        scale = Scale.of(orbit, family.scale.name, family.scale.min_deflection_unit)
        ahead = scale.moved(orbit, tangent)
        return SolvedPoint(
            orbit=orbit,
            scale=scale,
            ahead=ahead / np.linalg.norm(ahead),
            place=place,
            at=getattr(orbit.form.rod, scale.name),
            row=getattr(orbit.form.rod, family.rows.name),
            rates=rates,
        )
