"""Rows of a diagram with branches that only a curve of folds leads to, on ranks and after kills."""

from dataclasses import replace
from types import SimpleNamespace

import h5py
import numpy as np
import pytest
from conftest import Command
from contents import content, same

import rodsweep as rs
from rodsweep.determinant.parameter_plane import PlaneAxis
from rodsweep.discretization.stress.form import StressForm
from rodsweep.model.rod import Rod
from rodsweep.post.plane_curves import PlaneParameters
from rodsweep.post.summary.cycle_curves import detached_branch_lines
from rodsweep.results.run.checkpoints import ItemResults
from rodsweep.solve.branch.special.detached_rows import DiagramStages, RowsWithDetachedBranches
from rodsweep.solve.branch.special.folds_beyond_range import FoldsBeyondRange
from rodsweep.solve.branch.special.row_crossing import RowCrossing
from rodsweep.solve.branch.special.special_curve_tracer import SpecialCurveTracer
from rodsweep.solve.branch.special.special_curves import (
    CurveEndReason,
    CurvePoint,
    HalfCurve,
    TracedHalfCurve,
)
from rodsweep.solve.branch.special.special_point import RowSpecialPoint, SpecialPoint, SpecialPointKind
from rodsweep.solve.orbit.orbit import Orbit
from rodsweep.solve.orbit.orbit_mesh import OrbitMesh
from rodsweep.solve.orbit.symmetry import REFLECTION
from rodsweep.tasks.diagram.detached_branches import lost_curve_end_count_values

FORCES = [45.0, 55.0, 65.0, 70.0, 75.0]
DIAGRAM = f"""
task: phase_diagram
parameters:
  F: {FORCES}
  k1: 103
  k2: 1.0e4
  gamma3: [0.042, 0.05]
phase_diagram: {{cycles: true}}
"""
FOLD = 54.88683544
"""On the row gamma3 = 0.042, which has no Hopf point."""


@pytest.fixture(scope="module")
def whole(tmp_path_factory, loaded):
    """The command in a directory with the diagram computed by one rank without a break, `whole.h5`."""
    command = Command(tmp_path_factory.mktemp("detached"), lambda: loaded)
    command.write("c.yaml", DIAGRAM)
    run = command("run", "c.yaml", "-o", "whole.h5")
    assert run.returncode == 0, run.stderr
    assert "1 row solved again with branches found from curves of folds and torus points" in run.stdout
    yield command
    command.clear()


@pytest.mark.long
def test_cycles_on_a_branch_without_a_hopf_point_are_stable_states(whole):
    with h5py.File(whole.directory / "whole.h5") as file:
        assert file["stable_states"][...].reshape(2, -1).tolist() == [[1, 3, 3, 3, 3], [1, 2, 2, 3, 3]]
        kinds = file["cycle_special_kind"][...].reshape(2, -1)
        at = file["cycle_special_F"][...].reshape(2, -1)
        assert file["cycle_special_count"][...].ravel()[0] == 3
        assert kinds[0, :4].tolist() == [SpecialPointKind.end, SpecialPointKind.fold, SpecialPointKind.end, 0]
        assert at[0, :3] == pytest.approx([75, FOLD, 75], abs=1e-7)
        assert file["crossing_count"][...].ravel().tolist() == [0, 2]
        assert file["cycle_detached_row"][...].tolist() == [1]
        assert file["cycle_detached_count"][...].tolist() == [3]
        assert file["cycle_curves_untraced"][()] == 0
    text = " ".join(whole("show", "whole.h5").stdout.split())
    assert "branches that no Hopf point of their row leads to: on 1 of 2 rows, gamma3 = 0.042" in text
    assert "this curve crosses the row" not in text
    assert "folds of cycles: on 2 of 2 rows, F = 51.3625 to 54.8868, gamma3 = 0.042 to 0.05" in text


@pytest.mark.long
def test_time_integration_settles_on_the_cycle_of_the_branch(whole):
    """At the last force of a row the branch has a special point with the period of its stable cycle."""
    with h5py.File(whole.directory / "whole.h5") as file:
        heights, periods = (file[f"cycle_special_{name}"][...] for name in ("tip_y_max", "period"))
    beats = rs.sweep(
        "limit_cycle",
        F=75,
        k1=103,
        k2=1e4,
        gamma3=0.042,
        gamma1=1,
        amplitude=0.4,
        method="integration",
        accuracy=1e-4,
        progress=False,
    )
    larger = int(np.argmax(heights.reshape(2, -1)[0, :3]))
    assert float(beats.period.squeeze()) == pytest.approx(periods.reshape(2, -1)[0, larger], rel=1e-4)
    assert float(beats.tip_y_max.squeeze()) == pytest.approx(heights.reshape(2, -1)[0, larger], rel=1e-4)


