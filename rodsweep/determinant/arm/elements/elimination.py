"""Elimination of the minors theta^m and y^m from the collocation equations of an element. STAGES: number of
Gauss points of an element. LANES: number of elements of a batch. WIDTH: number of pairs (initial value,
element)."""

import numpy as np

from ....arrays import Array
from ....model.compiled.compilation import compiled, compiled_with_reordered_sums
from .settings import ARM_ELEMENT_SETTINGS, MINOR_COUNT


@compiled
def fill_elimination_matrices(F: float, c3: Array, g: Array, Q: Array, eliminations: Array) -> None:
    """Writes the matrix [M 1, M Q] of each element of a batch (lane) into `eliminations`, (STAGES, 1 +
    STAGES, WIDTH). It is repeated for each initial value. M is the inverse of the matrix 1 + F Q c3 Q g.

    M eliminates theta^m and y^m: M Q integrates the rates of theta^s and y^theta; M 1, with the vector of
    ones 1, is the contribution of an initial value of 1. Q: matrix of integrals from 0 to each Gauss point,
    (STAGES, STAGES). c3, g: coefficients at the Gauss points times the length of the element, (STAGES,
    LANES).
    """
    stages = ARM_ELEMENT_SETTINGS.stage_count
    integrands = np.empty((stages, ARM_ELEMENT_SETTINGS.lane_count * stages))
    integrals = np.empty((stages, ARM_ELEMENT_SETTINGS.lane_count * stages))
    _fill_load_integrands(F, c3, g, Q, integrands)
    _integrate_columns(Q, integrands, integrals)
    # The matrix, the right-hand sides 1 and Q, and columns of zeros: rows are whole vector instructions.
    system = np.zeros((stages, 2 * stages + ARM_ELEMENT_SETTINGS.lane_count))
    row = np.empty(system.shape[1])
    for lane in range(ARM_ELEMENT_SETTINGS.lane_count):
        _fill_linear_system(integrals, lane, Q, system)
        _solve_linear_system(system, row)
        _copy_solution_to_lane(system, lane, eliminations)


@compiled_with_reordered_sums
def _fill_load_integrands(F: float, c3: Array, g: Array, Q: Array, integrands: Array) -> None:
    """Writes the matrix F c3 Q g, (STAGES, STAGES), of each element of a batch (lane) into `integrands`,
    (STAGES, LANES * STAGES), one element's columns after the other. Other arguments: as in
    `fill_elimination_matrices`."""
    for k in range(ARM_ELEMENT_SETTINGS.stage_count):
        for lane in range(ARM_ELEMENT_SETTINGS.lane_count):
            for j in range(ARM_ELEMENT_SETTINGS.stage_count):
                column = lane * ARM_ELEMENT_SETTINGS.stage_count + j
                integrands[k, column] = F * c3[k, lane] * Q[k, j] * g[j, lane]


@compiled_with_reordered_sums
def _integrate_columns(Q: Array, integrands: Array, integrals: Array) -> None:
    """integrals = Q integrands, both (STAGES, LANES * STAGES); Q: (STAGES, STAGES)."""
    for i in range(ARM_ELEMENT_SETTINGS.stage_count):
        for column in range(ARM_ELEMENT_SETTINGS.lane_count * ARM_ELEMENT_SETTINGS.stage_count):
            total = 0.0
            for k in range(ARM_ELEMENT_SETTINGS.stage_count):
                total += Q[i, k] * integrands[k, column]
            integrals[i, column] = total


@compiled_with_reordered_sums
def _fill_linear_system(integrals: Array, lane: int, Q: Array, system: Array) -> None:
    """Writes the linear system (1 + F Q c3 Q g) X = [1, Q] of the element `lane` of a batch into `system`,
    (STAGES, columns): matrix, then right-hand sides; the 1 in the latter is a vector of ones. integrals: F Q
    c3 Q g of each element, (STAGES, LANES * STAGES). Q: (STAGES, STAGES)."""
    for i in range(ARM_ELEMENT_SETTINGS.stage_count):
        for j in range(ARM_ELEMENT_SETTINGS.stage_count):
            system[i, j] = integrals[i, lane * ARM_ELEMENT_SETTINGS.stage_count + j]
            system[i, ARM_ELEMENT_SETTINGS.stage_count + 1 + j] = Q[i, j]
        system[i, i] += 1.0
        system[i, ARM_ELEMENT_SETTINGS.stage_count] = 1.0


@compiled_with_reordered_sums
def _copy_solution_to_lane(system: Array, lane: int, eliminations: Array) -> None:
    """Copies the solutions in `system`, (STAGES, columns), into the columns of lane number `lane` of
    `eliminations`, (STAGES, 1 + STAGES, WIDTH)."""
    for i in range(ARM_ELEMENT_SETTINGS.stage_count):
        for j in range(1 + ARM_ELEMENT_SETTINGS.stage_count):
            for k in range(MINOR_COUNT):
                column = k * ARM_ELEMENT_SETTINGS.lane_count + lane
                eliminations[i, j, column] = system[i, ARM_ELEMENT_SETTINGS.stage_count + j]


@compiled_with_reordered_sums
def _solve_linear_system(system: Array, row_copy: Array) -> None:
    """Solves A x = right in place for a system (A, right), (STAGES, columns), by elimination with pivoting.
    row_copy: (columns,), overwritten."""
    columns = system.shape[1]
    for column in range(ARM_ELEMENT_SETTINGS.stage_count):
        pivot_row = column
        for i in range(column + 1, ARM_ELEMENT_SETTINGS.stage_count):
            if abs(system[i, column]) > abs(system[pivot_row, column]):
                pivot_row = i
        scale = 1 / system[pivot_row, column]
        for j in range(columns):
            row_copy[j] = system[pivot_row, j] * scale
            system[pivot_row, j] = system[column, j]
        # All other rows are reduced at once (Gauss-Jordan), without the short loops of a back substitution.
        for i in range(ARM_ELEMENT_SETTINGS.stage_count):
            factor = system[i, column]
            for j in range(columns):
                system[i, j] -= factor * row_copy[j]
        for j in range(columns):
            system[column, j] = row_copy[j]
