"""Stored form of a curve of folds or torus points: points, reasons for the two ends, and Hopf points where
the cycles vanish."""

from collections.abc import Sequence
from dataclasses import astuple, dataclass, field, replace
from enum import IntEnum

import numpy as np

from ....arrays import Array
from ....determinant.parameter_plane import ParameterPlane
from ...hopf.bautin_points import BautinPoint
from ...orbit.normalised_orbit import extrapolated_change_weights
from .row_crossing import RowCrossing, crossings_from_arrays, numbered_arrays
from .solved_curve_point import SolvedCurvePoint
from .special_point import SpecialPointKind


@dataclass(frozen=True, slots=True, kw_only=True)
class CurveIdentitySettings:
    """Settings of two tests: whether a special point lies on a curve, and whether two curves are
    identical."""

    max_distance_from_curve_per_row_length: float = 1e-6
    """A special point lies on a curve if its distance from the curve, along its row of the plane, is at most
    this fraction of the length of a row."""
    max_chord_distance_per_row_length: float = 0.1
    """A special point can lie on the arc between two points of a curve only if its distance from their
    interval, along its row of the plane, is at most this fraction of the length of a row."""
    period_interval_extension: float = 0.1
    """A special point can lie on the arc between two points of a curve only if its period is within the
    interval of the two points' periods, extended by this fraction."""
    max_relative_period_difference: float = 1e-4
    """Largest relative difference between the periods of two solutions for the same cycle."""
    max_end_distance: float = 1e-4
    """Two curves are identical if the coordinates of their ends differ by at most this number; each axis has
    length 1."""
    max_last_chord_distance_per_row_length: float = 1e-3
    """Between the last cycle of a curve and the Hopf point where the cycles vanish, a special point lies on
    the curve if its distance from the chord, along its row of the plane, is at most this fraction of the
    length of a row."""
    max_extrapolation_points: int = 4
    """Maximum number of points of the interpolating polynomial that predicts the next point, or the Hopf
    point where the cycles vanish."""
    extrapolation_safety_factor: float = 10.0
    """Safety factor on the error of an extrapolated Hopf point. The errors of the points do not include the
    displacement of the Hopf point along the curve that is caused by the mesh."""
    max_hopf_to_generalised_hopf_distance: float = 0.01
    """An extrapolated Hopf point is identical to a generalised Hopf point of a Hopf curve if their two
    coordinates differ by at most this number; each axis has length 1."""


CURVE_IDENTITY_SETTINGS = CurveIdentitySettings()


HalfCurveArrays = dict[str, Array]
"""Stored result of following a half curve: arrays by name."""


class CurveEndReason(IntEnum):
    """Reason for the end of a curve of special points, stored by value in the result file.

    none: the point is not an end. edge: edge of the parameter plane. crushed: F is near the crushing force.
    hopf: the cycles vanish at a Hopf point. left_the_model: h1 = 0. resonance: the complex pair of
    multipliers becomes real. closed: first point of a closed curve. not_followed: no further point was found.
    """

    none = 0
    edge = 1
    crushed = 2
    hopf = 3
    left_the_model = 4
    resonance = 5
    closed = 6
    not_followed = 7


@dataclass(frozen=True, slots=True)
class HopfEnd:
    """A Hopf point at which a curve of special points ends because the cycles vanish.

    parameter_value: value of the branch parameter, which varies along a row of the plane, with the absolute
    error `error`. row_parameter_value: value of the second parameter, fixed on a row. period: period of the
    vanishing cycles, in tau2. tip_y_max: their largest tip y, 0.
    """

    parameter_value: float
    row_parameter_value: float
    error: float  # named as its variable in files, without the prefix
    period: float
    tip_y_max: float = 0.0


