"""The ingredients of the covering proof: each bound bounds what it says, each derivative is one."""

import math
from math import inf

import mpmath as mp
import numpy as np
import pytest

from rodsweep.determinant.certificate.box_of_all_eigenvalues import (
    frequency_bound,
    frequency_bound_on_path,
    zero_free_radius,
)
from rodsweep.determinant.certificate.covering import (
    box_outcome_and_costs,
    distance_from_zero_bound,
    zeros_and_open_boxes_of_covering,
)
from rodsweep.determinant.certificate.discs import bidisc_centre, bound_on_bidisc
from rodsweep.determinant.certificate.first_crossing_boxes import (
    first_crossing_boxes,
    path_intervals_of_bounded_change,
)
from rodsweep.determinant.parameter_path import (
    ParameterPath,
    coefficients_at,
    determinant_value_on_path,
    dispersion_coefficient_derivatives,
)
from rodsweep.determinant.roots.newton import eigenvalue_with_slope_and_error
from rodsweep.determinant.value import scaled_determinant
from rodsweep.model.rod import Rod

RODS = [
    Rod(F=30.0, k1=1e4, k2=1e4, gamma3=1e-4),
    Rod(F=25.0, k1=1e4, k2=1e2, gamma3=1e-2),
    Rod(F=120.0, k1=2e2, k2=1e4, gamma3=1e-4),
    Rod(F=40.0, k1=inf, k2=inf, gamma3=0.0),
    Rod(F=19.9, k1=20.0, k2=30.0, gamma3=1.0),
    Rod(F=-12.0, k1=50.0, k2=5.0, gamma3=3.0),
    Rod(F=60.0, k1=1e3, k2=50.0, gamma3=0.0),
]
PATHS = [
    pytest.param(ParameterPath(rod, name), id=f"{name}-{rod.F}")
    for rod in RODS
    for name in ("F", "k1", "k2", "gamma3")
    if math.isfinite(getattr(rod, name)) and getattr(rod, name) != 0
]


@pytest.mark.parametrize("path", PATHS)
def test_derivative_along_a_path_is_that_of_the_determinant(path):
    p = path.coordinate(getattr(path.rod, path.parameter_name))
    w = complex(-3.0, 41.0)
    assert coefficients_at(p, path.origin, path.direction) == pytest.approx(path.rod.coefficients, rel=1e-12)
    D, D_w, D_p, S, _ = determinant_value_on_path(w, path.rod.coefficients, path.direction)
    assert (D, D_w, S) == scaled_determinant(w, path.rod.coefficients)[:3]

    def value(x):
        D, _, there, _ = scaled_determinant(w, coefficients_at(x, path.origin, path.direction))
        return D * math.exp(there - S)

    h = 1e-3 * abs(p)
    difference = (8 * (value(p + h) - value(p - h)) - (value(p + 2 * h) - value(p - 2 * h))) / (12 * h)
    assert abs(D_p - difference) < 1e-7 * abs(D_p) + 1e-12 / abs(p)


@pytest.mark.parametrize("path", PATHS)
def test_a_small_error_of_the_path_variable_becomes_that_of_the_parameter(path):
    value = getattr(path.rod, path.parameter_name)
    p = path.coordinate(value)
    assert path.value_and_error(p, 0.0) == (pytest.approx(value, rel=1e-15), 0.0)
    error = 1e-6 * abs(p)
    apart = abs(path.value_and_error(p + error, 0.0)[0] - path.value_and_error(p - error, 0.0)[0]) / 2
    assert path.value_and_error(p, error)[1] == pytest.approx(apart, rel=1e-8)


@pytest.mark.long
@pytest.mark.parametrize("path", PATHS)
def test_bound_on_a_bidisc_holds_for_the_determinant_in_complex_p(path):
    """Against D with complex coefficients in mpmath, on the distinguished boundary, where the maximum is."""
    rng = np.random.default_rng(3)
    p = path.coordinate(getattr(path.rod, path.parameter_name))
    c, direction = path.rod.coefficients, path.direction
    sharpest = inf
    for eta in (2.0, 190.0, 2500.0):
        w = complex(0.0, eta)
        D, D_w, D_p, S, _ = determinant_value_on_path(w, c, direction)
        centre = bidisc_centre(w, c, dispersion_coefficient_derivatives(c, direction), S)
        for share in (0.3, 0.05):
            for rates in ((0j, 0j), (D_w / D, D_p / D)):
                radii = share * eta, share * abs(p)
                bound = bound_on_bidisc(centre, rates, radii)
                if not math.isfinite(bound):
                    continue
                largest = 0.0
                for a, b in rng.uniform(0, 2 * np.pi, (12, 2)):
                    dw, dp = radii[0] * np.exp(1j * a), radii[1] * np.exp(1j * b)
                    value = complex_determinant(w + dw, path, p + dp)
                    value *= mp.exp(-mp.mpmathify(complex(rates[0] * dw + rates[1] * dp)) - S)
                    largest = max(largest, float(abs(value)))
                assert largest <= bound
                sharpest = min(sharpest, bound / largest)
    assert sharpest < 30  # a bound that is far too large would prove nothing


