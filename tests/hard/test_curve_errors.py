"""Stated errors of curves of folds and torus points, against branches at the stored value of the row."""

import numpy as np
import pytest
from surveyed import survey_only

import rodsweep as rs

KINDS = {2: "fold", 3: "torus"}


@survey_only
@pytest.mark.parametrize(
    ("rod", "F", "taper", "points"),
    [
        # Near a generalised Hopf point the test function is curved, and the curve is steep.
        ({"k1": 165, "k2": 1e4, "gamma3": 1e-4}, (0, 130, 11), (0.9, 1.3, 4), slice(21, 30, 4)),
        # One step across the curve is long: the matrix belongs to a cycle farther off than the corrections.
        ({"k1": 170, "k2": 1e4, "gamma3": 1e-4}, (0, 130, 27), (0.75, 1.2, 4), slice(7, 12, 4)),
        ({"k1": 1e4, "k2": 1e2, "gamma3": 1e-2}, (0, 230, 24), (0.7, 1.05, 4), slice(0, 4, 3)),
    ],
    ids=["near a generalised Hopf point", "a long step", "torus points"],
)
def test_points_of_curves_lie_on_branches_within_their_errors(rod, F, taper, points):
    axes = {
        name: dict(zip(("start", "stop", "num"), axis, strict=True))
        for name, axis in (("F", F), ("taper", taper))
    }
    found = rs.sweep("phase_diagram", **axes, **rod, cycles=True, certify=False, accuracy=1e-8)
    columns = {
        name: np.asarray(found[f"cycle_curve_{name}"])[points]
        for name in ("kind", "F", "taper", "error", "period")
    }
    assert len(columns["F"]) >= 2
    # 1e-7 is the accuracy of the mesh; a point's distance from the curve adds to it.
    assert (columns["error"] <= 2e-7 * columns["F"]).all()
    for kind, at, t, error, period in zip(*columns.values(), strict=True):
        branch = rs.Rod(**rod, taper=float(t)).branch(stop=1.03 * at + 1, accuracy=1e-6, certify=False)
        kinds = [str(each) for each in branch.special_kind[: branch.special_count]]
        near = [i for i, each in enumerate(kinds) if each == KINDS[int(kind)]]
        assert near, kinds
        i = min(near, key=lambda i: abs(branch.special_period[i] / period - 1))
        assert abs(branch.special_at[i] - at) <= error + branch.special_error[i]
        assert branch.special_period[i] == pytest.approx(period, rel=1e-5)


@pytest.mark.long
def test_curve_of_folds_of_lopsided_cycles_leads_through_all_rows():
    """The fold on the row k1 = 30 is that of `configs/lopsided.yaml`, at F = 19.71302059 by another code."""
    F, k1 = ({"start": start, "stop": stop, "num": num} for start, stop, num in ((12, 24, 13), (30, 32, 2)))
    found = rs.sweep("phase_diagram", F=F, k1=k1, k2=0.5, gamma3=0.1, cycles=True, certify=False)
    assert int(found.cycle_curves_untraced) == 0
    on_curve = {name: np.asarray(found[f"cycle_curve_{name}"]) for name in ("F", "k1", "error", "number")}
    assert set(on_curve["number"]) == {1}
    assert (on_curve["k1"][[0, -1]] == (30, 32)).all()
    assert abs(on_curve["F"][0] - 19.71302059) <= on_curve["error"][0] + 1e-8
