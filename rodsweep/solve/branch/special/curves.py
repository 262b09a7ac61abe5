"""Curves of folds and torus points of cycles, from a point located on a row to their ends."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ....arrays import Array
from ....determinant.parameter_plane import PlaneAxis
from ....watch import SolvePosition, report
from ....wording import counted
from ...continuation.follower import Curve, CurveStop, StepControl, StepResult, follow, zero_along
from ...orbit.matrix.workspace import NewtonWorkspace
from ...orbit.newton import relative_change
from ...orbit.orbit import Orbit
from ...orbit.orbit_mesh import OrbitMesh, mesh_of
from ...point import Unsolvable
from ..bordered.matrix import BorderedMatrix
from .augmented.functions import crossing_pair
from .curve_start import first_on_curve
from .cycle_curves import CURVE_IDENTITY, CurveEnd, weights_at
from .family import CycleFamily
from .least_stretch import stretch_of
from .on_curve import OnCurve, errors_between, lengths_of, slope_of, with_parameters
from .point import SpecialKind, SpecialPoint

CURVE_STEPS = StepControl(
    first=0.01,
    longest=0.1,
    shortest=1e-4,
    aim=3e-3,
    far=0.1,
    order=CURVE_IDENTITY.max_interpolated,
    sharpest=0.55,
    growth=2.0,
    most=400,
)
"""Step lengths along a curve; the rows' axis has length 1, the other three directions are those of
`Scale.place`."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CycleCurveSettings:
    """Settings for the ends of a curve of special points."""

    min_loop_points: int = 5
    """Minimum number of points of a closed curve."""
    on_edge: float = 1e-8
    """Largest scaled distance from an edge of a point on the edge."""
    edge_bracket: float = 1e-10
    """Fraction of a step to which the crossing of an edge is located."""
    crushing_margin: float = 1e-3
    """Relative distance below the crushing force k1 at which a curve ends."""
    crushing_accuracy: float = 1e-6
    """Relative accuracy of the shortened step that ends halfway into this margin."""
    vanishing: float = 0.01
    """Largest tip y, in L, from which a curve is extrapolated to the Hopf point where its cycles vanish."""
    almost_real: float = 0.2
    """Angle of a multiplier from the real axis, in radians, below which its pair is about to become real."""


CYCLE_CURVES = CycleCurveSettings()


ALONG_BRANCH = np.array([1.0, 0.0])


EDGE_COUNT = 4
"""Number of edges of the plane; the margins of a curve begin with the distances from these."""
ROW_EDGES = (2, 3)
"""Indices of the margins whose edges are rows."""
END_AT_MARGIN = (*EDGE_COUNT * (CurveEnd.edge,), CurveEnd.crushed, CurveEnd.left_the_model, CurveEnd.hopf)
"""Reason for the end of a curve, by the margin that becomes 0."""


