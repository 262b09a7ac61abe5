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
together. The last axis of arrays, WIDTH, combines the initial value, one of `MINOR_COUNT`, and the element;
loops over it are vector instructions. STAGES, LANES, MAX_TERMS: settings `stage_count`, `lane_count`,
`max_terms`."""

from typing import NamedTuple

import numpy as np

from ....arrays import Array
from ....model.compiled.compilation import compiled, compiled_with_reordered_sums
from .distinct_elements import distinct_element_indices
from .elimination import fill_elimination_matrices
from .minor_rates import (
    C3,
    PROPAGATOR_LENGTH,
    G,
    fill_drag_rates,
    integrate_minor_s_m,
    integrate_minor_theta_m,
    integrate_minor_theta_s,
    integrate_minor_y_m,
    integrate_minor_y_theta,
)
from .settings import ARM_ELEMENT_SETTINGS, MINOR_COUNT


class IntegrationMatrices(NamedTuple):
    """Matrix of integrals from 0 to each Gauss point on [0, 1], (STAGES, STAGES), and weights, (STAGES,)."""

    integration_matrix: Array
    integration_weights: Array


@compiled
def propagator_polynomials(
    F: Array, W: float, local: Array, lengths: Array, method: IntegrationMatrices
) -> Array:
    """Coefficients of the propagators in powers of w/W, (n, elements, terms, PROPAGATOR_LENGTH); the array is
    empty, terms = 0, if MAX_TERMS powers do not suffice. F: forces, (n,). W: bound of |w|. local:
    `LocalCoefficients`, (6, n, elements, STAGES). lengths: lengths of the elements, in L, (elements,)."""
    n, elements = local.shape[1:3]
    numbers = distinct_element_indices(local, lengths)
    different = numbers[-1] + 1
    batches = -(-different // ARM_ELEMENT_SETTINGS.lane_count)
    coefficients = np.empty(
        (n, batches, 6, ARM_ELEMENT_SETTINGS.stage_count, ARM_ELEMENT_SETTINGS.lane_count)
    )
    for b in range(batches):
        for lane in range(ARM_ELEMENT_SETTINGS.lane_count):
            # The last batch is filled up with the last element.
            number = min(b * ARM_ELEMENT_SETTINGS.lane_count + lane, different - 1)
            equal_elements = np.flatnonzero(numbers == number)
            # The lengths of equal elements differ by rounding; their mean keeps the sum of all lengths.
            length = lengths[equal_elements].mean()
            for arm in range(n):
                coefficients[arm, b, :, :, lane] = local[:, arm, equal_elements[0]] * length
    terms = np.zeros(
        (n, batches * ARM_ELEMENT_SETTINGS.lane_count, ARM_ELEMENT_SETTINGS.max_terms, PROPAGATOR_LENGTH)
    )
    term_count = fill_propagator_polynomials(F, W, coefficients, method, terms)
    if term_count > ARM_ELEMENT_SETTINGS.max_terms:
        return terms[:, :, :0].copy()
    return terms[:, numbers, :term_count]


@compiled
def fill_propagator_polynomials(
    F: Array, W: float, coefficients: Array, method: IntegrationMatrices, terms: Array
) -> int:
    """Fills `terms`, the coefficients of the propagators in powers of w/W; returns the number of powers
    needed, or MAX_TERMS + 1 if MAX_TERMS do not suffice.

    F: forces of n arms, (n,). W: bound of |w|. coefficients: `LocalCoefficients` times the lengths of the
    elements, which form batches of LANES elements, (n, batches, 6, STAGES, LANES). terms: (n, batches *
    LANES, MAX_TERMS, PROPAGATOR_LENGTH), all 0 at first.
    """
    count = 1
    stages, width = ARM_ELEMENT_SETTINGS.stage_count, ARM_ELEMENT_SETTINGS.lane_axis_length
    repeated = np.empty((6, stages, width))
    eliminations = np.empty((stages, 1 + stages, width))
    for arm in range(len(F)):
        for b in range(coefficients.shape[1]):
            _repeat_per_initial_value(coefficients[arm, b], repeated)
            c3, g = coefficients[arm, b, C3], coefficients[arm, b, G]
            fill_elimination_matrices(F[arm], c3, g, method.integration_matrix, eliminations)
            start = b * ARM_ELEMENT_SETTINGS.lane_count
            batch = terms[arm, start : start + ARM_ELEMENT_SETTINGS.lane_count]
            count = max(count, _fill_polynomials_of_batch((F[arm], W), repeated, method, eliminations, batch))
    return count


@compiled_with_reordered_sums
def _repeat_per_initial_value(coefficients: Array, repeated: Array) -> None:
    """Writes coefficients, (6, STAGES, LANES), for each initial value into repeated, (6, STAGES, WIDTH)."""
    for q in range(6):
        for i in range(ARM_ELEMENT_SETTINGS.stage_count):
            for k in range(MINOR_COUNT):
                for lane in range(ARM_ELEMENT_SETTINGS.lane_count):
                    repeated[q, i, k * ARM_ELEMENT_SETTINGS.lane_count + lane] = coefficients[q, i, lane]


@compiled
def _fill_polynomials_of_batch(
    load: tuple[float, float],
    coefficients: Array,
    method: IntegrationMatrices,
    eliminations: Array,
    terms: Array,
) -> int:
    """Fills `terms`, the coefficients of the propagators in powers of w/W, for one batch of LANES elements;
    returns the number of powers needed, or MAX_TERMS + 1 if MAX_TERMS do not suffice.

    terms: (LANES, MAX_TERMS, PROPAGATOR_LENGTH). load: (force F, bound W of |w|). coefficients: (6, STAGES,
    WIDTH). eliminations: matrices of `fill_elimination_matrices`, (STAGES, 1 + STAGES, WIDTH).
    """
    F, W = load
    Q, weights = method
    # Shapes known to the compiler give vector instructions without tests of overlapping arrays.
    values = np.zeros((MINOR_COUNT, ARM_ELEMENT_SETTINGS.stage_count, ARM_ELEMENT_SETTINGS.lane_axis_length))
    rates = np.zeros((MINOR_COUNT, ARM_ELEMENT_SETTINGS.stage_count, ARM_ELEMENT_SETTINGS.lane_axis_length))
    starts = np.zeros((MINOR_COUNT, ARM_ELEMENT_SETTINGS.lane_axis_length))
    end_terms = np.zeros((MINOR_COUNT, ARM_ELEMENT_SETTINGS.lane_axis_length))
    largest_terms = np.zeros((MINOR_COUNT, ARM_ELEMENT_SETTINGS.lane_axis_length))
    for k in range(MINOR_COUNT):
        for lane in range(ARM_ELEMENT_SETTINGS.lane_count):
            starts[k, k * ARM_ELEMENT_SETTINGS.lane_count + lane] = 1.0
    for n in range(terms.shape[1]):
        fill_drag_rates(W, coefficients, values, rates)
        integrate_minor_s_m(F, Q, starts, coefficients, rates)
        # theta^s and theta^m depend on each other, and so do y^theta and y^m: one of each pair is eliminated.
        integrate_minor_theta_s(eliminations, starts, coefficients, values, rates)
        integrate_minor_theta_m(F, Q, starts, coefficients, rates)
        integrate_minor_y_m(Q, starts, coefficients, values, rates)  # without the part by y^theta
        integrate_minor_y_theta(F, eliminations, starts, coefficients, values, rates)
        integrate_minor_y_m(Q, starts, coefficients, values, rates)
        _integrate_over_element(weights, starts, rates, end_terms)
        for lane in range(ARM_ELEMENT_SETTINGS.lane_count):
            for row in range(MINOR_COUNT):
                for k in range(MINOR_COUNT):
                    column = k * ARM_ELEMENT_SETTINGS.lane_count + lane
                    terms[lane, n, MINOR_COUNT * k + row] = end_terms[row, column]
        if _count_non_negligible_entries(end_terms, largest_terms) == 0:
            return n + 1
        starts[:] = 0.0  # the initial values belong to the term of w^0
    return terms.shape[1] + 1


@compiled_with_reordered_sums
def _integrate_over_element(weights: Array, starts: Array, rates: Array, end_terms: Array) -> None:
    """Writes the propagators' coefficients of a power of w into `end_terms`, (MINOR_COUNT, WIDTH): integrals
    of rates, (MINOR_COUNT, STAGES, WIDTH), plus the initial values `starts`, (MINOR_COUNT, WIDTH). weights:
    (STAGES,)."""
    for row in range(MINOR_COUNT):
        for c in range(ARM_ELEMENT_SETTINGS.lane_axis_length):
            total = starts[row, c]
            for i in range(ARM_ELEMENT_SETTINGS.stage_count):
                total += weights[i] * rates[row, i, c]
            end_terms[row, c] = total


@compiled_with_reordered_sums
def _count_non_negligible_entries(end_terms: Array, largest_terms: Array) -> float:
    """Number of entries of `end_terms`, the coefficients of one power of w, that are not negligible, each
    compared with the largest coefficient of the same entry of the propagator: entries have different units,
    and at a strong pull their sizes differ by many powers of ten. end_terms: (MINOR_COUNT, WIDTH).
    largest_terms: largest modulus of the coefficients of lower powers of w, (MINOR_COUNT, WIDTH), updated
    here."""
    count = 0.0
    for row in range(MINOR_COUNT):
        for c in range(ARM_ELEMENT_SETTINGS.lane_axis_length):
            size = abs(end_terms[row, c])
            is_negligible = size <= ARM_ELEMENT_SETTINGS.negligible_term_over_largest * largest_terms[row, c]
            count += 0.0 if is_negligible else 1.0  # nan is not negligible
            largest_terms[row, c] = max(largest_terms[row, c], size)
    return count