@pytest.mark.long
def test_two_ranks_and_python_give_the_same(whole):
    run = whole("run", "c.yaml", "-o", "two.h5", ranks=2)
    assert run.returncode == 0, run.stderr
    assert same(content(whole.directory / "two.h5"), content(whole.directory / "whole.h5"))
    data = rs.sweep(
        "phase_diagram", F=FORCES, k1=103, k2=1e4, gamma3=[0.042, 0.05], cycles=True, progress=False
    )
    assert data.cycle_detached_row.values.tolist() == [1]
    with h5py.File(whole.directory / "whole.h5") as file:
        for name in ("stable_states", "cycle_special_kind", "cycle_special_F", "status"):
            assert np.array_equal(data[name].values, file[name][...], equal_nan=name.endswith("F"))


NARROW_FORCES = FORCES[2:]
"""A range beyond the folds of both rows."""


@pytest.fixture(scope="module")
def narrow(whole):
    """The command with the diagram of a range without folds, `narrow.h5`."""
    whole.write("narrow.yaml", DIAGRAM.replace(str(FORCES), str(NARROW_FORCES)))
    run = whole("run", "narrow.yaml", "-o", "narrow.h5")
    assert run.returncode == 0, run.stderr
    assert "1 row with branches that leave the range" in run.stdout
    assert "1 row solved again with branches found from curves of folds and torus points" in run.stdout
    return whole


@pytest.mark.long
def test_a_fold_beyond_the_range_leads_to_cycles_of_a_row_without_hopf_points(narrow):
    with h5py.File(narrow.directory / "narrow.h5") as file, h5py.File(narrow.directory / "whole.h5") as wide:
        states = [each["stable_states"][...].reshape(2, -1) for each in (file, wide)]
        assert states[0].tolist() == states[1][:, 2:].tolist() == [[3, 3, 3], [2, 3, 3]]
        assert file["cycle_detached_row"][...].tolist() == [1]
        assert file["cycle_detached_count"][...].tolist() == [4]
        # The curve lies beyond the range and is no part of the diagram.
        assert len(file["cycle_curve_number"]) == 0
        assert file["cycle_curves_untraced"][()] == 0
        assert [file["status"][...].ravel().tolist()] == [[0, 0]]
    text = " ".join(narrow("show", "narrow.h5").stdout.split())
    assert "branches that no Hopf point of their row leads to: on 1 of 2 rows, gamma3 = 0.042" in text


@pytest.mark.long
def test_rows_with_folds_beyond_the_range_do_not_depend_on_ranks_or_kills(narrow):
    run = narrow("run", "narrow.yaml", "-o", "narrow2.h5", ranks=2)
    assert run.returncode == 0, run.stderr
    assert same(content(narrow.directory / "narrow2.h5"), content(narrow.directory / "narrow.h5"))
    for stage in ("FoldsBeyondRange", "RowsWithDetachedBranches"):
        patch = KILL.replace("RowsWithDetachedBranches", stage).replace("detached_rows", MODULES[stage])
        assert narrow("run", "narrow.yaml", "-o", f"{stage}.h5", patch=patch).returncode == 9
        again = narrow("run", "narrow.yaml", "-o", f"{stage}.h5")
        assert again.returncode == 0, again.stderr
        assert "0 of 2 points to do, 2 kept, then the curves" in again.stdout
        assert same(content(narrow.directory / f"{stage}.h5"), content(narrow.directory / "narrow.h5"))


MODULES = {"FoldsBeyondRange": "folds_beyond_range", "RowsWithDetachedBranches": "detached_rows"}
KILL = """
import os
from rodsweep.tasks.diagram.diagram_curve_search import DiagramCurveSolver
from rodsweep.solve.branch.special.detached_rows import RowsWithDetachedBranches

solve = DiagramCurveSolver.solve_item

def solve_or_die(self, items, item):
    if isinstance(items, RowsWithDetachedBranches):
        os._exit(9)
    return solve(self, items, item)

DiagramCurveSolver.solve_item = solve_or_die
"""


