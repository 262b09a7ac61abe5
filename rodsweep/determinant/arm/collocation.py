"""The transverse problem of arms in minors of two solutions, and its collocation over elements.

With the state (y, theta, s, m) the eigenproblem of an arm with profiles reads (physics: the arm as it is
built)

    y' = nu theta + c2 s,   theta' = c3 m,   s' = w gamma2 y + F c3 m,   m' = w gamma3 theta - g s.

D is the minor of the rows s and m of two solutions, those that start with s = 1 or m = 1 at the clamp. With
y^s for the minor of the rows y and s, and so on, y^s + theta^m - F y^theta is constant along the arm: 0 for
these two solutions. The other five minors then obey a linear system of their own,

    (s^m)'     = w (gamma2 y^m - gamma3 theta^s)
    (theta^s)' = F c3 theta^m - c3 s^m - w gamma2 y^theta
    (theta^m)' = -g theta^s
    (y^theta)' = c3 y^m - c2 theta^s
    (y^m)'     = (g + nu) theta^m + c2 s^m + (w gamma3 - F g) y^theta

from s^m = 1 at the clamp, the others 0, to D = s^m at the tip. A growing exponential of one solution cannot
hide the other one, as it does where the solutions themselves are integrated.

Elements are solved by collocation at their Gauss points, for one power of w after the other: the terms of the
propagator satisfy C_n' = A_0 C_n + A_1 C_(n-1). `ARM_ELEMENTS.lanes` elements are solved together. The last
axis of arrays, WIDTH, combines the initial value, one of `MINORS`, and the element; loops over it are vector
instructions. STAGES, LANES and MAX_TERMS are the settings of these names.
"""

from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...model.compiled.compilation import compiled, compiled_for_vectors
from .element_settings import ARM_ELEMENTS, MINORS

SM, TS, TM, YT, YM = range(MINORS)
"""Places of the minors s^m, theta^s, theta^m, y^theta and y^m."""
ENTRIES = MINORS * MINORS
NU, C2, C3, GAMMA2, GAMMA3, G = range(6)
"""Places of the `LocalCoefficients`."""


class IntegrationMatrices(NamedTuple):
    """Integrals on [0, 1] from 0 to each Gauss point, (STAGES, STAGES), and Gauss weights, (STAGES,)."""

    integrals: Array
    weights: Array


@compiled
def fill_terms(F: Array, W: float, coefficients: Array, method: IntegrationMatrices, terms: Array) -> int:
    """Fills the terms of the elements of n arms; returns how many are needed, MAX_TERMS + 1 for more.

    F: forces, (n,). coefficients: `LocalCoefficients` times the lengths of the elements, (n, batches, 6,
    STAGES, LANES). terms: of w/W, (n, batches * LANES, MAX_TERMS, ENTRIES), all 0.
    """
    most = 1
    values = np.empty((MINORS, ARM_ELEMENTS.stages, ARM_ELEMENTS.width))
    rates = np.empty((MINORS, ARM_ELEMENTS.stages, ARM_ELEMENTS.width))
    local = np.empty((6, ARM_ELEMENTS.stages, ARM_ELEMENTS.width))
    turning = np.empty((ARM_ELEMENTS.stages, 1 + ARM_ELEMENTS.stages, ARM_ELEMENTS.width))
    for arm in range(len(F)):
        for b in range(coefficients.shape[1]):
            _repeat(coefficients[arm, b], local)
            for lane in range(ARM_ELEMENTS.lanes):
                own = coefficients[arm, b, :, :, lane]
                eliminated = _eliminated(F[arm], own[C3], own[G], method.integrals)
                _put_in_lane(eliminated, lane, turning)
            here = terms[arm, b * ARM_ELEMENTS.lanes : (b + 1) * ARM_ELEMENTS.lanes]
            most = max(most, _fill_batch((F[arm], W), local, (method, turning), (values, rates), here))
    return most


@compiled_for_vectors
def _repeat(coefficients: Array, local: Array) -> None:
    """Coefficients, (6, STAGES, LANES), repeated for each initial value: (6, STAGES, WIDTH)."""
    for q in range(6):
        for i in range(ARM_ELEMENTS.stages):
            for k in range(MINORS):
                for lane in range(ARM_ELEMENTS.lanes):
                    local[q, i, k * ARM_ELEMENTS.lanes + lane] = coefficients[q, i, lane]


@compiled_for_vectors
def _put_in_lane(eliminated: Array, lane: int, turning: Array) -> None:
    """`_eliminated` of one element into its lane of (STAGES, 1 + STAGES, WIDTH), for each initial value."""
    for i in range(ARM_ELEMENTS.stages):
        for j in range(1 + ARM_ELEMENTS.stages):
            for k in range(MINORS):
                turning[i, j, k * ARM_ELEMENTS.lanes + lane] = eliminated[i, j]


