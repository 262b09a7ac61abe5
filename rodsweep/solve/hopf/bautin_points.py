"""Generalised Hopf (Bautin) points: points of a Hopf curve at which Re c changes its sign, c: Landau
coefficient.

The normal form gives the sign of Re c at every stored point of a Hopf curve. Between two neighbouring points
with opposite signs, D(i eta) = 0 (D: determinant, eta: frequency) and Re c = 0 have a common solution:
Newton's method on D computes the Hopf point at a position between the neighbours; Brent's method finds the
position at which Re c vanishes. Two sign changes between the same neighbours are missed.
"""

import math
from dataclasses import dataclass

import numpy as np

from ...arrays import Array
from ...determinant.parameter_path import ParameterPath
from ...determinant.parameter_plane import ParameterPlane
from ...determinant.stability_boundary import BoundarySolution, StabilityBoundary
from ...solve_progress import SolvePosition, report
from ..changes.arm.path import path_problem
from ..changes.diagram.boundary_curves import BoundaryCurve
from ..changes.threshold_kinds import Threshold, ThresholdKind
from ..point_outcome import FAILURE_EXCEPTIONS
from ..unsolvable import Unsolvable
from .hopf_coefficients import HopfCoefficients, hopf_coefficients


@dataclass(frozen=True, slots=True, kw_only=True)
class BautinPointSettings:
    """Settings for the location of generalised Hopf points on a Hopf curve. c: Landau coefficient."""

    coarsest_accuracy: float = 1e-10
    """Coarsest relative accuracy of c for locating generalised Hopf points; the points are then accurate to
    1e-9."""
    first_sign_accuracy: float = 1e-5
    """Relative accuracy of c at first; if the sign of Re c is undecided, c is recomputed with the requested
    accuracy."""
    brent_tolerance: float = 1e-13
    """Tolerance of Brent's method, as a fraction of the distance between two neighbouring stored points of
    the Hopf curve."""
    difference_step_over_spacing: float = 1e-3
    """Difference step for the derivative of Re c, as a fraction of the distance between two neighbouring
    stored points of the Hopf curve."""
    max_relative_landau_real_part: float = 1e-6
    """A root found by Brent's method is a zero of Re c only if |Re c|/|c| is at most this number; otherwise
    Re c jumps from negative to positive values."""


BAUTIN_POINT_SETTINGS = BautinPointSettings()


@dataclass(frozen=True, slots=True, kw_only=True)
class BautinPoint:
    """Generalised Hopf point: the point of a Hopf curve with Re c = 0.

    parameter_values, parameter_errors: values and absolute errors of both parameters of the plane. frequency
    in 1/tau2, growth_slope = dw/dF in L^2/(k3 tau2), landau_imag = Im c in 1/(tau2 L^2), c: Landau
    coefficient. preceding_index: index of the last stored point of the curve before this point.
    """

    preceding_index: int
    parameter_values: tuple[float, float]
    parameter_errors: tuple[float, float]
    frequency: float
    growth_slope: complex
    landau_imag: float


@dataclass(frozen=True, slots=True)
class CurveCriticality:
    """Signs of Re c along one Hopf curve, c: Landau coefficient, and the generalised Hopf points of this
    curve. criticality: sign of Re c at every stored point, 0 if undecided, NaN if the normal form failed,
    (points,). bautin_points: generalised Hopf points. unlocated_sign_change_count: number of sign changes
    without a located point."""

    criticality: Array
    bautin_points: tuple[BautinPoint, ...]
    unlocated_sign_change_count: int


@dataclass(frozen=True, slots=True)
class _NormalFormOnCurve:
    """A Hopf point in the plane of two parameters, with its normal form coefficients."""

    boundary_point: BoundarySolution
    """Point of the Hopf curve, with its unit tangent."""
    coefficients: HopfCoefficients

    @property
    def relative_landau_real_part(self) -> float:
        """Re c/|c|, a dimensionless function that vanishes where Re c vanishes."""
        return self.coefficients.landau.real / abs(self.coefficients.landau)


def curve_criticality(plane: ParameterPlane, curve: BoundaryCurve, accuracy: float) -> CurveCriticality:
    """The sign of Re c at every stored point of the Hopf curve `curve` in the plane `plane`, 0 if undecided,
    and the generalised Hopf points between points of opposite sign.

    accuracy: relative accuracy of the Landau coefficient c, reduced to
    `BAUTIN_POINT_SETTINGS.coarsest_accuracy` if larger. If the normal form fails at a point, the sign is NaN
    at this point only."""
    hopf_curve = HopfNormalForms(
        StabilityBoundary(plane, curve.double_eigenvalue_sign),
        curve.scaled_points,
        min(accuracy, BAUTIN_POINT_SETTINGS.coarsest_accuracy),
    )
    signs = np.array([hopf_curve.criticality_at(i) for i in range(len(curve.scaled_points))])
    points = []
    unlocated_count = 0
    decided_indices = np.flatnonzero(signs != 0)  # the sign may change within the error of a point
    for first_index, last_index in zip(decided_indices[:-1], decided_indices[1:], strict=True):
        if signs[first_index] * signs[last_index] < 0:
            bautin_point = hopf_curve.bautin_point_between(int(first_index), int(last_index))
            points += [bautin_point] if bautin_point else []
            unlocated_count += bautin_point is None
    return CurveCriticality(signs, tuple(points), unlocated_count)


