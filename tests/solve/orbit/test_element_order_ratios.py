"""Elements of unequal orders: where the cycle of an arm of segments needs a low order, it gets one."""

import pickle
from dataclasses import replace

import numpy as np
import pytest

from rodsweep.discretization.elements.mesh import mesh_with_edges
from rodsweep.discretization.stress.form import StressForm
from rodsweep.model.material.profile import FACTOR_NAMES, Profile
from rodsweep.model.material.rod_material import RodMaterial
from rodsweep.model.rod import Rod
from rodsweep.solve.cycle.accuracy.refinement import refined_cycle
from rodsweep.solve.cycle.hopf_start import hopf_point_below_force, orbit_from_hopf
from rodsweep.solve.cycle.transient.motion_mesh import coarse_mesh_for_branch_to_cycle
from rodsweep.solve.orbit.coefficient_tails import largest_coefficients_of_elements
from rodsweep.solve.orbit.element_order_choice import (
    ROD_ELEMENT_ORDER_RATIO_SETTINGS,
    element_order_ratios,
    without_excess_orders,
)
from rodsweep.solve.orbit.matrix.workspace import NewtonWorkspace
from rodsweep.solve.orbit.measures import CycleMotion
from rodsweep.solve.orbit.newton import solve_by_newton
from rodsweep.solve.orbit.orbit_mesh import OrbitMesh, mesh_of_orbit

ACCURACY = 1e-7
RODS = {
    "stiff base": (0.4, (0.36, 0.36, 0.13), {"F": 13.0}, ("linear", "fixed")),
    "soft base": (0.75, (20.0, 20.0, 60.0), {"F": 60.0}, ("linear", "fixed")),
    "rubber": (0.3, (0.5, 0.5, 0.2), {"F": 14.0}, ("neo_hookean", "swelling")),
}
"""Position of the jump, factors of k1, k2 and k3 behind it, force, and law: arms that beat."""


def refined(name):
    """(cycle, memory) of an arm of `RODS`."""
    at, stiffness, values, names = RODS[name]
    profile = Profile((0.0, at, at, 1.0), ((1.0,) * len(FACTOR_NAMES),) * 2 + ((*stiffness, 1, 1, 1),) * 2)
    rod = Rod(**values, k1=1e4, k2=1e4, gamma3=1e-3, gamma1=0.7, material=RodMaterial(*names, profile))
    memory = NewtonWorkspace()
    form = StressForm(rod, coarse_mesh_for_branch_to_cycle(rod))
    return refined_cycle(orbit_from_hopf(form, hopf_point_below_force(rod), memory), ACCURACY, memory), memory


@pytest.mark.parametrize("name", RODS)
def test_a_cycle_on_elements_of_unequal_orders_is_within_its_error(name):
    found, memory = refined(name)
    orbit = found.orbit
    grid = orbit.form.mesh
    assert min(grid.orders) <= 0.75 * grid.order
    equal = mesh_with_edges(grid.edges, grid.order + 8)
    exact = solve_by_newton(
        orbit.on_mesh(equal, 2 * orbit.interval_count, orbit.stage_count + 1), 1e-12, memory
    ).orbit
    assert abs(found.measures.period / exact.period - 1) <= found.errors.period_error <= 3 * ACCURACY
    y = CycleMotion(exact).tip_extrema["tip_y_max"]
    assert abs(found.measures.tip_y_max / y - 1) <= found.errors.amplitude_error


def test_coefficients_beyond_the_order_of_an_element_are_small():
    orbit = refined("stiff base")[0].orbit
    grid = orbit.form.mesh
    fine = orbit.on_mesh(mesh_with_edges(grid.edges, grid.order), orbit.interval_count, orbit.stage_count)
    aim = 1e-4
    ratios = element_order_ratios(fine, grid.order, aim)
    assert ROD_ELEMENT_ORDER_RATIO_SETTINGS.min_element_order_ratio <= min(ratios) <= 0.5
    assert max(ratios) == 1
    each = largest_coefficients_of_elements(fine)
    largest = np.max([c.max(axis=1) for c in each], axis=0)
    for c, order in zip(each, mesh_with_edges(grid.edges, grid.order, ratios).orders, strict=True):
        assert (c[:, order:] <= aim * largest[:, None]).all()


