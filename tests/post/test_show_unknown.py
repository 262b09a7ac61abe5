"""`rodsweep show` claims nothing that a file does not hold: full lists, cut branches, failed searches."""

import contextlib
import io
from dataclasses import replace

import numpy as np
import pytest
from shown import shown

import rodsweep as rs
from rodsweep.api.dataset import view_of_dataset
from rodsweep.determinant.arm.hull import hull
from rodsweep.post.summary import show_summary
from rodsweep.results.file.provenance import (
    FAILURE_REASONS_ATTRIBUTE,
    MAX_FAILURE_REASONS,
    joined_reasons_attribute,
    merged_history,
)
from rodsweep.results.layouts.phase_diagram import BOUNDARY_CURVE_END_REASONS, STABILITY_CLASSES
from rodsweep.results.layouts.thresholds import CROSSING_KINDS
from rodsweep.solve.changes.diagram import boundary_curves

ROD = "k1: 200, k2: 1.0e4, gamma3: 1.0e-4"
ROWS = {"F": rs.linspace(0.0, 190.0, 20), "k1": 200.0, "k2": [1e3, 1e4], "gamma3": 1e-4}
BESIDE = "stable cycles beside a stable straight rod"


def told(view):
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        show_summary(view)
    return " ".join(out.getvalue().split())


def view_of_sweep(tmp_path, task, **keywords):
    return view_of_dataset(rs.sweep(task, progress=False, **keywords), tmp_path / "c.h5")


def changed(view, **variables):
    """The view with some variables in place of its own."""
    own = {name: np.asarray(view.variables[name]) for name in view.variables}
    return replace(view, variables=own | variables)


def test_a_cycle_of_time_integration_has_no_verdict_of_multipliers(command):
    task = "task: limit_cycle\naccuracy: 1.0e-3\n"
    lines = shown(command, f"{task}parameters: {{F: 60, {ROD}}}\nlimit_cycle: {{method: integration}}\n")
    assert "the rod beats" in lines
    assert "no Floquet multiplier is computed" in lines
    assert "below 1" not in lines


def test_a_cycle_of_a_rod_whose_leading_mode_is_real_has_no_ratio_of_frequencies(tmp_path):
    """As of soft segments of rubber far beyond flutter, whose two leading eigenvalues are real."""
    view = view_of_sweep(tmp_path, "limit_cycle", F=60.0, k1=200.0, k2=1e4, gamma3=1e-4, accuracy=1e-3)
    assert "times that of the leading mode" in told(view)
    real = told(changed(view, linear_frequency=np.zeros_like(view.variables["linear_frequency"])))
    assert "rad/tau2; the leading mode of the straight rod does not oscillate" in real
    assert "times the frequency" not in real


BRANCHES = {"k1": 200.0, "gamma3": 1e-4, "stop": 190.0}
"""The rod of k2 = 1e4 has stable cycles beside a stable straight rod from F = 155.6 on."""


def test_a_branch_that_is_cut_short_leaves_open_where_cycles_are_stable(tmp_path):
    whole = told(view_of_sweep(tmp_path, "branch", k2=1e4, **BRANCHES))
    assert f"{BESIDE}: F = 155.6" in whole
    cut = told(view_of_sweep(tmp_path, "branch", k2=1e4, cycles=4, **BRANCHES))
    assert f"{BESIDE}: not known" in cut
    assert "no cycle is stored" in cut
    assert "no stable cycle" not in cut


def test_a_boundary_curve_that_is_cut_short_is_not_whole(tmp_path, monkeypatch):
    plane = {"F": rs.linspace(0.0, 90.0, 10), "k1": [100.0, 300.0], "k2": 1e4, "gamma3": 1e-4}
    (tmp_path / "whole").mkdir()
    assert "is incomplete" not in told(view_of_sweep(tmp_path / "whole", "phase_diagram", **plane))
    few = replace(boundary_curves.BOUNDARY_STEP_CONTROL, max_solutions=5)
    monkeypatch.setattr(boundary_curves, "BOUNDARY_STEP_CONTROL", few)
    view = view_of_sweep(tmp_path, "phase_diagram", **plane)
    reasons = [view.variables[name] for name in ("curve_start", "curve_end")]
    full = np.flatnonzero(
        np.any(np.array(reasons) == list(BOUNDARY_CURVE_END_REASONS).index("list_full"), axis=0)
    )
    assert len(full) > 0
    said = told(view)
    for i in full:
        k1, F = (float(view.variables[f"curve_{name}"][i]) for name in ("k1", "F"))
        where = f"is incomplete: it stops at k1 = {k1:.6g}, F = {F:.6g}"
        assert f"{where}: the curve has the maximum number of points" in said


