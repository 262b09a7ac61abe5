"""Counts, hulls and roots of arms against another discretisation and the closed form."""

import numpy as np
import pytest
from reference.dense_arm import eigenvalues
from reference.random_arms import random_arm
from surveyed import RODS

from rodsweep.determinant.arm.count.count import count_right_of
from rodsweep.determinant.arm.count.modes_near_axis import modes_near_axis
from rodsweep.determinant.arm.determinant import ArmDeterminant
from rodsweep.determinant.arm.hull.averaged_weight import regions_from_averaged_weights
from rodsweep.determinant.arm.hull.hull import hull_of
from rodsweep.determinant.arm.hull.region import EigenvalueHull, hull_distance_and_normal
from rodsweep.determinant.arm.mesh_eigenvalue_refinement import refine_mesh_eigenvalues
from rodsweep.determinant.arm.newton import refine_eigenvalue_and_error, root_error
from rodsweep.determinant.certificate.box_of_all_eigenvalues import box_of_all_eigenvalues, frequency_bound
from rodsweep.determinant.certificate.winding_number import count_right_of as count_of_uniform
from rodsweep.model.material.profile import Profile
from rodsweep.model.material.rod_material import RodMaterial
from rodsweep.model.rod import Rod

STEP = Profile((0.0, 0.4, 0.4, 1.0), ((1.0,) * 6, (1.0,) * 6, (0.1,) * 6, (0.1,) * 6))
SOFT_ROW = (0.1, 0.01, 0.1, 0.1, 0.1, 0.1)
SOFT_STEP = Profile((0.0, 0.4, 0.4, 1.0), ((1.0,) * 6, (1.0,) * 6, SOFT_ROW, SOFT_ROW))


def line_in_gap(w, behind=3):
    """A line between eigenvalues, in a gap that dense eigenvalues can tell."""
    at = next(i for i in range(behind, behind + 9) if w[i].real - w[i + 1].real > 0.02 * abs(w[i + 1].real))
    return min(float(w[at].real + w[at + 1].real) / 2, 0.0)