@dataclass(frozen=True, slots=True)
class CurvePoint:
    """Stored quantities of a point of a curve of special points.

    parameter_value: value of the branch parameter, which varies along a row of the plane, with the absolute
    error `error`. row_parameter_value: value of the second parameter, fixed on a row. row_coordinate:
    position of `row_parameter_value` on its axis, from 0 to 1. period: in tau2. tip_y_max: largest tip y, in
    L. row_parameter_error_at_extremum: absolute error of `row_parameter_value` where it is extremal along the
    curve, NaN at the point after an extremum that could not be located, 0 elsewhere.
    """

    parameter_value: float
    row_parameter_value: float
    row_coordinate: float
    error: float  # named as its variable in files, without the prefix
    period: float
    tip_y_max: float
    row_parameter_error_at_extremum: float = 0.0

    @classmethod
    def from_solved_point(cls, point: SolvedCurvePoint) -> "CurvePoint":
        """The stored quantities of a solved point of a curve."""
        return cls(
            parameter_value=point.branch_parameter_value,
            row_parameter_value=point.row_parameter_value,
            row_coordinate=point.row_coordinate,
            error=point.branch_parameter_error,
            period=point.orbit.period,
            tip_y_max=point.tip_y_max,
            row_parameter_error_at_extremum=point.row_parameter_error_at_extremum,
        )


@dataclass(frozen=True, slots=True)
class HalfCurve:
    """One half of a curve of special points: points in order from a special point of a branch to an end of
    the curve."""

    points: tuple[CurvePoint, ...]
    end_reason: CurveEndReason


@dataclass(frozen=True, slots=True)
class TracedHalfCurve:
    """Result of following one half of a curve of special points. half_curve: None if the half could not be
    followed. distances_along_row: distances of nearby special points from this half along their rows, in
    units of the length of a row, by the index of the special point in the list of all special points.
    crossings: points at which this half crosses a row whose branches have no special point there."""

    half_curve: HalfCurve | None
    distances_along_row: dict[int, float] = field(default_factory=dict)
    crossings: tuple[RowCrossing, ...] = ()

    def arrays(self) -> HalfCurveArrays:
        """The result as named arrays: points (points, 7), the fields of `CurvePoint`; end (1,), the value of
        the `CurveEndReason`, 0 if `half_curve` is None; distances (near, 2), index and distance of each
        nearby special point; and the arrays of `numbered_arrays` for the crossings."""
        points = [] if self.half_curve is None else list(map(astuple, self.half_curve.points))
        return {
            # A half without points still has columns, so that all results can be read alike.
            "points": np.array(points, dtype=float).reshape(-1, len(CurvePoint.__slots__)),
            "end": np.array([0.0 if self.half_curve is None else float(self.half_curve.end_reason)]),
            "distances": np.array(list(self.distances_along_row.items()), dtype=float).reshape(-1, 2),
        } | numbered_arrays(self.crossings)

    @classmethod
    def from_arrays(cls, arrays: HalfCurveArrays) -> "TracedHalfCurve":
        """The result from the named arrays that `arrays` returns."""
        points = tuple(CurvePoint(*map(float, row)) for row in arrays["points"])
        half = HalfCurve(points, CurveEndReason(int(arrays["end"][0]))) if points else None
        distances = {int(index): float(distance) for index, distance in arrays["distances"]}
        return cls(half, distances, crossings_from_arrays(arrays))