@pytest.mark.long
def test_branches_that_are_cut_short_leave_rods_open(tmp_path):
    whole = told(view_of_sweep(tmp_path, "branch", k2=[1e3, 1e4], **BRANCHES))
    assert f"{BESIDE} at 1 of 2 rods k2" in whole
    cut = told(view_of_sweep(tmp_path, "branch", k2=[1e3, 1e4], cycles=4, **BRANCHES))
    assert f"{BESIDE} at 0 of 2 rods, not known at 2 rods" in cut


@pytest.mark.long
def test_a_list_of_special_points_that_is_full_for_all_rods_states_no_rods(tmp_path):
    lines = told(view_of_sweep(tmp_path, "branch", k2=[1e3, 1e4], special=1, **BRANCHES))
    assert "whether two states are stable is not known for 2 rods" in lines
    assert BESIDE not in lines


def test_hopf_points_that_are_not_stored_are_not_among_all(tmp_path):
    rods = {"k1": 200.0, "k2": [1e3, 1e4], "gamma3": 1e-4, "F_max": 190.0}
    assert "stored Hopf points: 2 super" in told(view_of_sweep(tmp_path, "criticality", crossings=1, **rods))
    assert "all Hopf points: 2 super" in told(view_of_sweep(tmp_path, "criticality", **rods))


def test_rods_whose_search_failed_are_not_rods_without_thresholds(tmp_path):
    rods = {"k1": 200.0, "k2": [1e3, 1e4], "gamma3": 1e-4, "F_max": 190.0}
    view = view_of_sweep(tmp_path, "thresholds", **rods)
    assert "is stable again): F = 155.6 (k2 = 10000), at 1 of 2 rods; frequency" in told(view)
    count = np.asarray(view.variables["crossing_count"]).copy()
    count[..., 0, 0] = -1
    failed = changed(view, crossing_count=count)
    assert "is stable again): F = 155.6 (k2 = 10000), at 1 of 2 rods, not known at 1 rod; frequency" in told(
        failed
    )
    forms = view_of_sweep(tmp_path, "criticality", **rods)
    count = np.asarray(forms.variables["crossing_count"]).copy()
    count[..., 0, 0, 0] = -1
    failed = changed(forms, crossing_count=count)
    assert "Hopf points at 1 of 2 rods (k2 = 10000), not known at 1 rod" in told(failed)


def test_a_rod_with_an_open_range_has_no_threshold_located(tmp_path):
    view = view_of_sweep(tmp_path, "thresholds", k1=200.0, k2=1e4, gamma3=1e-4, F_max=10.0)
    assert "no threshold up to F = 10" in told(view)
    shape = view.variables["open_from"].shape
    opened = changed(view, open_from=np.full(shape, 3.0), open_to=np.full(shape, 4.0))
    assert "no threshold is located up to F = 10" in told(opened)


def test_changes_of_rows_that_are_not_stored_may_be_more(tmp_path):
    """The second row of a diagram loses its restabilization, as from a list that is full."""
    view = view_of_sweep(tmp_path, "phase_diagram", **ROWS)
    assert "restabilization (the last unstable pair becomes stable): on 1 of 2 rows" in told(view)
    kinds = np.asarray(view.variables["crossing_kind"]).copy()
    kinds[kinds == CROSSING_KINDS.index("hopf")] = 0
    assert "becomes stable): on at least 1 of 2 rows" in told(changed(view, crossing_kind=kinds))


def test_a_row_that_is_undecided_is_no_row_without_flutter(tmp_path):
    view = view_of_sweep(
        tmp_path, "phase_diagram", **ROWS | {"k1": [100.0, 200.0], "k2": 1e4, "F": [0.0, 60.0]}
    )
    assert "flutter: on 1 of 2 rows, k1 = 200; none on 1, k1 = 100" in told(view)
    classes = np.asarray(view.variables["class"]).copy()
    classes[..., 0, 0, 0, 1] = next(number for number, word in STABILITY_CLASSES if word == "undecided")
    shown = told(changed(view, **{"class": classes}))
    assert "none on" not in shown
    assert "undecided: on 1 of 2 rows, F = 60, k1 = 100" in shown


EARLY = {"k1": np.inf, "gamma3": 0.0, "F_max": 60.0} | {
    "profile": {"u": [0.0, 0.5, 0.5, 1.0], "k2": [1.0, 1.0, 0.5, 0.5], "k3": [1.0, 1.0, 0.5, 0.5]}
}


