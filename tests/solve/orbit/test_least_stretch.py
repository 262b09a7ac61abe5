"""The smallest stretch h1 of a cycle, against values on a fine grid of positions and times."""

import numpy as np
import pytest

from rodsweep.model.rod import Rod
from rodsweep.solve.branch.branch_limits import BranchRequest
from rodsweep.solve.branch.branches import solve_branches
from rodsweep.solve.orbit import measures
from rodsweep.solve.orbit.least_stretch import LEAST_STRETCH_SETTINGS
from rodsweep.solve.orbit.measures import CycleMotion


@pytest.fixture(scope="module")
def compressed_cycles() -> list[tuple[CycleMotion, float, float]]:
    """(path, smallest nodal h1, smallest h1 as measured) of cycles of a rod that the force almost crushes."""
    seen = []
    search = measures.least_stretch_between_nodes

    def recorded(path: CycleMotion, at_nodes: float) -> float:
        found = search(path, at_nodes)
        seen.append((path, at_nodes, found))
        return found

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(measures, "least_stretch_between_nodes", recorded)
        request = BranchRequest("F", 60.0, 95.0, 1e-4, certify=True, cycles=500, special=50)
        solve_branches(Rod(F=0.0, k1=100.0, k2=1e4, gamma3=0.1), request)
    return seen


def least_on_fine_grid(path: CycleMotion) -> float:
    """Smallest h1 at 4000 positions on the rod and 1024 times of the period."""
    c = path.strain_coefficients[:, 0]
    positions = path.orbit.form.mesh.one_sided_evaluation_matrix(np.linspace(0.0, 1.0, 4000))
    turns = np.exp(2j * np.pi * np.outer(np.arange(1024) / 1024, np.arange(len(c))))
    return float((turns @ (c @ positions.T)).real.min())


def test_small_stretch_is_measured_between_the_nodes_too(compressed_cycles) -> None:
    """Where h1 is small its smallest value lies below the nodal values; where it is large these suffice."""
    small = [each for each in compressed_cycles if each[1] <= LEAST_STRETCH_SETTINGS.safe_nodal_stretch]
    large = [each for each in compressed_cycles if each[1] > LEAST_STRETCH_SETTINGS.safe_nodal_stretch]
    assert len(small) > 3
    assert len(large) > 3
    for path, at_nodes, found in small[::3]:
        true = least_on_fine_grid(path)
        assert true - 1e-5 < found <= at_nodes
        assert found - true < 1e-5
    for path, at_nodes, found in large[::5]:
        assert found == at_nodes
        assert least_on_fine_grid(path) > 0.9 * at_nodes


def test_measures_of_a_cycle_have_the_searched_stretch(compressed_cycles) -> None:
    """The verdict `left_the_model`, the file and the ends of branches use one number."""
    path, at_nodes, found = min(compressed_cycles, key=lambda each: each[1])
    assert measures.measures_of(path).least_stretch == found < at_nodes
