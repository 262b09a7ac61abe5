"""The task branch as a user sees it: the file, `show`, the figure, Python."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_hex
from shown import shown
from surveyed import few
from test_paper import run, stated

import rodsweep as rs
from rodsweep.api.dataset import view_of_dataset
from rodsweep.model.floquet import min_unstable_multiplier_count
from rodsweep.model.rod import Rod
from rodsweep.post.branch_curves import RodBranches
from rodsweep.post.figures import draw
from rodsweep.post.figures.smooth_branch import smooth_curve_of_branch
from rodsweep.post.range_unions import intersection_of_ranges, union_of_ranges
from rodsweep.post.stored_branches import stability_between_vertices
from rodsweep.post.summary import branch as summary
from rodsweep.post.summary.selection import PointSelection
from rodsweep.results.file.view import read_view
from rodsweep.results.layouts.branch import END_REASONS, SPECIAL_KINDS
from rodsweep.results.layouts.variables import MISSING_STATUS
from rodsweep.solve.branch.branch_limits import BranchRequest
from rodsweep.solve.branch.branches import solve_branches
from rodsweep.solve.branch.special.special_point import SpecialPointKind
from rodsweep.solve.branch.status import BranchEndReason
from rodsweep.tasks.branch import branch_values
from rodsweep.tasks.running.job import job_of_file

CONFIG = (
    "task: branch\nparameters: {{k1: {k1}, k2: 1.0e4, gamma3: 1.0e-4}}\n"
    "branch: {{stop: {stop}}}\naccuracy: 1.0e-5\n"
)
FOLD = 85.60557673489
"""At k1 = 150, by a run at the accuracy 1e-8."""


@pytest.mark.long
def test_show_tells_branches_special_points_and_where_two_states_coexist(command):
    told = shown(command, CONFIG.format(k1=150, stop=200))
    ends = r"from the Hopf point at F = 67\.38698428\d+ \(\+- \S+\) to that at F = 85\.5693169\d+"
    assert re.search(rf"branch 1, {ends}", told)
    assert re.search(r"fold at F = 85\.605576\d* \(\+- \de-\d+\), period 0\.00638\d+ \(\+- \de-\d+\)", told)
    assert re.search(r"stable cycles at F = 67\.3869843 to 85\.605576", told)
    assert re.search(r"stable cycles beside a stable straight rod: F = 85\.5693169 to 85\.605576", told)
    assert "list of Hopf points is proved complete for 1 of 1 rod" in told


def test_show_of_many_rods_names_those_with_two_stable_states(command):
    told = shown(command, CONFIG.format(k1="[100, 150]", stop=90))
    assert "1 branch at 1 of 2 rods" in told
    assert re.search(r"1 fold: F = 85\.6056", told)
    assert "stable cycles beside a stable straight rod at 1 of 2 rods" in told
    assert re.search(r"\n  k1 = 150: F = 85\.5693169 to 85\.605576", told)


def test_show_of_many_rods_tells_where_branches_end_and_where_two_have_stable_cycles(command):
    """Each is told once: a symmetry breaking lies on both branches that meet there."""
    shown(command, CONFIG.format(k1="[100, 150]", stop=80))
    view = read_view(command.directory / "c.h5")
    (branch,) = RodBranches(view, 1).curves
    (start, end), stable = (
        (branch.special_points[0], branch.special_points[-1]),
        np.ones_like(branch.stability),
    )
    breaking = replace(end, kind="symmetry_breaking", reason="none", at=75.0)
    one = replace(branch, special_points=(start, replace(breaking, meets=2), end), stability=stable)
    other = replace(branch, special_points=(replace(breaking, meets=1), end), stability=stable)

    class WithBreaking(RodBranches):
        def __init__(self, view, rod=0):
            super().__init__(view, rod)
            self.curves = [one, other] if rod else []

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(summary, "RodBranches", WithBreaking)
        told = summary.branch_summary(PointSelection(view, np.ones((2, 1, 1, 1), bool))).answer
    assert "1 symmetry breaking: F = 75" in told
    assert "2 branches end at the end of the range: F = 80" in told
    assert "two stable cycles, on different branches, at 1 of 2 rods" in told
    assert "  k1 = 150: F = 67.3869843 to 80" in told


def test_show_names_the_branch_that_could_not_be_followed(command):
    shown(command, CONFIG.format(k1="[100, 150]", stop=80))
    view = read_view(command.directory / "c.h5")
    reasons = view.variables["special_reason"]
    reasons[reasons > 0] = END_REASONS.index("no_cycle_found")
    told = summary.branch_summary(PointSelection(view, np.ones((2, 1, 1, 1), bool))).answer
    assert "1 branch ends at a cycle beyond which the branch was not followed: F = 80" in told
    assert "  k1 = 150: branch 1, at F = 80" in told


def test_show_gives_the_limit_on_the_work_as_the_reason_of_an_end(command):
    command.write("c.yaml", CONFIG.format(k1=150, stop="80, work: 0.1"))
    command("run", "c.yaml")
    page = command("show", "c.h5").stdout
    assert "the last cycle within the limits branch.cycles and branch.work, F = " in page
    assert "found" not in page.split("status")[0]


def test_file_has_the_branches_in_order_and_nothing_behind_them(command):
    shown(command, CONFIG.format(k1="[100, 150]", stop=90))
    view = read_view(command.directory / "c.h5")
    v = {name: view.variables[name] for name in view.variables}
    assert v["hopf_count"].ravel().tolist() == [0, 2]
    assert v["branch_count"].ravel().tolist() == [0, 1]
    count = int(v["point_count"].ravel()[1])
    F, y, unstable = (v[name].reshape(2, -1)[1] for name in ("branch_F", "tip_y_max", "unstable_multipliers"))
    assert np.isfinite(F[:count]).all()
    assert np.isnan(F[count:]).all()
    assert np.isnan(v["branch_F"][0]).all()
    assert (v["branch"].reshape(2, -1)[1, :count] == 1).all()
    assert (y[:count] > 0).all()
    kinds = [SPECIAL_KINDS[i] for i in v["special_kind"].reshape(2, -1)[1] if i]
    assert kinds == ["hopf", "fold", "hopf"]
    fold = int(v["special_point"].reshape(2, -1)[1, 1]) - 1
    assert set(unstable[: fold + 1]) <= {0, -1}
    assert (unstable[1 : fold // 2] == 0).all()
    assert set(unstable[fold + 1 : count]) <= {1, -1}
    assert F[: fold + 1].max() < v["special_at"].reshape(2, -1)[1, 1] == pytest.approx(FOLD, rel=1e-8)
    assert v["branch_F_error"].reshape(2, -1)[1, :count].max() <= 1e-5
    steep = abs(np.gradient(np.log(y[:count])) / np.gradient(np.log(F[:count]))) > 100
    assert v["amplitude_error"].reshape(2, -1)[1, :count][~steep].max() <= 1e-5


def test_curves_of_a_file_go_through_cycles_and_special_points(command):
    shown(command, CONFIG.format(k1=150, stop=200))
    view = read_view(command.directory / "c.h5")
    (curve,) = RodBranches(view).curves
    assert (curve.tip_y_max[0], curve.tip_y_max[-1]) == (0, 0)
    assert int(np.argmax(curve.parameter)) == np.flatnonzero(~curve.is_cycle)[1]
    assert curve.parameter.max() == pytest.approx(FOLD, rel=1e-8)
    stable, unstable = RodBranches(view).straight_rod_stable_unstable_ranges((0.0, 200.0))
    assert stable == [
        (0.0, pytest.approx(67.3869842879)),
        (pytest.approx(85.569316943), 150 * (1 - 1e-4)),
    ] or (stable[1][1] == 200.0)
    assert unstable == [(pytest.approx(67.3869842879), pytest.approx(85.569316943))]
    assert RodBranches(view).coexistence_ranges == [(pytest.approx(85.569316943), pytest.approx(FOLD))]


def test_undecided_cycles_are_as_stable_as_others_between_the_same_special_points():
    pieces = {
        (None, 0, -1, None, -1, 1, None): [1, 1, 1, 0, 0, 0],
        (None, -1, None, 0): [-1, -1, 1],
        (None, 0, 2, -1, None): [1, -1, 0, -1],  # a change that no special point explains
        (-1, 0, 0): [1, 1],
        (None,): [],
    }
    assert {counts: stability_between_vertices(list(counts)).tolist() for counts in pieces} == pieces


@pytest.mark.parametrize(
    ("multiplier", "error", "outside"),
    [
        (0.999, 2e-3, -1),
        (1.001, 2e-3, -1),
        (1.003, 2e-3, 1),
        (2.8e13, 1.9e13, 1),
        (1.4e16, 3e16, 1),
        (9.0, 99.0, -1),
    ],
)
def test_a_cycle_is_unstable_if_its_largest_multiplier_lies_outside_for_certain(multiplier, error, outside):
    assert min_unstable_multiplier_count(-1, multiplier, error) == outside
    assert min_unstable_multiplier_count(2, multiplier, error) == 2


def test_ranges_are_joined_and_intersected():
    assert union_of_ranges([(3, 4), (0, 1), (1, 2)]) == [(0, 2), (3, 4)]
    assert intersection_of_ranges([(0, 2), (3, 4)], [(1, 3.5)]) == [(1, 2), (3, 3.5)]
    assert intersection_of_ranges([(0, 1)], [(1, 2)]) == []


@pytest.mark.parametrize("suffix", few(["svg", "png", "pdf"], 1))
def test_figure_is_drawn(command, suffix):
    shown(command, CONFIG.format(k1=150, stop=200))
    drawn = command.drawn("plot", "c.h5", "-o", f"c.{suffix}")
    assert drawn.returncode == 0, drawn.stderr
    assert "1 branch of cycles over F" in drawn.stdout
    assert (command.directory / f"c.{suffix}").stat().st_size > 5000


def test_figure_holds_the_amplitude_against_the_normal_form_from_both_hopf_points(command):
    """Both ends of the branch tend to the law, the subcritical one from above: its cycles lead to a fold."""
    shown(command, CONFIG.format(k1=150, stop=200))
    (curve,) = RodBranches(read_view(command.directory / "c.h5")).curves
    (first, y_first, stable), (last, y_last, unstable) = curve.scaled_curves_near_hopf_points()
    assert first[:2] == pytest.approx(y_first[:2] ** 2, rel=0.02)
    # The error of F is below a hundredth of the accuracy; the nearest cycle may lie within it.
    assert last[0] == pytest.approx(y_last[0] ** 2, rel=0.02, abs=1e-7)
    # The next term of the law puts the fold at its distance from the Hopf point.
    square = y_last[1] ** 2
    assert last[1] == pytest.approx(square - square**2 / (4 * last[-1]), rel=0.05)
    assert (np.diff(first) > 0).all()
    assert (np.diff(last) > 0).all()
    assert y_last[-1] > 1.2 * last[-1] ** 0.5
    assert last[-1] == pytest.approx(FOLD / 85.569316943 - 1, rel=1e-6)
    assert stable[0] == 1
    assert 0 in unstable
    assert 1 not in unstable
    assert len(first) == len(stable) + 1


@pytest.mark.parametrize(
    ("k1", "said"),
    [(100, "c.h5 holds no branch")],
)
def test_figure_that_shows_nothing_is_refused(command, k1, said):
    shown(command, CONFIG.format(k1=k1, stop=90))
    refused = command("plot", "c.h5", "-o", "c.png")
    assert refused.returncode == 2
    assert said in " ".join(refused.stderr.split())


@pytest.mark.long
def test_branches_of_several_rods_are_drawn_together_and_one_of_them_by_at(command):
    shown(command, CONFIG.format(k1="[100, 150]", stop=90))
    assert "1 of 2 rods has no branch" in " ".join(
        command.drawn("plot", "c.h5", "-o", "c.png").stdout.split()
    )
    alone = command.drawn("plot", "c.h5", "--at", "k1=150", "-o", "one.png")
    assert alone.returncode == 0, alone.stderr
    assert "none" not in alone.stdout


def test_rods_that_are_missing_are_not_said_to_have_no_branch(command):
    shown(command, CONFIG.format(k1="[100, 150]", stop=90))
    view = read_view(command.directory / "c.h5")
    view.variables["status"][0] = MISSING_STATUS
    assert "none" not in draw(view, command.directory / "c.png")


@pytest.mark.long
def test_the_straight_rod_is_drawn_up_to_where_it_is_crushed(command, drawn):
    """At k1 = 100 the cycles reach F = 99.99, and the figure a tenth beyond them."""
    command.write(
        "c.yaml", CONFIG.format(k1=100, stop=200).replace("1.0e-4", "0.1").replace("1.0e-5", "1.0e-3")
    )
    command.solved("c.yaml")
    draw(read_view(command.directory / "c.h5"), command.directory / "c.png")
    black = [line.get_xdata() for line in drawn[0].axes[0].lines if to_hex(line.get_color()) == "#000000"]
    assert np.concatenate(black).max() == 100


@pytest.mark.long
def test_branches_without_room_for_their_special_points_are_told_of_and_not_drawn(command):
    command.write("c.yaml", CONFIG.format(k1="[100, 150]", stop=200).replace("stop:", "special: 2, stop:"))
    assert "1 list_full" in command("run", "c.yaml").stdout
    done = command("show", "c.h5")
    assert done.returncode == 0, done.stderr
    told = " ".join(done.stdout.split())
    assert "whether two states are stable is not known for 1 rod: the list of special points is full" in told
    assert "stable cycles beside a stable straight rod at 0 of 1 rod" in told
    view = read_view(command.directory / "c.h5")
    assert [len(RodBranches(view, rod).curves) for rod in (0, 1)] == [0, 0]
    assert RodBranches(view).straight_rod_stable_unstable_ranges((0.0, 200.0))[0] == [(0.0, 200.0)]
    assert RodBranches(view, 1).straight_rod_stable_unstable_ranges((0.0, 200.0)) == ([], [])
    command.write("d.yaml", CONFIG.format(k1=150, stop=200).replace("stop:", "special: 2, stop:"))
    command.solved("d.yaml")
    assert "1 of 1 branch is not shown" in " ".join(command("show", "d.h5").stdout.split())
    assert "holds no branch with cycles" in " ".join(command("plot", "d.h5").stderr.split())


@pytest.mark.long
def test_those_whose_special_points_are_stored_are_told_and_drawn_before_others(command):
    config = "task: branch\nparameters: {k1: 1.0e4, k2: 100, gamma3: 0.01}\naccuracy: 1.0e-4\n"
    command.write("c.yaml", config + "branch: {special: 3, stop: 90}\n")
    assert "1 list_full" in command("run", "c.yaml").stdout
    told = " ".join(command("show", "c.h5").stdout.split())
    assert "1 of 2 branches is not shown" in told
    assert "branch 1, from the Hopf point at F = 27.427194126" in told
    assert "beside a stable straight rod" not in told
    drawn = " ".join(command.drawn("plot", "c.h5", "-o", "c.png").stdout.split())
    assert "1 branch of cycles over F; 1 more is not drawn: the list of special points is full" in drawn


@pytest.mark.long
def test_longer_lists_are_computed_anew_only_where_they_were_full(command):
    command.write("c.yaml", CONFIG.format(k1=150, stop=200).replace("{stop", "{cycles: 5, stop"))
    full = command("run", "c.yaml")
    assert full.returncode == 1
    assert "1 list_full" in full.stdout
    again = command("run", "c.yaml", "--extend", "--set", "branch.cycles=400")
    assert again.returncode == 0, again.stderr
    assert read_view(command.directory / "c.h5").variables["point_count"].ravel()[0] > 5
    assert "ok" in again.stdout


def test_words_have_the_numbers_of_the_solver():
    assert {kind.name: int(kind) for kind in SpecialPointKind} == {
        name: number for number, name in enumerate(SPECIAL_KINDS) if number
    }
    assert {reason.name: int(reason) for reason in BranchEndReason} == {
        name: number for number, name in enumerate(END_REASONS) if number
    }


@pytest.mark.long
@pytest.mark.parametrize("along", ["F", "k1"])
def test_record_has_all_variables_of_the_layout_and_no_other(tmp_path, along):
    config = tmp_path / "c.yaml"
    others = "k1: 150" if along == "F" else "F: 100"
    config.write_text(
        f"task: branch\nparameters: {{{others}, k2: 1.0e4, gamma3: 1.0e-4}}\n"
        f"branch: {{along: {along}, start: 50, stop: 160}}\n"
    )
    names = {variable.name for variable in job_of_file(config, ()).layout.variables}
    rod = (
        Rod(F=0.0, k1=150.0, k2=1e4, gamma3=1e-4)
        if along == "F"
        else Rod(k1=np.inf, F=100.0, k2=1e4, gamma3=1e-4)
    )
    found = solve_branches(rod, BranchRequest(along, 50.0, 160.0, 1e-4, True, 500, 64))
    assert set(branch_values(found, along, 500, 64)) == names


@pytest.mark.long
def test_other_parameters_are_followed_from_the_command_line(command):
    told = shown(
        command,
        "task: branch\nparameters: {F: 100, k2: 1.0e4, gamma3: 1.0e-4}\n"
        "branch: {along: k1, start: 120, stop: 170}\naccuracy: 1.0e-5\n",
    )
    assert re.search(r"fold at k1 = 155\.37066\d* \(", told)
    assert "to the end of the range, k1 = 170" in told
    drawn = command.drawn("plot", "c.h5", "-o", "c.png")
    assert "1 branch of cycles over k1" in drawn.stdout


def test_list_of_rods_needs_no_column_of_what_is_followed(command):
    command.write("rods.csv", "F,k2,gamma3,gamma1\n100,1e4,1e-4,1\n20,1e4,1e-4,1\n")
    told = shown(
        command,
        "task: branch\nparameters: {points: rods.csv}\nbranch: {along: k1, start: 120, stop: 170}\n"
        "accuracy: 1.0e-4\n",
    )
    assert "1 branch at 1 of 2 rods" in told


def test_rod_answers_in_python():
    answer = rs.Rod(k1=150, k2=1e4, gamma3=1e-4).branch(stop=200, accuracy=1e-5)
    assert answer.status == "ok"
    assert answer.special_at[1] == pytest.approx(FOLD, rel=1e-8)
    assert np.nanmax(answer.branch_F) < FOLD


@pytest.mark.long
def test_config_shows_the_numbers_of_its_head(command):
    with run(command, "branches") as file:
        F_hopf, F_again, fold = stated("branches")
        found = file["special_at"][0, 0, 0, 0, :3]
        assert found[[0, 2]] == pytest.approx([F_hopf, F_again], rel=1e-12)
        assert found[1] == pytest.approx(fold, rel=1e-10)


NEAR, FINER = 1e-3, 1e-8
"""Distance from the true branch, in units of the axes, that no eye sees: a fifth of a millimetre on a page;
accuracy of the branch that stands for it."""


@pytest.mark.long
@pytest.mark.parametrize(("k1", "stop"), few([(150, 140), (175, 150), (1000, 40.5)], 1))
def test_the_curve_in_the_figure_is_the_branch(k1, stop):
    """Straight pieces between its few cycles miss it by up to a hundredth, next to a Hopf point most."""
    coarse, fine = (
        RodBranches(
            view_of_dataset(
                rs.sweep("branch", k1=k1, k2=1e4, gamma3=1e-4, stop=stop, accuracy=accuracy), Path("b.h5")
            )
        ).curves
        for accuracy in (1e-3, FINER)
    )
    for curve, true in zip(coarse, fine, strict=True):
        at, y, period, stable = smooth_curve_of_branch(curve)
        assert len(stable) == len(at) - 1
        assert np.isin(curve.parameter.round(9), at.round(9)).all()
        for drawn, exact in (
            ((at, y), (true.parameter, true.tip_y_max)),
            ((at, np.log(period)), (true.parameter, np.log(true.period))),
        ):
            assert distance(np.column_stack(drawn), np.column_stack(exact)) < NEAR


def distance(polygon, points):
    """Largest distance of points, (n, 2), from a polygon, (m, 2), in units of the extent of the points."""
    polygon, points = polygon / np.ptp(points, axis=0), points / np.ptp(points, axis=0)
    begins, sides = polygon[:-1], np.diff(polygon, axis=0)
    lengths = (sides**2).sum(axis=1)
    off = points[:, None] - begins
    share = np.clip((off * sides).sum(axis=2) / np.where(lengths > 0, lengths, 1), 0, 1)
    return np.linalg.norm(off - share[..., None] * sides, axis=2).min(axis=1).max()


def test_a_branch_arrives_at_its_own_hopf_point_at_every_accuracy():
    """At 1e-3 its last cycles are further from it than their places are known."""
    branch = rs.Rod(k1=175, k2=1e4, gamma3=1e-4).branch(stop=150, accuracy=1e-3)
    assert branch.status == "ok"
    assert branch.special_kind[:3].tolist() == ["hopf", "fold", "hopf"]


@pytest.mark.long
@pytest.mark.parametrize("accuracy", few([1e-5, 1e-3], 1))
def test_errors_at_special_points_contain_a_finer_branch_and_the_amplitude_of_criticality(accuracy):
    rod = rs.Rod(k1=150, k2=1e4, gamma3=1e-4)
    found, fine = (rod.branch(stop=140, accuracy=each) for each in (accuracy, FINER))
    for name in ("special_period", "special_tip_y_max"):
        here, true, error = getattr(found, name), getattr(fine, name), getattr(found, f"{name}_error")
        assert (np.abs(here - true) <= here * error + 1e-9 * true).all(), name
    a = rod.criticality(F_max=140, accuracy=1e-9).amplitude_coefficient
    error = found.special_amplitude_coefficient_error[[0, 2]]
    assert (np.abs(found.special_amplitude_coefficient[[0, 2]] / a - 1) <= error).all()
    assert (error < 1e-3).all(), "three digits are known"


def test_check_foresees_no_time_for_a_pulled_rod(command):
    def seconds(forces):
        branches = "branch: {along: k1, start: 70, stop: 1.0e3}"
        command.write(
            "f.yaml", f"task: branch\nparameters: {{F: {forces}, k2: 100, gamma3: 1.0e-3}}\n{branches}\n"
        )
        told = " ".join(command("check", "f.yaml").stdout.split())
        return float(re.search(r"expected cost: ([\d.e-]+) s on one rank", told)[1])

    assert seconds("[-20, 60]") == pytest.approx(seconds("[60]"), rel=1e-2)
    assert seconds("[-20]") == 0
