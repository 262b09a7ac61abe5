"""Spectra of arms followed along a grid: those of single points, with the counts of dense eigenvalues."""

import numpy as np
import pytest
from followed_lines import solve_stretch
from reference.dense_arm import eigenvalues
from reference.random_arms import random_arm
from surveyed import RODS

from rodsweep.determinant.parameter_path import ParameterPath
from rodsweep.model.material.rod_material import RodMaterial
from rodsweep.model.rod import Rod
from rodsweep.solve.spectrum.path import carried_arm_count, neighbouring_rods
from rodsweep.solve.spectrum.path.carried_arm_count import ArmCountCarrier, confirmed_mode_count_at
from rodsweep.solve.spectrum.path.followed_arms import FollowedArms
from rodsweep.solve.spectrum.path.neighbouring_rods import NeighbouringRods, follow_spectra_of_arms
from rodsweep.solve.spectrum.search import SpectrumRequest, solve_spectrum

REQUEST = SpectrumRequest(4, 1e-10, certify=True)
CONE = {"F": 10.0, "k1": 1e4, "k2": 1e3, "gamma3": 1e-3, "taper": 0.6}
LINES = {
    "F": np.linspace(0.5, 40, 40),
    "k1": np.geomspace(60, 1e4, 24),
    "k2": [*np.geomspace(30, 1e4, 24), np.inf],
    "gamma3": [0.0, *np.geomspace(1e-5, 1e-1, 24)],
    "taper": np.linspace(0.4, 1.6, 25),
}
COMPARED = 6
"""Points of a line that are compared with single points and dense eigenvalues."""


def agrees(found, i, rod):
    """Asserts that the i-th point has the spectrum of the rod alone."""
    alone = solve_spectrum(rod, REQUEST)
    assert found.certified[i]
    assert found.unstable_count[i] == alone.unstable_count
    error = 10 * (found.error_estimate[i] + alone.error_estimate) + 1e-15 * np.abs(alone.eigenvalues)
    np.testing.assert_array_less(np.abs(found.eigenvalues[i] - alone.eigenvalues), error)


@pytest.mark.parametrize("name", LINES)
def test_followed_spectra_are_those_of_single_points(name):
    """The taper passes 1, where the rod is uniform, and F and k1 a double eigenvalue and a Hopf point."""
    values = np.array(LINES[name])
    stretch = NeighbouringRods(ParameterPath(Rod(**{**CONE, name: float(values[0])}), name), values)
    found = solve_stretch(stretch, REQUEST)
    for i in np.linspace(0, len(values) - 1, COMPARED).astype(int):
        agrees(found, i, stretch.rod_at(int(i)))


def test_uniform_rubber_has_the_spectra_of_its_linear_equivalent():
    rod = Rod(F=10.0, k1=300.0, k2=1e3, gamma3=1e-3, material=RodMaterial("neo_hookean", "swelling"))
    stretch = NeighbouringRods(ParameterPath(rod, "F"), np.linspace(10, 200, 10))
    found = solve_stretch(stretch, REQUEST)
    assert found.certified.all()
    for i in (0, 9):
        linear, rate = stretch.rod_at(i).equivalent_linear_rod_and_rate_factor
        w = rate * solve_spectrum(linear, REQUEST).eigenvalues
        np.testing.assert_array_equal(found.eigenvalues[i], w)


def test_a_cone_is_followed_and_proved_without_single_points():
    path = ParameterPath(Rod(**CONE), "F")
    reached = follow_spectra_of_arms(path, np.linspace(5, 14, 32), REQUEST)
    assert len(reached.is_accepted) == 32
    assert reached.is_accepted.all()


def test_counts_carried_along_a_path_are_those_of_single_points(monkeypatch):
    """Beyond F = 20 D'/D no longer proves the cone: a few counts serve all points up to F = 60."""
    counted = []
    count = carried_arm_count.count_right_of
    monkeypatch.setattr(
        carried_arm_count, "count_right_of", lambda *words: counted.append(words[0]) or count(*words)
    )
    path, values = (
        ParameterPath(Rod(F=0.0, k1=1e4, k2=1e2, gamma3=1e-2, taper=0.5), "F"),
        np.linspace(20, 60, 160),
    )
    followed = [follow_spectra_of_arms(path, part, REQUEST) for part in np.split(values, 2)]
    accepted, unstable = (
        np.concatenate([getattr(part, name) for part in followed])
        for name in ("is_accepted", "unstable_count")
    )
    assert accepted.all()
    assert len(counted) < len(values) / 8
    for i in range(0, len(values), 10):
        alone = solve_spectrum(path.rod_at(float(values[i])), REQUEST)
        assert unstable[i] == alone.unstable_count


def test_a_second_count_that_disagrees_takes_the_carried_counts_back(monkeypatch):
    """Single counts then decide at every point."""
    path, values = (
        ParameterPath(Rod(F=0.0, k1=1e4, k2=1e2, gamma3=1e-2, taper=0.5), "F"),
        np.linspace(40, 42, 40),
    )
    line_at = ArmCountCarrier._confirmed_line_at_or_left_of
    monkeypatch.setattr(
        ArmCountCarrier,
        "_confirmed_line_at_or_left_of",
        lambda self, i, *rest: None if self.interval.p[i] > 40.5 else line_at(self, i, *rest),
    )
    single = []
    monkeypatch.setattr(
        neighbouring_rods,
        "confirmed_mode_count_at",
        lambda *words: single.append(words[2]) or confirmed_mode_count_at(*words),
    )
    followed = follow_spectra_of_arms(path, values, REQUEST)
    assert followed.is_accepted.all()
    assert len(single) == len(values)


@pytest.mark.parametrize("seed", range(RODS // 10 or 2))
def test_counts_of_followed_points_are_those_of_dense_eigenvalues(seed):
    rng, compared = np.random.default_rng(4000 + seed), 0
    for _ in range(4):
        rod = random_arm(rng)
        values = np.linspace(0.4, 1.0, 24) * rod.F
        path = ParameterPath(rod.with_values(F=float(values[0])), "F")
        reached = follow_spectra_of_arms(path, values, REQUEST)
        if reached is None:
            continue
        for i in np.flatnonzero(reached.is_accepted)[::8]:
            dense = eigenvalues(path.rod_at(float(values[i])))
            # An eigenvalue of an arm in tension may be -1e-18, the largest ones of the mesh are 1e9.
            blur = 1e-16 * np.abs(dense).max()
            least, most = (int((dense.real > limit).sum()) for limit in (blur, -blur))
            assert least <= reached.unstable_count[i] <= most, (rod, rod.material, values[i])
            for w in dense[:4]:
                assert np.abs(reached.w[i] - w).min() <= 1e-4 * max(abs(w), 1.0)
            compared += 1
    assert compared >= 3


def test_points_between_those_followed_have_their_own_spectra():
    path = ParameterPath(Rod(**CONE), "F")
    followed = FollowedArms(path, np.linspace(1, 25, 25), 4)
    for F in (3.3, 12.72, 24.99):
        found, alone = followed.spectrum(F, 4), solve_spectrum(path.rod_at(F), REQUEST)
        assert found.unstable_count == alone.unstable_count
        error = 10 * (found.error_estimate + alone.error_estimate) + 1e-15 * np.abs(alone.eigenvalues)
        np.testing.assert_array_less(np.abs(found.eigenvalues - alone.eigenvalues), error)
    assert followed.spectrum(26.0, 4) is None
