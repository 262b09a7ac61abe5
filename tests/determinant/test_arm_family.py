"""Interpolated propagators against those of the arm itself."""

import numpy as np
import pytest
from reference.random_arms import random_arm

from rodsweep.determinant.arm.arm_family import interpolated_family
from rodsweep.determinant.arm.arm_family_values import (
    determinant_of_family_arm,
    eigenvalue_of_family_arm,
    write_propagators,
)
from rodsweep.determinant.arm.determinant import ArmDeterminant
from rodsweep.determinant.arm.determinant_along_path import ArmAlongPath
from rodsweep.determinant.arm.newton import refine_eigenvalue_and_error
from rodsweep.determinant.arm.value import path_value_from_propagators
from rodsweep.determinant.parameter_path import ParameterPath
from rodsweep.model.material.profile import Profile
from rodsweep.model.material.rod_material import RodMaterial
from rodsweep.model.rod import Rod
from rodsweep.solve.changes.thresholds_along_path import find_imaginary_axis_crossings
from rodsweep.solve.spectrum.search import SpectrumRequest, solve_spectrum

PLACES = (-3.0 + 0j, 60j, -300 + 70j, -2000 + 0j, 3000 + 100j)


def along(family, w, p):
    shape = family.chebyshev_coefficients.shape[1:]
    polynomials, changes = np.empty(shape), np.empty(shape)
    write_propagators(family, p, polynomials, changes)
    return path_value_from_propagators(w, family.largest_w, polynomials, changes)


@pytest.mark.parametrize("name", ["F", "k1", "k2", "gamma3", "taper"])
@pytest.mark.parametrize("seed", range(3))
def test_families_have_the_determinants_of_their_arms_and_their_slopes(name, seed):
    rng = np.random.default_rng(seed)
    path = ParameterPath(random_arm(rng, pulled=0.0), name)
    p = path.coordinate(getattr(path.rod, name))
    low, high = sorted((p, p * (0.4 if name == "F" else 0.8)))
    family = interpolated_family(path, low, high, 4.0**6)
    assert family is not None
    between = ArmAlongPath(path)
    for share in (0.0, 0.31, 0.77, 1.0):
        p = low + share * (high - low)
        arm = ArmDeterminant(path.rod_at(p))
        for w in PLACES:
            here, own = along(family, w, p), arm.value(w)
            scale = np.exp(here.log_scale - own.log_scale)
            blur = 1e-13 + 20 * own.rounding_error / abs(own.D)
            assert abs(here.D * scale / own.D - 1) < blur
            assert abs(here.D_w * scale / own.D_w - 1) < 20 * blur
            assert determinant_of_family_arm(family, w, p).D == here.D
            if 0 < share < 1:
                slope = between.derivative_by_p(w, p, own.log_scale)
                assert abs(here.D_p * scale - slope) < 1e-5 * (abs(slope) + abs(own.D / p))


def test_a_family_of_compressed_rubber_is_spaced_by_the_force():
    """Equal steps would need an interval of a tenth of the length."""
    rod = Rod(F=0.0, k1=20.0, k2=200.0, gamma3=1e-2, taper=0.9, material=RodMaterial("neo_hookean", "fixed"))
    path = ParameterPath(rod, "F")
    family = interpolated_family(path, 0.0, 60.0, 4.0**5)
    assert family is not None
    assert family.log_spacing_scale < np.inf
    for p in (0.0, 0.3, 7.0, 31.0, 60.0):
        own = ArmDeterminant(path.rod_at(p))
        for w in (-3.0 + 0j, 60j, -300 + 70j):
            here, value = along(family, w, p), own.value(w)
            assert (
                abs(here.D * np.exp(here.log_scale - value.log_scale) - value.D)
                < 1e-13 + 20 * value.rounding_error
            )
            if 0 < p < 60:
                slope = ArmAlongPath(path).derivative_by_p(w, p, value.log_scale)
                assert here.D_p * np.exp(here.log_scale - value.log_scale) == pytest.approx(
                    slope, rel=1e-5, abs=1e-8
                )


def test_eigenvalues_of_a_family_are_those_of_the_arm_within_their_errors():
    path = ParameterPath(Rod(F=15.0, k1=1e4, k2=1e4, gamma3=1e-4, taper=0.5), "F")
    family = interpolated_family(path, 10.0, 20.0, 4.0**5)
    w, slope, error = eigenvalue_of_family_arm(family, -1.0 + 175j, 15.4627583986)
    assert abs(w - 175.530930682j) < 1e-8
    own = ArmAlongPath(path).eigenvalue_with_slope_and_error(w, 15.4627583986)
    assert abs(w - own[0]) <= 4 * (error + own[2])
    assert slope == pytest.approx(own[1], rel=1e-6)


