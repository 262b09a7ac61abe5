"""Rates d/du of the five minors along an element, one power of w at a time, and start values of the minors.

The minor s^m is the 2 x 2 determinant of the rows s and m of two solutions; s^m, theta^s, ... and their
equations are defined in `rodsweep.determinant.arm.elements.collocation`. STAGES: number of Gauss points of an
element. WIDTH: number of pairs (initial value, element). values, rates: values and rates of the minors at the
Gauss points of some elements, (MINORS, STAGES, WIDTH). coefficients: `LocalCoefficients` at these points, (6,
STAGES, WIDTH). eliminations: `elimination_matrix` of each element, (STAGES, 1 + STAGES, WIDTH). start: 1 at
the power w^0, else 0.
"""

from ....arrays import Array
from ....model.compiled.compilation import compiled_for_vectors
from .settings import ARM_ELEMENT_SETTINGS, MINORS

SM, TS, TM, YT, YM = range(MINORS)
"""Row indices of the minors s^m, theta^s, theta^m, y^theta and y^m."""
PADDED = 28
"""Length of a stored propagator, a matrix that multiplies the minors: its MINORS^2 entries, then zeros up to
a multiple of 4, for vector instructions."""
NU, C2, C3, GAMMA2, GAMMA3, G = range(6)
"""Row indices of the `LocalCoefficients` nu, c2, c3, gamma2, gamma3 and g."""


@compiled_for_vectors
def add_start_value(minor: int, start: float, values: Array) -> None:
    """Adds `start` to the values, (MINORS, STAGES, WIDTH), of the minor with row index `minor`, in the lanes
    of the solution whose start value is 1 for this minor and 0 for all other minors."""
    for i in range(ARM_ELEMENT_SETTINGS.stages):
        for lane in range(ARM_ELEMENT_SETTINGS.lane_count):
            values[minor, i, minor * ARM_ELEMENT_SETTINGS.lane_count + lane] += start


@compiled_for_vectors
def add_eliminated_start_value(minor: int, start: float, eliminations: Array, values: Array) -> None:
    """`add_start_value` for the minor theta^s or y^theta, from whose equation another minor is eliminated.
    values: (MINORS, STAGES, WIDTH). eliminations: (STAGES, 1 + STAGES, WIDTH), whose column 0 multiplies
    `start`."""
    for i in range(ARM_ELEMENT_SETTINGS.stages):
        for lane in range(ARM_ELEMENT_SETTINGS.lane_count):
            c = minor * ARM_ELEMENT_SETTINGS.lane_count + lane
            values[minor, i, c] += start * eliminations[i, 0, c]


@compiled_for_vectors
def fill_drag_rates(W: float, coefficients: Array, values: Array, rates: Array) -> None:
    """Writes the terms proportional to w in the rates of s^m, theta^s and y^m, from the values of the minors
    at the previous power of w. values, rates: (MINORS, STAGES, WIDTH). coefficients: (6, STAGES, WIDTH). W:
    unit of w."""
    for i in range(ARM_ELEMENT_SETTINGS.stages):
        for c in range(ARM_ELEMENT_SETTINGS.width):
            transverse_drag = W * coefficients[GAMMA2, i, c]
            rotational_drag = W * coefficients[GAMMA3, i, c]
            rates[SM, i, c] = transverse_drag * values[YM, i, c] - rotational_drag * values[TS, i, c]
            rates[TS, i, c] = -transverse_drag * values[YT, i, c]
            rates[YM, i, c] = rotational_drag * values[YT, i, c]


@compiled_for_vectors
def add_theta_s_rates(F: float, start: float, coefficients: Array, values: Array, rates: Array) -> None:
    """Adds to the rates of theta^s, (STAGES, WIDTH), the term -c3 s^m, and F c3 times the start value of
    theta^m. coefficients, values: see the module docstring."""
    for i in range(ARM_ELEMENT_SETTINGS.stages):
        for c in range(ARM_ELEMENT_SETTINGS.width):
            rates[TS, i, c] -= coefficients[C3, i, c] * values[SM, i, c]
        # The elimination leaves out the start value of theta^m, so its share of theta^s is added here.
        for lane in range(ARM_ELEMENT_SETTINGS.lane_count):
            c = TM * ARM_ELEMENT_SETTINGS.lane_count + lane
            rates[TS, i, c] += F * start * coefficients[C3, i, c]


@compiled_for_vectors
def fill_theta_m_rates(coefficients: Array, values: Array, rates: Array) -> None:
    """Writes the rates -g theta^s of the minor theta^m, (STAGES, WIDTH); arguments: see the module
    docstring."""
    for i in range(ARM_ELEMENT_SETTINGS.stages):
        for c in range(ARM_ELEMENT_SETTINGS.width):
            rates[TM, i, c] = -coefficients[G, i, c] * values[TS, i, c]


@compiled_for_vectors
def add_rates_by_theta_m(F: float, start: float, coefficients: Array, values: Array, rates: Array) -> None:
    """Adds to the rates of theta^s and y^m, (STAGES, WIDTH) each, the terms with theta^m, and to the rates of
    y^m the term c2 s^m. The start value of theta^m in theta^s, already added, is subtracted.
    coefficients, values: see the module docstring."""
    for i in range(ARM_ELEMENT_SETTINGS.stages):
        for c in range(ARM_ELEMENT_SETTINGS.width):
            turn = values[TM, i, c]
            rates[TS, i, c] += F * coefficients[C3, i, c] * turn
            rates[YM, i, c] += (coefficients[G, i, c] + coefficients[NU, i, c]) * turn
            rates[YM, i, c] += coefficients[C2, i, c] * values[SM, i, c]
        for lane in range(ARM_ELEMENT_SETTINGS.lane_count):
            c = TM * ARM_ELEMENT_SETTINGS.lane_count + lane
            rates[TS, i, c] -= F * start * coefficients[C3, i, c]  # contained in `add_theta_s_rates`


@compiled_for_vectors
def fill_y_theta_rates(coefficients: Array, values: Array, rates: Array) -> None:
    """Writes the rates c3 y^m - c2 theta^s of the minor y^theta, (STAGES, WIDTH). coefficients, values:
    see the module docstring."""
    for i in range(ARM_ELEMENT_SETTINGS.stages):
        for c in range(ARM_ELEMENT_SETTINGS.width):
            rates[YT, i, c] = (
                coefficients[C3, i, c] * values[YM, i, c] - coefficients[C2, i, c] * values[TS, i, c]
            )


@compiled_for_vectors
def add_rates_by_y_theta(F: float, coefficients: Array, values: Array, rates: Array) -> None:
    """Adds to the rates of y^m, (STAGES, WIDTH), the term -F g y^theta; arguments: see the module
    docstring."""
    for i in range(ARM_ELEMENT_SETTINGS.stages):
        for c in range(ARM_ELEMENT_SETTINGS.width):
            rates[YM, i, c] -= F * coefficients[G, i, c] * values[YT, i, c]