@pytest.mark.long
def test_a_run_killed_in_a_row_that_is_solved_again_resumes_to_the_same_file(whole):
    assert whole("run", "c.yaml", "-o", "killed.h5", patch=KILL).returncode == 9
    with h5py.File(whole.directory / "killed.h5") as file:
        assert file["stable_states"][...].reshape(2, -1)[0].tolist() == [1] * 5
        assert "finished" not in file.attrs
    assert sorted(ItemResults(whole.directory / "killed.h5.journal", "").directory.glob("unit-*"))
    again = whole("run", "c.yaml", "-o", "killed.h5")
    assert again.returncode == 0, again.stderr
    assert "0 of 2 points to do, 2 kept, then the curves" in again.stdout
    assert "pieces of curves of" not in again.stdout
    assert same(content(whole.directory / "killed.h5"), content(whole.directory / "whole.h5"))
    assert "nothing to do" in whole("run", "c.yaml", "-o", "killed.h5").stdout


@pytest.mark.long
def test_an_extension_solves_changed_rows_anew(whole):
    whole.write("more.yaml", DIAGRAM.replace("[0.042, 0.05]", "[0.042, 0.046, 0.05]"))
    assert whole("run", "c.yaml", "-o", "more.h5").returncode == 0
    run = whole("run", "more.yaml", "-o", "more.h5", "--extend")
    assert run.returncode == 0, run.stderr
    assert "2 of 3 points to do, 1 kept" in run.stdout
    assert "1 of 2 stored points are computed again" in run.stdout
    fresh = whole("run", "more.yaml", "-o", "fresh.h5")
    assert fresh.returncode == 0, fresh.stderr
    assert same(content(whole.directory / "more.h5"), content(whole.directory / "fresh.h5"))


@pytest.mark.long
def test_a_merge_leaves_changed_rows_to_the_next_run(whole):
    beside = DIAGRAM.replace("[0.042, 0.05]", "[0.055, 0.06]")
    whole.write("beside.yaml", beside)
    whole.write("all.yaml", DIAGRAM.replace("[0.042, 0.05]", "[0.042, 0.05, 0.055, 0.06]"))
    assert whole("run", "beside.yaml", "-o", "beside.h5").returncode == 0
    run = whole("merge", "all.h5", "whole.h5", "beside.h5")
    assert run.returncode == 75, run.stderr
    assert "3 points from 2 files, 1 missing" in run.stdout
    run = whole("run", "all.yaml", "-o", "all.h5")
    assert run.returncode == 0, run.stderr
    assert "1 of 4 points to do, 3 kept" in run.stdout
    with h5py.File(whole.directory / "all.h5") as file:
        assert file["cycle_detached_row"][...].tolist() == [1]
        assert file["stable_states"][...].reshape(4, -1)[0].tolist() == [1, 3, 3, 3, 3]


@pytest.mark.long
def test_a_row_whose_branch_is_lost_is_undecided_and_says_why(whole):
    patch = """
import rodsweep.solve.branch.branch_search as search
from rodsweep.solve.unsolvable import Unsolvable

def lost(*given):
    raise Unsolvable("it is lost")

search.complete_branch_through = lost
"""
    run = whole("run", "c.yaml", "-o", "lost.h5", patch=patch)
    assert run.returncode == 1, run.stderr
    with h5py.File(whole.directory / "lost.h5") as file:
        assert file["stable_states"][...].reshape(2, -1)[0].tolist() == [4] * 5
        assert file["cycle_detached_row"][...].tolist() == [1]
    text = " ".join(whole("show", "lost.h5").stdout.split())
    assert "branches_stopped" in text
    assert "no branch is followed through the fold at F = 54.8868" in text


@pytest.mark.long
def test_a_row_whose_solver_raises_is_unchanged_and_named(whole):
    run = whole(
        "run", "c.yaml", "-o", "raised.h5", patch=KILL.replace("os._exit(9)", 'raise IndexError("a bug")')
    )
    assert run.returncode == 0, run.stderr
    assert "unforeseen exception" in run.stdout
    assert "detached branches of gamma3 = 0.042" in (whole.directory / "raised.h5.log").read_text()
    with h5py.File(whole.directory / "raised.h5") as file:
        assert "cycle_detached_row" not in file
        assert file["stable_states"][...].reshape(2, -1)[0].tolist() == [1] * 5
    assert "this curve crosses the row gamma3 = 0.042 between" in whole("show", "raised.h5").stdout


