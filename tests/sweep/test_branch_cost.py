"""Estimates of branches say for which rods no times were measured."""

import numpy as np
import pytest

from rodsweep.cli.checking import print_job_check
from rodsweep.model.material.rod_material import DEFAULT_MATERIAL, RodMaterial
from rodsweep.sweep.branch_cost import branches_cost
from rodsweep.sweep.points.points import Points
from rodsweep.tasks.running.job import job_of_file


def points_of(material=None, **columns):
    values = {"k1": 1e4, "k2": 1e4, "gamma3": 1e-3, "taper": 1.0} | columns
    columns = {name: np.atleast_1d(value) for name, value in values.items()}
    length = max(map(len, columns.values()))
    full = {name: np.resize(value, length) for name, value in columns.items()}
    return Points(tuple(full), tuple(full.values()), is_grid=False, material=material or DEFAULT_MATERIAL)


@pytest.mark.parametrize(
    ("columns", "material", "doubt"),
    [
        ({}, None, ""),
        ({"taper": 0.5}, None, ""),
        ({"taper": [1.0, 0.19]}, None, "branches of cones with a taper outside 0.5 to 1.5"),
        ({"taper": 2.0}, None, "branches of cones with a taper outside 0.5 to 1.5"),
        ({"k1": [1e4, 60.0]}, None, "branches near the crushing force"),
        ({}, RodMaterial("neo_hookean", "swelling"), "branches of rubber"),
        ({}, RodMaterial("neo_hookean", "fixed"), "branches of rubber"),
    ],
)
def test_rods_without_measured_times_are_in_doubt(columns, material, doubt):
    assert branches_cost(points_of(material, **columns), "F", (0.0, 60.0), 1e-7).underestimated_rods == doubt


@pytest.mark.parametrize(("material", "known"), [("", True), ("material: {law: neo_hookean}\n", False)])
def test_check_of_a_diagram_with_cycles_says_when_its_time_is_not_known(tmp_path, capsys, material, known):
    path = tmp_path / "d.yaml"
    path.write_text(
        "task: phase_diagram\nparameters: {F: [0, 60], k1: [330, 600], k2: 1.0e4, gamma3: 1.0e-4}\n"
        f"{material}phase_diagram: {{cycles: true}}\n"
    )
    print_job_check(job_of_file(path, ()))
    text = " ".join(capsys.readouterr().out.split())
    assert ("this estimate is uncertain: branches of rubber" in text) is not known
    assert "not counted, because only the run shows them: branches beyond the range, curves of folds" in text
    assert "rows that such a curve shows to have a detached branch" in text


@pytest.mark.parametrize(("F", "known"), [("[60, 300]", True), ("[60, 400]", False)])
def test_check_says_that_cycles_far_above_flutter_may_take_longer(tmp_path, capsys, F, known):
    """0.2 s were foreseen for rods whose motion does not repeat; it took more than 60 s."""
    path = tmp_path / "c.yaml"
    path.write_text(f"task: limit_cycle\nparameters: {{F: {F}, k1: 1.0e4, k2: 1.0e4, gamma3: 1.0e-4}}\n")
    print_job_check(job_of_file(path, ()))
    text = " ".join(capsys.readouterr().out.split())
    assert (
        "this estimate is uncertain: rods far above flutter, whose motion may not repeat, may" in text
    ) is (not known)
    assert "not counted" not in text
