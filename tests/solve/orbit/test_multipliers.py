"""Eigenvalues of matrices of low rank, against NumPy's of the whole matrix and against exact ones."""

from types import SimpleNamespace

import numpy as np
import pytest

from rodsweep.discretization.state_layout import plane_layout
from rodsweep.solve.orbit.matrix.multipliers import (
    FLOQUET_MULTIPLIER_SETTINGS,
    compressed_matrix,
    nonzero_eigenvalues,
)
from rodsweep.solve.orbit.matrix.shooting_intervals import ShootingIntervals
from rodsweep.solve.orbit.newton import error_of_largest_multiplier
from rodsweep.solve.orbit.symmetry import REFLECTION


def by_modulus(values):
    return values[np.lexsort((values.imag, values.real, -np.round(np.abs(values), 9)))]


@pytest.mark.parametrize("n, rank", [(1, 1), (12, 3), (45, 7), (60, 60)])
def test_the_nonzero_eigenvalues_are_those_of_the_whole_matrix(n, rank):
    rng = np.random.default_rng(n)
    A = rng.standard_normal((n, rank)) @ rng.standard_normal((rank, n)) / n
    found, exact = by_modulus(nonzero_eigenvalues(A)), by_modulus(np.linalg.eigvals(A))
    assert found[:rank] == pytest.approx(exact[:rank], abs=1e-12 * np.abs(exact[0]))
    assert np.abs(found[rank:]).max(initial=0.0) < 1e-13 * np.abs(exact[0])


def test_eigenvalues_of_any_size_are_right_to_the_largest_times_rounding():
    """As of a flow over a period: each is smaller by a factor, in directions that are not orthogonal."""
    n, rng = 40, np.random.default_rng(1)
    X = np.eye(n) + 0.3 * rng.standard_normal((n, n)) / np.sqrt(n)
    exact = 0.05 ** np.arange(n)
    found = nonzero_eigenvalues(X @ np.diag(exact) @ np.linalg.inv(X))
    found = found[np.argsort(-np.abs(found))]
    assert len(found) < n
    assert np.abs(found[:10] - exact[:10]).max() < 1e-13


def test_what_is_left_out_is_rounding():
    A = np.diag([1.0, 1e-8, 0.1 * FLOQUET_MULTIPLIER_SETTINGS.negligible_column_ratio, 0.0])
    assert compressed_matrix(A, FLOQUET_MULTIPLIER_SETTINGS.negligible_column_ratio).shape == (2, 2)
    assert sorted(nonzero_eigenvalues(A).real) == pytest.approx([1e-8, 1.0], rel=1e-14)
    assert nonzero_eigenvalues(np.zeros((3, 3))) == pytest.approx([0.0])


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_what_is_not_finite_is_refused(bad):
    A = np.eye(4)
    A[1, 2] = bad
    with pytest.raises(np.linalg.LinAlgError, match="not finite"):
        nonzero_eigenvalues(A)


def test_multipliers_over_legs_keep_their_digits_below_a_product_of_1e15():
    """Each leg is similar to a diagonal matrix, so that the product has known eigenvalues."""
    n, legs, rng = 12, 4, np.random.default_rng(2)
    layout = plane_layout(4)
    assert layout.unknown_count == n
    bases = [np.eye(n) + 0.3 * rng.standard_normal((n, n)) / np.sqrt(n) for _ in range(legs)]
    growths = 10.0 ** rng.uniform(-1, 1, (legs, n)) * np.geomspace(1e15, 1e-7, n) ** (1 / legs)
    turned = [*bases[1:], REFLECTION.matrix(layout) @ bases[0]]
    maps = [
        after @ np.diag(growth) @ np.linalg.inv(before)
        for before, growth, after in zip(bases, growths, turned, strict=True)
    ]
    orbit = SimpleNamespace(symmetry=REFLECTION, form=SimpleNamespace(layout=layout))
    found = np.sort(ShootingIntervals(tuple(range(legs + 1)), np.array(maps)).multipliers(orbit).real)
    assert found == pytest.approx(np.sort(growths.prod(axis=0)), rel=1e-8)


def test_change_of_the_largest_multiplier_is_not_its_distance_from_a_smaller_one():
    assert error_of_largest_multiplier(np.array([4e15, 1e3]), np.array([3e17, 5e15, 1e3])) == 3e17 - 4e15
    assert error_of_largest_multiplier(
        np.array([1.1j, -1.1j, 0.2]), np.array([1.0j, -1.0j])
    ) == pytest.approx(0.1)
    assert error_of_largest_multiplier(np.array([0.9, -0.8]), np.array([-0.9, 0.7])) == pytest.approx(0.2)