LINE, ROWS = PlaneAxis("F", 0.0, 1.0), PlaneAxis("k1", 1.0, 5.0)


def special(row, at):
    return RowSpecialPoint(
        row_index=row,
        row_parameter_value=float(row),
        kind=SpecialPointKind.fold,
        parameter_value=at,
        period=1.0,
        tip_y_max=0.1,
    )


def crossing(row, at):
    mesh = OrbitMesh((0.0, 1.0), 8, 4, 3)
    form = StressForm(Rod(F=1.0, k1=10.0, k2=10.0, gamma3=0.1), mesh.space_mesh)
    values = np.append(np.zeros((1 + 4 * 3) * form.unknown_count), 1.0)
    orbit = Orbit(form, REFLECTION, 4, 3, values)
    point = SpecialPoint(
        kind=SpecialPointKind.fold, parameter_value=at, period=1.0, tip_y_max=0.1, error=1e-9, orbit=orbit
    )
    return RowCrossing(row, point)


def half(one, last, near=(), crossings=()):
    points = tuple(
        CurvePoint(
            parameter_value=one.parameter_value,
            row_parameter_value=row,
            row_coordinate=(row - 1) / 4,
            error=0.0,
            period=1.0,
            tip_y_max=0.1,
        )
        for row in (one.row_parameter_value, last)
    )
    distances = dict.fromkeys(near, 0.0)
    return TracedHalfCurve(HalfCurve(points, CurveEndReason.edge), distances, tuple(crossings)).arrays()


def of_row(row, values):
    return [special(row, float(at)) for at in values["at"]]


def test_new_special_points_of_a_row_start_curves_that_lead_to_further_rows():
    """The curve at F = 0.2 crosses row 3, whose branch has a fold at F = 0.6 too; its curve crosses row 4."""
    first = SpecialCurveTracer(LINE, ROWS, [special(5, 0.2)], {3: 3.0, 4: 4.0, 5: 5.0})
    stages = DiagramStages(first, of_row)
    results = {0: half(first.special_points[0], 5.0, [0])}
    assert stages.stages(results) == [first]
    results[1] = half(first.special_points[0], 1.0, [0], [crossing(3, 0.2)])
    _, rows = stages.stages(results)
    assert isinstance(rows, RowsWithDetachedBranches)
    assert [rows.row_index_of_item(item) for item in rows.items_to_solve(results)] == [3]
    assert rows.items_to_solve(results) == [2]

    results[2] = {"at": np.array([0.2, 0.6])}
    *_, curves = stages.stages(results)
    assert [(point.row_index, point.parameter_value) for point in curves.special_points] == [(3, 0.6)]
    assert [start.parameter_value for start in curves.branch_starts_of_row(3)] == [0.2]
    assert curves.items_to_solve(results) == [3, 4]

    results[3] = half(curves.special_points[0], 5.0, [0], [crossing(4, 0.6)])
    results[4] = half(curves.special_points[0], 1.0, [0])
    *_, rows = stages.stages(results)
    assert rows.items_to_solve(results) == [5]
    assert [start.parameter_value for start in rows.branch_starts_of_row(4)] == [0.6]
    results[5] = {"at": np.array([0.6])}
    assert not stages.stages(results)[-1].items_to_solve(results)
    assert {
        row: values["at"].tolist() for row, values in stages.variables_of_rows_solved_again(results).items()
    } == {
        3: [0.2, 0.6],
        4: [0.6],
    }
    assert [curve.points[0].parameter_value for curve in stages.curves(results).curves] == [0.2, 0.6]


