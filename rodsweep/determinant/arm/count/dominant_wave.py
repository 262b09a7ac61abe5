"""The fastest growing exponential of D along an arm: how D changes over distances of the size of |w|.

With the local exponents of the minors, +-sqrt(z+-), D is about exp(Phi), Phi = int sqrt(z+) du, times a
factor that changes slowly where no eigenvalue is near:

    z+- = T x - F c3 g +- 2 P,   P = sqrt(x) sqrt(g nu + X x),   x = w gamma2 c3,
    T = c2/c3 + gamma3/gamma2,   X = (c2/c3) (gamma3/gamma2).

For Im w > 0 is Im P > 0 and Im z+ > 0: Phi has no branch point in the upper half plane. Nothing rests on Phi
being close to log D: the count divides D by exp(Phi), and Phi is analytic, whatever its quadrature.
"""

import cmath

from ....model.compiled.compilation import compiled
from ..determinant import ArmSamples


@compiled
def dominant_wave(w: complex, samples: ArmSamples) -> complex:
    """Phi at w, Im w > 0."""
    exponent = 0j
    for i in range(len(samples.weights)):
        nu, c2, c3, gamma2, gamma3, g = samples.local[:, i]
        X = c2 / c3 * gamma3 / gamma2
        x = w * gamma2 * c3
        P = cmath.sqrt(x) * cmath.sqrt(g * nu + X * x)
        square = (c2 / c3 + gamma3 / gamma2) * x - samples.F * c3 * g + 2 * P
        exponent += samples.weights[i] * cmath.sqrt(square)
    return exponent


@compiled
def slope_of_wave(w: complex, samples: ArmSamples) -> complex:
    """dPhi/dw at w, Im w > 0."""
    slope = 0j
    for i in range(len(samples.weights)):
        nu, c2, c3, gamma2, gamma3, g = samples.local[:, i]
        T = c2 / c3 + gamma3 / gamma2
        X = c2 / c3 * gamma3 / gamma2
        x = w * gamma2 * c3
        P = cmath.sqrt(x) * cmath.sqrt(g * nu + X * x)
        root = cmath.sqrt(T * x - samples.F * c3 * g + 2 * P)
        slope += samples.weights[i] * (T + (g * nu + 2 * X * x) / P) / (2 * root) * gamma2 * c3
    return slope