@dataclass(frozen=True, slots=True)
class SpecialPointCurve:
    """A complete curve of folds or torus points: points in order, and the reasons for the two ends.
    hopf_ends: for each end the Hopf point at which the cycles vanish; None for an end with another
    reason, or on a curve with too few points for the extrapolation."""

    kind: SpecialPointKind
    """Kind of all points of the curve: fold or torus point."""
    points: tuple[CurvePoint, ...]
    end_reasons: tuple[CurveEndReason, CurveEndReason]
    hopf_ends: tuple[HopfEnd | None, HopfEnd | None]

    @classmethod
    def joined(
        cls, kind: SpecialPointKind, forward: HalfCurve, backward: HalfCurve | None
    ) -> "SpecialPointCurve":
        """The curve joined from the halves `forward` and `backward`, which start at the same point; backward:
        None for a closed curve."""
        # A closed curve has one half only, and its second end has the same reason.
        first_half = backward or HalfCurve(forward.points[:1], forward.end_reason)
        # The first point belongs to both halves, so the slice leaves it out of one.
        points = (*first_half.points[:0:-1], *forward.points)
        hopf_ends = [
            extrapolated_hopf_end(side) if end is CurveEndReason.hopf else None
            # Extrapolation takes its last points, so the first end needs the curve in reverse.
            for end, side in ((first_half.end_reason, points[::-1]), (forward.end_reason, points))
        ]
        return cls(kind, points, (first_half.end_reason, forward.end_reason), (hopf_ends[0], hopf_ends[1]))


def with_bautin_ends(
    curve: SpecialPointCurve, plane: ParameterPlane, known_points: Sequence[BautinPoint]
) -> SpecialPointCurve:
    """The curve `curve` of folds, in which each extrapolated end is replaced by the identical generalised
    Hopf point in `known_points`, which is more accurate than the extrapolation. A curve of torus points, and
    an end without an identical point, are unchanged."""
    max_distance = CURVE_IDENTITY_SETTINGS.max_hopf_to_generalised_hopf_distance

    def at_generalised_hopf(end: HopfEnd | None) -> HopfEnd | None:
        if end is None or curve.kind != SpecialPointKind.fold:
            return end
        values = end.parameter_value, end.row_parameter_value
        for point in known_points:
            pairs = zip(plane.axes, point.parameter_values, values, strict=True)
            distances = [abs(axis.scaled_coordinate(a) - axis.scaled_coordinate(b)) for axis, a, b in pairs]
            if all(distance <= max_distance for distance in distances):
                period = 2 * np.pi / point.frequency
                return HopfEnd(*point.parameter_values, point.parameter_errors[0], period)
        return end

    first, last = map(at_generalised_hopf, curve.hopf_ends)
    return replace(curve, hopf_ends=(first, last))


def lagrange_weights(abscissas: Array, abscissa: float) -> Array:
    """Lagrange weights, (n,): the weighted sum of n values at the abscissas `abscissas`, (n,), is the
    value of their interpolating polynomial at the abscissa `abscissa`."""
    if len(abscissas) == 1:
        return np.ones(1)
    # Relative to the last abscissa, whose weight follows as all weights sum to 1.
    differences = abscissas[:-1] - abscissas[-1]
    weights = extrapolated_change_weights(differences, np.zeros(len(differences)), abscissa - abscissas[-1])
    return np.append(weights, 1 - weights.sum())


def extrapolated_hopf_end(points: Sequence[CurvePoint]) -> HopfEnd | None:
    """The Hopf point where the cycles vanish beyond the last of `points`, extrapolated by polynomials in the
    squared amplitude; None if there is only one point."""
    last_points = points[-CURVE_IDENTITY_SETTINGS.max_extrapolation_points :]
    if len(last_points) == 1:
        return None
    # Parameters and period are even in the amplitude, so polynomials in its square converge.
    squared_amplitudes = np.array([point.tip_y_max**2 for point in last_points])
    quantities = np.array([[p.parameter_value, p.row_parameter_value, p.period] for p in last_points])
    # The error estimate is the difference between the polynomials with and without the first point.
    values, values_of_lower_order = (
        np.dot(lagrange_weights(squared_amplitudes[i:], 0.0), quantities[i:]) for i in (0, 1)
    )
    # Both polynomials share the errors of the points, which their difference would not show.
    difference = abs(values[0] - values_of_lower_order[0])
    difference += max(point.error for point in last_points)
    error = CURVE_IDENTITY_SETTINGS.extrapolation_safety_factor * difference
    return HopfEnd(float(values[0]), float(values[1]), float(error), float(values[2]))