def test_curves_are_followed_beyond_the_range_after_all_other_stages():
    """From the fold at F = 1.5 of row 5, and along the curve that leaves the range from F = 0.2 on row 4."""
    wide = PlaneAxis("F", 0.0, 2.0)
    first = SpecialCurveTracer(LINE, ROWS, [special(4, 0.2)], {3: 3.0, 4: 4.0, 5: 5.0})
    stages = DiagramStages(first, of_row, wide, {5: 5.0})
    results = {0: half(first.special_points[0], 5.0, [0]), 1: half(first.special_points[0], 1.0, [0])}
    _, folds = stages.stages(results)
    assert isinstance(folds, FoldsBeyondRange)
    assert (folds.items_to_solve(results), folds.row_index_of_item(2), folds.branch_starts_of_row(5)) == (
        [2],
        5,
        (),
    )
    known = [crossing(5, at).special_point for at in (0.7, 1.5)]
    results[2] = folds.solve(2, lambda row: known if row == 5 else [], (0.0, 1.0))
    *_, tracer = stages.stages(results)
    assert tracer.axis_along_row == wide
    assert [(point.row_index, point.parameter_value) for point in tracer.special_points] == [(5, 1.5)]
    results[3] = half(tracer.special_points[0], 5.0, [0])
    results[4] = half(tracer.special_points[0], 1.0, [0], [crossing(3, 1.5)])
    *_, rows = stages.stages(results)
    assert isinstance(rows, RowsWithDetachedBranches)
    assert [start.parameter_value for start in rows.branch_starts_of_row(3)] == [1.5]
    results[5] = {"at": np.array([])}
    # Their texts are compared, since from Python 3.13 on an error of NaN makes the rows unequal to
    # themselves.
    assert repr(stages.stages(results)[-1]) == repr(rows)
    assert stages.count_of_curves_lost_beyond_range(results) == 0
    lost = half(tracer.special_points[0], 1.0, [0]) | {"end": np.array([float(CurveEndReason.not_followed)])}
    assert stages.count_of_curves_lost_beyond_range(results | {4: lost}) == 1
    assert stages.count_of_curves_lost_beyond_range(results | {3: TracedHalfCurve(None).arrays()}) == 1
    ((variable, count),) = lost_curve_end_count_values(2)
    view = SimpleNamespace(variables={variable.name: count})
    (line,) = detached_branch_lines(view, PlaneParameters("F", "k1"))
    assert line.startswith("ends of curves of folds lost beyond the range: 2; rows whose branches")
    bare = SimpleNamespace(variables={})
    assert lost_curve_end_count_values(0) == detached_branch_lines(bare, PlaneParameters("F", "k1")) == []
    assert [curve.points[0].parameter_value for curve in stages.curves(results).curves] == [0.2]
    # A row that could not be solved again has no folds.
    assert stages.stages({**{i: results[i] for i in (0, 1)}, 2: {}})[-1] == folds
    # Where nothing leaves the range there is nothing to follow.
    assert DiagramStages(first, of_row, wide).stages(results) == [first]
    leaving = SpecialCurveTracer(LINE, ROWS, [special(4, 1.0)], {})
    results = {0: half(leaving.special_points[0], 5.0, [0]), 1: half(leaving.special_points[0], 1.0, [0])}
    *_, tracer = DiagramStages(leaving, of_row, wide).stages(results)
    assert (tracer.axis_along_row, tracer.special_points) == (wide, leaving.special_points)


def test_a_row_is_solved_again_with_all_its_crossings_and_only_for_new_ones():
    first = SpecialCurveTracer(LINE, ROWS, [special(5, 0.2)], {3: 3.0, 5: 5.0})
    stages = DiagramStages(first, of_row)
    results = {
        0: half(first.special_points[0], 5.0, [0]),
        1: half(first.special_points[0], 1.0, [0], [crossing(3, 0.2), crossing(3, 0.3), crossing(3, 0.2)]),
        2: {"at": np.array([0.2, 0.3, 0.6])},
    }
    *_, rows, curves = stages.stages(results)
    assert [start.parameter_value for start in rows.branch_starts_of_row(3)] == [0.2, 0.3]
    results[3] = half(curves.special_points[0], 5.0, [0], [crossing(3, 0.8)])
    results[4] = half(curves.special_points[0], 1.0, [0], [crossing(3, 0.3)])
    *_, rows = stages.stages(results)
    assert [start.parameter_value for start in rows.branch_starts_of_row(3)] == [0.2, 0.3, 0.8]
    # A row whose solver failed is unchanged, and its crossings start nothing else.
    results[5] = {}
    assert stages.variables_of_rows_solved_again(results) == {3: results[2]}
    assert repr(stages.stages(results)[-1]) == repr(rows)
    assert replace(rows, first_item_number=0).end_item_number == 1