def test_beyond_a_search_that_ended_early_nothing_is_known(tmp_path, monkeypatch):
    """A smaller limit of the a-priori bound leaves none for the stepped arm beyond a force."""
    monkeypatch.setattr(hull, "HULL_SETTINGS", replace(hull.HULL_SETTINGS, min_one_minus_c=0.995))
    view = view_of_sweep(tmp_path, "thresholds", k2=1e4, **EARLY)
    end = float(view.variables["F_end"].ravel()[0])
    lines = told(view)
    assert 30.0 < end < 60.0
    assert "flutter from F = 27.0372; 2 crossings up to F = " in lines
    assert f"; not known beyond F = {end:.6g}, where the search ended early" in lines
    assert f"searched up to F = {end:.15g}; the list of crossings is confirmed by counts" in lines
    answer = rs.Rod(k2=1e4, **{n: v for n, v in EARLY.items() if n != "F_max"}).thresholds(F_max=60.0)
    first = " ".join(str(answer).split("Rod(", 1)[0].split())
    assert first.endswith(f"; not known beyond F = {end:.6g} k3/L^2, where the search ended early")
    rods = told(view_of_sweep(tmp_path, "thresholds", k2=[5e3, 1e4], **EARLY))
    assert "starts to flutter): F = 27.0372 (k2 = 10000), at 1 of 2 rods, not known at 1 rod" in rods
    assert "is stable again): at none of 2 rods, not known at 2 rods" in rods
    forms = told(view_of_sweep(tmp_path, "criticality", k2=[5e3, 1e4], **EARLY))
    assert "Hopf points at 1 of 2 rods (k2 = 10000), not known at 1 rod" in forms


def test_show_names_the_reason_of_each_kind_of_failure_with_a_point(tmp_path):
    """Two points fail for one reason in two numbers."""
    rod = {"k1": 1e4, "k2": 1e2, "gamma3": 1e-2, "method": "integration", "accuracy": 1e-3}
    view = view_of_sweep(tmp_path, "limit_cycle", F=[27.45, 27.5], most_periods=20, **rod)
    said = told(view)
    at = "gamma3 = 0.01, gamma1 = 1: "
    assert said.count("not_settled, for example at F = ") == 1
    why = "the motion does not repeat: after 20 returns of the tip "
    assert f"not_settled, for example at F = 27.45, k1 = 10000, k2 = 100, {at}{why}" in said
    status = view.variables["status"].copy()
    status[0] = 0
    anew = changed(view, status=status)
    assert ", for example at F = " not in told(anew)


def test_files_that_are_merged_keep_the_reasons_of_both():
    one, other = "F=1.0: failed a", "F=2.0: failed b"
    attributes = [{FAILURE_REASONS_ATTRIBUTE: text} for text in (one, f"{one}\n{other}")] + [{}]
    assert merged_history(attributes)[FAILURE_REASONS_ATTRIBUTE] == f"{one}\n{other}"
    assert FAILURE_REASONS_ATTRIBUTE not in merged_history([{}])
    # Without an empty line, which is no failed point, where only the second file has reasons.
    assert merged_history([{}, {FAILURE_REASONS_ATTRIBUTE: one}])[FAILURE_REASONS_ATTRIBUTE] == one
    assert (
        joined_reasons_attribute("F=1.0: failed after 3 steps", "F=2.0: failed after 4 steps")[
            FAILURE_REASONS_ATTRIBUTE
        ].count("F=")
        == 1
    )
    many = "\n".join(f"F={i}.0: failed {'x' * i}" for i in range(2 * MAX_FAILURE_REASONS))
    assert len(joined_reasons_attribute(many)[FAILURE_REASONS_ATTRIBUTE].splitlines()) == MAX_FAILURE_REASONS


@pytest.mark.parametrize(
    ("task", "told_of_one"),
    [
        ("thresholds", "the thresholds of this rod are not known"),
        ("criticality", "the Hopf points of this rod are not known"),
    ],
)
def test_a_failed_search_is_not_told_as_a_search_without_thresholds(command, task, told_of_one):
    """No bound on the eigenvalues of this rod can be computed in double precision."""
    parameters = "k1: {}, k2: 1.0e-300, gamma3: 1.0e+300"
    text = f"task: {task}\nparameters: {{{parameters}}}\n"
    pages = []
    for name, k1 in (("one", "1.0e+300"), ("two", "[200, 1.0e+300]")):
        command.write(f"{name}.yaml", text.replace("k1: {}", f"k1: {k1}"))
        command.solved(f"{name}.yaml")
        pages.append(command("show", f"{name}.h5").stdout)
    one, several = pages
    assert told_of_one in one
    assert "not known at 2 rods" in several
    for page in pages:
        assert "searched up to" not in page
        assert "no threshold up to" not in page
    failed = getattr(rs.Rod(k1=1e300, k2=1e-300, gamma3=1e300), task)()
    assert (str(failed.status), failed.crossing_count) == ("failed", None)
    assert "up to" not in str(failed)


def test_show_claims_no_mesh_only_where_the_file_stores_none(command):
    command.write("c.yaml", "task: spectrum\nparameters: {F: -1.0e+5, k1: 146, k2: 1.0e+6, gamma3: 1.0e-4}\n")
    command("run", "c.yaml")
    page = command("show", "c.h5").stdout
    assert "no mesh of at most 10000 unknowns resolves the requested modes" in page
    assert "no mesh is stored: eigenvalues were continued from a neighbouring point, or not found" in page
    assert "needed" not in page
