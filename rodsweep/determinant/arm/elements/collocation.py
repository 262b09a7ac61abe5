"""The transverse problem of arms in minors of two solutions, and its collocation over elements.

With the state (y, theta, s, m) the eigenproblem of an arm whose coefficients vary with u reads

    y' = nu theta + c2 s,   theta' = c3 m,   s' = w gamma2 y + F c3 m,   m' = w gamma3 theta - g s.

D is the minor of the rows s and m of the two solutions that start with s = 1 or m = 1 at the clamp. Let y^s
be the minor (2 x 2 determinant) of the rows y and s of both solutions, and so on. y^s + theta^m - F y^theta
is constant along the arm, and 0 for these two solutions. The five minors other than y^s then satisfy a closed
linear system,

    (s^m)'     = w (gamma2 y^m - gamma3 theta^s)
    (theta^s)' = F c3 theta^m - c3 s^m - w gamma2 y^theta
    (theta^m)' = -g theta^s
    (y^theta)' = c3 y^m - c2 theta^s
    (y^m)'     = (g + nu) theta^m + c2 s^m + (w gamma3 - F g) y^theta

from s^m = 1 at the clamp, all other minors 0, to D = s^m at the tip. Integrating the two solutions themselves
would lose the second solution in the rounding errors of the growing exponential; the minors do not.

Elements are solved by collocation at their Gauss points, for one power of w after another: the terms of the
propagator satisfy C_n' = A_0 C_n + A_1 C_(n-1). `ARM_ELEMENT_SETTINGS.lane_count` elements are solved
together. The last axis of arrays, WIDTH, combines the initial value, one of `MINORS`, and the element; loops
over it are vector instructions. STAGES, LANES, MAX_TERMS: settings `stages`, `lane_count`, `max_terms`."""

from typing import NamedTuple

import numpy as np

from ....arrays import Array
from ....model.compiled.compilation import compiled, compiled_for_vectors
from .different_elements import numbers_of_different_elements
from .elimination import elimination_matrix
from .minor_rates import (
    C3,
    PADDED,
    SM,
    TM,
    TS,
    YM,
    YT,
    G,
    add_eliminated_start_value,
    add_rates_by_theta_m,
    add_rates_by_y_theta,
    add_start_value,
    add_theta_s_rates,
    fill_drag_rates,
    fill_theta_m_rates,
    fill_y_theta_rates,
)
from .settings import ARM_ELEMENT_SETTINGS, MINORS


class IntegrationMatrices(NamedTuple):
    """Matrix of integrals from 0 to each Gauss point on [0, 1], (STAGES, STAGES), and weights, (STAGES,)."""

    integrals: Array
    weights: Array


