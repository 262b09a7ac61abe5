"""Local exponents of D along an arm: exponents of a uniform rod with the coefficients at a point of the arm.

The minors of `rodsweep.determinant.arm.elements.collocation` grow like exp(+-sqrt(z+-) u), with

    z+- = (c2 gamma2 + c3 gamma3) w - F c3 g +- 2 P,
    P^2 = w (g nu gamma2 c3 + c2 c3 gamma2 gamma3 w).
"""

import math
from typing import NamedTuple

import numpy as np

from ...arrays import Array, Complex
from ...model.compiled.compilation import compiled, compiled_with_reordered_sums
from ...model.material.rod_material import LocalCoefficients
from ..exponents import EXPONENT_SETTINGS


class ExponentSamples(NamedTuple):
    """Coefficients of z+-(w), the squared exponents of the module docstring, at points along an arm, and the
    weights of a quadrature over these points.

    squared_exponent_coefficients: (4, points), rows c2 gamma2 + c3 gamma3, F c3 g, g nu gamma2 c3, and c2 c3
    gamma2 gamma3, so that z+- = row 0 w - row 1 +- 2 P and P^2 = row 2 w + row 3 w^2. quadrature_weights:
    (points,).
    """

    squared_exponent_coefficients: Array
    quadrature_weights: Array


def exponent_samples(F: float | Array, coefficients: LocalCoefficients, weights: Array) -> ExponentSamples:
    """Samples of an arm from the force F, its coefficients at points, (points,), and weights, (points,). For
    n arms, F is (n, 1), each coefficient (n, points), and `squared_exponent_coefficients` (4, n, points)."""
    nu, c2, c3, gamma2, gamma3, g = coefficients
    shear = c2 * gamma2
    rotation = c3 * gamma3
    return ExponentSamples(
        np.array([shear + rotation, F * c3 * g, g * nu * gamma2 * c3, shear * rotation]), weights
    )


@compiled_with_reordered_sums
def sqrt_in_upper_half_plane(real: float, imag: float) -> tuple[float, float]:
    """(real part, imaginary part) of the square root of real + i imag, imag >= 0."""
    # The larger part comes from a sum of positive terms; the smaller then follows without cancellation.
    larger = math.sqrt((math.sqrt(real * real + imag * imag) + abs(real)) / 2)
    smaller = imag / (2 * max(larger, EXPONENT_SETTINGS.min_divisor))
    return (larger, smaller) if real >= 0 else (smaller, larger)


@compiled_with_reordered_sums
def modulus_of_parts(real: float, imag: float) -> float:
    """Modulus of the number real + i imag."""
    return math.sqrt(real * real + imag * imag)


@compiled_with_reordered_sums
def mean_wave_number_and_w_scale(w: complex, samples: ExponentSamples) -> tuple[float, float]:
    """Returns (wave number, scale of w) at w. wave number, in 1/L: mean along the arm of (|sqrt z+| + |sqrt
    z-|)/2, a local bound of |q| for eigenfunctions exp(+-q u). scale of w, in 1/tau2: change of w over which
    an exponent of D changes by about 1: the reciprocal of the mean along the arm of the larger |d
    sqrt(z+-)/dw|."""
    wave_number = 0.0
    rate_sum = 0.0
    a = w.real
    b = w.imag
    for i in range(len(samples.quadrature_weights)):
        linear, constant, square_linear, square_quadratic = samples.squared_exponent_coefficients[:, i]
        x, y = sqrt_in_upper_half_plane(
            a * (square_linear + square_quadratic * a) - square_quadratic * b * b,
            b * (square_linear + 2 * square_quadratic * a),
        )
        P = modulus_of_parts(x, y)
        first_root = math.sqrt(modulus_of_parts(linear * a - constant + 2 * x, linear * b + 2 * y))
        second_root = math.sqrt(modulus_of_parts(linear * a - constant - 2 * x, linear * b - 2 * y))
        # Where both squares are close D depends on P^2, which has no branch point, and not on P.
        inverse_scale = 1 / (max(P, EXPONENT_SETTINGS.min_divisor) * max(P, 1.0, first_root, second_root))
        slope = square_linear + 2 * square_quadratic * a
        real_rate = inverse_scale * (slope * x + 2 * square_quadratic * b * y)
        imag_rate = inverse_scale * (2 * square_quadratic * b * x - slope * y)
        rates = (
            modulus_of_parts(linear + real_rate, imag_rate) / max(1.0, first_root),
            modulus_of_parts(linear - real_rate, imag_rate) / max(1.0, second_root),
        )
        wave_number += samples.quadrature_weights[i] * (first_root + second_root) / 2
        rate_sum += samples.quadrature_weights[i] * max(rates[0], rates[1]) / 2
    return wave_number, 1 / max(rate_sum, EXPONENT_SETTINGS.min_divisor)


@compiled
def mean_wave_numbers_and_w_scales(w: Complex, samples: ExponentSamples) -> Array:
    """Wave numbers, row 0, and scales of w, row 1, of `mean_wave_number_and_w_scale` at every w: (2, n). w:
    (n,), conjugates next to each other."""
    results = np.empty((2, len(w)))
    for n in range(len(w)):
        # Conjugates, which stand next to each other, have the same scales.
        if n > 0 and w[n] == w[n - 1].conjugate():
            results[:, n] = results[:, n - 1]
        else:
            results[:, n] = mean_wave_number_and_w_scale(w[n], samples)
    return results
