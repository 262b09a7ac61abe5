"""Rates d/du of the five minors along an element, and their integrals, one power of w at a time.

The minor s^m is the 2 x 2 determinant of the rows s and m of two solutions; s^m, theta^s, ... and their
equations are defined in `rodsweep.determinant.arm.elements.collocation`. STAGES: number of Gauss points of an
element. WIDTH: number of pairs (initial value, element). values, rates: values and rates of the minors at the
Gauss points of some elements, (MINOR_COUNT, STAGES, WIDTH). coefficients: `LocalCoefficients` at these
points, (6, STAGES, WIDTH). Q: matrix of integrals from 0 to each Gauss point, (STAGES, STAGES). eliminations:
matrices of `fill_elimination_matrices`, (STAGES, 1 + STAGES, WIDTH). starts: initial values of the minors,
(MINOR_COUNT, WIDTH), all 0 except at the power w^0.

Each integral is added to the rates that contain the minor in the same loop, as most of the time is spent on
loads and stores: only the values that a later step needs are stored.
"""

from ....arrays import Array
from ....model.compiled.compilation import compiled_with_reordered_sums
from .settings import ARM_ELEMENT_SETTINGS, MINOR_COUNT

SM, TS, TM, YT, YM = range(MINOR_COUNT)
"""Row indices of the minors s^m, theta^s, theta^m, y^theta and y^m."""
PROPAGATOR_LENGTH = 28
"""Length of a stored propagator, a matrix that multiplies the minors: its MINOR_COUNT^2 entries, then zeros
up to a multiple of 4, for vector instructions."""
NU, C2, C3, GAMMA2, GAMMA3, G = range(6)
"""Row indices of the `LocalCoefficients` nu, c2, c3, gamma2, gamma3 and g."""


@compiled_with_reordered_sums
def fill_drag_rates(W: float, coefficients: Array, values: Array, rates: Array) -> None:
    """Writes the terms proportional to w in the rates of s^m, theta^s and y^m, from the values of the minors
    at the previous power of w. values, rates: (MINOR_COUNT, STAGES, WIDTH). coefficients: (6, STAGES, WIDTH).
    W: unit of w."""
    for i in range(ARM_ELEMENT_SETTINGS.stage_count):
        for c in range(ARM_ELEMENT_SETTINGS.lane_axis_length):
            transverse_drag = W * coefficients[GAMMA2, i, c]
            rotational_drag = W * coefficients[GAMMA3, i, c]
            rates[SM, i, c] = transverse_drag * values[YM, i, c] - rotational_drag * values[TS, i, c]
            rates[TS, i, c] = -transverse_drag * values[YT, i, c]
            rates[YM, i, c] = rotational_drag * values[YT, i, c]


@compiled_with_reordered_sums
def integrate_minor_s_m(F: float, Q: Array, starts: Array, coefficients: Array, rates: Array) -> None:
    """Integrates the rates of s^m, and adds the terms with s^m to the rates of theta^s and y^m. The
    elimination of theta^m leaves out the initial value of theta^m, so its contribution to the rates of
    theta^s is added here. rates: (MINOR_COUNT, STAGES, WIDTH). Other arguments: see the module docstring."""
    for i in range(ARM_ELEMENT_SETTINGS.stage_count):
        for c in range(ARM_ELEMENT_SETTINGS.lane_axis_length):
            value = starts[SM, c]
            for j in range(ARM_ELEMENT_SETTINGS.stage_count):
                value += Q[i, j] * rates[SM, j, c]
            rates[TS, i, c] += coefficients[C3, i, c] * (F * starts[TM, c] - value)
            rates[YM, i, c] += coefficients[C2, i, c] * value


@compiled_with_reordered_sums
def integrate_minor_theta_s(
    eliminations: Array, starts: Array, coefficients: Array, values: Array, rates: Array
) -> None:
    """Integrates the rates of theta^s after the elimination of theta^m, and writes the rates -g theta^s of
    theta^m. values, rates: (MINOR_COUNT, STAGES, WIDTH). Other arguments: see the module docstring."""
    for i in range(ARM_ELEMENT_SETTINGS.stage_count):
        for c in range(ARM_ELEMENT_SETTINGS.lane_axis_length):
            value = eliminations[i, 0, c] * starts[TS, c]
            for j in range(ARM_ELEMENT_SETTINGS.stage_count):
                value += eliminations[i, j + 1, c] * rates[TS, j, c]
            values[TS, i, c] = value
            rates[TM, i, c] = -coefficients[G, i, c] * value


@compiled_with_reordered_sums
def integrate_minor_theta_m(F: float, Q: Array, starts: Array, coefficients: Array, rates: Array) -> None:
    """Integrates the rates of theta^m, and adds the terms with theta^m to the rates of theta^s and y^m; the
    rates of theta^s already contain the initial value of theta^m (`integrate_minor_s_m`). rates:
    (MINOR_COUNT, STAGES, WIDTH). Other arguments: see the module docstring."""
    for i in range(ARM_ELEMENT_SETTINGS.stage_count):
        for c in range(ARM_ELEMENT_SETTINGS.lane_axis_length):
            change = 0.0
            for j in range(ARM_ELEMENT_SETTINGS.stage_count):
                change += Q[i, j] * rates[TM, j, c]
            rates[TS, i, c] += F * coefficients[C3, i, c] * change
            rates[YM, i, c] += (coefficients[G, i, c] + coefficients[NU, i, c]) * (starts[TM, c] + change)


@compiled_with_reordered_sums
def integrate_minor_y_m(Q: Array, starts: Array, coefficients: Array, values: Array, rates: Array) -> None:
    """Integrates the rates of y^m, and writes the rates c3 y^m - c2 theta^s of y^theta. values,
    rates: (MINOR_COUNT, STAGES, WIDTH). Other arguments: see the module docstring."""
    for i in range(ARM_ELEMENT_SETTINGS.stage_count):
        for c in range(ARM_ELEMENT_SETTINGS.lane_axis_length):
            value = starts[YM, c]
            for j in range(ARM_ELEMENT_SETTINGS.stage_count):
                value += Q[i, j] * rates[YM, j, c]
            values[YM, i, c] = value
            rates[YT, i, c] = coefficients[C3, i, c] * value - coefficients[C2, i, c] * values[TS, i, c]


@compiled_with_reordered_sums
def integrate_minor_y_theta(
    F: float, eliminations: Array, starts: Array, coefficients: Array, values: Array, rates: Array
) -> None:
    """Integrates the rates of y^theta after the elimination of y^m, and adds the term -F g y^theta to the
    rates of y^m. values, rates: (MINOR_COUNT, STAGES, WIDTH). Other arguments: see the module docstring."""
    for i in range(ARM_ELEMENT_SETTINGS.stage_count):
        for c in range(ARM_ELEMENT_SETTINGS.lane_axis_length):
            value = eliminations[i, 0, c] * starts[YT, c]
            for j in range(ARM_ELEMENT_SETTINGS.stage_count):
                value += eliminations[i, j + 1, c] * rates[YT, j, c]
            values[YT, i, c] = value
            rates[YM, i, c] -= F * coefficients[G, i, c] * value