@compiled
def _fill_batch(
    load: tuple[float, float],
    local: Array,
    method: tuple[IntegrationMatrices, Array],
    work: tuple[Array, Array],
    terms: Array,
) -> int:
    """Fills the terms of some elements, (LANES, MAX_TERMS, ENTRIES); returns how many are needed.

    load: (F, W). local: (6, STAGES, WIDTH). method: the second is `_eliminated` in lanes. work: values of the
    minors and their rates, (MINORS, STAGES, WIDTH) each.
    """
    F, W = load
    (Q, weights), turning = method
    values, rates = work
    values[:] = 0.0
    rates[:] = 0.0
    for n in range(terms.shape[1]):
        start = 1.0 if n == 0 else 0.0  # the initial values belong to the term of w^0
        _loads_of_w(W, local, values, rates)
        _integrate(Q, rates[SM], values[SM])
        _start(SM, start, values)
        _add_pushes(F, start, local, values, rates)
        _integrate_eliminated(turning, rates[TS], values[TS])
        _start_eliminated(TS, start, turning, values)
        _turns(local, values, rates)
        _integrate(Q, rates[TM], values[TM])
        _start(TM, start, values)
        _add_turns(F, start, local, values, rates)
        _integrate(Q, rates[YM], values[YM])  # without the part by y^theta
        _start(YM, start, values)
        _rises(local, values, rates)
        _integrate_eliminated(turning, rates[YT], values[YT])
        _start_eliminated(YT, start, turning, values)
        _add_tilts(F, local, values, rates)
        _integrate(Q, rates[YM], values[YM])
        _start(YM, start, values)
        _rises(local, values, rates)
        if _end_values(weights, rates, n, terms):
            return n + 1
    return terms.shape[1] + 1


@compiled_for_vectors
def _integrate(Q: Array, rates: Array, out: Array) -> None:
    """out = the integrals of rates, both (STAGES, WIDTH), to each stage; Q: integrals, (STAGES, STAGES)."""
    for i in range(ARM_ELEMENTS.stages):
        for c in range(ARM_ELEMENTS.width):
            out[i, c] = 0.0
        for j in range(0, ARM_ELEMENTS.stages, 4):  # four products at a time save passes over `out`
            p = Q[i, j]
            q = Q[i, j + 1]
            r = Q[i, j + 2]
            s = Q[i, j + 3]
            for c in range(ARM_ELEMENTS.width):
                out[i, c] += p * rates[j, c] + q * rates[j + 1, c] + r * rates[j + 2, c] + s * rates[j + 3, c]


@compiled_for_vectors
def _integrate_eliminated(turning: Array, rates: Array, out: Array) -> None:
    """out = M Q rates, both (STAGES, WIDTH), for the M of each lane; turning: (STAGES, 1 + STAGES, WIDTH)."""
    for i in range(ARM_ELEMENTS.stages):
        for c in range(ARM_ELEMENTS.width):
            out[i, c] = 0.0
        for j in range(0, ARM_ELEMENTS.stages, 4):
            for c in range(ARM_ELEMENTS.width):
                out[i, c] += turning[i, j + 1, c] * rates[j, c] + turning[i, j + 2, c] * rates[j + 1, c]
                out[i, c] += turning[i, j + 3, c] * rates[j + 2, c] + turning[i, j + 4, c] * rates[j + 3, c]


@compiled_for_vectors
def _start(minor: int, start: float, values: Array) -> None:
    """Adds a minor's start value to values, (MINORS, STAGES, WIDTH), where the minor is the initial value."""
    for i in range(ARM_ELEMENTS.stages):
        for lane in range(ARM_ELEMENTS.lanes):
            values[minor, i, minor * ARM_ELEMENTS.lanes + lane] += start


@compiled_for_vectors
def _start_eliminated(minor: int, start: float, turning: Array, values: Array) -> None:
    """`_start` of theta^s or y^theta, from whose equation another minor is eliminated."""
    for i in range(ARM_ELEMENTS.stages):
        for lane in range(ARM_ELEMENTS.lanes):
            c = minor * ARM_ELEMENTS.lanes + lane
            values[minor, i, c] += start * turning[i, 0, c]


@compiled_for_vectors
def _loads_of_w(W: float, local: Array, values: Array, rates: Array) -> None:
    """Writes rates proportional to w, from values one power lower, both (MINORS, STAGES, WIDTH)."""
    for i in range(ARM_ELEMENTS.stages):
        for c in range(ARM_ELEMENTS.width):
            push = W * local[GAMMA2, i, c]
            turn = W * local[GAMMA3, i, c]
            rates[SM, i, c] = push * values[YM, i, c] - turn * values[TS, i, c]
            rates[TS, i, c] = -push * values[YT, i, c]
            rates[YM, i, c] = turn * values[YT, i, c]


