"""Elimination of the minors theta^m and y^m from the collocation equations of an element."""

import numpy as np

from ....arrays import Array
from ....model.compiled.compilation import compiled, compiled_for_vectors
from .settings import ARM_ELEMENTS


@compiled
def elimination_matrix(F: float, c3: Array, g: Array, Q: Array) -> Array:
    """M 1 and M Q, in the columns of (STAGES, 1 + STAGES), with the inverse M of 1 + F Q c3 Q g.

    M eliminates theta^m and y^m: M Q integrates the rates of theta^s and y^theta, and M 1 belongs to a start
    value of 1. Q: integrals, (STAGES, STAGES). c3, g: coefficients times the length of the element,
    (STAGES,).
    """
    system = np.zeros((ARM_ELEMENTS.stages, ARM_ELEMENTS.stages))
    right = np.ones((ARM_ELEMENTS.stages, 1 + ARM_ELEMENTS.stages))
    right[:, 1:] = Q
    _add_twice_integrated(F, c3, g, Q, system)
    _solve(system, right)
    return right


@compiled_for_vectors
def _add_twice_integrated(F: float, c3: Array, g: Array, Q: Array, system: Array) -> None:
    """Adds 1 + F Q c3 Q g to a matrix, (STAGES, STAGES)."""
    for i in range(ARM_ELEMENTS.stages):
        system[i, i] += 1.0
        for k in range(ARM_ELEMENTS.stages):
            factor = F * Q[i, k] * c3[k]
            for j in range(ARM_ELEMENTS.stages):
                system[i, j] += factor * Q[k, j] * g[j]


@compiled_for_vectors
def _solve(A: Array, right: Array) -> None:
    """Solves A x = right, (STAGES, columns), in place, by elimination with pivoting, which destroys A."""
    columns = right.shape[1]
    for column in range(ARM_ELEMENTS.stages):
        pivot = column
        for i in range(column + 1, ARM_ELEMENTS.stages):
            if abs(A[i, column]) > abs(A[pivot, column]):
                pivot = i
        if pivot != column:
            for j in range(ARM_ELEMENTS.stages):
                A[column, j], A[pivot, j] = A[pivot, j], A[column, j]
            for j in range(columns):
                right[column, j], right[pivot, j] = right[pivot, j], right[column, j]
        scale = 1 / A[column, column]
        for j in range(ARM_ELEMENTS.stages):
            A[column, j] *= scale
        for j in range(columns):
            right[column, j] *= scale
        for i in range(ARM_ELEMENTS.stages):
            if i != column:
                factor = A[i, column]
                for j in range(ARM_ELEMENTS.stages):
                    A[i, j] -= factor * A[column, j]
                for j in range(columns):
                    right[i, j] -= factor * right[column, j]
