"""Prediction of cycles of a branch by Hermite polynomials through earlier cycles.

The polynomial through n cycles and their tangents has the degree 2 n - 1. Its variable is the arc length
along the tangent at the last cycle. N is the number of orbit values; tangents and changes have the parameter
coordinate (1/k for a stiffness k) as component N + 1.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.polynomial import Polynomial

from ...arrays import Array
from ..cycle.accuracy.cycle_errors import CycleErrors
from ..cycle.cycles_along_parameter import interpolated_change
from ..orbit.normalised_orbit import extrapolated_change_weights
from ..orbit.orbit import Orbit
from ..orbit.orbit_mesh import mesh_of_orbit
from .bordered.scale import ArcLengthScale


@dataclass(frozen=True, slots=True, kw_only=True)
class BranchPredictionSettings:
    """Settings for the prediction of cycles of a branch."""

    min_cosine_between_tangents: float = 0.2
    """An earlier cycle is used only if the cosine of the angle between its tangent and the tangent at the
    last cycle is at least this number: at a larger angle, the arc length along the last tangent is not a
    suitable variable."""


BRANCH_PREDICTION_SETTINGS = BranchPredictionSettings()


@dataclass(frozen=True, eq=False)
class PreviousCycle:
    """The previous cycle of a branch. tangent: tangent of the branch at `orbit`, of any length, (N + 1,).
    errors: errors of the cycle. previous: the cycle before it, or None."""

    orbit: Orbit
    tangent: Array
    errors: CycleErrors
    previous: "PreviousCycle | None" = None


class HermiteNode(NamedTuple):
    """An earlier cycle on the mesh of the last cycle. arc_length: arc length along the tangent at the last
    cycle, negative behind it. difference_from_last_cycle: orbit values and parameter coordinate minus those
    of the last cycle, (N + 1,). difference_per_arc_length: derivative of orbit values and parameter
    coordinate with respect to `arc_length`, (N + 1,)."""

    arc_length: float
    difference_from_last_cycle: Array
    difference_per_arc_length: Array


def hermite_nodes(
    orbit: Orbit, scale: ArcLengthScale, unit_tangent: Array, previous: PreviousCycle | None
) -> list[HermiteNode]:
    """The last one or two cycles before the cycle `orbit`, the nearest first; empty if no earlier cycle lies
    behind this cycle. previous: the previous cycle of the branch, or None. scale, unit_tangent: scale and
    tangent at `orbit`, the latter in components (deflection, log period, parameter), (3,)."""
    data: list[HermiteNode] = []
    for cycle in (previous, previous and previous.previous):
        if cycle is None:
            break
        datum = _hermite_node(orbit, scale, unit_tangent, cycle)
        # The cycles must lie in order along the tangent; the nearest needs progress only.
        last_position = data[-1].arc_length if data else 0.0
        if datum is None or not datum.arc_length < last_position:
            break
        data.append(datum)
    return data


def _hermite_node(
    orbit: Orbit, scale: ArcLengthScale, unit_tangent: Array, cycle: PreviousCycle
) -> HermiteNode | None:
    """The earlier cycle `cycle` as a datum for predictions from `orbit`; None if the branch has turned too
    far between the two orbits. scale, unit_tangent: as in `hermite_nodes`, the latter (3,)."""
    mesh = mesh_of_orbit(orbit)
    name = scale.parameter_name
    earlier = mesh.interpolated_orbit(cycle.orbit)
    # Values and tangents on one mesh: the polynomial combines them node by node.
    slope = np.append(interpolated_change(cycle.orbit, cycle.tangent[:-1], mesh), cycle.tangent[-1])
    derivative = scale.directional_derivative(earlier, slope)
    rate = float(unit_tangent @ derivative)
    if not rate > BRANCH_PREDICTION_SETTINGS.min_cosine_between_tangents * np.linalg.norm(derivative):
        return None
    position = float(unit_tangent @ (scale.components(earlier) - scale.components(orbit)))
    coordinate_change = earlier.form.rod.coordinate(name) - orbit.form.rod.coordinate(name)
    return HermiteNode(position, np.append(earlier.values - orbit.values, coordinate_change), slope / rate)


def predicted_change(tangent: Array, data: Sequence[HermiteNode], length: float) -> Array:
    """Predicted change, (N + 1,), of orbit values and parameter coordinate over the arc length `length`.
    tangent: tangent with unit arc length at the last cycle, (N + 1,). data: earlier cycles."""
    positions = [0.0, *(datum.arc_length for datum in data for _ in range(2))]
    is_slope = [1.0, *(order for _ in data for order in (0.0, 1.0))]
    weights = extrapolated_change_weights(np.array(positions), np.array(is_slope), length)
    changes = [
        tangent,
        *(
            change
            for datum in data
            for change in (datum.difference_from_last_cycle, datum.difference_per_arc_length)
        ),
    ]
    result: Array = weights @ np.array(changes)
    return result


def parameter_change_polynomial(
    tangent: Array, data: Sequence[HermiteNode], ends: tuple[float, float]
) -> Polynomial:
    """The predicted change of the parameter coordinate as a polynomial of the arc length from the last cycle,
    for arc lengths between the two `ends`. tangent: tangent at the last cycle, (N + 1,), of unit arc length.
    data: earlier cycles."""
    degree = 1 + 2 * len(data)
    lengths = np.linspace(*ends, degree + 1)
    last_components = [
        HermiteNode(
            datum.arc_length, datum.difference_from_last_cycle[-1:], datum.difference_per_arc_length[-1:]
        )
        for datum in data
    ]
    changes = [predicted_change(tangent[-1:], last_components, length)[0] for length in lengths]
    return Polynomial.fit(lengths, changes, degree)
