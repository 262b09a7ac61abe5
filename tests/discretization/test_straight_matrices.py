"""The straight rod's matrices of some components, against those of all components."""

import numpy as np
import pytest
from mixed_motion import mixed_form, whole_A

from rodsweep.discretization.straight.straight_matrices import (
    LONGITUDINAL_COMPONENTS,
    TRANSVERSE_COMPONENTS,
    StraightMatrices,
)
from rodsweep.model.rod import Rod

INF = np.inf
RODS = pytest.mark.parametrize(
    "rod",
    [
        Rod(F=40.0, k1=200.0, k2=1e4, gamma3=1e-4),
        Rod(F=75.0, k1=100.0, k2=5.0, gamma3=1.0),
        Rod(F=37.7, k1=INF, k2=INF, gamma3=0.0),
        Rod(F=-20.0, k1=1.5, k2=3.0, gamma3=1e-6),
    ],
)
MESHES = pytest.mark.parametrize("elements, order", [(1, 12), (1, 17), (2, 9), (5, 13), (9, 25)])
PARTS = pytest.mark.parametrize(
    "components, parity", [(LONGITUDINAL_COMPONENTS, 1), (TRANSVERSE_COMPONENTS, -1)]
)


def vectors(form, parity, seed=0):
    """Two complex random vectors of the components of a parity."""
    real, imag = np.random.default_rng(seed).normal(size=(2, 2, form.unknown_count))
    return np.where(form.reflection_signs == parity, real + 1j * imag, 0)


@RODS
@MESHES
@PARTS
def test_products_are_those_of_all_components(rod, elements, order, components, parity):
    form = mixed_form(rod.with_values(gamma1=0.7), elements, order)
    restricted = StraightMatrices(form, components)
    p, q = vectors(form, parity)
    A, M = whole_A(form), form.M
    for found, exact in ((restricted.times_A(q), A @ q), (restricted.times_M(q), M * q)):
        assert np.abs(found - exact).max() <= 1e-14 * np.abs(exact).max()
    size = np.abs(p) @ (np.abs(A) @ np.abs(q))
    assert size <= restricted.A_product_magnitude(p, q) * (1 + 1e-12) <= 2 * size


@pytest.mark.long
@pytest.mark.kernel
@RODS
@MESHES
@PARTS
@pytest.mark.parametrize("shift", [0.0, 190j, 3 + 2500j])
def test_solutions_are_those_of_all_components(rod, elements, order, components, parity, shift):
    form = mixed_form(rod.with_values(gamma1=0.7), elements, order)
    factors = StraightMatrices(form, components).lu_factors(shift)
    b, _ = vectors(form, parity)
    K = whole_A(form) - shift * np.diag(form.M)
    for matrix, x in ((K, factors.solve(b)), (K.conj().T, factors.solve(b, adjoint=True))):
        residual = np.abs(matrix @ x - b)[form.reflection_signs == parity]
        assert residual.max() <= 1e-13 * (np.abs(matrix) @ np.abs(x)).max()
        assert np.all(x[form.reflection_signs != parity] == 0)
