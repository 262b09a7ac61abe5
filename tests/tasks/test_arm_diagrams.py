"""Phase diagrams of arms: their curves do not depend on what the process solved before."""

import numpy as np
import pytest

import rodsweep as rs
from rodsweep.determinant import parameter_plane
from rodsweep.determinant.arm.determinant import arm_determinant
from rodsweep.tasks.diagram.diagram_curve_search import DiagramCurveSolver

DIAGRAM = {"F": [50.0, 60.0, 70.0], "k1": [102.0, 103.5, 105.0], "k2": 1e4, "gamma3": 0.02}
PROFILE = {"u": [0, 0.5, 0.5, 1], "k3": [1, 1, 0.8, 0.8]}


def test_curves_are_the_same_whatever_was_solved_before(monkeypatch):
    """To the last bit: with two ranks, each had propagators of D for other |w| from its rows."""
    rods = []

    def noted(rod):
        rods.append(rod)
        return arm_determinant(rod)

    monkeypatch.setattr(parameter_plane, "arm_determinant", noted)
    alone = rs.sweep("phase_diagram", **DIAGRAM, profile=PROFILE, progress=False)
    assert alone.curve_F.size > 10
    assert len(rods) > 10
    result = DiagramCurveSolver.result

    def after_many_w(self, view, results):
        for rod in rods[:8]:  # the first rods of the first curve
            for size in np.geomspace(20, 2e4, 40):
                arm_determinant(rod).propagators_for(size)
        return result(self, view, results)

    monkeypatch.setattr(DiagramCurveSolver, "result", after_many_w)
    again = rs.sweep("phase_diagram", **DIAGRAM, profile=PROFILE, progress=False)
    for name in ("curve_F", "curve_k1", "curve_frequency", "fold_F", "fold_k1"):
        assert np.array_equal(alone[name].values, again[name].values)


@pytest.mark.parametrize("cycles", [False, True])
def test_a_row_of_crushed_cones_beside_other_rows_is_crushed(cycles):
    """At the taper 0.6 the force crushes the tip whatever the shear stiffness, along which the row runs."""
    plane = {"F": 75.0, "k1": 150.0, "k2": [1e3, 1e4], "gamma3": 1e-4, "taper": [0.6, 0.8]}
    data = rs.sweep("phase_diagram", **plane, cycles=cycles, **({"cycle_accuracy": 1e-3} if cycles else {}))
    assert data.status.values.ravel().tolist() == [0, 0]
    words = dict(zip(data["class"].flag_values, data["class"].flag_meanings.split(), strict=True))
    classes = data["class"].squeeze(drop=True).transpose("taper", "k2").values
    assert [[words[value] for value in row] for row in classes] == [["crushed"] * 2, ["flutter"] * 2]


def test_check_knows_rows_of_crushed_cones(command):
    command.write(
        "cones.yaml",
        "task: phase_diagram\nparameters: {F: 75, k1: 150, k2: [1.0e3, 1.0e4], gamma3: 0, taper: [0.6, 1]}",
    )
    checked = command("check", "cones.yaml")
    assert (checked.returncode, checked.stderr) == (0, "")
    assert "2 rows, one for each taper" in checked.stdout
