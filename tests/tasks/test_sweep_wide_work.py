"""Curves of cycles as units of work: shared, kept, stopped, resumed, the same whoever followed them."""

import itertools
import os
import signal

import h5py
import pytest
from conftest import Command
from contents import content, same
from ranks import PATIENCE, pause_until, wait_for_end
from surveyed import survey_only

from rodsweep.determinant.parameter_plane import PlaneAxis
from rodsweep.results.run.checkpoints import ItemResults
from rodsweep.solve.branch.special.special_curve_tracer import SpecialCurveTracer
from rodsweep.solve.branch.special.special_curves import (
    CurveEndReason,
    CurvePoint,
    HalfCurve,
    TracedHalfCurve,
)
from rodsweep.solve.branch.special.special_point import RowSpecialPoint, SpecialPointKind
from rodsweep.sweep.chunk_queue import NO_WORK_LEFT, DependentItemQueue, RankReport

DIAGRAM = """
task: phase_diagram
parameters:
  F: [60, 70, 80, 88, 90, 90.5, 91, 92, 110]
  k1: [149.5, 152]
  k2: 1.0e4
  gamma3: 1.0e-4
phase_diagram: {cycles: true}
"""
HALT = """
import pathlib, time
from rodsweep.results.run.checkpoints import ItemResults
import rodsweep.solve_progress as watch
from rodsweep.sweep.stop import SolverReportListener

write, hear = ItemResults.write, SolverReportListener.__call__
state = []

def write_and_note(self, unit, arrays):
    write(self, unit, arrays)
    state.append(unit)

def hear_and_wait(self, text):
    while len(state) >= {items} and "curve of" in self.item_label():
        pathlib.Path("inside").touch()
        time.sleep(0.01)
        hear(self, text)
    hear(self, text)

ItemResults.write, SolverReportListener.__call__ = write_and_note, hear_and_wait
"""
"""What every rank executes first: in the half of a curve after so many it waits for a stop."""


@pytest.fixture(scope="module")
def whole(tmp_path_factory, loaded):
    """The command in a directory with the diagram computed by one rank without a break, `whole.h5`."""
    command = Command(tmp_path_factory.mktemp("sweep_wide"), lambda: loaded)
    command.write("c.yaml", DIAGRAM)
    run = command("run", "c.yaml", "-o", "whole.h5")
    assert run.returncode == 0, run.stderr
    assert "2 of 2 points to do, then the curves" in run.stdout
    assert "2 pieces of curves of folds and torus points followed" in run.stdout
    yield command
    command.clear()


def run_halted(command, name, items, ranks, how):
    """A run that ends by a signal, or is killed, in the middle of the half of a curve after so many."""
    inside = command.directory / "inside"
    inside.unlink(missing_ok=True)
    process = command.started("run", "c.yaml", "-o", name, ranks=ranks, patch=HALT.format(items=items))
    pause_until(lambda: inside.exists() or process.poll() is not None, "no curve is followed")
    if how == signal.SIGKILL and ranks:
        command.clear()
    else:
        process.send_signal(how)
    out, err = process.communicate(timeout=PATIENCE)
    wait_for_end(command.directory)
    assert "Traceback" not in err
    return process.returncode, out


@pytest.mark.long
@pytest.mark.parametrize(
    ("items", "ranks", "how"),
    [
        pytest.param(1, 0, signal.SIGINT, marks=survey_only),
        pytest.param(1, 0, signal.SIGKILL, marks=survey_only),
        (0, 2, signal.SIGUSR1),
    ],
    ids=["Ctrl-C in the second", "killed", "two ranks in the first"],
)
def test_curves_are_stopped_said_to_be_missing_and_resumed(whole, items, ranks, how):
    name = f"{items}-{ranks}-{how.name}.h5"
    status, out = run_halted(whole, name, items, ranks, how)
    if how != signal.SIGKILL:
        assert status == 75
        results = "1 result" if items == 1 else f"{items} results"
        kept = f"2 points kept, {results} for the curves kept, the other results are missing"
        assert f"stopped by {how.name}; {kept}" in out
    shown = " ".join(whole("show", name).stdout.split())
    assert "all rows are computed; the curves are missing" in shown
    if how == signal.SIGKILL:
        assert "curves are missing" in whole("plot", name, "-o", "c.png").stdout
    with h5py.File(whole.directory / name) as file:
        assert "cycle_curve_number" not in file
        assert "finished" not in file.attrs
    kept = ItemResults(whole.directory / f"{name}.journal", "")
    assert len([p for p in kept.directory.glob("unit-*") if p.name[5:].isdecimal()]) == items
    again = whole("run", "c.yaml", "-o", name)
    assert again.returncode == 0, again.stderr
    assert "0 of 2 points to do, 2 kept, then the curves" in again.stdout
    assert "nothing to do" not in again.stdout
    pieces = "1 piece" if items == 1 else "2 pieces"
    assert f"{pieces} of curves of folds and torus points followed" in again.stdout
    assert same(content(whole.directory / name), content(whole.directory / "whole.h5"))
    assert not kept.directory.exists()
    assert "nothing to do" in whole("run", "c.yaml", "-o", name).stdout