@compiled
def propagator_terms(F: Array, W: float, local: Array, lengths: Array, method: IntegrationMatrices) -> Array:
    """Coefficients of the propagators in powers of w/W, (n, elements, terms, PADDED); the array is empty,
    terms = 0, if MAX_TERMS powers do not suffice. F: forces, (n,). W: bound of |w|. local:
    `LocalCoefficients`, (6, n, elements, STAGES). lengths: lengths of the elements, in L, (elements,)."""
    n, elements = local.shape[1:3]
    numbers = numbers_of_different_elements(local, lengths)
    different = numbers[-1] + 1
    batches = -(-different // ARM_ELEMENT_SETTINGS.lane_count)
    coefficients = np.empty((n, batches, 6, ARM_ELEMENT_SETTINGS.stages, ARM_ELEMENT_SETTINGS.lane_count))
    for b in range(batches):
        for lane in range(ARM_ELEMENT_SETTINGS.lane_count):
            # The last batch is filled up with the last element.
            number = min(b * ARM_ELEMENT_SETTINGS.lane_count + lane, different - 1)
            equal_elements = np.flatnonzero(numbers == number)
            # The lengths of equal elements differ by rounding; their mean keeps the sum of all lengths.
            length = lengths[equal_elements].mean()
            for arm in range(n):
                coefficients[arm, b, :, :, lane] = local[:, arm, equal_elements[0]] * length
    terms = np.zeros((n, batches * ARM_ELEMENT_SETTINGS.lane_count, ARM_ELEMENT_SETTINGS.max_terms, PADDED))
    term_count = fill_propagator_terms(F, W, coefficients, method, terms)
    if term_count > ARM_ELEMENT_SETTINGS.max_terms:
        return terms[:, :, :0].copy()
    return terms[:, numbers, :term_count]


@compiled
def fill_propagator_terms(
    F: Array, W: float, coefficients: Array, method: IntegrationMatrices, terms: Array
) -> int:
    """Fills `terms`, the coefficients of propagators; returns the number of terms needed, or MAX_TERMS + 1 if
    MAX_TERMS do not suffice.

    F: forces of n arms, (n,). coefficients: `LocalCoefficients` times the lengths of the elements, (n,
    batches, 6, STAGES, LANES). terms: coefficients of the powers of w/W, (n, batches * LANES, MAX_TERMS,
    PADDED), all 0 at first.
    """
    count = 1
    shape = (ARM_ELEMENT_SETTINGS.stages, ARM_ELEMENT_SETTINGS.width)
    values = np.empty((MINORS, *shape))
    rates = np.empty((MINORS, *shape))
    largest_terms = np.empty((MINORS, shape[1]))
    repeated = np.empty((6, *shape))
    matrices = np.empty((shape[0], 1 + shape[0], shape[1]))
    for arm in range(len(F)):
        for b in range(coefficients.shape[1]):
            _repeat_per_initial_value(coefficients[arm, b], repeated)
            for lane in range(ARM_ELEMENT_SETTINGS.lane_count):
                element = coefficients[arm, b, :, :, lane]
                matrix = elimination_matrix(F[arm], element[C3], element[G], method.integrals)
                _copy_to_simd_lane(matrix, lane, matrices)
            start = b * ARM_ELEMENT_SETTINGS.lane_count
            batch = terms[arm, start : start + ARM_ELEMENT_SETTINGS.lane_count]
            work = values, rates, largest_terms
            count = max(count, _fill_batch_terms((F[arm], W), repeated, (method, matrices), work, batch))
    return count


@compiled_for_vectors
def _repeat_per_initial_value(coefficients: Array, repeated: Array) -> None:
    """Writes coefficients, (6, STAGES, LANES), for each initial value into repeated, (6, STAGES, WIDTH)."""
    for q in range(6):
        for i in range(ARM_ELEMENT_SETTINGS.stages):
            for k in range(MINORS):
                for lane in range(ARM_ELEMENT_SETTINGS.lane_count):
                    repeated[q, i, k * ARM_ELEMENT_SETTINGS.lane_count + lane] = coefficients[q, i, lane]


@compiled_for_vectors
def _copy_to_simd_lane(matrix: Array, lane: int, lane_matrices: Array) -> None:
    """Copies `matrix`, the `elimination_matrix` of one element, into the columns of lane number `lane` of
    `lane_matrices`, (STAGES, 1 + STAGES, WIDTH)."""
    for i in range(ARM_ELEMENT_SETTINGS.stages):
        for j in range(1 + ARM_ELEMENT_SETTINGS.stages):
            for k in range(MINORS):
                lane_matrices[i, j, k * ARM_ELEMENT_SETTINGS.lane_count + lane] = matrix[i, j]


@compiled
def _fill_batch_terms(
    load: tuple[float, float],
    coefficients: Array,
    method: tuple[IntegrationMatrices, Array],
    work: tuple[Array, Array, Array],
    terms: Array,
) -> int:
    """Fills `terms`, the coefficients of propagators, for one batch of elements; returns the number of terms
    needed.

    terms: (LANES, MAX_TERMS, PADDED). load: (F, W). coefficients: (6, STAGES, WIDTH). method: integrals, and
    `elimination_matrix` of each lane's element. work: values and rates of the minors, (MINORS, STAGES,
    WIDTH) each, and the largest terms of the propagators, (MINORS, WIDTH).
    """
    F, W = load
    (Q, weights), matrices = method
    values, rates, largest_terms = work
    values[:] = 0.0
    rates[:] = 0.0
    largest_terms[:] = 0.0
    for n in range(terms.shape[1]):
        start = 1.0 if n == 0 else 0.0  # the initial values belong to the term of w^0
        fill_drag_rates(W, coefficients, values, rates)
        _integrate(Q, rates[SM], values[SM])
        add_start_value(SM, start, values)
        # theta^s and theta^m depend on each other, and so do y^theta and y^m: one of each pair is eliminated.
        add_theta_s_rates(F, start, coefficients, values, rates)
        _integrate_eliminated(matrices, rates[TS], values[TS])
        add_eliminated_start_value(TS, start, matrices, values)
        fill_theta_m_rates(coefficients, values, rates)
        _integrate(Q, rates[TM], values[TM])
        add_start_value(TM, start, values)
        add_rates_by_theta_m(F, start, coefficients, values, rates)
        _integrate(Q, rates[YM], values[YM])  # without the part by y^theta
        add_start_value(YM, start, values)
        fill_y_theta_rates(coefficients, values, rates)
        _integrate_eliminated(matrices, rates[YT], values[YT])
        add_eliminated_start_value(YT, start, matrices, values)
        add_rates_by_y_theta(F, coefficients, values, rates)
        _integrate(Q, rates[YM], values[YM])
        add_start_value(YM, start, values)
        # The rates are needed once more, with the complete y^m, for the value at the end of the element.
        fill_y_theta_rates(coefficients, values, rates)
        if _write_end_terms(weights, rates, n, largest_terms, terms):
            return n + 1
    return terms.shape[1] + 1


@compiled_for_vectors
def _integrate(Q: Array, rates: Array, out: Array) -> None:
    """out = the integrals of rates, both (STAGES, WIDTH), to each stage; Q: integrals, (STAGES, STAGES)."""
    for i in range(ARM_ELEMENT_SETTINGS.stages):
        for c in range(ARM_ELEMENT_SETTINGS.width):
            total = 0.0
            for j in range(ARM_ELEMENT_SETTINGS.stages):
                total += Q[i, j] * rates[j, c]
            out[i, c] = total


@compiled_for_vectors
def _integrate_eliminated(matrices: Array, rates: Array, out: Array) -> None:
    """Writes M Q rates into out, both (STAGES, WIDTH): rates integrated after the elimination of a minor.
    matrices: `elimination_matrix` of each lane's element, with M Q, (STAGES, 1 + STAGES, WIDTH)."""
    for i in range(ARM_ELEMENT_SETTINGS.stages):
        for c in range(ARM_ELEMENT_SETTINGS.width):
            total = 0.0
            for j in range(ARM_ELEMENT_SETTINGS.stages):
                total += matrices[i, j + 1, c] * rates[j, c]
            out[i, c] = total


@compiled
def _write_end_terms(weights: Array, rates: Array, n: int, largest_terms: Array, terms: Array) -> bool:
    """Writes the propagators' coefficients of w^n into terms[:, n]; returns whether all are negligible, each
    compared with the largest coefficient of the same entry of the propagator: entries have different units,
    and at a strong pull their sizes differ by many powers of ten.

    terms: (LANES, MAX_TERMS, PADDED). rates: rates of minors, (MINORS, STAGES, WIDTH). weights: (STAGES,).
    largest_terms: largest modulus of the coefficients of lower powers of w, (MINORS, WIDTH), updated here."""
    integrals = np.empty((MINORS, ARM_ELEMENT_SETTINGS.width))
    _integrate_to_end(weights, rates, integrals)
    is_negligible = True
    for lane in range(ARM_ELEMENT_SETTINGS.lane_count):
        for row in range(MINORS):
            for k in range(MINORS):
                column = k * ARM_ELEMENT_SETTINGS.lane_count + lane
                entry = integrals[row, column] + (1.0 if n == 0 and k == row else 0.0)
                terms[lane, n, MINORS * k + row] = entry
                max_size = ARM_ELEMENT_SETTINGS.negligible_term_ratio * largest_terms[row, column]
                is_negligible = is_negligible and abs(entry) <= max_size
                largest_terms[row, column] = max(largest_terms[row, column], abs(entry))
    return is_negligible


@compiled_for_vectors
def _integrate_to_end(weights: Array, rates: Array, integrals: Array) -> None:
    """Writes integrals of rates, (MINORS, STAGES, WIDTH), into `integrals`, (MINORS, WIDTH); weights,
    (STAGES,)."""
    for row in range(MINORS):
        for c in range(ARM_ELEMENT_SETTINGS.width):
            total = 0.0
            for i in range(ARM_ELEMENT_SETTINGS.stages):
                total += weights[i] * rates[row, i, c]
            integrals[row, c] = total
