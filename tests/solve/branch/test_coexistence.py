"""Phase diagrams with cycles: where straight and beating rods are both stable, and the curves of folds."""

import re
from dataclasses import replace

import h5py
import numpy as np
import pytest
from conftest import Command
from contents import content, same
from surveyed import survey_only
from test_paper import stated

import rodsweep as rs
from rodsweep.determinant.parameter_plane import PlaneAxis
from rodsweep.errors import InputError
from rodsweep.model.rod import Rod
from rodsweep.post.summary.phase_diagram import phase_diagram_summary
from rodsweep.post.summary.selection import PointSelection
from rodsweep.results.file.view import read_view
from rodsweep.results.layouts.phase_diagram import CYCLE_CURVE_END_REASONS
from rodsweep.solve.branch import coexistence
from rodsweep.solve.branch.bordered.border_condition import BorderCondition
from rodsweep.solve.branch.bordered.matrix import BorderedMatrix
from rodsweep.solve.branch.bordered.scale import ArcLengthScale
from rodsweep.solve.branch.coexistence import StableStates, solve_coexistence
from rodsweep.solve.branch.special.augmented.fold_and_torus_test_functions import FoldTestFunction
from rodsweep.solve.branch.special.curve_problem import SpecialCurveProblem
from rodsweep.solve.branch.special.special_curves import (
    CurveEndReason,
    CurvePoint,
    HalfCurve,
    SpecialPointCurve,
)
from rodsweep.solve.branch.special.special_point import SpecialPointKind
from rodsweep.solve.branch.status import BranchStatus, CoexistenceStatus
from rodsweep.solve.changes.diagram.rows import RowRequest
from rodsweep.solve.orbit.matrix.workspace import NewtonWorkspace
from rodsweep.tasks.running.job import job_of_file

FOLD, RESTABILIZATION = 199.160114343, 155.600159298791
"""Of Fig. 2c's rod: the one of `configs/branches.yaml`, the other of 40-digit arithmetic."""
BAUTIN_F, BAUTIN_K1 = stated("generalised_hopf")[1], stated("generalised_hopf")[0]
FIG_2C = Rod(F=0.0, k1=200.0, k2=1e4, gamma3=1e-4)
DIAGRAM = """
task: phase_diagram
parameters:
  F: [60, 70, 80, 88, 90, 90.5, 91, 92, 110]
  k1: [149.5, 152]
  k2: 1.0e4
  gamma3: 1.0e-4
phase_diagram: {cycles: true}
"""
FOLD_AT_150 = 85.6055767349
"""The fold on the row k1 = 150, which AUTO-07p has to 2e-9 (tests/solve/branch/test_branch_auto.py)."""


def request(values, certify=True):
    return RowRequest("F", np.array(values, dtype=float), 1e-10, certify, 16, max_special_points=64)


@pytest.fixture(scope="module")
def fig_2c():
    values = [40, 100, 150, 155.6, 155.6002, 180, 199.16, 199.1602, 199.9, 205]
    return solve_coexistence(FIG_2C, request(values))


@pytest.mark.long
def test_fig_2c_has_two_stable_states_from_the_restabilization_to_the_fold(fig_2c):
    assert fig_2c.status == CoexistenceStatus.ok
    assert fig_2c.stable_states.tolist() == [1, 2, 2, 2, 3, 3, 3, 1, 1, 5]
    kinds = [point.kind for point in fig_2c.special_points]
    assert kinds == [SpecialPointKind.hopf, SpecialPointKind.fold, SpecialPointKind.hopf]
    assert fig_2c.special_points[1].parameter_value == pytest.approx(FOLD, abs=2e-9)
    assert fig_2c.special_points[2].parameter_value == pytest.approx(RESTABILIZATION, abs=1e-10)
    assert fig_2c.special_points[1].error <= 1e-9 * FOLD


def test_a_cycle_on_the_last_value_of_a_row_counts():
    row = solve_coexistence(FIG_2C, request([40, 60, 70]))
    assert row.stable_states.tolist() == [StableStates.straight, StableStates.cycle, StableStates.cycle]


