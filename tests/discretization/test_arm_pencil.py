"""The pencil of arms against that of uniform rods, against D, and with elements across a jump."""

import numpy as np
import pytest
from reference.random_arms import random_arm

from rodsweep.determinant.arm.determinant import ArmDeterminant
from rodsweep.determinant.arm.newton import refine_eigenvalue_and_error
from rodsweep.discretization.elements.elements import Elements
from rodsweep.discretization.elements.resolution import RESOLUTION_SETTINGS
from rodsweep.discretization.straight.arm_pencil import ArmPencil
from rodsweep.discretization.straight.arm_resolution import ArmMesh, arm_mesh, finer_arm_mesh
from rodsweep.discretization.straight.dense_eigenproblem import dense_eigenproblem
from rodsweep.discretization.straight.pencil import assemble_pencil
from rodsweep.model.material.profile import Profile
from rodsweep.model.material.rod_material import RodMaterial
from rodsweep.model.rod import Rod

SHIFT = 500.0


def leading(rod, mesh, number):
    """The eigenvalues of the pencil nearest to a shift, by dense shift-and-invert."""
    form = dense_eigenproblem(rod, ArmPencil(mesh))
    M = np.diag(form.B)
    inverse = np.linalg.solve(form.A - SHIFT * M, M)
    m = np.linalg.eigvals(inverse)
    w = SHIFT + 1 / m[np.abs(m) > 1e-8]
    return w[np.argsort(-w.real)][:number]


@pytest.mark.parametrize(
    "rod", [Rod(F=30.0, k1=1e4, k2=1e3, gamma3=1e-3), Rod(F=9.0, k1=40.0, k2=np.inf, gamma3=0.0)]
)
def test_uniform_arm_has_the_pencil_of_the_uniform_rod(rod):
    form = dense_eigenproblem(rod, ArmPencil(ArmMesh((0.0, 0.5, 1.0), 10)))
    expected = dense_eigenproblem(rod, assemble_pencil(2, 10))
    np.testing.assert_allclose(form.A, expected.A, rtol=0, atol=1e-14 * np.abs(expected.A).max())
    np.testing.assert_allclose(form.B, expected.B, rtol=1e-14)


@pytest.mark.parametrize("seed", range(8))
def test_eigenvalues_of_the_chosen_mesh_are_roots_of_the_determinant(seed):
    """The mesh is chosen for a relative error of 1e-8; D knows the eigenvalues to rounding."""
    rod = random_arm(np.random.default_rng(seed), pulled=0.0)
    determinant = ArmDeterminant(rod)
    for w in leading(rod, arm_mesh(rod, 4, 1e-8), 4):
        assert abs(refine_eigenvalue_and_error(complex(w), determinant)[0] / w - 1) < 1e-6


def test_elements_that_end_at_the_jump_are_worth_ten_digits():
    jump = Profile((0.0, 0.4, 0.4, 1.0), ((1.0,) * 6, (1.0,) * 6, (0.01,) * 6, (0.01,) * 6))
    rod = Rod(F=0.1, k1=1e4, k2=1e4, gamma3=1e-4, material=RodMaterial(profile=jump))
    determinant = ArmDeterminant(rod)

    def worst(mesh):
        return max(
            abs(refine_eigenvalue_and_error(complex(w), determinant)[0] / w - 1)
            for w in leading(rod, mesh, 2)
        )

    across = worst(ArmMesh((0.0, 0.25, 0.5, 0.75, 1.0), 14))
    along = worst(ArmMesh((0.0, 0.4, 1.0), 14))
    assert along < 1e-10
    assert across > 1e-4


def test_mesh_ends_elements_at_breaks_and_gets_finer():
    profile = Profile((0.0, 0.3, 0.3, 1.0), ((1.0,) * 6, (1.0,) * 6, (0.2,) * 6, (0.3,) * 6))
    rod = Rod(F=3.0, k1=1e4, k2=1e4, gamma3=1e-4, taper=0.2, material=RodMaterial(profile=profile))
    mesh = arm_mesh(rod, 4, 1e-4)
    assert {0.0, 0.3, 1.0} <= set(mesh.edges)
    for _ in range(6):
        finer = finer_arm_mesh(rod, mesh)
        assert finer.unknown_count > mesh.unknown_count
        assert set(mesh.edges) <= set(finer.edges)
        mesh = finer


def test_values_at_points_are_those_of_the_polynomials():
    pencil = ArmPencil(ArmMesh((0.0, 0.3, 1.0), 6))
    points = np.linspace(0, 1, 17)
    nodal = pencil.node_positions**5
    np.testing.assert_allclose(pencil.evaluation_matrix(points) @ nodal, points**5, atol=1e-14)


def test_coefficients_are_sampled_at_the_nodes_and_on_their_own_side_of_a_jump():
    """1e-9 of an element beside its ends moved the largest y of cycles next to Hopf points by 1e-8."""
    mesh = Elements((0.0, 0.3, 0.3 + 1e-6, 1.0), 12)
    edges = np.array(mesh.edges)
    points = mesh.one_sided_nodes.reshape(mesh.element_count, -1)
    assert (np.diff(points) > 0).all()
    assert (points[:, 0] > edges[:-1]).all()
    assert (points[:, -1] < edges[1:]).all()
    assert np.abs(points.ravel() - mesh.node_positions[mesh.element_node_indices]).max() < 2e-15


@pytest.mark.parametrize("F", [-1e13, -1e25])
def test_an_arm_that_no_mesh_resolves_has_a_mesh_that_is_too_fine(F):
    """The elements of the finest wave were counted one by one, up to a million and more."""
    profile = Profile((0.0, 0.4, 0.4, 1.0), ((1.0,) * 6,) * 2 + ((0.5,) * 6,) * 2)
    rod = Rod(F=F, k1=1e4, k2=1e3, gamma3=1e-4, material=RodMaterial(profile=profile))
    mesh = arm_mesh(rod, 4, 1e-8)
    assert RESOLUTION_SETTINGS.max_unknowns < mesh.unknown_count < 10 * RESOLUTION_SETTINGS.max_unknowns
