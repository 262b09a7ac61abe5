"""Leading eigenvalues of arms that vary and of rubber, certified, against other ways to have them."""

from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest
from reference.dense_arm import eigenvalues
from reference.random_arms import random_arm
from surveyed import RODS

from rodsweep.determinant.arm.determinant import ArmDeterminant
from rodsweep.determinant.arm.hull.region import UNBOUNDED_HULL
from rodsweep.determinant.arm.newton import refine_eigenvalue_and_error
from rodsweep.model.material.profile import Profile
from rodsweep.model.material.rod_material import RodMaterial
from rodsweep.model.rod import Rod
from rodsweep.solve.spectrum import problem, search
from rodsweep.solve.spectrum.krylov_schur_on_two_meshes import solve_on_two_meshes
from rodsweep.solve.spectrum.search import SpectrumRequest, solve_spectrum
from rodsweep.solve.spectrum.status import SpectrumStatus

REQUEST = SpectrumRequest(4, 1e-10, certify=True)
ONES = Profile((0.0, 1.0), ((1.0,) * 6, (1.0,) * 6))
UNIFORM = {"F": 30.0, "k1": 1e4, "k2": 300.0, "gamma3": 1e-3}


@pytest.mark.parametrize("seed", range(max(10, RODS // 10)))
def test_random_arms_have_the_leading_eigenvalues_of_another_discretisation(seed):
    rng = np.random.default_rng(1000 + seed)
    for _ in range(3):
        rod = random_arm(rng, pulled=0.0)
        found, dense = solve_spectrum(rod, REQUEST), eigenvalues(rod)
        assert (found.status, found.certified) == (SpectrumStatus.ok, True), (rod, rod.material)
        assert found.unstable_count == int((dense.real > 0).sum())
        for w, error in zip(found.eigenvalues.tolist(), found.error_estimate.tolist(), strict=True):
            assert np.abs(dense - w).min() <= 1e-5 * max(abs(w), 1.0)
            assert abs(refine_eigenvalue_and_error(w, ArmDeterminant(rod))[0] - w) <= 4 * error + 1e-15 * abs(
                w
            )


@mp.workdps(32)
def exact_root(w, rod):
    """The root of D next to w in 32 digits, of a stepped arm of linear material."""
    mp.mp.dps = 32
    profile = rod.material.profile
    ends = zip(profile.u[::2], profile.u[1::2], profile.rows[::2], strict=True)
    k1, k2, F, gamma3 = map(mp.mpf, (rod.k1, rod.k2, rod.F, rod.gamma3))

    def determinant(w):
        sides = mp.matrix([[1, 0], [0, 1], [0, 0], [0, 0]])
        for start, end, row in reversed(segments):
            c1, c2, c3 = 1 / (k1 * row[0]), 1 / (k2 * row[1]), 1 / mp.mpf(row[2])
            nu = 1 - F * c1
            rates = mp.matrix(
                [[0, nu, c2, 0], [0, 0, 0, c3], [w, 0, 0, F * c3], [0, w * gamma3, -(nu + F * c2), 0]]
            )
            sides = mp.expm(rates * (mp.mpf(start) - mp.mpf(end))) * sides
        return sides[0, 0] * sides[1, 1] - sides[0, 1] * sides[1, 0]

    segments = list(ends)
    last, here = mp.mpc(w) * (1 + mp.mpf("1e-10")), mp.mpc(w)
    values = determinant(last), determinant(here)
    for _ in range(2):
        last, here = here, here - values[1] * (here - last) / (values[1] - values[0])
        values = values[1], determinant(here)
    return here


@pytest.mark.parametrize("seed", range(max(3, RODS // 10)))
def test_errors_of_stepped_arms_hold_in_the_last_digit(seed):
    """Rounding of propagators, of which D is a small part, moved some by 150 times what was stated."""
    rng = np.random.default_rng([34, seed])
    factors = 10 ** rng.uniform(-0.6, 0.6, (3, 3))
    rows = tuple((*row, 1.0, 1.0, 1.0) for row in factors.tolist() for _ in range(2))
    profile = Profile((0.0, 0.3, 0.3, 0.65, 0.65, 1.0), rows)
    numbers = {"k1": 10 ** rng.uniform(2, 4.5), "k2": 10 ** rng.uniform(1, 4), "gamma3": 1e-3}
    F = min(10 ** rng.uniform(0.3, 2), 0.9 * numbers["k1"] * factors[:, 0].min())
    rod = Rod(F=F, **numbers, material=RodMaterial(profile=profile))
    found = solve_spectrum(rod, REQUEST)
    assert found.status == SpectrumStatus.ok
    for w, error in zip(found.eigenvalues.tolist(), found.error_estimate.tolist(), strict=True):
        assert abs(exact_root(w, rod) - w) <= error <= 1e-12 * abs(w)


def test_a_profile_of_ones_is_the_uniform_rod():
    uniform = solve_spectrum(Rod(**UNIFORM), REQUEST)
    profiled = solve_spectrum(Rod(**UNIFORM, material=RodMaterial(profile=ONES)), REQUEST)
    np.testing.assert_allclose(profiled.eigenvalues, uniform.eigenvalues, rtol=1e-12)
    assert profiled.certified


@pytest.mark.parametrize("section", ["fixed", "swelling"])
def test_uniform_rubber_is_solved_by_its_linear_equivalent(section):
    """Both ways: the closed form of the equivalent rod, and elements with a profile of ones."""
    values = {"F": 450.0, "k1": 500.0, "k2": 1e4, "gamma3": 1e-4}
    quick = solve_spectrum(Rod(**values, material=RodMaterial("neo_hookean", section)), REQUEST)
    general = solve_spectrum(Rod(**values, material=RodMaterial("neo_hookean", section, ONES)), REQUEST)
    assert quick.certified
    assert general.certified
    np.testing.assert_allclose(general.eigenvalues, quick.eigenvalues, rtol=1e-11)


def test_vectors_are_those_of_a_finer_mesh():
    rod = Rod(F=14.0, k1=1e4, k2=200.0, gamma3=1e-3, taper=0.4)
    rough = solve_spectrum(rod, SpectrumRequest(3, 1e-6, certify=True, vector_node_count=17)).vectors
    fine = solve_spectrum(rod, SpectrumRequest(3, 1e-11, certify=True, vector_node_count=17)).vectors
    assert np.abs(rough - fine).max() < 1e-5 * np.abs(fine).max()
    np.testing.assert_allclose(fine[0, :, -1], 1, atol=1e-12)


@pytest.mark.parametrize("seed", range(4))
def test_two_meshes_agree_with_the_determinant(seed):
    rod = random_arm(np.random.default_rng(2000 + seed), pulled=0.0)
    request = replace(REQUEST, accuracy=1e-8)
    found, proved = solve_on_two_meshes(rod, request), solve_spectrum(rod, REQUEST)
    assert found.status == SpectrumStatus.ok
    assert not found.certified
    np.testing.assert_array_less(np.abs(found.eigenvalues - proved.eigenvalues), found.error_estimate + 1e-12)


def test_without_a_bound_there_are_eigenvalues_but_nothing_is_certified():
    """A cone that is almost a uniform rod, pulled beyond its shear stiffness without rotational drag."""
    pulled = Rod(F=-25.0, k1=1e4, k2=20.0, gamma3=0.0)
    found, uniform = solve_spectrum(replace(pulled, taper=0.999), REQUEST), solve_spectrum(pulled, REQUEST)
    assert (found.status, found.certified) == (SpectrumStatus.not_certified, False)
    assert found.unstable_count == uniform.unstable_count == -1
    assert found.eigenvalues == pytest.approx(uniform.eigenvalues, rel=0.02)


def test_accurate_eigenvalues_without_a_bound_are_not_certified_though_the_mesh_is_coarse():
    """A thin cone with two short stiff rings: roots of D to 2e-14, from a mesh with a larger error, had the
    status of eigenvalues that miss the accuracy."""
    one = (1.0,) * 6
    inner, outer = (3.7, 3.7, 13.5, 1.3, 1.3, 3.7), (18.9, 18.9, 357.0, 1.8, 1.8, 18.9)
    u = (0.0, 0.6, 0.6, 0.61, 0.61, 0.88, 0.88, 0.89, 0.89, 1.0)
    rings = Profile(u, (one, one, inner, inner, one, one, outer, outer, one, one))
    material = RodMaterial("neo_hookean", "swelling", rings)
    found = solve_spectrum(Rod(F=6.0, k1=5e3, k2=48.8, gamma3=0.0, taper=0.15, material=material), REQUEST)
    assert found.status == SpectrumStatus.not_certified
    assert found.message.startswith("no a-priori bound on the eigenvalues applies")
    assert (found.error_estimate < REQUEST.accuracy * np.abs(found.eigenvalues)).all()


def test_many_growing_modes_of_a_soft_segment_are_all_found():
    """Few modes are asked for; all that grow are counted, between them and beyond."""
    soft = (0.1, 0.01, 0.1, 0.1, 0.1, 0.1)
    jump = Profile((0.0, 0.4, 0.4, 1.0), ((1.0,) * 6, (1.0,) * 6, soft, soft))
    rod = Rod(F=4.0, k1=1e4, k2=1.0, gamma3=1e-2, material=RodMaterial(profile=jump))
    found = solve_spectrum(rod, REQUEST)
    assert (found.status, found.certified, found.unstable_count) == (SpectrumStatus.ok, True, 24)
    dense = eigenvalues(rod, 10)[:4]  # two pairs, each in either order
    assert np.array([found.eigenvalues.real, np.abs(found.eigenvalues.imag)]) == pytest.approx(
        np.array([dense.real, np.abs(dense.imag)]), rel=1e-6
    )


@pytest.mark.parametrize("countable", [True, False])
def test_growing_modes_beyond_enough_are_solved_for_only_for_a_count(monkeypatch, countable):
    """A count needs all growing modes of a stepped arm; where no count is possible the first are enough."""
    soft = (1.0, 0.5, 0.5, 1.0, 1.0, 1.0)
    step = Profile((0.0, 0.5, 0.5, 1.0), ((1.0,) * 6, (1.0,) * 6, soft, soft))
    rod = Rod(F=400.0, k1=1e4, k2=1e4, gamma3=0.0, material=RodMaterial(profile=step))
    wanted, whole = [], search.candidates_on_mesh

    def attempt(rod_problem, mesh, number, vectors, tight):
        wanted.append(number)
        return whole(rod_problem, mesh, number, vectors, tight)

    monkeypatch.setattr(search, "candidates_on_mesh", attempt)
    monkeypatch.setattr(
        search, "SEARCH_SETTINGS", replace(search.SEARCH_SETTINGS, max_modes_found_without_proof=2)
    )
    if not countable:
        monkeypatch.setattr(problem, "hull_of", lambda rod: UNBOUNDED_HULL)
    found = solve_spectrum(rod, SpectrumRequest(2, 1e-6, certify=True))
    assert found.certified == countable
    assert found.unstable_count > 2 if countable else found.status == SpectrumStatus.not_certified
    assert (max(wanted) > 2) == countable


@pytest.mark.parametrize("factor", [1e4, 1e6])
def test_two_rows_far_apart_are_the_same_arm_as_many_rows_on_their_line(factor):
    """With rows at 0 and 1 alone, k2 has its zero at a millionth of the length before the base."""
    rows = np.array([0.0, *10.0 ** np.arange(-6, 1)])

    def leading(u):
        table = [(1.0, 1 + (factor - 1) * each, 1.0, 1.0, 1.0, 1.0) for each in u]
        material = RodMaterial(profile=Profile(tuple(u), tuple(table)))
        rod = Rod(F=3.8, k1=1e4, k2=1e4, gamma3=1e-4, material=material)
        return solve_spectrum(rod, SpectrumRequest(4, 1e-10, True))

    few = leading([0.0, 1.0])
    many = leading(rows.tolist())
    assert few.status == many.status == SpectrumStatus.ok
    apart = np.abs(few.eigenvalues - many.eigenvalues)
    assert (apart <= few.error_estimate + many.error_estimate).all()


RUBBER = RodMaterial(law="neo_hookean")
CONES = {
    "more roots than a proof needs": Rod(F=0.9, k1=1e4, k2=100.0, gamma3=1e-2, taper=100.0),
    "growth at a thin tip": Rod(F=0.3, k1=1e4, k2=100.0, gamma3=1e-2, taper=0.02),
    "long elements at a thin tip": Rod(
        F=0.0257, k1=31549.0, k2=198.0, gamma3=1.79e-4, taper=0.0105, material=RUBBER
    ),
    "growth at a pulled tip alone": Rod(F=-0.0212, k1=221.67, k2=32.47, gamma3=1.53e-3, taper=0.01093),
    "growth rates far apart": Rod(
        F=-0.238, k1=1665.6, k2=20.4, gamma3=7.226e-6, taper=0.05833, material=RUBBER
    ),
}


@pytest.mark.parametrize("rod", CONES.values(), ids=CONES)
def test_eigenvalues_right_of_the_line_of_a_count_are_found(rod):
    """Roots refined only as far as a proof needs, or a shift left of the spectrum, hid eigenvalues; so did
    growth between the points where local waves are sampled, and a shift at the largest growth rate."""
    found, dense = solve_spectrum(rod, SpectrumRequest(4, 1e-10, certify=True)), eigenvalues(rod, 16)
    assert (found.status, found.certified) == (SpectrumStatus.ok, True)
    assert found.unstable_count == int((dense.real > 0).sum())
    leading = dense[np.lexsort((-dense.imag, -dense.real))][:4]
    np.testing.assert_allclose(found.eigenvalues, leading, rtol=1e-5)


SWELLING = RodMaterial(law="neo_hookean", section="swelling")
STRONG_PULLS = {
    "growth rates over five decades": (
        Rod(F=-0.752, k1=4801.0, k2=18.14, gamma3=6.78e-6, taper=0.0517, material=SWELLING),
        10,
        [29921141.960089818, 14394371.418672776, 6230379.630984758, 1353824.499039975],
    ),
    "one eigenvalue far right of all others": (
        Rod(F=-0.2617, k1=295.4, k2=5.134, gamma3=2.227e-6, taper=0.09488),
        2,
        [3319221.8558797245, 74.07515813467127, -3.540543462128108, -30.263508137510172],
    ),
    "a leading eigenvalue of 2e-203": (
        Rod(
            F=-71.53477942927429,
            k1=150.97883954970362,
            k2=290.0504936618152,
            gamma3=2.6396053647370833e-05,
            taper=0.06857019025471348,
        ),
        0,
        [-2.177006998066638e-203, -143.7971269693847, -582.5761179259405, -1317.3592142786076],
    ),
    "entries of propagators of very different sizes": (
        Rod(F=-2.08e4, k1=2420.0, k2=34.13, gamma3=0.2225, taper=30.63, material=RUBBER),
        18,
        [19837558.42620787, 19082939.80988208, 13491190.195591455, 12925343.798193436],
    ),
}


@pytest.mark.parametrize(("rod", "unstable_count", "expected"), STRONG_PULLS.values(), ids=STRONG_PULLS)
def test_strongly_pulled_cones_have_all_eigenvalues(rod, unstable_count, expected):
    """References: a propagator in 80-bit arithmetic that shares no code with this one."""
    found = solve_spectrum(rod, SpectrumRequest(4, 1e-10, certify=True))
    assert (found.status, found.certified) == (SpectrumStatus.ok, True)
    assert found.unstable_count == unstable_count
    assert (np.abs(found.eigenvalues - expected) <= found.error_estimate).all()


@pytest.mark.parametrize("k2", [1e4, np.inf])
def test_an_exponentially_small_eigenvalue_hides_no_others(k2):
    """The shift 0 was so close to the leading eigenvalue, -9e-11 1/tau2, that rounding hid most others."""
    base, tip = (5.9, 0.5, 0.54, 0.68, 2.3, 3.7), (7.6, 0.56, 2.6, 0.48, 4.4, 0.29)
    material = RodMaterial(profile=Profile((0.0, 0.58, 0.58, 1.0), (base, base, tip, tip)))
    rod = Rod(F=-44.4, k1=1e4, k2=k2, gamma3=0.041, taper=0.141, material=material)
    found = solve_spectrum(rod, SpectrumRequest(9, 1e-10, certify=True))
    assert (found.status, found.certified) == (SpectrumStatus.ok, True)
    assert -1e-9 < found.eigenvalues[0].real < 0
    # The reference needs a finite stiffness of shear; between both k2, eigenvalues differ by 0.6 %.
    dense = eigenvalues(replace(rod, k2=1e4))
    expected = dense[np.argsort(-dense.real)][:9]
    tolerance = 1e-8 if k2 == 1e4 else 0.01
    assert np.abs(found.eigenvalues - expected)[1:] == pytest.approx(0, abs=tolerance * abs(expected[-1]))


def test_a_large_rotational_drag_slows_the_modes_of_a_cone():
    """gamma3 = 1e6 and 1e10: all motion is slow, and w gamma3 tends to a limit. With elements for |w| = 16
    there was no eigenvalue at all."""
    slow, slower = (
        solve_spectrum(
            Rod(F=10.0, k1=1e4, k2=1e3, gamma3=g, taper=0.5), SpectrumRequest(3, 1e-10, certify=False)
        )
        for g in (1e6, 1e10)
    )
    assert slow.status == slower.status == SpectrumStatus.ok
    expected = [
        4.345917035039398e-06 + 1.4023332100043779e-05j,
        -3.102618750971156e-05 + 9.233420547358184e-06j,
    ]
    assert (np.abs(slow.eigenvalues[[0, 2]] - expected) <= slow.error_estimate[[0, 2]]).all()
    np.testing.assert_allclose(1e10 * slower.eigenvalues, 1e6 * slow.eigenvalues, rtol=1e-4)
