"""Matrices in a workspace: the last one made has its factors, and an earlier one raises."""

import gc
import tracemalloc
from dataclasses import replace

import numpy as np
import pytest

from rodsweep.discretization.elements.mesh import uniform_mesh
from rodsweep.discretization.stress.form import StressForm
from rodsweep.model.rod import Rod
from rodsweep.solve.branch.bordered.matrix import BorderedMatrix
from rodsweep.solve.branch.bordered.scale import ArcLengthScale
from rodsweep.solve.orbit.matrix.linearisation import Linearisation
from rodsweep.solve.orbit.matrix.workspace import (
    WORKSPACE_SETTINGS,
    FactorStorage,
    NewtonWorkspace,
    block_count,
)
from rodsweep.solve.orbit.orbit import Orbit
from rodsweep.solve.orbit.orbit_mesh import ORBIT_MESH_SETTINGS, OrbitMesh
from rodsweep.solve.orbit.symmetry import REFLECTION
from rodsweep.solve.unsolvable import Unsolvable, WorkLimitReached

INTERVALS, PERIOD = 4, 0.02
ROD = Rod(F=50.0, k1=1e4, k2=1e2, gamma3=1e-2, gamma1=0.7)
MOMENT = np.array([1.0, 0.0, 0.0])


def orbit_with(stages):
    """Any states: what is tested holds for orbits and for what is none."""
    form = StressForm(ROD, uniform_mesh(1, 8))
    states = np.random.default_rng(stages).normal(size=(1 + INTERVALS * stages, form.unknown_count))
    return Orbit.from_states(form, REFLECTION, PERIOD, states, stages)


def matrix_of_a_cycle(orbit, workspace):
    """Newton's matrix with its multipliers and what corrects another orbit."""
    matrix = Linearisation(orbit, workspace)
    return matrix, lambda: matrix.newton_step_at_nearby_orbit(orbit)


def matrix_of_a_branch(orbit, workspace):
    """The same with the force as a further unknown."""
    matrix = BorderedMatrix(orbit, ArcLengthScale.at_orbit(orbit, "F", 1.0), workspace)
    return matrix, lambda: matrix.newton_step_at_nearby_orbit(orbit, MOMENT, 0.0)


KINDS = [matrix_of_a_cycle, matrix_of_a_branch]


@pytest.mark.parametrize("stages", [3, 4], ids=["as large", "larger"])
@pytest.mark.parametrize("made", KINDS)
@pytest.mark.parametrize("other", KINDS)
def test_a_matrix_whose_workspace_another_one_used_raises_and_keeps_its_multipliers(made, other, stages):
    workspace = NewtonWorkspace()
    matrix, correct = made(orbit_with(3), workspace)
    multipliers = matrix.multipliers()
    assert np.isfinite(correct()).all()
    other(orbit_with(stages), workspace)
    with pytest.raises(RuntimeError, match="its workspace was used again"):
        correct()
    assert (matrix.multipliers() == multipliers).all()


@pytest.mark.parametrize(
    "used",
    [
        lambda matrix: matrix.newton_step(MOMENT, 0.1),
        lambda matrix: matrix.branch_tangent(MOMENT),
        lambda matrix: matrix.approximate_null_vector(),
        lambda matrix: matrix.residual_variations(matrix.orbit, np.ones((1, len(matrix.orbit.values) + 1))),
        lambda matrix: matrix.orbit_increments_at_fixed_parameter(
            np.ones((1, 24)), np.ones((INTERVALS, 3, 1, 24))
        ),
    ],
    ids=["step", "branch_tangent", "approximate_null_vector", "varied", "spread"],
)
def test_all_that_needs_the_factors_of_a_branch_raises_without_them(used):
    workspace, orbit = NewtonWorkspace(), orbit_with(3)
    matrix, _ = matrix_of_a_branch(orbit, workspace)
    assert used(matrix) is not None
    Linearisation(orbit, workspace)
    with pytest.raises(RuntimeError, match="its workspace was used again"):
        used(matrix)


