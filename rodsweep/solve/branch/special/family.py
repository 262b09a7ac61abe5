"""Correction of a predicted point of a curve of folds or torus points over two parameters.

Cycles near a special point form a family with two variables: arc length along the branch (`bordered`), and
row coordinate. There the special points form a smooth curve, also at a cusp, where both parameters turn back:
the zeros of a test function. The secant method finds a zero across the curve. All cycles and test functions
are corrected with the matrix factors of one cycle (`augmented`). The first derivatives across the curve come
from the previous point. The error is the difference between two meshes, measured at every third point or so.
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
from .augmented.functions import AUGMENTED_SETTINGS, FoldFunction, TorusFunction
from .augmented.nearby_cycles import NearbyCycleSolver
from .on_curve import CURVE_SECANT, CurveErrors, NormalDerivatives, SolvedPoint, orbit_with_parameters
from .point import SpecialKind


class _SecantIterate(NamedTuple):
    """A cycle solved by the secant method. vectors: tangent, (N + 1,), or eigenvector, (2, N + 1), of the
    test function. test: value of the test function. distance: distance from the predicted point, in the
    direction across the curve."""

    orbit: Orbit
    vectors: Array
    test: float
    distance: float


@dataclass(frozen=True, slots=True)
class CycleFamily:
    """Two-parameter family of the cycles near a point of a curve of special points.

    kind: fold or torus. rows: axis of the row parameter. scale: units of arc length. border: direction of the
    branch in components (deflection, log period, parameter), (3,). small: whether the fold test function is
    divided by the deflection, because a Hopf point is near. workspace: memory of Newton's matrices.
    """

    kind: SpecialKind
    rows: PlaneAxis
    scale: Scale
    border: Array
    small: bool
    workspace: NewtonWorkspace

    @classmethod
    def near_point(
        cls, kind: SpecialKind, rows: PlaneAxis, point: SolvedPoint, workspace: NewtonWorkspace
    ) -> "CycleFamily":
        """The family of the cycles near `point` of a curve of special points; the rest as in the class."""
        small = kind == SpecialKind.fold and point.tip_y_max < CURVE_SECANT.small_fold_cycle
        return cls(kind, rows, point.scale, point.ahead, small, workspace)

    def orbit_at_row(self, orbit: Orbit, row_coordinate: float) -> Orbit:
        """The orbit with unchanged values, for the rod at `row_coordinate`; raises Unsolvable."""
        return orbit_with_parameters(orbit, {self.rows.name: self.rows.value(row_coordinate)})

    def function(self, matrix: BorderedMatrix) -> FoldFunction | TorusFunction:
        """The test function of this kind of special points, for cycles near the orbit of `matrix`."""
        if self.kind == SpecialKind.fold:
            return FoldFunction(matrix, self.border, self.small)
        return TorusFunction(matrix)

    def correct(
        self,
        start: Orbit,
        row_coordinate: float,
        normal: Array,
        derivatives: NormalDerivatives | None = None,
        is_other_mesh: bool = False,
    ) -> SolvedPoint:
        """The point of the curve near the orbit `start`, found by the secant method across the curve; raises
        Unsolvable.

        row_coordinate: row coordinate of `start`, from 0 to 1. normal: direction of the search, (2,), in
        components (along the branch, row coordinate). derivatives: derivatives from an earlier search, used
        if their direction is close to `normal`. is_other_mesh: whether `derivatives` were computed at the
        same point on another mesh.
        """
        # Derivatives along another direction across the curve would mislead the secant method.
        usable = derivatives and derivatives.direction @ normal >= CURVE_SECANT.min_cosine
        known = derivatives if usable else None
        search = _SecantState(self, start, row_coordinate, normal, known, is_other_mesh)
        for _ in range(CURVE_SECANT.max_secants):
            found = search.next()
            if found is not None:
                return found
        raise Unsolvable("the secant method across the curve does not converge")

    def correct_with_error(
        self,
        start: Orbit,
        row_coordinate: float,
        normal: Array,
        slope: float = 0.0,
        derivatives: NormalDerivatives | None = None,
        previous: SolvedPoint | None = None,
    ) -> SolvedPoint:
        """The point of the curve near `start` with an error estimate, on a finer mesh if necessary; raises
        Unsolvable.

        slope: `chord_slope` of the curve, with which a displacement along the curve is removed from the
        error. previous: previous point of the curve, whose measured error is used if it still applies. Other
        arguments as in `correct`.
        """
        last = self.correct(start, row_coordinate, normal, derivatives)
        if previous and previous.errors and previous.errors.apply_at(last):
            return replace(last, errors=previous.errors.for_next_point)
        for _ in range(CURVE_SECANT.max_finer_meshes):
            mesh = mesh_of(last.orbit)
            longer = ceil(CURVE_SECANT.more_intervals * mesh.intervals)
            finer = replace(mesh, order=mesh.order + CURVE_SECANT.more_orders, intervals=longer)
            if not finer.allowed:
                break
            known = last.normal_derivatives
            fine = self.correct(finer.interpolate(last.orbit), last.row_coordinate, normal, known, True)
            # The solutions on both meshes may be displaced along the curve; the slope removes this
            # displacement from the error.
            off = abs(fine.parameter - last.parameter - slope * (fine.row_coordinate - last.row_coordinate))
            error = CURVE_SECANT.error_factor * off + CURVE_SECANT.secant_error * abs(fine.parameter)
            if error <= CURVE_SECANT.accuracy * abs(fine.parameter):
                errors = CurveErrors(error / abs(last.parameter), smooth_tails(last.orbit), mesh)
                return replace(last, errors=errors)
            last = fine
        raise Unsolvable("no mesh of allowed size reaches the requested accuracy")


class _SecantState:
    """State of the secant method across a curve; all cycles are corrected with the matrix factors of one
    cycle. start, place: predicted orbit, its row coordinate. direction: `normal` of `CycleFamily.correct`."""

    def __init__(
        self,
        family: CycleFamily,
        start: Orbit,
        row_coordinate: float,
        direction: Array,
        derivatives: NormalDerivatives | None,
        is_other_mesh: bool,
    ) -> None:
        self.family = family
        self.row_coordinate = row_coordinate
        self.direction = direction
        self.derivatives = derivatives
        self.orbit = family.orbit_at_row(start, row_coordinate)
        self.distance = 0.0
        self.previous: _SecantIterate | None = None
        self.length = float(family.border @ family.scale.components(start))
        self.max_last_step = CURVE_SECANT.max_linear_step if is_other_mesh else CURVE_SECANT.max_carried_step
        """Longest last secant step, used if the present step gives no derivatives."""
        contraction = derivatives.contraction if derivatives and not family.small else inf
        self.nearby = NearbyCycleSolver(family, self.orbit, contraction)

    def next(self) -> SolvedPoint | None:
        """Makes one secant step. Returns the point of the curve after the last step, otherwise None. Raises
        Unsolvable."""
        present = self._solve_at_distance()
        enough = self.max_last_step
        if own := self._derivatives_from_last(present):
            self.derivatives = own
            self.max_last_step = CURVE_SECANT.max_linear_step
            enough = CURVE_SECANT.max_linear_product / own.span
        rates = self.derivatives
        # Without derivatives any small step suffices: the two cycles then give derivatives.
        step = -present.test / rates.test if rates else CURVE_SECANT.first_secant
        if not abs(step) <= CURVE_SECANT.longest_secant:
            raise Unsolvable("the secant method leaves the curve")
        if rates and abs(step) <= enough:
            return self._point(step, replace(rates, contraction=self.nearby.contraction))
        if self.previous:  # the vectors are extrapolated along a line, like the cycle
            change = (present.vectors - self.previous.vectors) / (present.distance - self.previous.distance)
            self.nearby.predict(present.vectors + step * change)
        if rates:
            self.orbit = self._predicted_orbit(step, rates)
        self.previous = present
        self.distance += step
        return None

    def _solve_at_distance(self) -> _SecantIterate:
        """The cycle at the present distance across the curve, with its test function; raises Unsolvable."""
        family = self.family
        rates = self.derivatives
        length = self.length + self.distance * float(self.direction[0])
        row = self.row_coordinate + self.distance * float(self.direction[1])
        self.orbit = family.orbit_at_row(self.orbit, row)
        slope = abs(rates.test) if rates else 1.0
        enough = (
            AUGMENTED_SETTINGS.tolerance
            if rates
            else AUGMENTED_SETTINGS.tolerance_share * CURVE_SECANT.first_secant
        )
        condition = BorderCondition(family.scale, family.border, length)
        self.orbit, test = self.nearby.solve(self.orbit, condition, slope, enough)
        return _SecantIterate(self.orbit, self.nearby.function.vectors, test, self.distance)

    def _derivatives_from_last(self, present: _SecantIterate) -> NormalDerivatives | None:
        """Derivatives across the curve from the last cycle and the cycle `present`; None if `present` is the
        first cycle, or if the two cycles are too close or have equal test functions."""
        before = self.previous
        if before is None or present.test == before.test:
            return None
        if abs(present.distance - before.distance) < CURVE_SECANT.min_cycle_distance:
            return None
        name = self.family.scale.name
        # The test function is nearly linear here, so that difference quotients are as good as derivatives.
        span = present.distance - before.distance
        one = before.orbit
        other = present.orbit
        change = other.form.rod.coordinate(name) - one.form.rod.coordinate(name)
        orbit = np.append(other.values - one.values, change) / span
        return NormalDerivatives(
            self.direction, (present.test - before.test) / span, orbit, mesh_of(one), abs(span)
        )

    def _predicted_orbit(self, step: float, derivatives: NormalDerivatives) -> Orbit:
        """The last cycle, moved by `step` across the curve along `derivatives`."""
        return moved_orbit(self.orbit, self.family.scale.name, step * derivatives.on_mesh_of(self.orbit))

    def _point(self, step: float, derivatives: NormalDerivatives) -> SolvedPoint:
        """The point of the curve: the last cycle, moved by `step` across the curve along `derivatives`."""
        family = self.family
        matrix = self.nearby.matrix
        tangent = tangent_at(matrix.orbit, family.scale, family.border, matrix)
        row_coordinate = self.row_coordinate + (self.distance + step) * float(self.direction[1])
        orbit = family.orbit_at_row(self._predicted_orbit(step, derivatives), row_coordinate)
        scale = Scale.of(orbit, family.scale.name, family.scale.min_deflection_unit)
        ahead = scale.directional_derivative(orbit, tangent)
        return SolvedPoint(
            orbit=orbit,
            scale=scale,
            ahead=ahead / np.linalg.norm(ahead),
            row_coordinate=row_coordinate,
            parameter=getattr(orbit.form.rod, scale.name),
            row_parameter=getattr(orbit.form.rod, family.rows.name),
            normal_derivatives=derivatives,
        )
