"""Local coefficients of arms as one array, compiled: twin of `RodMaterial.local_coefficients`. The overhead
of NumPy would take 4 % of the time of a certified spectrum, and 20 % for rubber."""

from collections.abc import Sequence

import numpy as np

from ..arrays import Array
from .base_coefficients import stiffnesses_and_drags_at_base
from .compiled.compilation import compiled
from .material.factors import factors_along
from .material.stress_strain import bending_factor_and_derivatives, shortening
from .parameters import NON_OPTIONAL_LINEAR_PARAMETER_NAMES
from .rod import Rod


def local_coefficient_array(rods: Sequence[Rod], u: Array, remainder: Array | None = None) -> Array:
    """The `LocalCoefficients` of n rods of one material at points u, (...,), as an array, (6, n, *u.shape),
    in the order of the fields. No point may be a break of the profile. remainder: exact coordinates of the
    points minus u; None: u is exact."""
    material = rods[0].material
    coefficients = np.empty((6, len(rods), u.size))
    for i, rod in enumerate(rods):
        at_base = stiffnesses_and_drags_at_base(rod.values)
        factors = factors_along(material.profile, rod.taper, u, remainder)
        _write_coefficients(
            material.law_number,
            tuple(float(at_base[name]) for name in NON_OPTIONAL_LINEAR_PARAMETER_NAMES),
            tuple(factors[name].ravel() for name in ("k1", "k2", "k3", "gamma2", "gamma3")),
            coefficients[:, i],
        )
    return coefficients.reshape(6, len(rods), *u.shape)


@compiled
def _write_coefficients(
    law: int, at_base: tuple[float, ...], factors: tuple[Array, ...], coefficients: Array
) -> None:
    """Writes `LocalCoefficients` into `coefficients`, (6, points). law: number of the law. at_base: F, k1, k2
    and gamma3 at the base. factors: of k1, k2, k3, gamma2 and gamma3, (points,) each."""
    F, k1, k2, gamma3 = at_base
    for i in range(coefficients.shape[1]):
        nu = 1 - shortening(law, F / (k1 * factors[0][i]))
        c2 = 1 / (k2 * factors[1][i])
        coefficients[0, i] = nu
        coefficients[1, i] = c2
        coefficients[2, i] = 1 / (factors[2][i] * bending_factor_and_derivatives(law, nu)[0])
        coefficients[3, i] = factors[3][i]
        coefficients[4, i] = gamma3 * factors[4][i]
        coefficients[5, i] = nu + F * c2
