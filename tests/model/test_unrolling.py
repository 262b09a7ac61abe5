"""Functions of an algebra: written out they do what their loops do; what cannot be written out is refused.

Balance and Jacobian are compared with their loops in `test_space`, where both are compiled for se(3) anyway.
"""

import importlib.util

import numpy as np
import pytest

from rodsweep.discretization.elements.mesh import uniform_mesh
from rodsweep.discretization.nodal_rod import nodal_rod, nodal_rod_derivative
from rodsweep.discretization.stress.balance import (
    write_balance_parameter_derivative,
    write_velocities_and_rates,
)
from rodsweep.model.compiled.digest import kernel_digest, kernel_of
from rodsweep.model.compiled.unrolling import UnrolledOverAlgebra
from rodsweep.model.lie_algebra import SE2, SE3
from rodsweep.model.rod import Rod

ROD, GRID = Rod(F=50.0, k1=1e3, k2=1e2, gamma3=1e-2), uniform_mesh(2, 3)
PLANE = ROD.with_values(gamma1=0.7).balance_coefficients
HEAD = "from rodsweep.model.compiled.unrolling import UnrolledOverAlgebra\n\n@UnrolledOverAlgebra\n"
BOTH = pytest.mark.parametrize("g", [SE2, SE3], ids=["plane", "space"])


def test_derivative_along_a_parameter_is_that_of_loops_in_python():
    rod, change = nodal_rod(PLANE, GRID), nodal_rod_derivative(ROD.balance_coefficient_derivative("k1"), GRID)
    x = np.random.default_rng(1).standard_normal(3 * GRID.node_count)
    V, G = np.empty((2, 3, GRID.node_count + 1))
    write_velocities_and_rates(SE2, x, V, G, rod, GRID.node_matrices)
    out = np.empty((2, 3, 3, GRID.node_count + 1))
    write_balance_parameter_derivative.compiled_for(SE2)(x, V, out[0], change, rod, GRID.node_matrices)
    write_balance_parameter_derivative(SE2, x, V, out[1], change, rod, GRID.node_matrices)
    assert np.abs(out[0] - out[1]).max() <= 1e-13 * np.abs(out[1]).max()


@UnrolledOverAlgebra
def decided(g, x):
    total = 0.0
    both = [
        [x[a] * x[b] if g.ad_pattern[a][b] else 0.0 for b in g.component_indices] for a in g.component_indices
    ]
    for a, b, o, sign in g.structure_constants:
        if a == o:
            total += x[b] / 0.0
        else:
            total += sign * both[a][o] if g.ad_pattern[a][o] else x[a] / 0.0
    return total


@UnrolledOverAlgebra
def left_early(g, x):
    for a in g.component_indices:
        if x[a] > 0:
            break
    return a


@BOTH
def test_conditions_on_the_algebra_are_decided_before_compilation(g):
    x = np.arange(1.0, 1 + g.dimension)
    assert decided.compiled_for(g)(x) == pytest.approx(
        sum(sign * x[a] * x[o] for a, _, o, sign in g.structure_constants)
    )


def test_a_loop_that_is_left_early_is_not_written_out():
    with pytest.raises(TypeError, match="has no break"):
        left_early.compiled_for(SE2)


def test_algebras_have_kernels_of_their_own():
    assert write_velocities_and_rates.compiled_for(SE2) is write_velocities_and_rates.compiled_for(SE2)
    assert write_velocities_and_rates.compiled_for(SE2) is not write_velocities_and_rates.compiled_for(SE3)


@pytest.mark.parametrize(
    ("text", "same"), [("    # a comment\n    return x[0]", True), ("    return x[1]", False)]
)
def test_compiled_code_is_kept_by_the_formula_not_by_its_comments(tmp_path, text, same):
    digests = []
    for k, body in enumerate(("    return x[0]", text)):
        path = tmp_path / f"{k}.py"
        path.write_text(
            "from rodsweep.model.compiled.unrolling import UnrolledOverAlgebra\n\n"
            f"@UnrolledOverAlgebra\ndef f(g, x):\n{body}\n"
        )
        spec = importlib.util.spec_from_file_location("of_a_test", path)
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        digests.append(kernel_digest(kernel_of(module.f.unrolled_for(SE2), {}), {}))
    assert (digests[0] == digests[1]) == same