def test_what_a_branch_that_stopped_leaves_open_is_undecided(monkeypatch):
    real = coexistence.solve_branches

    def stopped(rod, asked, workspace, starts):
        return replace(real(rod, asked, workspace), status=BranchStatus.stopped, message="no further cycle")

    monkeypatch.setattr(coexistence, "solve_branches", stopped)
    row = solve_coexistence(FIG_2C, request([0, 40, 60, 70]))
    assert row.status == CoexistenceStatus.branches_stopped
    assert "no further cycle" in row.message
    nothing_beats_without_a_force = StableStates.straight
    assert row.stable_states.tolist() == [
        nothing_beats_without_a_force,
        StableStates.undecided,
        StableStates.cycle,
        StableStates.cycle,
    ]


@pytest.mark.long
def test_cycles_whose_multipliers_are_lost_to_rounding_but_for_their_size_are_unstable():
    """From the sixth Hopf point of a rod, at F = 98.698, with multipliers of 1e13 to 1e16."""
    rod = Rod(F=0.0, k1=1844.51, k2=7.75717, gamma3=0.3, gamma1=0.602896)
    row = solve_coexistence(rod, replace(request([95, 100, 103]), cycle_accuracy=6e-4))
    assert row.status == CoexistenceStatus.ok
    assert row.stable_states.tolist() == [StableStates.neither_known] * 3


def test_states_that_multipliers_on_the_circle_leave_undecided_have_a_status(monkeypatch):
    real = coexistence.solve_branches

    def on_the_circle(rod, asked, workspace, starts):
        branches = real(rod, asked, workspace)
        (curve,) = branches.curves
        curve.stored_cycles[:] = [
            replace(point, unstable_count=-1, multiplier=1.0) for point in curve.stored_cycles
        ]
        return branches

    monkeypatch.setattr(coexistence, "solve_branches", on_the_circle)
    row = solve_coexistence(FIG_2C, request([40, 60, 70]))
    assert row.stable_states.tolist() == [
        StableStates.straight,
        StableStates.undecided,
        StableStates.undecided,
    ]
    assert row.status == CoexistenceStatus.special_undecided
    assert "undecided at 2 values of F, from 60 to 70" in row.message


def test_a_list_of_special_points_that_is_full_is_told():
    row = solve_coexistence(FIG_2C, replace(request([40, 60, 70]), max_special_points=1))
    assert row.status == CoexistenceStatus.special_full


def test_a_curve_of_folds_leads_into_the_generalised_hopf_point():
    """From the row k1 = 149.9 down, and up to the edge of the plane, where AUTO-07p has the fold."""
    row = solve_coexistence(FIG_2C.with_values(k1=149.9), request([60, 110]))
    (fold,) = [point for point in row.special_points if point.kind == SpecialPointKind.fold]
    plane = PlaneAxis("F", 60.0, 110.0), PlaneAxis("k1", 149.5, 150.0)
    halves = []
    for side in (1.0, -1.0):
        points, end = SpecialCurveProblem(SpecialPointKind.fold, *plane, NewtonWorkspace(), side).follow_from(
            fold, 149.9
        )
        halves.append(HalfCurve(tuple(map(CurvePoint.from_solved_point, points)), end))
    curve = SpecialPointCurve.joined(SpecialPointKind.fold, *halves)
    assert curve.end_reasons == (CurveEndReason.hopf, CurveEndReason.edge)
    last = curve.points[-1]
    assert last.row_parameter_value == 150.0
    assert last.parameter_value == pytest.approx(FOLD_AT_150, abs=last.error + 1e-9)
    assert last.error <= 1e-7 * last.parameter_value
    end = curve.hopf_ends[0]
    assert abs(end.parameter_value - BAUTIN_F) <= end.error
    assert end.row_parameter_value == pytest.approx(BAUTIN_K1, rel=1e-5)
    assert curve.hopf_ends[1] is None
    heights = [point.tip_y_max for point in curve.points]
    assert heights == sorted(heights)


