"""Tangent of a branch at a cycle near the orbit at which a bordered matrix was assembled. Shapes: as in
`matrix`."""

from dataclasses import replace

import numpy as np

from ....arrays import Array
from ...orbit.matrix.linearisation import closing_residual
from ...orbit.matrix.phase_condition import phase_right_side, write_phase_row
from ...orbit.orbit import Orbit
from .matrix import BorderedMatrix


def corrected_tangent(
    matrix: BorderedMatrix, orbit: Orbit, border: Array, tangent: Array, residuals: tuple[Array, Array]
) -> Array:
    """The approximate tangent `tangent` of the branch at `orbit` after one step of iterative refinement of
    its linear equation with the factors of `matrix`; shape (N + 1,). The arc length of the tangent along
    `border`, in components (deflection, log period, parameter), (3,), becomes 1. tangent: approximate
    tangent, (N + 1,). residuals: stages, (K, s, 1, n), and ends, (1, n), of
    `BorderedMatrix.residual_variations` for `tangent`.
    """
    p = orbit.orbit_equations
    columns, ends = residuals
    change = replace(orbit, values=tangent[:-1])
    row = np.empty(len(orbit.start_state))
    write_phase_row(orbit.start_state, p.rod, p.node_matrices, row)
    parameter_derivative = orbit.form.nodal_rod_parameter_derivative(matrix.scale.parameter_name)
    phase_derivative = phase_right_side(orbit.start_state, parameter_derivative, p.rod, p.node_matrices)
    matching_sides = matrix.matching_right_sides(closing_residual(change.all_states, p), columns, ends)
    phase_side = phase_derivative * tangent[-1] - row @ change.start_state
    border_side = 1 - border @ matrix.scale.directional_derivative(orbit, tangent)
    right_side = np.array([*matching_sides, phase_side, border_side])
    return tangent + matrix.solve(border, right_side, columns[:, :, 0], 1.0)