@dataclass(frozen=True, slots=True)
class HopfNormalForms:
    """Normal forms along a Hopf curve. boundary: equation D = 0 of the curve in the plane of two parameters.
    scaled_points: points (x, y, h) of the curve, (points, 3); x, y: scaled parameters, h = log frequency.
    landau_accuracy: relative accuracy of the Landau coefficient c."""

    boundary: StabilityBoundary
    scaled_points: Array
    landau_accuracy: float

    def criticality_at(self, i: int) -> float:
        """Sign of Re c at the stored point with the index i: -1 or 1; 0 if undecided, NaN after a failure."""
        point_count = len(self.scaled_points)
        report(
            lambda: SolvePosition(
                f"criticality of a Hopf curve, point {i + 1} of {point_count}", i / point_count
            )
        )
        try:
            v = self.scaled_points[i]
            normal = self.boundary.tangent(v)
            hopf_point = self.hopf_point_on_plane(
                v, normal, BAUTIN_POINT_SETTINGS.first_sign_accuracy
            ).coefficients.criticality
            # An accurate c, which costs more, is needed only where the rough sign is undecided.
            return (
                hopf_point
                or self.hopf_point_on_plane(v, normal, self.landau_accuracy).coefficients.criticality
            )
        except FAILURE_EXCEPTIONS:
            return math.nan

    def hopf_point_on_plane(self, guess: Array, normal: Array, accuracy: float) -> _NormalFormOnCurve:
        """The Hopf point at which the Hopf curve crosses the plane through `guess`, (3,), with normal vector
        `normal`, (3,), and its normal form; raises Unsolvable. accuracy: relative accuracy of c."""
        solution = self.boundary.point_near(guess, normal)
        if solution is None:
            raise Unsolvable("Newton's method finds no Hopf point near a known point of the Hopf curve")
        x, y, h = map(float, solution.v)
        rod = self.boundary.plane.rod_at(x, y)
        w = complex(0.0, math.exp(h))
        slope = path_problem(ParameterPath(rod, "F")).eigenvalue_with_slope_and_error(w, rod.F)[1]
        value = self.boundary.plane.determinant(w, x, y)
        # The force is the only parameter of the normal form: convert the point's error into an error of F.
        force_error = solution.error * (abs(value.D_x) + abs(value.D_y)) / abs(slope * value.D_w)
        hopf = Threshold(
            rod.F, ThresholdKind.hopf, w.imag, 0.0, force_error, frequency_error=solution.error * w.imag
        )
        return _NormalFormOnCurve(solution, hopf_coefficients(rod, hopf, accuracy))

    def bautin_point_between(self, first_index: int, last_index: int) -> BautinPoint | None:
        """The generalised Hopf point between the stored points with the indices `first_index` and
        `last_index`, at which Re c has opposite signs. None if a normal form fails, if Brent's method finds
        no zero, or if Re c jumps there."""
        settings = BAUTIN_POINT_SETTINGS
        from scipy.optimize import brentq  # slow import: 0.1 s, for few runs

        start = self.scaled_points[first_index]
        chord = self.scaled_points[last_index] - self.scaled_points[first_index]
        normal = chord / np.linalg.norm(chord)

        def on_chord(s: float) -> _NormalFormOnCurve:
            return self.hopf_point_on_plane(start + s * chord, normal, self.landau_accuracy)

        try:
            s = float(
                brentq(
                    lambda s: on_chord(s).relative_landau_real_part, 0.0, 1.0, xtol=settings.brent_tolerance
                )
            )
            hopf_point, point_before, point_after = (
                on_chord(s + side * settings.difference_step_over_spacing) for side in (0, -1, 1)
            )
        except (*FAILURE_EXCEPTIONS, ValueError):
            return None
        slope = (point_after.relative_landau_real_part - point_before.relative_landau_real_part) / (
            2 * settings.difference_step_over_spacing
        )
        if abs(hopf_point.relative_landau_real_part) > settings.max_relative_landau_real_part or slope == 0:
            return None
        # Points of undecided sign may lie between the two points, on both sides of the zero.
        is_passed = (self.scaled_points[first_index + 1 : last_index] - start) @ chord <= s * (chord @ chord)
        position_error = hopf_point.coefficients.landau_error / abs(slope) + settings.brent_tolerance
        return self.as_bautin_point(hopf_point, first_index + int(is_passed.sum()), chord * position_error)

    def as_bautin_point(
        self, hopf_point: _NormalFormOnCurve, index_before: int, position_error: Array
    ) -> BautinPoint:
        """The generalised Hopf point at `hopf_point`, with errors of both parameters. index_before: index of
        the last stored point before this point. position_error: error vector of the zero along the chord
        between two stored points, in the scaled coordinates of the curve, (3,)."""
        solution = hopf_point.boundary_point
        axes = self.boundary.plane.axes
        tangent = solution.tangent
        # The error along the curve is the error along the chord over the cosine of their angle.
        tangent_error = tangent * float(np.linalg.norm(position_error) ** 2 / (tangent @ position_error))
        values = [axis.value(float(x)) for axis, x in zip(axes, solution.v[:2], strict=True)]
        errors = [
            abs(axis.parameter_per_scaled_coordinate(value)) * (abs(float(coordinate_error)) + solution.error)
            for axis, value, coordinate_error in zip(axes, values, tangent_error[:2], strict=True)
        ]
        return BautinPoint(
            preceding_index=index_before,
            parameter_values=(values[0], values[1]),
            parameter_errors=(errors[0], errors[1]),
            frequency=math.exp(float(solution.v[2])),
            growth_slope=hopf_point.coefficients.growth_slope,
            landau_imag=hopf_point.coefficients.landau.imag,
        )