def test_rise_along_a_branch_is_known_with_the_factors_of_a_cycle_near_by():
    row = solve_coexistence(FIG_2C.with_values(k1=149.9), request([60, 110]))
    (fold,) = [point for point in row.special_points if point.kind == SpecialPointKind.fold]
    scale = ArcLengthScale.at_orbit(fold.orbit, "F", 0.0)
    own = BorderedMatrix(fold.orbit, scale, NewtonWorkspace())
    ahead = scale.directional_derivative(fold.orbit, own.branch_tangent(np.array([1.0, 0.0, 0.0])))
    border = ahead / np.linalg.norm(ahead)
    truth = FoldTestFunction(own, border, has_small_cycles=False).value(fold.orbit)
    other = (
        BorderCondition.at_arc_length(scale, border, fold.orbit, 1e-4)
        .solve_cycle(fold.orbit, 1e-10, NewtonWorkspace())
        .orbit
    )
    function = FoldTestFunction(
        BorderedMatrix(other, scale, NewtonWorkspace()), border, has_small_cycles=False
    )
    before = abs(function.value(fold.orbit) - truth)
    for _ in range(8):
        function.correct_null_vectors(fold.orbit)
    assert abs(function.value(fold.orbit) - truth) < 1e-2 * before


@pytest.fixture(scope="module")
def diagram(tmp_path_factory, loaded):
    """The command in a directory with a diagram, `c.h5`, put together from two shards."""
    command = Command(tmp_path_factory.mktemp("coexistence"), lambda: loaded)
    command.write("c.yaml", DIAGRAM)
    for number in (1, 2):
        assert command("run", "c.yaml", "--shard", f"{number}/2").returncode == 0
    assert command("merge", "c.h5", "c-1-of-2.h5", "c-2-of-2.h5").returncode == 0
    ended = command("run", "c.yaml")
    assert ended.returncode == 0, ended.stderr
    yield command
    command.clear()


def test_a_diagram_classes_the_plane_and_continues_the_folds(diagram):
    with h5py.File(diagram.directory / "c.h5") as file:
        states = file["stable_states"][...].reshape(2, -1)
        curve = {name[12:]: file[name][...] for name in file if name.startswith("cycle_curve_")}
        untraced = int(file["cycle_curves_untraced"][()])
    assert states.tolist() == [[1, 2, 2, 1, 1, 1, 1, 1, 1], [1, 2, 2, 2, 2, 3, 3, 1, 1]]
    assert set(curve["number"]) == {1}
    assert set(curve["kind"]) == {SpecialPointKind.fold}
    words = tuple(CYCLE_CURVE_END_REASONS)
    assert [words[i] for name in ("start", "end") for i in curve[name] if i] == ["hopf", "edge"]
    assert (curve["F"][0], curve["k1"][0]) == pytest.approx((BAUTIN_F, BAUTIN_K1), rel=1e-8)
    assert curve["tip_y_max"][0] == 0
    assert curve["k1"][-1] == pytest.approx(152, rel=1e-12)
    assert untraced == 0
    assert float(curve["agreement"]) < 1e-7
    assert np.interp(150.0, curve["k1"], curve["F"]) == pytest.approx(FOLD_AT_150, rel=1e-3)


def test_it_is_told_and_drawn(diagram):
    told = " ".join(diagram("show", "c.h5").stdout.split())
    assert (
        "straight rod and cycle both stable: at grid points of 1 of 2 rows, F = 90.5 to 91, k1 = 152" in told
    )
    assert "folds of cycles: on 1 of 2 rows" in told
    start = r"from k1 = 149.616892, F = 84.4786266\d* \(\+- \de-\d+\) \(Hopf point, where"
    assert re.search(f"curve of folds of cycles: {start}", told)
    assert diagram.drawn("plot", "c.h5", "-o", "c.png").returncode == 0


@survey_only
def test_a_file_without_cycles_is_extended_on_two_ranks_to_the_same(diagram):
    diagram.write("plain.yaml", DIAGRAM.replace("cycles: true", "cycles: false"))
    assert diagram("run", "plain.yaml").returncode == 0
    whole, plain = (content(diagram.directory / name) for name in ("c.h5", "plain.h5"))
    assert same({name: whole[name] for name in plain}, plain)
    refused = diagram("run", "c.yaml", "-o", "plain.h5")
    assert refused.returncode == 2
    assert "cycles" in refused.stderr
    extended = diagram("run", "c.yaml", "-o", "plain.h5", "--extend", ranks=2)
    assert extended.returncode == 0, extended.stderr
    assert same(whole, content(diagram.directory / "plain.h5"))


