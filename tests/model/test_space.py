"""The compiled balance with the algebra of space, se(3), and with rods that are not uniform, on meshes."""

from functools import partial

import numpy as np
import pytest
from pointwise_balance import PLANE_COMPONENTS, material_in_space, unloaded_strain
from scipy.linalg import expm

from rodsweep.discretization.elements.mesh import uniform_mesh
from rodsweep.discretization.nodal_rod import nodal_rod
from rodsweep.discretization.stress.balance import (
    write_strain_rates,
    write_velocities_and_rates,
    write_velocity_residuals,
)
from rodsweep.discretization.stress.jacobian import write_jacobian
from rodsweep.model.balance import ad
from rodsweep.model.lie_algebra import ALGEBRAS, SE3
from rodsweep.model.rod import Rod

ROD, GAMMA1 = Rod(F=50.0, k1=1e3, k2=1e2, gamma3=1e-2), 0.7
PLANE = ROD.with_values(gamma1=GAMMA1).balance_coefficients
SPACE = material_in_space(ROD.with_values(gamma1=GAMMA1), twist_stiffness=0.6, twist_drag=0.02)
MATERIALS = {"plane": PLANE, "space": SPACE}
ALL = pytest.mark.parametrize("material", MATERIALS.values(), ids=MATERIALS.keys())
MESHES = pytest.mark.parametrize(
    "grid", [uniform_mesh(1, 9), uniform_mesh(3, 4)], ids=["1 element", "3 elements"]
)


def tapered(material, grid):
    """The material with compliances and drags that vary along the rod, each in its own way."""
    u, phase = grid.node_positions, np.arange(len(material.drag))[:, None]
    profile = 1 + 0.4 * np.sin(2 * u + phase)
    compliance, drag = material.compliance[:, None] * profile, material.drag[:, None] * profile[::-1]
    rest = unloaded_strain(material)[:, None] + compliance * material.tip_stress[:, None]
    return material._replace(compliance=compliance, drag=drag, straight_state_strain=rest)


def state(rod, grid):
    """Stresses that no mesh resolves, and with them any velocities that are unknown, (unknowns,)."""
    d = len(rod.tip_stress)
    size = d * grid.node_count + len(rod.unknown_velocity_components) * (grid.node_count + 1)
    return 10 * np.random.default_rng(d).standard_normal(size)


def balanced(x, rod, grid):
    """V and G at all nodes, (d, nodes + 1)."""
    V, G = np.empty((2, *rod.drag.shape))
    write_velocities_and_rates.compiled_for(ALGEBRAS[len(V)])(x, V, G, rod, grid.node_matrices)
    return V, G


def equations(x, rod, grid):
    """G at all nodes, (d, nodes + 1), and the balance of what is unknown of V, flat."""
    _, G = balanced(x, rod, grid)
    out = np.empty(len(x))
    write_velocity_residuals.compiled_for(ALGEBRAS[len(G)])(x, out, rod, grid.node_matrices)
    return np.append(G.ravel(), out[len(G) * grid.node_count :])


@pytest.mark.long
@ALL
@pytest.mark.parametrize("kept", [(), (2,)], ids=["eliminated", "kept"])
def test_compiled_functions_do_what_their_loops_do(material, kept):
    """The loops themselves run in Python, with the algebra as an argument."""
    grid = uniform_mesh(2, 3)
    rod, d = nodal_rod(material, grid, kept), len(material.drag)
    g, n = ALGEBRAS[d], d * grid.node_count + len(kept) * (grid.node_count + 1)
    x = np.random.default_rng(d).standard_normal(n)
    found = []
    for run, slope in (
        (write_velocities_and_rates.compiled_for(g), write_jacobian.compiled_for(g)),
        (partial(write_velocities_and_rates, g), partial(write_jacobian, g)),
    ):
        V, G = np.empty((2, d, grid.node_count + 1))
        J, tip = np.full((n, n), np.nan), np.full((d, n), np.nan)
        run(x, V, G, rod, grid.node_matrices)
        slope(x, V, J, tip, rod, grid.node_matrices)
        found.append((V, G, J, tip))
    for compiled, plain in zip(*found, strict=True):
        assert np.abs(compiled - plain).max() <= 1e-13 * np.abs(plain).max()