@pytest.mark.parametrize("made", KINDS)
@pytest.mark.parametrize("other", KINDS)
def test_matrices_of_two_solvers_leave_each_other_alone(made, other):
    """Each has the correction that it has where there is no other."""
    _, alone = made(orbit_with(3), NewtonWorkspace())
    expected = alone()
    _, correct = made(orbit_with(3), NewtonWorkspace())
    _, other_correct = other(orbit_with(4), NewtonWorkspace())
    others = other_correct()
    assert (correct() == expected).all()
    assert (other_correct() == others).all()


def test_a_workspace_serves_smaller_and_larger_matrices():
    """In any order a matrix is the one that a workspace of its own has."""
    workspace = NewtonWorkspace()
    for stages in (4, 3, 5, 3):
        _, shared = matrix_of_a_cycle(orbit_with(stages), workspace)
        _, own = matrix_of_a_cycle(orbit_with(stages), NewtonWorkspace())
        assert (shared() == own()).all()


def test_matrices_of_one_workspace_take_the_memory_of_the_largest():
    """Of twenty that are all alive, of which the largest needs 20 MB and all together 280."""
    workspace = NewtonWorkspace()
    gc.collect()
    tracemalloc.start()
    try:
        kept = [FactorStorage(workspace, 40 + k, 4, 72) for k in range(20)]
        _, most = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    largest = 8 * 59 * 8 * 72**2  # half the blocks of the 4 x 4 stages
    assert len(kept) == 20
    assert largest < most < 1.1 * largest


def test_a_buffer_starts_at_a_cache_line():
    workspace = NewtonWorkspace()
    for size in (1, 100, 10**6):
        buffer = workspace.buffer(workspace.reserve(size))
        assert len(buffer) >= size and buffer.ctypes.data % 64 == 0


def test_a_released_workspace_keeps_what_most_rods_need():
    workspace = NewtonWorkspace()
    for numbers, kept in (
        (WORKSPACE_SETTINGS.max_kept_buffer_doubles, True),
        (WORKSPACE_SETTINGS.max_kept_buffer_doubles + 1, False),
    ):
        memory = FactorStorage(workspace, -(-numbers // block_count(3)), 3, 1)
        buffer = memory.factors.eliminated_blocks.base
        workspace.release()
        with pytest.raises(RuntimeError, match="its workspace was used again"):
            memory.factors  # noqa: B018 - raises
        again = FactorStorage(workspace, 1, 3, 1).factors.eliminated_blocks.base
        assert np.shares_memory(again, buffer) == kept


def test_work_is_limited_until_the_workspace_is_released():
    workspace = NewtonWorkspace()
    one = 4 * 3**2 * 10.0**3
    workspace.limit_work(20 * one)
    for _ in range(20):
        FactorStorage(workspace, 4, 3, 10)
    with pytest.raises(WorkLimitReached, match="`work`"):
        FactorStorage(workspace, 4, 3, 10)
    workspace.release()
    FactorStorage(workspace, 4, 3, 10)


def test_no_matrix_takes_more_than_its_share_of_the_work():
    workspace = NewtonWorkspace()
    one = 4 * 3**2 * 10.0**3
    workspace.limit_work(one / WORKSPACE_SETTINGS.max_matrix_work_fraction * 0.99)
    with pytest.raises(WorkLimitReached):
        FactorStorage(workspace, 4, 3, 10)


def test_a_matrix_of_more_memory_than_allowed_is_refused_before_it_is_allocated():
    """Five stages with the most intervals and unknowns allowed by themselves would need 4.6 GB."""
    with pytest.raises(Unsolvable, match=r"needs 4\.6 GB, more than the 2\.1 GB allowed"):
        FactorStorage(
            NewtonWorkspace(),
            ORBIT_MESH_SETTINGS.max_time_interval_count,
            5,
            ORBIT_MESH_SETTINGS.max_unknown_count,
        )
    mesh = OrbitMesh((0.0, 0.2, 0.4, 0.6, 0.8, 1.0), 26, ORBIT_MESH_SETTINGS.max_time_interval_count, 3)
    assert mesh.is_allowed
    assert not replace(mesh, stage_count=5).is_allowed
    assert replace(mesh, stage_count=5, interval_count=100).is_allowed