def test_another_axial_drag_is_another_config(tmp_path):
    path = tmp_path / "c.yaml"
    marks = []
    for more in ("", ", gamma1: 1", ", gamma1: 2"):
        path.write_text(DIAGRAM.replace("k2: 1.0e4", "k2: 1.0e4" + more.replace(", ", "\n  ")))
        marks.append(job_of_file(path, ()).config.settings_of_results)
    assert marks[0] == marks[1] != marks[2]


def test_check_says_that_cycles_are_nonlinear(command):
    command.write("c.yaml", DIAGRAM)
    told = " ".join(command("check", "c.yaml").stdout.split())
    assert "nonlinear motion yes of the cycles" in told
    assert "gravity, inertia no" in told
    assert (
        "the Hopf points of each row, and on the detached branches that the fold and torus curves cross"
        in told
    )


@pytest.mark.long
def test_cycles_of_a_diagram_are_as_accurate_as_asked_for():
    """At the last force of a row its branch ends on a cycle that `limit_cycle` solves more accurately."""
    rows, beside = [1e3, 1e4], {"k2": 1e2, "gamma3": 1e-2}
    cycles = [rs.Rod(F=40, k1=k1, **beside).cycle(accuracy=1e-11) for k1 in rows]
    truths = {name: np.array([getattr(cycle, name) for cycle in cycles]) for name in ("period", "tip_y_max")}
    options, errors = {"cycles": True, "curves": False, "progress": False}, []
    for accuracy in (1e-3, 1e-6, 1e-9):
        asked = {"F": [20.0, 40.0], "k1": rows, "cycle_accuracy": accuracy}
        data = rs.sweep("phase_diagram", **asked, **beside, **options)
        ends = data.cycle_special_kind.values == SpecialPointKind.end
        for name, true in truths.items():
            stored, error = (data[f"cycle_special_{name}{of}"].values[ends] for of in ("", "_error"))
            assert (np.abs(stored / true - 1) <= error).all()
            assert (error <= accuracy).all()
            errors.append(error.max())
    assert (np.array(errors[2:]) < np.array(errors[:-2])).all()


def test_accuracy_of_cycles_makes_another_config_only_with_cycles(tmp_path):
    path = tmp_path / "c.yaml"
    meanings = []
    for options in (
        "cycles: true",
        "cycles: true, cycle_accuracy: 1e-6",
        "cycles: true, cycle_accuracy: 1e-7",
    ):
        path.write_text(DIAGRAM.replace("cycles: true", options))
        meanings.append(job_of_file(path, ()).config.settings_of_results)
    assert meanings[0] == meanings[1] != meanings[2]
    path.write_text(DIAGRAM.replace("cycles: true", "cycles: false"))
    assert "cycle_accuracy" not in job_of_file(path, ()).config.settings_of_results["phase_diagram"]


def test_axial_drag_without_cycles_is_refused(tmp_path):
    path = tmp_path / "c.yaml"
    path.write_text(
        DIAGRAM.replace("gamma3:", "gamma1: 2\n  gamma3:").replace("cycles: true", "cycles: false")
    )
    with pytest.raises(InputError, match=r"phase_diagram\.cycles: true"):
        job_of_file(path, ())


def test_two_stable_states_between_two_grid_points_are_told(command):
    """At k1 = 160 from the restabilization at F = 104.353 to the fold at 111.212, at 200 from 155.6 on."""
    command.write(
        "c.yaml",
        "task: phase_diagram\nparameters: {F: [0, 60, 100, 120, 180], k1: [160, 200], k2: 1.0e+4, "
        "gamma3: 1.0e-4}\nphase_diagram: {cycles: true, curves: false}\n",
    )
    command.solved("c.yaml")
    told = command("show", "c.h5").stdout
    both = "straight rod and cycle both stable"
    assert f"{both}: at grid points of 1 of 2 rows, F = 180, k1 = 200\n" in told
    assert f"{both}: only between grid points on 1 row, k1 = 160\n" in told