def complex_determinant(w, path, p):
    """D at complex w and p, from the formula in `rodsweep.determinant.value`, in 30 digits."""
    with mp.workdps(30):
        w, p = mp.mpmathify(complex(w)), mp.mpmathify(complex(p))
        F, nu, c2, gamma3 = (mp.mpf(a) + p * b for a, b in zip(path.origin, path.direction, strict=True))
        g = nu + F * c2
        P = mp.sqrt(w * (g * nu + c2 * gamma3 * w))
        D = mp.mpf(1)
        for sign in (1, -1):
            z = (c2 + gamma3) * w - F * g + sign * 2 * P
            slope = c2 + gamma3 + sign * (g * nu + 2 * c2 * gamma3 * w) / P
            D += w / 2 * slope * (mp.cosh(mp.sqrt(z)) - 1) / z
        return D


def test_distance_of_a_parallelogram_from_zero():
    """Exact along its sides, never too large, zero where it holds zero."""
    assert distance_from_zero_bound(5 + 0j, 1 + 0j, 1j) == pytest.approx(4.0)
    assert distance_from_zero_bound(0.5 + 0.5j, 1 + 0j, 1j) == 0.0
    rng = np.random.default_rng(8)
    for _ in range(200):
        value, a, b = rng.normal(size=3) + 1j * rng.normal(size=3)
        grid = np.linspace(-1, 1, 41)
        nearest = np.abs(value + grid[:, None] * a + grid[None, :] * b).min()
        assert distance_from_zero_bound(value, a, b) <= nearest + 1e-12


@pytest.mark.parametrize("path", PATHS)
def test_no_box_with_a_crossing_is_called_empty_and_regular_ones_hold_one_at_most(path):
    """Boxes about known crossings of a path, of random size and offset."""
    rng = np.random.default_rng(11)
    value = getattr(path.rod, path.parameter_name)
    shares = (
        (1.01, 2.0) if path.parameter_name == "k1" else (0.5, min(1.5, 0.99 * path.rod.k1 / abs(path.rod.F)))
    )
    low, high = sorted(path.coordinate(share * value) for share in shares)
    zeros, left, _ = zeros_and_open_boxes_of_covering(
        first_crossing_boxes(path, low, high), path.origin, path.direction
    )
    assert not left
    for eta, p, *_ in zeros:
        for scale in 10.0 ** rng.uniform(-6, 0, 20):
            half = scale * eta * rng.uniform(0.1, 1), scale * abs(p) * rng.uniform(0.1, 1)
            at = eta + half[0] * rng.uniform(-1, 1), p + half[1] * rng.uniform(-1, 1)
            if at[0] <= half[0]:
                continue
            kind = box_outcome_and_costs(
                complex(0, at[0]), coefficients_at(at[1], path.origin, path.direction), path.direction, half
            )[0]
            assert kind != 0
            if kind == 1:
                near = [
                    z for z in zeros if abs(z[0] - at[0]) < 2 * half[0] and abs(z[1] - at[1]) < 2 * half[1]
                ]
                assert len(near) <= 1


@pytest.mark.parametrize("path", PATHS)
def test_a_priori_bounds_over_a_path_hold_at_each_of_its_rods(path):
    value = getattr(path.rod, path.parameter_name)
    shares = (1.01, 2.5) if path.parameter_name == "k1" else (0.4, 0.99)
    ends = sorted(path.coordinate(share * value) for share in shares)
    largest = frequency_bound_on_path(path, *ends)
    radius = zero_free_radius(path, *ends, 1e3)
    assert radius > 0
    for p in np.linspace(*ends, 9):
        rod = path.rod_at(float(p))
        assert frequency_bound(rod) <= largest * (1 + 1e-12)
        for eta in radius * np.array([1e-6, 0.1, 0.5, 1.0]):
            D, _, S, _ = scaled_determinant(complex(0, eta), rod.coefficients)
            assert abs(D * math.exp(S) - 1) < 0.5


def test_slabs_reach_from_end_to_end_and_grow_finer_towards_a_crushed_rod():
    path = ParameterPath(Rod(F=0.0, k1=100.0, k2=1e4, gamma3=1e-4), "F")
    parts = path_intervals_of_bounded_change(path, 0.0, 99.9999)
    assert parts[0][0] == 0.0
    assert parts[-1][1] == 99.9999
    assert all(a[1] == b[0] for a, b in zip(parts[:-1], parts[1:], strict=True))
    assert all(100 - b > 0.49 * (100 - a) for a, b in parts[:-1])


@pytest.mark.parametrize("ends", [(0.0, 5e-324), (0.0, 1e-323), (30.0, 30.000000000000004)])
def test_a_path_of_one_rounding_is_one_interval(ends):
    """The steps along it were 0, and their number had no end."""
    path = ParameterPath(Rod(F=30.0, k1=1e4, k2=1e4, gamma3=1e-4), "F")
    assert path_intervals_of_bounded_change(path, *ends) == [ends]


def test_an_eigenvalue_and_its_slope_along_the_force():
    path = ParameterPath(RODS[0], "F")
    w, slope, error = eigenvalue_with_slope_and_error(
        complex(-60, 150), path.rod.coefficients, path.direction
    )
    assert error < 1e-11
    h = 1e-4
    after, before = (
        eigenvalue_with_slope_and_error(
            w + s * slope, coefficients_at(30 + s, path.origin, path.direction), path.direction
        )[0]
        for s in (h, -h)
    )
    assert (after - before) / (2 * h) == pytest.approx(slope, rel=1e-7)