@compiled_for_vectors
def _add_pushes(F: float, start: float, local: Array, values: Array, rates: Array) -> None:
    """Adds to the rates of theta^s what s^m and the start value of theta^m contribute."""
    for i in range(ARM_ELEMENTS.stages):
        for c in range(ARM_ELEMENTS.width):
            rates[TS, i, c] -= local[C3, i, c] * values[SM, i, c]
        for lane in range(ARM_ELEMENTS.lanes):
            c = TM * ARM_ELEMENTS.lanes + lane
            rates[TS, i, c] += F * start * local[C3, i, c]


@compiled_for_vectors
def _turns(local: Array, values: Array, rates: Array) -> None:
    """Writes the rates -g theta^s of the minor theta^m."""
    for i in range(ARM_ELEMENTS.stages):
        for c in range(ARM_ELEMENTS.width):
            rates[TM, i, c] = -local[G, i, c] * values[TS, i, c]


@compiled_for_vectors
def _add_turns(F: float, start: float, local: Array, values: Array, rates: Array) -> None:
    """Adds to the rates of theta^s and y^m what theta^m and s^m contribute."""
    for i in range(ARM_ELEMENTS.stages):
        for c in range(ARM_ELEMENTS.width):
            turn = values[TM, i, c]
            rates[TS, i, c] += F * local[C3, i, c] * turn
            rates[YM, i, c] += (local[G, i, c] + local[NU, i, c]) * turn
            rates[YM, i, c] += local[C2, i, c] * values[SM, i, c]
        for lane in range(ARM_ELEMENTS.lanes):
            c = TM * ARM_ELEMENTS.lanes + lane
            rates[TS, i, c] -= F * start * local[C3, i, c]  # contained in `_add_pushes`


@compiled_for_vectors
def _rises(local: Array, values: Array, rates: Array) -> None:
    """Writes the rates c3 y^m - c2 theta^s of the minor y^theta."""
    for i in range(ARM_ELEMENTS.stages):
        for c in range(ARM_ELEMENTS.width):
            rates[YT, i, c] = local[C3, i, c] * values[YM, i, c] - local[C2, i, c] * values[TS, i, c]


@compiled_for_vectors
def _add_tilts(F: float, local: Array, values: Array, rates: Array) -> None:
    """Adds to the rates of y^m what y^theta contributes by the force."""
    for i in range(ARM_ELEMENTS.stages):
        for c in range(ARM_ELEMENTS.width):
            rates[YM, i, c] -= F * local[G, i, c] * values[YT, i, c]


@compiled
def _end_values(weights: Array, rates: Array, n: int, terms: Array) -> bool:
    """Fills term n, (LANES, MAX_TERMS, ENTRIES), from rates; whether it is negligible in all elements."""
    end = np.zeros((MINORS, ARM_ELEMENTS.width))
    _add_ends(weights, rates, end)
    done = True
    for lane in range(ARM_ELEMENTS.lanes):
        size = 0.0
        first = 0.0
        for row in range(MINORS):
            for k in range(MINORS):
                entry = end[row, k * ARM_ELEMENTS.lanes + lane] + (1.0 if n == 0 and k == row else 0.0)
                terms[lane, n, MINORS * k + row] = entry
                size = max(size, abs(entry))
                first = max(first, abs(terms[lane, 0, MINORS * k + row]))
        done = done and size <= ARM_ELEMENTS.negligible * first
    return done


@compiled_for_vectors
def _add_ends(weights: Array, rates: Array, end: Array) -> None:
    """Adds the integrals of rates, (MINORS, STAGES, WIDTH), over the elements to `end`, (MINORS, WIDTH)."""
    for row in range(MINORS):
        for i in range(0, ARM_ELEMENTS.stages, 4):
            p = weights[i]
            q = weights[i + 1]
            r = weights[i + 2]
            s = weights[i + 3]
            for c in range(ARM_ELEMENTS.width):
                end[row, c] += p * rates[row, i, c] + q * rates[row, i + 1, c]
                end[row, c] += r * rates[row, i + 2, c] + s * rates[row, i + 3, c]


@compiled
def _eliminated(F: float, c3: Array, g: Array, Q: Array) -> Array:
    """M 1 and M Q, (STAGES, 1 + STAGES), with the inverse M of 1 + F Q c3 Q g.

    M eliminates theta^m and y^m: M Q integrates the rates of theta^s and y^theta, and M 1 belongs to a start
    value of 1. Q: integrals. c3, g: coefficients times the length of the element.
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