def test_states_of_a_row_are_known_from_the_pull_on_from_which_it_is_searched():
    rod = Rod(F=0.0, k1=1e4, k2=1e4, gamma3=1e-4)
    row = solve_coexistence(rod, request(np.array([-1e6, -1e3, 0.0, 39.0])))
    assert row.status == CoexistenceStatus.ended_early
    assert (
        "the search begins at F = -1000, because a search from F = -1000000 fails: no a-priori bound"
        in row.message
    )
    names = [StableStates(state).name for state in row.stable_states]
    assert names == ["undecided", "straight", "straight", "cycle"]


BEYOND = """
task: phase_diagram
parameters: {{F: {forces}, k1: [322.11, 322.2], k2: 1.0e4, gamma3: 0.02}}
material: {{law: neo_hookean, section: swelling}}
phase_diagram: {{cycles: true, certify: false}}
"""


@pytest.fixture(scope="module")
def beyond(diagram):
    """Both branches leave the range with unstable cycles, and the first one turns back beyond it."""
    diagram.write("beyond.yaml", BEYOND.format(forces=[100, 110, 120]))
    run = diagram("run", "beyond.yaml", "-o", "beyond.h5")
    assert run.returncode == 0, run.stderr
    return diagram


@pytest.mark.long
def test_a_narrow_diagram_has_the_stable_states_of_a_wide_one(beyond):
    beyond.write("wider.yaml", BEYOND.format(forces=[50, 100, 110, 120]))
    assert beyond("run", "wider.yaml", "-o", "wider.h5").returncode == 0
    with h5py.File(beyond.directory / "wider.h5") as file:
        assert file["stable_states"][...].reshape(2, -1)[:, 1:].tolist() == [[3, 2, 3]] * 2
    with h5py.File(beyond.directory / "beyond.h5") as file:
        assert file["stable_states"][...].reshape(2, -1).tolist() == [[3, 2, 3]] * 2
        assert file["cycle_followed_from"][...].ravel().tolist() == [0, 0]
        assert file["cycle_followed_to"][...].ravel() == pytest.approx([180, 180])
    told = " ".join(beyond("show", "beyond.h5").stdout.split())
    assert "branches that may enter the range are followed down to F = 0 and up to 180; cycles are" in told


@pytest.mark.long
def test_two_ranks_follow_the_same_branches_beyond_the_range(beyond):
    run = beyond("run", "beyond.yaml", "-o", "two.h5", ranks=2)
    assert run.returncode == 0, run.stderr
    assert same(content(beyond.directory / "two.h5"), content(beyond.directory / "beyond.h5"))


KILL_BEYOND = """
import os
from rodsweep.solve.branch import branch_search

followed = []

def follow_or_die(entry, limits, follow=branch_search.follow_from_range_end):
    if followed:
        os._exit(9)
    followed.append(entry)
    return follow(entry, limits)

branch_search.follow_from_range_end = follow_or_die
"""


@pytest.mark.long
def test_a_run_killed_on_a_branch_from_beyond_resumes_to_the_same_file(beyond):
    """The first row is kept, the second one is killed."""
    assert beyond("run", "beyond.yaml", "-o", "killed.h5", patch=KILL_BEYOND).returncode == 9
    again = beyond("run", "beyond.yaml", "-o", "killed.h5")
    assert again.returncode == 0, again.stderr
    assert "1 of 2 points to do, 1 kept" in again.stdout
    assert same(content(beyond.directory / "killed.h5"), content(beyond.directory / "beyond.h5"))


@pytest.mark.long
def test_where_no_stable_state_is_known_is_listed(beyond):
    view = read_view(beyond.directory / "beyond.h5")
    view.variables["stable_states"][..., 1] = StableStates.neither_known
    told = phase_diagram_summary(PointSelection(view, view.variables["status"] >= 0)).answer
    assert "no stable state known: at grid points of 2 of 2 rows, F = 110, k1 = 322.11 to 322.2" in told