@pytest.mark.long
def test_two_ranks_share_the_halves_of_one_curve(whole):
    """Each waits within its first half until the other is within one."""
    patch = f"""
import os, pathlib, time
from rodsweep.tasks.diagram.diagram_curve_search import DiagramCurveSolver

solve = DiagramCurveSolver.solve_item
rank = os.environ.get("OMPI_COMM_WORLD_RANK", os.environ.get("PMI_RANK"))

def solve_beside_another(self, items, item):
    pathlib.Path(f"follows-{{rank}}-{{item}}").touch()
    end = time.monotonic() + {PATIENCE / 2}
    while len(list(pathlib.Path().glob("follows-*"))) < 2 and time.monotonic() < end:
        time.sleep(0.01)
    return solve(self, items, item)

DiagramCurveSolver.solve_item = solve_beside_another
"""
    run = whole("run", "c.yaml", "-o", "shared.h5", ranks=2, patch=patch)
    assert run.returncode == 0, run.stderr
    names = sorted(path.name.split("-") for path in whole.directory.glob("follows-*"))
    assert [rank for _, rank, _ in names] == ["0", "1"]
    assert len({item for *_, item in names}) == 2
    assert same(content(whole.directory / "shared.h5"), content(whole.directory / "whole.h5"))


@pytest.mark.long
def test_curve_whose_solver_raises_is_none_and_the_diagram_is_finished(whole):
    patch = """
from rodsweep.tasks.diagram.diagram_curve_search import DiagramCurveSolver

def broken(self, items, item):
    raise IndexError("a bug")

DiagramCurveSolver.solve_item = broken
"""
    run = whole("run", "c.yaml", "-o", "broken.h5", patch=patch)
    assert run.returncode == 0, run.stderr
    assert "unforeseen exception" in run.stdout
    assert "curve of folds from k1 = " in (whole.directory / "broken.h5.log").read_text()
    with h5py.File(whole.directory / "broken.h5") as file:
        assert file["cycle_curves_untraced"][()] == 1
        assert file["cycle_curve_number"].size == 0


LINE, ROWS = PlaneAxis("F", 0.0, 1.0), PlaneAxis("k1", 1.0, 5.0)


def boundaries():
    """Two curves of folds through the rows 1 to 5, at F = 0.2 and at F = 0.6."""
    special = [
        RowSpecialPoint(
            row_index=row,
            row_parameter_value=float(row),
            kind=SpecialPointKind.fold,
            parameter_value=at,
            period=1.0,
            tip_y_max=0.1,
        )
        for row in range(1, 6)
        for at in (0.2, 0.6)
    ]
    return SpecialCurveTracer(LINE, ROWS, special)


def half(items, item):
    """The half of a straight curve, as if followed."""
    place, behind = divmod(item, 2)
    one = items.special_points[place]
    last = 1.0 if behind else 5.0
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
    near = {
        i: 0.0 for i, other in enumerate(items.special_points) if other.parameter_value == one.parameter_value
    }
    low, high = sorted((one.row_parameter_value, last))
    near = {i: d for i, d in near.items() if low <= items.special_points[i].row_parameter_value <= high}
    return TracedHalfCurve(HalfCurve(points, CurveEndReason.edge), near).arrays()


@pytest.mark.parametrize("ranks", [1, 2, 3, 8])
def test_curves_do_not_depend_on_who_followed_what_in_which_order(ranks):
    """Every rank in turn asks for a unit and hands in the one it had, in all rotations."""
    found = []
    for rotation in range(ranks):
        items = boundaries()
        pool = DependentItemQueue(items, {}, ranks)
        held, turn = {}, itertools.cycle([(rank + rotation) % ranks for rank in range(ranks)])
        while True:
            rank = next(turn)
            results = {held[rank]: half(items, held[rank])} if rank in held else {}
            pool.add_report(rank, RankReport(results=results))
            held.pop(rank, None)
            chunk = pool.next_chunk(rank)
            if chunk == NO_WORK_LEFT:
                break
            if chunk is not None:
                held[rank] = chunk[0]
        found.append(items.curves(pool.results))
    assert all(curves == found[0] for curves in found)
    assert [curve.points[0].parameter_value for curve in found[0].curves] == [0.6, 0.2]
    assert found[0].untraced_seed_count == 0


def test_one_rank_follows_no_half_in_vain():
    items, results = boundaries(), {}
    while wanted := items.items_to_solve(results):
        results[wanted[0]] = half(items, wanted[0])
    assert len(results) == 4  # two of each curve


def test_unit_that_a_stop_ended_is_wanted_again():
    items = boundaries()
    pool = DependentItemQueue(items, {}, 2)
    first = pool.next_chunk(0)
    assert pool.next_chunk(1) != first
    pool.add_report(0, RankReport(returned_items=first))
    assert pool.next_chunk(0) == first
    pool.stop()
    assert pool.next_chunk(1) == NO_WORK_LEFT


def test_results_of_units_are_read_whole_or_not_at_all(tmp_path):
    kept, arrays = ItemResults(tmp_path, "a"), half(boundaries(), 3)
    kept.write(3, arrays)
    (found,) = kept.read().values()
    assert {name: values.tolist() for name, values in found.items()} == {
        name: values.tolist() for name, values in arrays.items()
    }
    assert ItemResults(tmp_path, "b").read() == {}
    path = tmp_path / "unit-000000003"
    data = bytearray(path.read_bytes())
    for damaged in (data[:-1], data[:20], b"", data[:60] + bytes([data[60] ^ 1]) + data[61:]):
        path.write_bytes(bytes(damaged))
        assert kept.read() == {}
    os.remove(path)
    kept.remove_all()
