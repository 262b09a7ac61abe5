"""The exact numbers of this directory against others that were obtained in another way."""

import mpmath as mp
import numpy as np
import pytest
from reference import determinant as reference

from .adjoint import condition
from .exact import leading, unstable
from .rods import EXCEPTIONAL, at_force


def test_leading_eigenvalues_are_the_stored_ones(reference_spectra):
    """Without a pull beyond the shear stiffness, whose layers the dense mesh does not resolve."""
    compared = 0
    for point in reference_spectra[::12]:
        rod = tuple(float(point[name]) for name in ("F", "k1", "k2", "gamma3"))
        if rod[0] < 0:
            continue
        stored = [mp.mpc(*w) for w in point["eigenvalues"][:4]]
        found = leading(rod, 4)
        assert max(abs(a - b) / abs(b) for a, b in zip(found, stored, strict=True)) < 1e-15, rod
        assert unstable(rod) == point["unstable"]
        compared += 1
    assert compared > 30


def test_two_evaluations_of_d_agree_at_the_roots():
    """One sums a Taylor series and one closed exponentials; both vanish to 25 digits."""
    for rod in ((30.0, 1e4, 1e4, 1e-4), (2000.0, 1e4, 1e4, 1e-4), (9.0, 1e4, 0.5, 10.0)):
        for w in leading(rod, 4)[::2]:
            with mp.workdps(60):
                beside = w * (1 + mp.mpf(10) ** -25)
                for D in (reference.D, reference.D_wedge):
                    assert abs(D(w, *rod, 60)) < 1e-3 * abs(D(beside, *rod, 60))


def test_the_pair_at_a_stored_onset_is_double():
    *rod, event = EXCEPTIONAL[0]
    first, second = leading(at_force(event["F"], 0, *rod), 4)[:2]
    assert abs(first - second) < 1e-6 * abs(first)
    assert float(mp.re(first)) == pytest.approx(float(event["rate"]), rel=1e-6)


def test_condition_numbers_at_rest_are_one_and_grow_like_the_inverse_distance_at_a_double_root():
    for rod in ((0.0, 1e4, 1e2, 1e-2), (0.0, 1e4, 1e2, 0.0)):
        assert abs(condition(rod, leading(rod, 4)[0]) - 1) < mp.mpf(10) ** -25
    *rod, event = EXCEPTIONAL[0]
    products = []
    for offset in (1e-6, 1e-8):
        w = leading(at_force(event["F"], offset, *rod), 4)
        products.append(float(abs(w[0] - w[1]) * condition(at_force(event["F"], offset, *rod), w[0])))
    assert np.ptp(products) < 1e-4 * products[0]
