"""Where fields lie in a state, and what a symmetry makes of one."""

import numpy as np
import pytest

from rodsweep.discretization.elements.mesh import uniform_mesh
from rodsweep.discretization.plane_equations import write_balance
from rodsweep.discretization.state_layout import StateLayout
from rodsweep.discretization.straight.mixed_form import MixedForm
from rodsweep.discretization.stress.form import StressForm
from rodsweep.model.rod import Rod
from rodsweep.solve.orbit.symmetry import NO_SYMMETRY, REFLECTION, Symmetry

FORMS = {
    "Omega eliminated": StressForm(Rod(F=50.0, k1=1e4, k2=1e2, gamma3=1e-2, gamma1=0.7), uniform_mesh(2, 4)),
    "Omega unknown": StressForm(Rod(F=50.0, k1=np.inf, k2=1e2, gamma3=0.0, gamma1=0.7), uniform_mesh(2, 4)),
}
EACH = pytest.mark.parametrize("form", FORMS.values(), ids=FORMS.keys())


def states(layout, *many):
    return np.random.default_rng(5).standard_normal((*many, layout.unknown_count))


@pytest.mark.parametrize(
    "layout", [StateLayout(3, 4), StateLayout(3, 4, (2,)), StateLayout(6, 3, (0, 3))], ids=str
)
@pytest.mark.parametrize("many", [(), (5,), (2, 3)])
def test_a_state_is_made_of_its_fields_and_taken_apart_again(layout, many):
    x = states(layout, *many)
    S, known = layout.stresses(x), layout.velocities(x)
    assert S.shape == (layout.component_count, *many, layout.node_count + 1)
    assert known.shape == (len(layout.unknown_velocity_components), *many, layout.node_count + 1)
    assert not S[..., -1].any()
    V = np.full(S.shape, np.nan)
    V[list(layout.unknown_velocity_components)] = known
    assert np.array_equal(layout.state(S, V), x)


def test_a_field_is_known_by_its_name():
    layout = StateLayout(3, 4, (2,))
    x = states(layout, 2)
    for number, name in enumerate(("n1", "n2", "m3")):
        assert np.array_equal(layout.stress_field(x, name), layout.stresses(x)[number, :, :-1])
        assert np.array_equal(x[:, layout.stress_index(name, 2)], layout.stress_field(x, name)[:, 2])
    row = layout.state_with_stresses({"m3": np.arange(4.0)})
    assert x @ row == pytest.approx(layout.stress_field(x, "m3") @ np.arange(4.0))
    layout.stress_field(x, "n2")[:] = 0
    assert not layout.stresses(x)[1].any(), "a field is a view"
    with pytest.raises(ValueError, match="not in"):
        layout.stress_field(x, "n3")


@EACH
@pytest.mark.parametrize("symmetry", [NO_SYMMETRY, REFLECTION], ids=["none", "reflection"])
def test_a_symmetry_maps_motions_to_motions(form, symmetry):
    def motion(x):
        V, G = np.empty((2, 3, form.mesh.node_count + 1))
        write_balance(x, V, G, form.nodal_rod, form.mesh.node_matrices)
        return V, form.layout.state(G, V)

    x = states(form.layout)
    V, rate = motion(x)
    image, rate_of_image = motion(symmetry.apply(x, form.layout))
    assert image == pytest.approx(symmetry.component_matrix @ V, abs=1e-12 * np.abs(V).max())
    assert rate_of_image == pytest.approx(symmetry.apply(rate, form.layout), abs=1e-12 * np.abs(rate).max())


@EACH
def test_the_reflection_is_the_one_of_the_mixed_form(form):
    x, layout = states(form.layout), MixedForm(form.rod, form.mesh).layout
    X = states(layout)
    assert np.array_equal(REFLECTION.apply(X, layout), MixedForm(form.rod, form.mesh).reflection_signs * X)
    assert np.array_equal(
        REFLECTION.reversal_mask(form.layout) * x, (x - REFLECTION.apply(x, form.layout)) / 2
    )


@pytest.mark.parametrize("layout", [StateLayout(3, 4, (2,)), StateLayout(6, 3)], ids=["plane", "space"])
def test_a_symmetry_is_a_matrix_and_is_undone(layout):
    turn, _ = np.linalg.qr(np.random.default_rng(1).standard_normal((layout.component_count,) * 2))
    if layout.unknown_velocity_components:  # what leaves Omega alone
        turn = np.array([[0.6, -0.8, 0.0], [0.8, 0.6, 0.0], [0.0, 0.0, -1.0]])
    symmetry, x, P = Symmetry(turn, 3), states(layout, 2), states(layout, layout.unknown_count)
    S = symmetry.matrix(layout)
    assert symmetry.apply(x, layout) == pytest.approx(x @ S.T)
    assert symmetry.apply_inverse_to_flow(P, layout) == pytest.approx(np.linalg.solve(S, P))
