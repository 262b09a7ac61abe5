"""The leader of an arm of a chain, from propagators interpolated over a range: that of the arm alone."""

from itertools import pairwise

import numpy as np
import pytest
from reference.random_arms import random_arm
from surveyed import RODS

from rodsweep.bench.limit_cycle.swept_rods import TWO_SEGMENT_PROFILE
from rodsweep.model.material.rod_material import RodMaterial
from rodsweep.model.rod import Rod
from rodsweep.solve.cycle.straight_rod import (
    eigenvalues_to_follow,
    straight_rod_stability,
    straight_rod_stability_in_chain,
)
from rodsweep.solve.spectrum.path.leader_in_range import (
    ARM_RANGE_SETTINGS,
    ArmRange,
    arm_family_and_hulls_of_range,
    leader_in_range,
    next_range,
)
from rodsweep.solve.spectrum.search import SpectrumRequest, solve_spectrum

ARM = Rod(F=18.3, k1=1e4, k2=1e2, gamma3=1e-2, material=RodMaterial(profile=TWO_SEGMENT_PROFILE))
CONE = Rod(F=5.0, k1=1e3, k2=1e3, gamma3=1e-3, taper=0.8)


def chain_of(rod, name, ratio, points):
    """Yields each rod behind the first, its stability in the chain, and the range that it was solved in."""
    near, arm_range = eigenvalues_to_follow(rod, straight_rod_stability(rod)), None
    rods = [rod.with_values(**{name: getattr(rod, name) * ratio**k}) for k in range(points + 1)]
    for previous, here in pairwise(rods):
        found = straight_rod_stability_in_chain(here, near, name, arm_range)
        yield here, found, arm_range
        near = eigenvalues_to_follow(here, found)
        arm_range = next_range(here, previous, name, found.arm_range, near)


def is_from_range(found, arm_range):
    return arm_range is not None and arm_range.is_usable and found.arm_range.successive_failure_count == 0


def agrees_with_single_arm(rod, found):
    w = solve_spectrum(rod, SpectrumRequest(1, 1e-9, True)).eigenvalues[0]
    assert found.w == pytest.approx(complex(w.real, abs(w.imag)), rel=1e-11)
    assert abs(found.w - complex(w.real, abs(w.imag))) <= 20 * found.eigenvalue_error + 1e-13 * abs(w)


@pytest.mark.parametrize(
    ("rod", "name", "ratio"),
    [(ARM, "F", 0.99), (ARM, "k1", 0.985), (ARM, "gamma3", 1.02), (CONE, "F", 1.01), (CONE, "taper", 0.99)],
)
def test_leaders_of_a_chain_are_those_of_single_arms(rod, name, ratio):
    """Single arms are needed at the first two points, and where a pair becomes real."""
    found = list(chain_of(rod, name, ratio, 24))
    for here, stability, _ in found:
        agrees_with_single_arm(here, stability)
    assert sum(is_from_range(stability, arm_range) for _, stability, arm_range in found) > len(found) / 2


def test_leaders_of_random_chains_are_those_of_single_arms():
    in_range = 0
    for k in range(max(4, RODS // 4)):
        random = np.random.default_rng([34, k])
        rod = random_arm(random)
        name = str(random.choice(["F", "k2", "gamma3"]))
        if rod.is_uniform or not np.isfinite(rod.coordinate(name)) or rod.coordinate(name) == 0:
            continue
        for here, stability, arm_range in chain_of(rod, name, float(random.uniform(0.98, 0.995)), 12):
            if is_from_range(stability, arm_range):
                agrees_with_single_arm(here, stability)
                in_range += 1
    assert in_range > 0


def test_a_range_proves_no_eigenvalue_that_does_not_lead():
    *_, (rod, stability, arm_range) = chain_of(ARM, "k1", 0.985, 4)
    w = stability.followed_eigenvalues
    assert leader_in_range(rod, "k1", arm_range, w)[0] == pytest.approx(w, rel=1e-11)
    assert leader_in_range(rod, "k1", arm_range, w[1:]) is None
    # After a failure the propagators of the range are used again.
    misses = arm_family_and_hulls_of_range.cache_info().misses
    assert leader_in_range(rod, "k1", arm_range._replace(successive_failure_count=1.0), w)[
        0
    ] == pytest.approx(w, rel=1e-11)
    assert arm_family_and_hulls_of_range.cache_info().misses == misses


def test_a_chain_without_use_for_a_range_has_none():
    """Uniform rods, steps that are too long, repeated rods; a range without proofs is given up."""
    near = np.array([-1.0 + 20j])
    step = ARM_RANGE_SETTINGS.max_relative_length / ARM_RANGE_SETTINGS.min_chain_steps_per_range
    beside = ARM.with_values(F=ARM.F * (1 + 0.5 * step))
    assert next_range(ARM, beside, "F", None, near) is not None
    uniform = [Rod(F=rod.F, k1=1e4, k2=1e2, gamma3=1e-2) for rod in (ARM, beside)]
    assert next_range(*uniform, "F", None, near) is None
    assert next_range(ARM, ARM.with_values(F=ARM.F * (1 + 1.1 * step)), "F", None, near) is None
    assert next_range(ARM, ARM, "F", None, near) is None
    assert next_range(ARM, beside, "F", None, np.array([np.nan])) is None
    # No w beyond 1e-3 is resolved, so that nothing is proved.
    coarse = ArmRange(0.5 * ARM.F, 2 * ARM.F, 1e-3, 0.0)
    eigenvalues = eigenvalues_to_follow(ARM, straight_rod_stability(ARM))
    for failures in range(1, ARM_RANGE_SETTINGS.max_successive_failures + 1):
        found = straight_rod_stability_in_chain(ARM, eigenvalues, "F", coarse)
        agrees_with_single_arm(ARM, found)
        coarse = found.arm_range
        assert coarse.successive_failure_count == failures
    assert not coarse.is_usable
