"""Elimination of the minors theta^m and y^m from the collocation equations of an element. STAGES: number of
Gauss points of an element."""

import numpy as np

from ....arrays import Array
from ....model.compiled.compilation import compiled, compiled_for_vectors
from .settings import ARM_ELEMENT_SETTINGS


@compiled
def elimination_matrix(F: float, c3: Array, g: Array, Q: Array) -> Array:
    """The matrix [M 1, M Q], (STAGES, 1 + STAGES), where M is the inverse of the matrix 1 + F Q c3 Q g.

    M eliminates theta^m and y^m: M Q integrates the rates of theta^s and y^theta; M 1 is the contribution of
    a start value of 1. Q: matrix of integrals from 0 to each Gauss point, (STAGES, STAGES). c3, g:
    coefficients at the Gauss points times the length of the element, (STAGES,).
    """
    stages = ARM_ELEMENT_SETTINGS.stages
    # The matrix, the right-hand sides 1 and Q, and columns of zeros: rows are whole vector instructions.
    system = np.zeros((stages, 2 * stages + ARM_ELEMENT_SETTINGS.lane_count))
    row = np.empty(system.shape[1])
    row[:stages] = g
    _add_twice_integrated(F, c3, row, Q, system)
    for i in range(stages):
        system[i, i] += 1.0
        system[i, stages] = 1.0
        system[i, stages + 1 : 2 * stages + 1] = Q[i]
    _solve_linear_system(system, row)
    return system[:, stages : 2 * stages + 1]


@compiled_for_vectors
def _add_twice_integrated(F: float, c3: Array, g: Array, Q: Array, system: Array) -> None:
    """Adds F Q c3 Q g to the leading (STAGES, STAGES) part of `system`, (STAGES, columns). c3, Q: as in
    `elimination_matrix`. g: (STAGES or more,), of which the first STAGES entries are used."""
    stages = Q.shape[0]  # no constant: the compiler would unroll the inner loop instead of vectorizing it
    for i in range(stages):
        for k in range(stages):
            factor = F * Q[i, k] * c3[k]
            for j in range(stages):
                system[i, j] += factor * Q[k, j] * g[j]


@compiled_for_vectors
def _solve_linear_system(system: Array, row_copy: Array) -> None:
    """Solves A x = right in place for a system (A, right), (STAGES, columns), by elimination with pivoting.
    row_copy: (columns,), overwritten."""
    columns = system.shape[1]
    for column in range(ARM_ELEMENT_SETTINGS.stages):
        pivot_row = column
        for i in range(column + 1, ARM_ELEMENT_SETTINGS.stages):
            if abs(system[i, column]) > abs(system[pivot_row, column]):
                pivot_row = i
        scale = 1 / system[pivot_row, column]
        for j in range(columns):
            row_copy[j] = system[pivot_row, j] * scale
            system[pivot_row, j] = system[column, j]
        # All other rows are reduced at once (Gauss-Jordan), without the short loops of a back substitution.
        for i in range(ARM_ELEMENT_SETTINGS.stages):
            factor = system[i, column]
            for j in range(columns):
                system[i, j] -= factor * row_copy[j]
        for j in range(columns):
            system[column, j] = row_copy[j]
