"""Continuation of folds and torus points of cycles as curves over two parameters.

Cycles near a special point form a two-parameter family: arc length along the branch (`bordered`), and place
on the rows' axis. In this plane the special points are the zeros of one test function along a smooth curve,
also at a cusp, where both parameters turn back. The curve is followed by arc length. A polynomial through the
previous points predicts cycle and place. The secant method across the curve corrects; every cycle and the
test function's vectors are solved with the factors of one elimination (`augmented`). Derivatives across the
curve come from the previous point. Errors are differences of two meshes, measured at every third point or so.
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
from ...orbit.tails import lasting_tails
from ...point import Unsolvable
from ..arc import tangent_at
from ..bordered.condition import BorderCondition, moved
from ..bordered.matrix import BorderedMatrix
from ..bordered.scale import Scale
from .augmented.functions import AUGMENTED, FoldFunction, TorusFunction
from .augmented.nearby_cycles import NearbyCycles
from .on_curve import ACROSS_CURVE, CurveErrors, NormalDerivatives, OnCurve, with_parameters
from .point import SpecialKind


class _CycleAcross(NamedTuple):
    """A cycle at the distance `at` from a curve, measured across it, with test function and its vectors."""

    orbit: Orbit
    vectors: Array
    test: float
    at: float


@dataclass(frozen=True, slots=True)
class CycleFamily:
    """Cycles about a point of a curve. border: direction of its branch in the scale, (3,).

    small: whether the fold function is divided by the deflection, because the cycles are near a Hopf point.
    workspace: memory of the matrices.
    """

    kind: SpecialKind
    rows: PlaneAxis
    scale: Scale
    border: Array
    small: bool
    workspace: NewtonWorkspace

    @classmethod
    def about(
        cls, kind: SpecialKind, rows: PlaneAxis, point: OnCurve, workspace: NewtonWorkspace
    ) -> "CycleFamily":
        """The cycles about a point."""
        small = kind == SpecialKind.fold and point.tip_y_max < ACROSS_CURVE.small_fold_cycle
        return cls(kind, rows, point.scale, point.ahead, small, workspace)

    def placed(self, orbit: Orbit, place: float) -> Orbit:
        """The orbit's values for the rod at a place on the rows' axis; raises Unsolvable."""
        return with_parameters(orbit, {self.rows.name: self.rows.value(place)})

    def function(self, matrix: BorderedMatrix) -> FoldFunction | TorusFunction:
        """The test function that is zero at special points of this kind, at the cycle of a matrix."""
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
    ) -> OnCurve:
        """The point of the curve near an orbit, searched across the curve in a direction, (2,). Raises
        Unsolvable.

        rates: approximate derivatives across the curve. same: whether `rates` belong to the point sought, on
        another mesh.
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
        before: OnCurve | None = None,
    ) -> OnCurve:
        """`nearest` with an error estimate, on a finer mesh if necessary; raises Unsolvable.

        slope: d(line's value)/d(place) along the curve; a difference along the curve is no error. before: the
        previous point, whose errors are reused while they apply.
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
            # The two points may lie at different places along the curve; the slope takes this out of the
            # error.
            off = abs(fine.at - last.at - slope * (fine.place - last.place))
            error = ACROSS_CURVE.error_factor * off + ACROSS_CURVE.secant_error * abs(fine.at)
            if error <= ACROSS_CURVE.accuracy * abs(fine.at):
                return replace(
                    last, errors=CurveErrors(error / abs(last.at), lasting_tails(last.orbit), mesh)
                )
            last = fine
        raise Unsolvable("no mesh of allowed size reaches the requested accuracy")


class _SecantAcross:
    """The secant method across a curve; all its cycles are corrected with the factors of the first."""

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
        self.length = float(family.border @ family.scale.place(start))
        self.trusted = ACROSS_CURVE.max_linear_step if same else ACROSS_CURVE.max_carried_step
        """Largest last step along a line for derivatives that were not computed from two cycles of this
        search."""
        contraction = rates.contraction if rates and not family.small else inf
        self.near = NearbyCycles(family, self.orbit, contraction)

    def next(self) -> OnCurve | None:
        """The point of the curve, once a step is short enough; None while more steps are needed. Raises
        Unsolvable."""
        present = self._solved_here()
        enough = self.trusted
        if own := self._rates_since(present):
            self.rates = own
            self.trusted = ACROSS_CURVE.max_linear_step
            enough = ACROSS_CURVE.max_linear_product / own.span
        rates = self.rates
        # Without derivatives any small step serves: two cycles then give them.
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
        """The cycle at the present length across the curve; raises Unsolvable."""
        family = self.family
        rates = self.rates
        length = self.length + self.at * float(self.direction[0])
        self.orbit = family.placed(self.orbit, self.place + self.at * float(self.direction[1]))
        slope = abs(rates.test) if rates else 1.0
        enough = AUGMENTED.tolerance if rates else AUGMENTED.function_share * ACROSS_CURVE.first_secant
        condition = BorderCondition(family.scale, family.border, length)
        self.orbit, test = self.near.solved(self.orbit, condition, slope, enough)
        return _CycleAcross(self.orbit, self.near.function.vectors, test, self.at)

    def _rates_since(self, present: _CycleAcross) -> NormalDerivatives | None:
        """Derivatives across the curve from the last two cycles; None for a single cycle or too small a
        distance."""
        before = self.before
        if before is None or present.test == before.test:
            return None
        if abs(present.at - before.at) < ACROSS_CURVE.min_cycle_distance:
            return None
        name = self.family.scale.name
        # Difference quotients of whole cycles are as good as derivatives here: the test function is nearly
        # linear.
        span = present.at - before.at
        one = before.orbit
        other = present.orbit
        change = other.form.rod.coordinate(name) - one.form.rod.coordinate(name)
        orbit = np.append(other.values - one.values, change) / span
        return NormalDerivatives(
            self.direction, (present.test - before.test) / span, orbit, mesh_of(one), abs(span)
        )

    def _moved(self, step: float, rates: NormalDerivatives) -> Orbit:
        """The last cycle moved by a step across the curve."""
        return moved(self.orbit, self.family.scale.name, step * rates.on(self.orbit))

    def _point(self, step: float, rates: NormalDerivatives) -> OnCurve:
        """The point of the curve at a short step across from the last cycle."""
        family = self.family
        matrix = self.near.matrix
        tangent = tangent_at(matrix.orbit, family.scale, family.border, matrix)
        place = self.place + (self.at + step) * float(self.direction[1])
        orbit = family.placed(self._moved(step, rates), place)
        scale = Scale.of(orbit, family.scale.name, family.scale.least)
        ahead = scale.moved(orbit, tangent)
        return OnCurve(
            orbit=orbit,
            scale=scale,
            ahead=ahead / np.linalg.norm(ahead),
            place=place,
            at=getattr(orbit.form.rod, scale.name),
            row=getattr(orbit.form.rod, family.rows.name),
            rates=rates,
        )
