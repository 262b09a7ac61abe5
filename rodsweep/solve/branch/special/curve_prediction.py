"""Prediction of points of a curve of folds or torus points, by polynomials through earlier points at which
the same parameter is the branch parameter (`ParameterRoles`)."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ....arrays import Array
from ...orbit.orbit import Orbit
from ...orbit.orbit_mesh import OrbitMesh, mesh_of_orbit
from ...unsolvable import Unsolvable
from ..bordered.border_condition import require_equal_unknowns
from .curve_ends import SPECIAL_CURVE_END_SETTINGS
from .parameter_roles import ParameterRoles
from .solved_curve_point import SolvedCurvePoint, arc_lengths_from_last_point
from .special_curves import CURVE_IDENTITY_SETTINGS, lagrange_weights


def predicted_orbit_and_row_coordinate(
    roles: ParameterRoles, points: Sequence[SolvedCurvePoint], length: float
) -> tuple[Orbit, float]:
    """Returns (orbit, row coordinate), predicted at the arc length `length` beyond the last of `points`, or
    at a shorter arc length, before the rod is crushed; raises Unsolvable. The row coordinate is the scaled
    value, 0 to 1, of the parameter that is not the branch parameter. roles: says which parameter this is."""
    last_points = points[-CURVE_IDENTITY_SETTINGS.max_extrapolation_points :]
    lengths = arc_lengths_from_last_point(last_points)
    weights = lagrange_weights(lengths, _length_before_crushing(roles, last_points, lengths, length))
    return weighted_sum_of_curve_points(roles, last_points, weights, mesh_of_orbit(last_points[-1].orbit))


def weighted_sum_of_curve_points(
    roles: ParameterRoles,
    points: Sequence[SolvedCurvePoint],
    weights: Sequence[float] | Array,
    mesh: OrbitMesh,
) -> tuple[Orbit, float]:
    """Returns (orbit on `mesh`, row coordinate): sums over `points` with the weights `weights`, (points,);
    raises Unsolvable. roles: says which of the two parameters the row coordinate is."""
    values = np.dot(weights, [mesh.interpolated_orbit(point.orbit).values for point in points])
    row, parameters = _weighted_parameters(roles, points, weights)
    orbit = replace(mesh.interpolated_orbit(points[-1].orbit), values=values)
    return orbit_with_parameters(orbit, parameters), row


def _length_before_crushing(
    roles: ParameterRoles, points: Sequence[SolvedCurvePoint], lengths: Array, length: float
) -> float:
    """The arc length `length`, shortened so that the rod predicted beyond `points` keeps half of the distance
    `crushing_margin` from the crushing force; unchanged if the last point is nearer than this. lengths: arc
    lengths of the points, (points,). roles: branch parameter and row parameter at the points."""
    from scipy.optimize import brentq  # slow import: 0.1 s, for few runs

    def distance(length: float) -> float:
        rod = points[-1].orbit.form.rod
        _, parameters = _weighted_parameters(roles, points, lagrange_weights(lengths, length))
        values = {**rod.values, **parameters}
        load = rod.material.force_over_crushing_force(values["F"], values["k1"], values["taper"])
        return 1 - SPECIAL_CURVE_END_SETTINGS.crushing_margin / 2 - load

    # Both ends on one side of the limit: there is no root between them for brentq.
    if distance(length) >= 0 or distance(0.0) <= 0:
        return length
    return float(
        brentq(distance, 0.0, length, rtol=SPECIAL_CURVE_END_SETTINGS.step_tolerance_before_crushing)
    )


def orbit_with_parameters(orbit: Orbit, parameters: dict[str, float]) -> Orbit:
    """The orbit with unchanged values, for a rod with changed parameters; raises Unsolvable if the new
    parameters are not allowed or change the unknowns of a state. parameters: new parameter values by name."""
    try:
        form = replace(orbit.form, rod=orbit.form.rod.with_values(**parameters))
    except (ValueError, ZeroDivisionError) as error:
        raise Unsolvable(f"the curve leaves the allowed range of the parameters: {error}") from error
    require_equal_unknowns(form, orbit)
    return replace(orbit, form=form)


def _weighted_parameters(
    roles: ParameterRoles, points: Sequence[SolvedCurvePoint], weights: Sequence[float] | Array
) -> tuple[float, dict[str, float]]:
    """Returns (row coordinate, values of both parameters by name): sums over `points` with the weights
    `weights`, (points,). roles: says which of the two parameters the row coordinate is."""
    branch_axis, row_axis = roles.axes_of(points[-1])
    row = float(np.dot(weights, [point.row_coordinate for point in points]))
    value = float(np.dot(weights, [point.branch_parameter_value for point in points]))
    return row, {branch_axis.parameter_name: value, row_axis.parameter_name: row_axis.value(row)}
