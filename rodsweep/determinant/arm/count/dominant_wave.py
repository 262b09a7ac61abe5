"""The dominant wave Phi of an arm: log D(w) without the zeros of D, over distances of the size of |w|.

With the local exponents of the minors, +-sqrt(z+-) of `rodsweep.determinant.arm.local_waves`, D is about
exp(Phi), Phi = int sqrt(z+) du, times a factor that changes slowly where no eigenvalue is near.

If Im w > 0, then Im P > 0 and Im z+ > 0, so Phi has no branch point in the upper half plane. The count does
not require that Phi is close to log D: D is divided by exp(Phi), and Phi, a quadrature sum, is analytic.
"""

import cmath

from ....model.compiled.compilation import compiled, compiled_with_reordered_sums
from ..local_waves import ExponentSamples, sqrt_in_upper_half_plane


@compiled_with_reordered_sums
def dominant_wave_exponent(w: complex, samples: ExponentSamples) -> complex:
    """Phi(w) = int sqrt(z+) du of an arm, by quadrature over its samples; Im w > 0."""
    # Each factor has its own root: w (rate + bend w) can leave the sheet of the principal root.
    root = cmath.sqrt(w)
    a = root.real
    b = root.imag
    real = 0.0
    imag = 0.0
    for i in range(len(samples.quadrature_weights)):
        drag, load, rate, bend = samples.squared_exponent_coefficients[:, i]
        x, y = sqrt_in_upper_half_plane(rate + bend * w.real, bend * w.imag)
        x, y = sqrt_in_upper_half_plane(
            drag * w.real - load + 2 * (a * x - b * y), drag * w.imag + 2 * (a * y + b * x)
        )
        real += samples.quadrature_weights[i] * x
        imag += samples.quadrature_weights[i] * y
    return complex(real, imag)


@compiled
def dominant_exponent_slope(w: complex, samples: ExponentSamples) -> complex:
    """dPhi/dw of the dominant wave at w, Im w > 0."""
    root = cmath.sqrt(w)
    slope = 0j
    for i in range(len(samples.quadrature_weights)):
        drag, load, rate, bend = samples.squared_exponent_coefficients[:, i]
        P = root * cmath.sqrt(rate + bend * w)
        fastest = cmath.sqrt(drag * w - load + 2 * P)
        slope += samples.quadrature_weights[i] * (drag + (rate + 2 * bend * w) / P) / (2 * fastest)
    return slope