@pytest.mark.parametrize("seed", range(max(12, RODS // 10)))
def test_counts_and_hulls_agree_with_dense_eigenvalues(seed):
    rng = np.random.default_rng(seed)
    for _ in range(4):
        rod = random_arm(rng)
        hull, determinant, w = hull_of(rod), ArmDeterminant(rod), eigenvalues(rod)
        for value in w[:8]:
            assert hull_distance_and_normal(complex(value.real, abs(value.imag)), hull.a, hull.c)[
                0
            ] <= 1e-6 * abs(value)
        line = line_in_gap(w)
        counted = count_right_of(line, determinant, hull)
        assert counted.number == int((w.real > line).sum()), (rod, rod.material, counted)


@pytest.mark.parametrize("seed", range(4))
def test_uniform_rods_are_counted_as_by_the_closed_form(seed):
    rng = np.random.default_rng(seed)
    for _ in range(5):
        k1, k2 = (float(10 ** rng.uniform(1.5, 5)) for _ in range(2))
        F = float(min(10 ** rng.uniform(0, 3), 0.9 * k1))
        rod = Rod(F=F, k1=k1, k2=k2, gamma3=float(10 ** rng.uniform(-5, 0)))
        line = -float(10 ** rng.uniform(1, 4))
        found = count_right_of(line, ArmDeterminant(rod), hull_of(rod))
        assert found.number == count_of_uniform(line, rod).number


@pytest.mark.parametrize(
    "rod",
    [
        Rod(F=37.0, k1=1e4, k2=1e4, gamma3=1e-4),
        Rod(F=90.0, k1=100.0, k2=20.0, gamma3=0.5),
        Rod(F=30.0, k1=np.inf, k2=np.inf, gamma3=0.0),
        Rod(F=30.0, k1=200.0, k2=50.0, gamma3=0.0),
    ],
)
def test_hull_of_a_uniform_rod_has_the_box_of_the_closed_form(rod):
    hull = hull_of(rod)
    assert hull.c == 0
    assert hull.a == pytest.approx(1.05 * frequency_bound(rod) ** 0.5, rel=1e-9)
    for own, closed in zip(hull.box(30.0), box_of_all_eigenvalues(rod, 30.0), strict=True):
        assert closed <= own <= 1.15 * closed


@pytest.mark.parametrize("share", [0.0, 0.3, 0.8])
def test_clearance_is_no_more_than_the_distance_from_the_hull(share):
    rng = np.random.default_rng(1)
    hull = EigenvalueHull(7.0, share)
    n = np.linspace(0, 200, 40_001)
    for _ in range(40):
        w = complex(rng.uniform(-300, 100), rng.uniform(0, 300))
        distance, normal = hull_distance_and_normal(w, hull.a, hull.c)
        if distance <= 0:
            continue
        x, y = hull.a * n - (1 - hull.c) * n**2, hull.a * n + hull.c * n**2
        assert ((w.real - x) * normal.real + (w.imag - y) * normal.imag).min() >= distance * (1 - 1e-6)
        assert abs(normal) == pytest.approx(1)


def test_stepped_arm_without_rotational_drag_is_bounded_by_its_clamp():
    """No best weight is continuous across the jump; theta(0) = 0 bounds what is left."""
    stiff = Rod(F=2.0, k1=1e4, k2=1e4, gamma3=0.0, material=RodMaterial(profile=STEP))
    assert 0 < hull_of(stiff).c < 0.5
    count = count_right_of(-100.0, ArmDeterminant(stiff), hull_of(stiff))
    reference = eigenvalues(Rod(F=2.0, k1=1e4, k2=1e4, gamma3=1e-9, material=RodMaterial(profile=STEP)))
    assert count.number == int((reference.real > -100.0).sum())


def test_without_a_bound_no_count_is_given():
    pulled = Rod(F=-3.0, k1=1e4, k2=1.0, gamma3=0.0, material=RodMaterial(profile=STEP))
    assert hull_of(pulled).a == np.inf
    refused = count_right_of(-1.0, ArmDeterminant(pulled), hull_of(pulled))
    assert refused.number is None
    assert refused.failure_reason == "no a-priori bound on the eigenvalues applies to this rod at F = -3"


@pytest.mark.parametrize("gamma3", [0.0, 1e-5, 1e-2])
@pytest.mark.parametrize("F", [2.0, 4.0])
def test_arms_with_soft_segments_are_bounded_and_counted_with_and_without_known_modes(F, gamma3):
    """Of the tip's growing modes those close to the line are divided out of D, or none."""
    rod = Rod(F=F, k1=1e4, k2=1.0, gamma3=gamma3, material=RodMaterial(profile=SOFT_STEP))
    dense = eigenvalues(rod if gamma3 else Rod(F=F, k1=1e4, k2=1.0, gamma3=1e-9, material=rod.material), 10)
    hull, determinant = hull_of(rod), ArmDeterminant(rod)
    for value in dense[:12]:
        assert hull_distance_and_normal(complex(value.real, abs(value.imag)), hull.a, hull.c)[
            0
        ] <= 1e-6 * abs(value)
    line = line_in_gap(dense, int((dense.real > 0).sum()))
    number = int((dense.real > line).sum())
    found = refine_mesh_eigenvalues(dense[: number + 2].astype(complex), determinant, hull, 400.0)
    alone = count_right_of(line, determinant, hull)
    fast = count_right_of(line, determinant, hull, found.w, found.error)
    one_less = count_right_of(line, determinant, hull, found.w[2:], found.error[2:])
    assert (alone.number, fast.number, one_less.number) == (number,) * 3
    assert max(fast.node_count, alone.node_count) < 65  # without the dominant wave 84 and 135 in four cases


@pytest.mark.long
@pytest.mark.parametrize("F", [4.5, 12.0])
def test_modes_beside_the_axis_are_those_of_the_dense_eigenvalues(F):
    rod = Rod(F=F, k1=1e5, k2=100.0, gamma3=1e-3, taper=0.117)
    dense = eigenvalues(rod, 24)
    beside = dense[(dense.imag > 0) & (dense.imag < 3000) & (np.abs(dense.real) < 0.3 * dense.imag)]
    found = modes_near_axis(ArmDeterminant(rod), 3000.0, np.empty(0, complex))
    assert len(beside) == 1
    np.testing.assert_allclose(found, beside, rtol=1e-7)


@pytest.mark.parametrize("W", [30.0, 60.0, 120.0, 220.0])
def test_a_count_ends_whichever_elements_exist(W):
    """Elements for |w| <= W that serve |w| = 16 are too many for smaller |w|, and yet the smallest."""
    rod = Rod(F=0.4, k1=1e5, k2=1.0, gamma3=1e-3, taper=0.1)
    alone = count_right_of(-1.3, ArmDeterminant(rod), hull_of(rod))
    determinant = ArmDeterminant(rod)
    determinant.propagators_for(W)
    assert count_right_of(-1.3, determinant, hull_of(rod)).number == alone.number


@pytest.mark.parametrize("seed", range(6))
def test_roots_are_those_of_the_mesh_and_within_their_errors_on_a_finer_grid(seed):
    rng = np.random.default_rng(100 + seed)
    rod = random_arm(rng, pulled=0.0)
    determinant, w = ArmDeterminant(rod), eigenvalues(rod)[:5]
    found = refine_mesh_eigenvalues(w.astype(complex), determinant, hull_of(rod), 400.0)
    assert len(found.w) == 5
    assert found.relative_mesh_displacement.max() < 1e-5
    for value, error in zip(found.w.tolist(), found.error.tolist(), strict=True):
        assert abs(refine_eigenvalue_and_error(value, determinant)[0] - value) <= 4 * error + 1e-15 * abs(
            value
        )
        # Another compiled function, whose sums are ordered differently: the residual is rounding.
        assert root_error(value, determinant) == pytest.approx(error, rel=0.2)


def test_eigenvalues_that_are_no_roots_are_left_out():
    rod = Rod(F=15.0, k1=1e4, k2=1e4, gamma3=1e-4, taper=0.5)
    w = eigenvalues(rod)[:4]
    raw = np.array([*w, -1000.0, np.inf, 1e9, w[0] + 40])
    found = refine_mesh_eigenvalues(raw, ArmDeterminant(rod), hull_of(rod), 100.0)
    assert sorted(found.mesh_indices.tolist()) == [0, 1, 2, 3]
    np.testing.assert_allclose(found.w, w[found.mesh_indices], rtol=1e-6)


@pytest.mark.parametrize(("profile", "F"), [(STEP, 2.0), (STEP, 30.0), (SOFT_STEP, 30.0)])
def test_weights_given_up_for_the_smallest_hull_have_larger_hulls(profile, F):
    rod = Rod(F=F, k1=1e4, k2=1e3, gamma3=1e-3, material=RodMaterial(profile=profile))
    side = 1e-9
    u = np.concatenate([np.linspace(side, 0.4 - side, 40), np.linspace(0.4 + side, 1 - side, 60)])
    coefficients = np.array(rod.local_coefficients(u))
    every, smallest = (regions_from_averaged_weights(u, coefficients, F, only) for only in (False, True))
    given_up = np.isinf(smallest[:, 0])
    without_c = every[every[:, 1] == 0.0]
    assert given_up.any() and np.isfinite(every).all()
    assert (smallest[~given_up] == every[~given_up]).all()
    # Some weights have equal hulls but for rounding.
    assert every[given_up, 0].min() >= (1 - 1e-15) * without_c[:, 0].min() > 0