def test_an_interval_too_long_for_polynomials_has_no_family():
    rod = Rod(F=1.0, k1=1.0, k2=1e3, gamma3=1e-3, taper=0.9, material=RodMaterial("neo_hookean", "swelling"))
    path = ParameterPath(rod, "F")
    assert interpolated_family(path, -30.0, 300.0, 4.0**5) is None
    assert interpolated_family(path, 1.0, 1.3, 4.0**5) is not None


def test_errors_of_double_eigenvalues_hold_where_minors_are_large_amid_the_arm():
    """The noise of D at the tip shows a tenth of the error, which interpolation of propagators makes."""
    factors = ((1.0, 1.0, 1.0), (1.34, 0.956, 0.746), (2.66, 0.633, 0.243), (2.08, 0.483, 0.209))
    factors += ((1.29, 0.56, 0.381), (1.3, 0.722, 0.323), (0.999, 2.48, 0.397), (1.03, 1.82, 0.453))
    u = (0.0, 0.23, 0.23, 0.45, 0.45, 0.71, 0.71, 1.0)
    material = RodMaterial(
        "neo_hookean", "fixed", Profile(u, tuple((*row, 1.0, 1.0, 1.0) for row in factors))
    )
    path = ParameterPath(Rod(F=20.0, k1=151.37, k2=10.358, gamma3=0.08934, material=material), "F")
    family = interpolated_family(path, 0.0, 60.0, 4.0**8)
    of_family = ArmAlongPath(path, lambda p: family).double_eigenvalue(254.4652, 22.71770, 0.5)
    of_arms = ArmAlongPath(path).double_eigenvalue(254.4652, 22.71770, 0.5)
    assert abs(of_family.p - of_arms.p) <= of_family.error_of_p + of_arms.error_of_p < 1e-9


RUBBER_CONE = Rod(
    F=1.0, k1=2000.0, k2=30.0, gamma3=1e-3, taper=0.6, material=RodMaterial("neo_hookean", "fixed")
)
SOFT_IN_SHEAR = Rod(F=1.0, k1=664.0, k2=1.05, gamma3=0.0017, material=RodMaterial("neo_hookean", "fixed"))


@pytest.mark.parametrize("rod", [RUBBER_CONE, SOFT_IN_SHEAR], ids=["cone", "soft in shear"])
def test_eigenvalues_at_the_low_end_of_a_long_interval_are_within_their_errors(rod):
    """Interpolation errors are relative to the largest force of the interval."""
    path = ParameterPath(rod, "F")
    family = interpolated_family(path, 0.0, 400.0, 4.0**8)
    for F in (0.1, 0.4, 1.3, 2.4):
        arm = ArmDeterminant(path.rod_at(F))
        for guess in solve_spectrum(
            path.rod_at(F), SpectrumRequest(4, 1e-8, certify=False)
        ).eigenvalues.tolist():
            own, own_error = refine_eigenvalue_and_error(guess, arm)
            w, _, error = eigenvalue_of_family_arm(family, guess, F)
            assert abs(w - own) <= error + own_error < 1e-11 * abs(w)


@pytest.mark.parametrize(
    "rod, x, F", [(RUBBER_CONE, -39.1, 5.08), (SOFT_IN_SHEAR, -6.17, 2.49)], ids=["cone", "soft in shear"]
)
def test_double_eigenvalues_have_no_interpolation_error(rod, x, F):
    """Newton's method ends with D of the arms themselves: D of the family alone is off by up to 1e-12."""
    path = ParameterPath(rod, "F")
    family = interpolated_family(path, 0.0, 400.0, 4.0**8)
    by_family = ArmAlongPath(path, lambda p: family).double_eigenvalue(x, F, 0.1)
    own = ArmAlongPath(path).double_eigenvalue(x, F, 0.1)
    assert abs(by_family.p - own.p) <= by_family.error_of_p + own.error_of_p < 1e-14 * 2 * F
    assert abs(by_family.eta_or_x - own.eta_or_x) <= by_family.error_of_eta_or_x + own.error_of_eta_or_x


def test_hopf_points_of_rubber_that_is_very_soft_in_shear_are_within_their_errors():
    """Small entries of propagators have larger truncation than rounding errors here. F by the closed form of
    D with 40 digits."""
    rod = Rod(F=0.0, k1=60.0, k2=0.3, gamma3=1.0, material=RodMaterial("neo_hookean", "swelling"))
    found = find_imaginary_axis_crossings(ParameterPath(rod, "F"), 0.0, 400.0).thresholds
    near = min(found, key=lambda one: abs(one.value - 57))
    assert abs(near.value - 56.9264722670805158) <= near.error < 1e-11