@MESHES
def test_plane_states_of_space_are_those_of_the_plane(grid):
    plane, space = (nodal_rod(material, grid) for material in (PLANE, SPACE))
    x, n = state(plane, grid), grid.node_count
    at = np.concatenate([np.arange(a * n, (a + 1) * n) for a in PLANE_COMPONENTS])
    there = np.zeros(6 * n)
    there[at] = x
    jacobians = []
    for rod, here in ((plane, x), (space, there)):
        V, G = balanced(here, rod, grid)
        J, tip = np.empty((len(here),) * 2), np.empty((len(V), len(here)))
        write_jacobian.compiled_for(ALGEBRAS[len(V)])(here, V, J, tip, rod, grid.node_matrices)
        jacobians.append((V, G, J, tip))
    (V, G, J, tip), (V_space, G_space, J_space, tip_space) = jacobians
    for ours, theirs in ((V_space, V), (G_space, G)):
        assert np.abs(ours[PLANE_COMPONENTS] - theirs).max() <= 1e-13 * np.abs(theirs).max()
        assert not np.delete(ours, PLANE_COMPONENTS, axis=0).any()
    assert np.abs(J_space[np.ix_(at, at)] - J).max() <= 1e-13 * np.abs(J).max()
    assert np.abs(tip_space[np.ix_(PLANE_COMPONENTS, at)] - tip).max() <= 1e-13 * np.abs(tip).max()
    assert not np.delete(J_space[:, at], at, axis=0).any(), "a bent rod does not leave its plane"


@ALL
@MESHES
@pytest.mark.parametrize("uniform", [True, False], ids=["uniform", "tapered"])
def test_power_of_the_stresses_is_lost_to_the_fluid(material, grid, uniform):
    """The energy law: with the tip's stress, whose power is that of the force, to rounding on any mesh."""
    rod = nodal_rod(material if uniform else tapered(material, grid), grid)
    x = state(rod, grid)
    V, G = balanced(x, rod, grid)
    Sigma = np.tile(rod.tip_stress[:, None], grid.node_count + 1)
    Sigma[:, :-1] += x.reshape(len(V), -1)
    lost = (rod.drag * V**2 @ grid.quadrature_weights).sum()
    assert (Sigma * G).sum() == pytest.approx(-lost, rel=1e-12)


@pytest.mark.long
@ALL
@MESHES
@pytest.mark.parametrize("uniform", [True, False], ids=["uniform", "tapered"])
@pytest.mark.parametrize("kept", [(), (2,), (0, 2)], ids=["eliminated", "one kept", "two kept"])
def test_jacobian_is_the_derivative_of_the_equations(material, grid, uniform, kept):
    rod = nodal_rod(material if uniform else tapered(material, grid), grid, kept)
    x, d, n = state(rod, grid), len(rod.tip_stress), grid.node_count
    V, _ = balanced(x, rod, grid)
    J, tip = np.full((len(x),) * 2, np.nan), np.full((d, len(x)), np.nan)
    write_jacobian.compiled_for(ALGEBRAS[d])(x, V, J, tip, rod, grid.node_matrices)
    whole = np.concatenate([J[: d * n].reshape(d, n, -1), tip[:, None]], axis=1).reshape(d * (n + 1), -1)
    whole = np.concatenate([whole, J[d * n :]])
    for k, step in enumerate(1e-2 * np.eye(len(x))):  # the equations are cubic: this difference is exact
        once, twice = (
            equations(x + s * step, rod, grid) - equations(x - s * step, rod, grid) for s in (1, 2)
        )
        column = (8 * once - twice) / (12 * step[k])
        assert np.abs(whole[:, k] - column).max() <= 1e-10 * np.abs(whole).max()


@MESHES
def test_a_rod_turned_about_its_axis_moves_turned(grid):
    turn = np.array([[1, 0, 0], [0, np.cos(0.8), -np.sin(0.8)], [0, np.sin(0.8), np.cos(0.8)]])
    turn, rod = np.kron(np.eye(2), turn), nodal_rod(SPACE, grid)
    x = state(rod, grid)
    turned = (turn @ x.reshape(6, -1)).ravel()
    for here, there in zip(balanced(x, rod, grid), balanced(turned, rod, grid), strict=True):
        assert np.abs(there - turn @ here).max() <= 1e-12 * np.abs(here).max()


def test_a_rigid_motion_strains_no_rod():
    """Of a rod bent to a helix, whose points see one twist of all space in their own frames."""
    grid = uniform_mesh(1, 24)
    E = np.array([0.9, 0.2, -0.1, 1.5, 2.0, 0.7])
    bracket = np.stack([ad(E[:, None], column[:, None])[:, 0] for column in np.eye(6)], axis=1)
    seen = np.array([0.3, -1.0, 0.5, 2.0, 0.4, -0.6])
    V = np.stack([expm(-u * bracket) @ seen for u in grid.node_positions], axis=1)
    G, strain = np.empty(V.shape), np.repeat(E[:, None], grid.node_count + 1, axis=1)
    write_strain_rates.compiled_for(SE3)(strain, V, G, grid.node_matrices)
    G[:, 0] -= V[:, 0]  # what a clamp would hold
    G[:, -1] += V[:, -1]  # and the reaction
    assert np.abs(G).max() < 1e-12 * np.abs(V).max()
