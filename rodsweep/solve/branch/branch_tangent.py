"""Oriented tangent of a branch at a solved cycle, and its scale."""

import numpy as np

from ...arrays import Array
from ..orbit.newton import ConvergedOrbit
from ..orbit.orbit import Orbit
from .bordered.corrected_linearisation import CorrectedLinearisation
from .bordered.matrix import BorderedMatrix
from .bordered.scale import ArcLengthScale
from .branch_errors import BranchDerivatives


def branch_derivatives(solved: ConvergedOrbit, scale: ArcLengthScale, tangent: Array) -> BranchDerivatives:
    """Scale and unit tangent of a branch at the cycle `solved`. scale: scale at another cycle of the branch.
    tangent: tangent of any length, (N + 1,). In the result `parameter_second_derivative` and
    `multiplier_rate` are 0, to be set by the caller."""
    own_scale = ArcLengthScale.at_orbit(
        solved.orbit, scale.parameter_name, scale.min_deflection_unit, scale.min_coordinate_unit
    )
    derivative = own_scale.directional_derivative(solved.orbit, tangent)
    unit = float(np.linalg.norm(derivative))
    return BranchDerivatives(own_scale, tangent / unit, derivative / unit, 0.0, 0.0)


def tangent_at(
    orbit: Orbit, scale: ArcLengthScale, side: Array, matrix: BorderedMatrix | CorrectedLinearisation
) -> Array:
    """Tangent of the branch at an orbit, (N + 1,), from the orbit's bordered matrix. scale: units of the
    components. side: direction in components (deflection, log period, parameter), (3,); the tangent makes an
    acute angle with `side`."""
    tangent = matrix.branch_tangent(side)
    # A null vector has no sign; the branch must not turn back.
    return tangent if scale.directional_derivative(orbit, tangent) @ side > 0 else -tangent