@pytest.mark.parametrize("order", [10, 13, 15, 16, 18, 24])
def test_all_orders_change_with_the_largest_order(order):
    """The difference between cycles on two meshes must contain the error of every element."""
    ratios = (0.25, 1.0, 0.3, 1.0, 0.5)
    mesh = OrbitMesh((0.0, 0.1, 0.4, 0.5, 0.9, 1.0), 14, 9, 4, ratios)
    other = mesh.with_order(order)
    orders = np.array(other.space_mesh.orders)
    assert other.order == max(orders) == order
    changes = orders - mesh.space_mesh.orders
    assert (np.sign(changes) == np.sign(order - mesh.order)).all()
    # The errors of an element may be equal for an order and the next, by parity.
    least = min(2, abs(order - mesh.order))
    assert min(abs(changes)) >= least
    assert abs(orders - np.array(ratios) * order).max() <= 1 + least
    assert mesh.with_order(mesh.order) == mesh
    plain = OrbitMesh((0.0, 0.5, 1.0), 14, 9, 4)
    assert plain.with_order(order) == OrbitMesh((0.0, 0.5, 1.0), order, 9, 4)


def test_a_mesh_with_unequal_orders_is_stored_and_refined():
    mesh = OrbitMesh((0.0, 0.25, 1.0), 17, 9, 3, (0.5, 1.0))
    assert OrbitMesh.from_array(mesh.as_array) == mesh
    plain = OrbitMesh((0.0, 0.25, 1.0), 17, 9, 3)
    assert OrbitMesh.from_array(plain.as_array) == plain
    spaced = replace(mesh, spacing_ratios=(1.0, 0.25))
    assert OrbitMesh.from_array(spaced.as_array) == spaced != mesh
    assert not spaced.has_same_edges_and_order_ratios(mesh)
    assert (mesh.unknown_count, plain.unknown_count) == (3 * (9 + 17), 3 * (17 + 17))
    assert mesh.space_mesh.orders == (9, 17)
    assert (np.array(mesh.mesh_finer_in_space.space_mesh.orders) > mesh.space_mesh.orders).all()
    halved = OrbitMesh((0.0, 0.25, 1.0), 40, 9, 3, (0.5, 1.0)).mesh_finer_in_space
    assert halved.space_mesh.orders == (12, 12, 24, 24)
    orbit = refined("soft base")[0].orbit
    sent = pickle.loads(pickle.dumps(orbit))
    assert mesh_of_orbit(sent) == mesh_of_orbit(orbit)
    assert mesh_of_orbit(sent).order_ratios


@pytest.mark.parametrize("name", RODS)
def test_an_element_loses_the_orders_that_do_not_reduce_the_error(name):
    found, memory = refined(name)
    orders = found.orbit.form.mesh.orders
    high = max(orders) - 5

    def mesh_with_orders(low):
        return mesh_of_orbit(found.orbit).with_orders([high if p == max(orders) else low for p in orders])

    def solved(mesh):
        return solve_by_newton(mesh.interpolated_orbit(found.orbit), 1e-12, memory).orbit

    def measures(mesh):
        orbit = solved(mesh)
        return np.array([orbit.period, *CycleMotion(orbit).tip_extrema.values()])

    start = mesh_with_orders(high - 2)
    finer = replace(start, order=high + 3)
    trimmed = without_excess_orders(start, solved(finer))
    low = min(trimmed.orders)
    assert max(trimmed.orders) == high >= 2 * low
    exact = measures(finer.with_orders((high + 9,) * 2))
    kept, lost, too_low = (
        abs(measures(mesh) / exact - 1).max() for mesh in (start, trimmed, mesh_with_orders(low - 2))
    )
    assert lost <= 1.6 * kept
    assert too_low >= 5 * kept
    assert without_excess_orders(start, found.orbit) is start