@dataclass(frozen=True, slots=True)
class CurveLimits:
    """Limits of the curves of one kind of special points: the line's and the rows' axis.

    side: 1 or -1, first direction along the rows' axis. workspace: memory of all matrices.
    """

    kind: SpecialKind
    line: PlaneAxis
    rows: PlaneAxis
    workspace: NewtonWorkspace
    side: float = 1.0

    def followed(self, special: SpecialPoint, row: float) -> tuple[list[OnCurve], CurveEnd]:
        """(points from a special point of a row to an end of its curve, reason for the end); raises
        Unsolvable."""
        first = first_on_curve(special, self.line.name, self.rows, row, self.workspace)
        curve = follow(self, first, CURVE_STEPS, self._report)
        return errors_between(curve.solutions), self._why_ended(curve)

    def _why_ended(self, curve: Curve[OnCurve]) -> CurveEnd:
        """Reason for the end of a curve."""
        if curve.end is CurveStop.margin:
            return END_AT_MARGIN[curve.margin]
        if curve.end is CurveStop.closed:
            return CurveEnd.closed
        return self._why_lost(curve.solutions[-1]) if curve.end is CurveStop.lost else CurveEnd.not_followed

    def _report(self, points: Sequence[OnCurve]) -> None:
        """Reports the position along the curve."""
        report(
            lambda: SolvePosition(f"{self.rows.name} = {points[-1].row:.5g}, {counted(len(points), 'point')}")
        )

    def step(self, behind: Sequence[OnCurve], length: float) -> StepResult[OnCurve]:
        """The point a step ahead; raises Unsolvable."""
        last = behind[-1]
        if len(behind) == 1:
            start = last.orbit
            place = last.place + self.side * length
            across = ALONG_BRANCH
            slope = 0.0
            rates = None
        else:
            start, place = self._predicted(behind, self._step_before_crushing(behind, length))
            way = np.append(last.scale.place(start) - last.scale.place(last.orbit), place - last.place)
            across = last.across(way)
            slope = slope_of(*behind[-2:])
            rates = last.rates
        point = self._family(last).point(start, place, across, slope, rates, last)
        mesh = mesh_of(point.orbit)
        predicted = start if mesh == mesh_of(start) else mesh.carry(start)
        # Prediction and point must live on one mesh to be compared.
        off = relative_change(predicted, point.orbit.values - predicted.values)
        if len(behind) == 1:  # the prediction was the cycle of another row
            return StepResult(point, min(off, CURVE_STEPS.far), 1.0)
        one = last.step_from(behind[-2])
        other = point.step_from(last)
        return StepResult(point, off, float(one @ other / np.linalg.norm(one) / np.linalg.norm(other)))

    def _family(self, point: OnCurve) -> CycleFamily:
        return CycleFamily.about(self.kind, self.rows, point, self.workspace)

    def _predicted(self, points: Sequence[OnCurve], step: float) -> tuple[Orbit, float]:
        """(orbit, place) a step beyond the last of some points; raises Unsolvable."""
        known = points[-CURVE_IDENTITY.max_interpolated :]
        return self._mixed(known, weights_at(lengths_of(known), step), mesh_of(known[-1].orbit))

    def _step_before_crushing(self, points: Sequence[OnCurve], step: float) -> float:
        """The step length, shortened if its prediction would lie beyond the crushing margin."""
        from scipy.optimize import brentq  # slow import: 0.1 s, for few runs

        known = points[-CURVE_IDENTITY.max_interpolated :]
        lengths = lengths_of(known)

        def distance(longest: float) -> float:
            weights = weights_at(lengths, longest)
            rod = known[-1].orbit.form.rod
            at, place = (float(np.dot(weights, [getattr(p, n) for p in known])) for n in ("at", "place"))
            values = {"F": rod.F, "k1": rod.k1, self.line.name: at, self.rows.name: self.rows.value(place)}
            return 1 - CYCLE_CURVES.crushing_margin / 2 - values["F"] / values["k1"]

        if distance(step) >= 0 or distance(0.0) <= 0:
            return step
        return float(brentq(distance, 0.0, step, rtol=CYCLE_CURVES.crushing_accuracy))

    def _mixed(
        self, points: Sequence[OnCurve], weights: Sequence[float] | Array, mesh: OrbitMesh
    ) -> tuple[Orbit, float]:
        """(orbit, place): weighted means of some points, (points,); raises Unsolvable."""
        values = np.dot(weights, [mesh.carry(point.orbit).values for point in points])
        at, place = (float(np.dot(weights, [getattr(p, n) for p in points])) for n in ("at", "place"))
        changed = {self.line.name: at, self.rows.name: self.rows.value(place)}
        return with_parameters(replace(mesh.carry(points[-1].orbit), values=values), changed), place

    def margins(self, point: OnCurve) -> Array:
        """Scaled distances from the four edges, distance from crushing, least h1, and the cycle's size,
        (7,)."""
        x = self.line.scaled(point.at)
        y = point.place
        rod = point.orbit.form.rod
        crushing = 1 - CYCLE_CURVES.crushing_margin - rod.F / rod.k1
        stretch = stretch_of(point.orbit)
        return np.array([x, 1 - x, y, 1 - y, crushing, stretch, point.tip_y_max - CYCLE_CURVES.vanishing])

    def landed(self, behind: Sequence[OnCurve], outer: OnCurve, margin: int) -> OnCurve | None:
        """The point between `behind[-1]` and `outer` at which a margin is 0; None if not found."""
        inner = behind[-1]
        if END_AT_MARGIN[margin] is CurveEnd.hopf:
            return outer  # no cycle exists at the Hopf point itself: the curve's end is extrapolated
        ends = float(self.margins(inner)[margin]), float(self.margins(outer)[margin])
        if ends[0] <= CYCLE_CURVES.on_edge:
            return None
        try:
            if margin in ROW_EDGES:
                point = self.on_row(inner, outer, float(margin - ROW_EDGES[0]))
            else:
                point = self._where_zero(inner, outer, margin, ends)
        except Unsolvable:
            return None
        return replace(point, errors=outer.errors and outer.errors.carried)

    def _where_zero(self, inner: OnCurve, outer: OnCurve, margin: int, ends: tuple[float, float]) -> OnCurve:
        """The point between two at which a margin is 0. ends: margin at the two points. Raises Unsolvable."""
        found: dict[float, OnCurve] = {1.0: outer}

        def left(share: float) -> float:
            found[share] = self.between(inner, outer, share)
            return float(self.margins(found[share])[margin])

        return found[zero_along(left, ends, 1.0, CYCLE_CURVES.edge_bracket, CYCLE_CURVES.edge_bracket)]

    def closes(self, behind: Sequence[OnCurve], point: OnCurve) -> bool:
        """Whether the first point of the curve lies between its last point and the next."""
        first = behind[0]
        last = behind[-1]
        step = point.step_from(last)
        back = point.step_from(first)
        # The start lies within the last step, both along it and in distance.
        passed = float(back @ step) / float(step @ step)
        near = float(np.linalg.norm(back)) <= float(np.linalg.norm(step))
        return len(behind) > CYCLE_CURVES.min_loop_points and 0 <= passed <= 1 and near

    def between(self, one: OnCurve, other: OnCurve, share: float) -> OnCurve:
        """The point at a fraction of the way between two, without error; raises Unsolvable."""
        start, place = self._mixed((one, other), (1 - share, share), mesh_of(other.orbit))
        across = other.across(other.step_from(one))
        return self._family(other).nearest(start, place, across, other.rates)

    def on_row(self, one: OnCurve, other: OnCurve, place: float) -> OnCurve:
        """The point at a scaled place of the rows' axis between two points, without error; raises
        Unsolvable."""
        share = (place - one.place) / (other.place - one.place) if other.place != one.place else 0.0
        start, _ = self._mixed((one, other), (1 - share, share), mesh_of(other.orbit))
        return self._family(other).nearest(start, place, ALONG_BRANCH, other.rates)

    def _why_lost(self, last: OnCurve) -> CurveEnd:
        """Reason why a curve cannot be followed beyond a point."""
        if self.kind == SpecialKind.torus:
            pair = crossing_pair(BorderedMatrix(last.orbit, last.scale, self.workspace))
            if pair is None or abs(pair.imag) < CYCLE_CURVES.almost_real * abs(pair):
                return CurveEnd.resonance
        return CurveEnd.not_followed
