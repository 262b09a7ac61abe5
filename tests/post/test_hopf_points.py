"""F** and the square-root law from files of limit cycles: how accurate, where drawn, what is told."""

import re

import numpy as np
import pytest
from known_cycles import UNSTABLE, hopf_variables, make_view, store

from rodsweep.post.figures.cycle.amplitudes.amplitude import draw_amplitude
from rodsweep.post.figures.cycle.amplitudes.square_root_law import square_root_laws
from rodsweep.post.located_thresholds import BracketedThreshold, LocatedThreshold, StoredThresholds
from rodsweep.post.summary.stability import rod_and_arm_stability_lines
from rodsweep.sweep.points.points import lines_along
from rodsweep.tasks.protocol import map_on_one_rank
from rodsweep.tasks.running.job import job_of_file

pytestmark = pytest.mark.filterwarnings("error::UserWarning")

HOPF = 27.4271941267593
"""Of the rod of configs/fig6.yaml, a 40-digit root of D."""
WINDOW = 49.7580049161915, 155.600159298791
"""Of the rod of configs/fig2c.yaml, 40-digit roots of D."""


def config_of(F, k1, k2, gamma3):
    return (
        f"task: limit_cycle\nparameters: {{F: {F}, k1: {k1}, k2: {k2}, gamma3: {gamma3}, gamma1: 1}}\n"
        "accuracy: 1.0e-2\n"
    )


def searched(tmp_path, config, in_order=map_on_one_rank):
    """The variables of the Hopf points of a config, by name."""
    path = tmp_path / "c.yaml"
    path.write_text(config)
    return {v.name: values for v, values in job_of_file(path, ()).task.variables_from_config(in_order)}


@pytest.mark.parametrize("F", ["[45, 55, 65, 75]", "[49, 50]", "{start: 1, stop: 150, num: 4}"])
def test_the_hopf_points_of_a_line_do_not_depend_on_the_points(tmp_path, F):
    found = searched(tmp_path, config_of(F, 200, "1.0e4", "1.0e-4"))
    assert found["hopf_F"] == pytest.approx(WINDOW[:1], rel=1e-12)
    assert found["hopf_error"].max() < 1e-13
    assert (found["hopf_k1"], found["hopf_unstable_after"]) == (200, 2)
    assert (int(found["hopf_lines"]), int(found["hopf_lines_proved"])) == (1, 1)


def test_the_hopf_points_of_a_grid_are_those_of_its_lines_once_each(tmp_path):
    """gamma1 moves none; along k1 the window of flutter of F = 100 closes at one place."""
    text = config_of("[40, 100]", "[140, 200, .inf]", "1.0e4", "1.0e-4").replace(
        "gamma1: 1", "gamma1: [0.5, 1]"
    )
    found = searched(tmp_path, text)
    along = [("F", "k1", "k2", "gamma3")[i] for i in found["hopf_along"]]
    assert int(found["hopf_lines"]) == 5  # three over F, two over k1
    by_line = {
        (name, k1 if name == "F" else F): at
        for name, F, k1 in zip(along, found["hopf_F"], found["hopf_k1"], strict=True)
        for at in [F if name == "F" else k1]
    }
    assert by_line["F", 200.0] == pytest.approx(WINDOW[0], rel=1e-12)
    assert 140 < by_line["k1", 100.0] < 200
    assert {key for key in by_line if key[0] == "k1"} == {("k1", 100.0)}


def test_a_line_that_cannot_be_searched_is_counted_as_not_proved(tmp_path):
    found = searched(
        tmp_path, config_of("[45, 55]", 200, "1.0e4", "1.0e-4"), lambda items, work: [None for _ in items]
    )
    assert (int(found["hopf_lines"]), int(found["hopf_lines_proved"]), len(found["hopf_F"])) == (1, 0, 0)


def test_points_that_are_listed_make_the_lines_that_a_grid_makes(tmp_path):
    (tmp_path / "p.csv").write_text(
        "F,k1,k2,gamma3,gamma1\n75,200,1e4,1e-4,1\n30,400,1e4,1e-4,1\n45,200,1e4,1e-4,0.5\n"
    )
    found = searched(tmp_path, "task: limit_cycle\nparameters: {points: p.csv}\n")
    assert found["hopf_F"] == pytest.approx(WINDOW[:1], rel=1e-12)
    assert int(found["hopf_lines"]) == 1


def changes_on(view, name="F"):
    (line,) = lines_along(view.point_columns, name)
    return StoredThresholds(view, name).thresholds_on_line(line)


def test_a_window_of_flutter_has_a_hopf_point_at_each_end():
    view = make_view(([20.0, 40, 60, 80], [1e4], [1e2], [1e-2], [1.0]), [1, 0, 0, 1], stored=())
    rods = [(27.0, 1e4, 1e2, 1e-2), (33.0, 1e4, 1e2, 1e-2), (71.0, 1e4, 1e2, 1e-2)]
    view.variables.update(hopf_variables("F", rods, kinds=["hopf", "hopf", "restabilization"]))
    view.variables["hopf_unstable_after"][1] = 4
    view.variables["linear_growth_rate"] = np.array([-1.0, 1, 1, -1]).reshape(-1, 1, 1, 1, 1)
    assert [(p.position, p.kind) for p in changes_on(view)] == [(27.0, "hopf"), (71.0, "restabilization")]


def test_a_change_that_no_search_has_located_lies_between_two_points():
    view = swept((100,), constant)
    view.variables.update(hopf_variables("F", []))
    assert changes_on(view) == [BracketedThreshold(27.0, 28.0, "hopf")]
    (line,), _ = rod_and_arm_stability_lines(view, "F", StoredThresholds(view, "F").thresholds_on_line)
    assert line == "F** (straight rod starts to flutter): between 27 and 28"


def test_a_point_on_a_hopf_point_makes_no_second_change():
    """Whichever sign rounding gives the growth rate there."""
    for sign in (-1, 1):
        view = swept((100,), constant)
        view.variables["F"] = np.array([24.0, 26, 27.25 * (1 - 1e-10 * sign), 28, 29, 30, 32])
        view.variables["linear_growth_rate"][2] = sign * 1e-13
        (change,) = changes_on(view)
        assert change.position == pytest.approx(27.25)


def test_hopf_points_beyond_the_points_of_a_line_are_not_its_own():
    view = swept((100,), constant)
    view.variables["F"] = np.arange(28.0, 35)
    view.variables["linear_growth_rate"][:] = 1
    assert changes_on(view) == []


THRESHOLD = LocatedThreshold(20.0, 1e-6, "hopf")


def test_the_law_has_the_coefficient_to_which_the_cycles_tend_and_ends_where_they_leave_it():
    s = np.array([0.02, 0.05, 0.1, 0.2, 0.25, 0.26, 0.3])
    amplitude = 0.9 * np.sqrt(s * (1 - 1.2 * s))  # a fifth below the law at s = 0.2546
    F = np.r_[18, 20 * (1 + s)]
    (law,) = square_root_laws(F[::-1], np.r_[0, amplitude][::-1], [THRESHOLD])
    assert (law.coefficient, law.is_above, law.end_force) == (pytest.approx(0.9), True, pytest.approx(25))
    x, y = law.curve()
    assert (x[0], y[0], x[-1]) == (20, 0, law.end_force)
    assert y == pytest.approx(0.9 * np.sqrt((x - 20) / 20))


def test_cycles_that_shrink_towards_a_restabilization_have_a_law_below_it():
    F = np.array([18.0, 19, 19.5, 21])
    amplitude = np.r_[0.4 * np.sqrt((20 - F[:3]) / 20), 0]
    (law,) = square_root_laws(F, amplitude, [LocatedThreshold(20.0, 1e-6, "restabilization")])
    assert (law.coefficient, law.is_above, law.end_force) == (pytest.approx(0.4), False, 18)


def test_the_smaller_of_two_cycles_at_a_force_follows_the_law():
    F = np.array([19.5, 19.5, 19, 19, 19, 18.5])
    unstable = 0.4 * np.sqrt((20 - F) / 20)
    amplitude = np.where([False, True, False, True, False, True], unstable, [0.6, 0, 0.5, 0, 0, 0])
    (law,) = square_root_laws(F, amplitude, [THRESHOLD])
    assert (law.coefficient, law.is_above) == (pytest.approx(0.4), False)


NOTHING = np.nan


@pytest.mark.parametrize(
    ("F", "amplitude"),
    [
        ([20.5, 21, 22, 24], [0.3, 0.31, 0.33, 0.35]),  # a finite amplitude at the threshold: subcritical
        ([19, 19.5, 20.5, 21], [0.32, 0.31, 0.3, 0.29]),  # and through it, as the extensible rod has
        ([19, 22.5, 23, 24], [0, 0.3, 0.35, 0.4]),  # too far
        ([19, 20.5, 24], [0, 0.15, 0.4]),  # one that is near
        ([20.5, 21, 21.5], [0.15, 0, 0.27]),  # straight between them
        ([20.5, 21, 21.5], [0.15, NOTHING, 0.27]),
        ([20.5, 21, 21.5], [NOTHING, NOTHING, NOTHING]),
        ([20.00001, 20.00002], [0.001, 0.0014]),  # nearer than the threshold is known
        ([], []),
    ],
)
def test_no_law_is_drawn_that_the_cycles_do_not_follow(F, amplitude):
    assert square_root_laws(np.array(F, float), np.array(amplitude, float), [THRESHOLD]) == []


F = [24.0, 26, 27, 28, 29, 30, 32]


def swept(k2, hopf, gamma1=(1.0,), **words):
    """A sweep over F whose rods beat above F**."""
    axes = (F, [1e4], list(k2), [1e-2], list(gamma1))
    table = np.meshgrid(*axes, indexing="ij")
    return make_view(axes, np.where(table[0] > hopf(*table), 0, 1), stored=(), hopf=hopf, **words)


def constant(F, k1, k2, gamma3, gamma1):
    return 27.25 + 0 * F


def rising(F, k1, k2, gamma3, gamma1):
    return 24.3 + np.log10(k2)


def dotted(axes):
    lines = [line for line in axes.lines if line.get_ls() == ":" and len(line.get_xdata())]
    return [(float(line.get_xdata()[0]), line.get_color()) for line in lines]


def legend(figure):
    return [text.get_text() for text in figure.legends[0].get_texts()]


def test_hopf_points_are_dotted_lines_in_the_colours_of_their_branches():
    figure = draw_amplitude([swept((100, 1000), rising)])[0]
    lines = {line.get_color() for line in figure.axes[0].lines if line.get_marker() in "os"}
    for axes in figure.axes:
        places, colours = zip(*dotted(axes), strict=True)
        assert places == pytest.approx([26.3, 27.3], abs=1e-3)
        assert set(colours) == lines
    assert r"$\tilde F_{**}$" in legend(figure)


def test_a_hopf_point_that_branches_share_is_one_grey_line_with_its_value():
    figure = draw_amplitude([swept((100,), constant, (0.5, 1))])[0]
    ((place, colour),) = dotted(figure.axes[1])
    assert (place, colour) == (pytest.approx(27.25, abs=1e-3), "0.3")
    assert r"$\tilde F_{**}$ = 27.25" in " ".join(legend(figure))


def test_the_law_is_a_dashed_curve_through_the_largest_y_only():
    figure = draw_amplitude([swept((100,), constant)])[0]
    laws = {axes: [x for x in axes.lines if x.get_color() == "0.45"] for axes in figure.axes}
    (largest,) = (axes for axes in laws if laws[axes])
    assert "y" in largest.get_ylabel()
    x, y = laws[largest][0].get_data()
    assert y == pytest.approx(0.5 * np.sqrt((x - 27.25) / 27.25), abs=1e-4)
    assert r"$a\sqrt{(\tilde F - \tilde F_{**})/\tilde F_{**}}$, $a$ = 0.5" in legend(figure)


def test_unstable_cycles_are_open_markers_on_their_branch():
    view = swept((100,), constant)
    view.variables["status"][-2:] = UNSTABLE
    figure = draw_amplitude([view])[0]
    for axes in figure.axes:
        (marks,) = (line for line in axes.lines if line.get_mfc() == "white")
        assert marks.get_xdata().tolist() == [30, 32]
    (branch,) = (line for line in figure.axes[1].lines if line.get_ls() == "-" and line.get_marker() == "o")
    assert np.isfinite(branch.get_ydata()[-2:]).all()
    assert "unstable cycle" in legend(figure)


def test_no_hopf_point_is_marked_over_another_parameter():
    axes = ([50.0], [1e4], [50.0, 100, 200], [1e-2], [1.0])
    view = make_view(axes, [0, 0, 1], stored=())
    view.variables["linear_growth_rate"][0, 0, 2] = -1
    figure = draw_amplitude([view])[0]
    assert dotted(figure.axes[1]) == []
    assert rod_and_arm_stability_lines(view, "F", StoredThresholds(view, "F").thresholds_on_line) == ([], [])


def test_lines_over_a_parameter_hold_every_point_once_in_the_order_of_the_file():
    axes = ([20.0, 30, 40], [1e4], [200.0, 100], [1e-2], [1.0, 0.5])
    view = make_view(axes, [0] * 12, stored=())
    lines = list(lines_along(view.point_columns, "F"))
    keys = [(line.other_parameters["k2"], line.other_parameters["gamma1"]) for line in lines]
    assert keys == [(200, 1), (200, 0.5), (100, 1), (100, 0.5)]
    assert sorted(np.concatenate([line.indices for line in lines])) == list(range(12))
    for line in lines:
        assert line.values.tolist() == [20, 30, 40]
        assert {view.point_columns["k2"][i] for i in line.indices} == {line.other_parameters["k2"]}


@pytest.mark.parametrize(
    ("view", "expected"),
    [
        (swept((100,), constant), "27.25000000000 (+- 3e-11), frequency 110 rad/tau2"),
        (swept((100,), constant, (0.5, 1)), "27.25000000000 (+- 3e-11), frequency 110 rad/tau2"),
        (
            swept((100, 1000), rising),
            "26.30000000000 for k2 = 100, 27.30000000000 for k2 = 1000 (+- 3e-11)",
        ),
        (swept(np.geomspace(10, 1e5, 9), rising), "25.30000000000 to 29.30000000000 (+- 3e-11)"),
        (
            swept((100, 1e9), rising),
            "26.30000000000 (+- 3e-11), found on 1 of 2 lines of points along F, frequency 110 rad/tau2",
        ),
    ],
)
def test_the_summary_tells_hopf_points_one_by_one_or_their_range(view, expected):
    (line,), _ = rod_and_arm_stability_lines(view, "F", StoredThresholds(view, "F").thresholds_on_line)
    assert line == f"F** (straight rod starts to flutter): {expected}"


def test_the_summary_counts_no_single_point_of_a_list_as_a_line():
    """Two forces of one rod, and two other rods at one force each."""
    columns = [np.array(values) for values in ([27.0, 28, 27, 28], [1e4] * 4, [100.0, 100, 50, 25])]
    columns += [np.full(4, 1e-2), np.ones(4)]
    view = make_view(columns, [1, 0, 1, 0], stored=(), hopf=constant, as_list=True)
    (line,), _ = rod_and_arm_stability_lines(view, "F", StoredThresholds(view, "F").thresholds_on_line)
    assert ", found on 1 of 1 line of points along F" in line


def test_the_summary_tells_every_window_of_flutter_on_a_line():
    axes = (np.arange(0.0, 100, 2.5), [1e4], [1e2], [1e-2], [1.0])
    view = make_view(axes, [0] * 40, stored=())
    view.variables["linear_growth_rate"] = -np.cos((axes[0] + 1) * np.pi / 20).reshape(-1, 1, 1, 1, 1)
    places = [9.0, 29.0, 49.0, 69.0, 89.0]
    kinds = ["hopf", "restabilization"] * 2 + ["hopf"]
    view.variables.update(hopf_variables("F", [(F, 1e4, 1e2, 1e-2) for F in places], kinds=kinds))
    (beats, again), _ = rod_and_arm_stability_lines(view, "F", StoredThresholds(view, "F").thresholds_on_line)
    assert re.findall(r"(\d+)\.0+", beats) == ["9", "49", "89"]
    assert re.findall(r"(\d+)\.0+", again) == ["29", "69"]


def test_show_tells_the_hopf_point_that_the_task_has_stored(command):
    """Of a file whose last point is stable again, that is only known to lie between two points."""
    axes = (F, [1e4], [1e2], [1e-2], [1.0])
    view = make_view(axes, [1, 1, 1, 0, 0, 0, 0], hopf=constant)
    view.variables["linear_growth_rate"][-1] *= -1
    store(view, command.directory / "arms.h5")
    shown = command("show", "arms.h5").stdout
    assert "F** (straight rod starts to flutter): 27.25000000000 (+- 3e-11)" in shown
    assert "restabilization (straight rod is stable again): between 30 and 32" in shown
    assert "of 7 points: beats at 4 (F = 28 to 32), stays straight at 3 (F = 24 to 27)" in shown
    assert shown.index("beats at 4") < shown.index("status") < shown.index("parameter") < shown.index("BLAS")


@pytest.mark.long
@pytest.mark.parametrize(("ranks", "gamma1"), [(1, "1"), (2, "[0.5, 1]")])
def test_show_of_a_sweep_has_the_threshold_of_the_solver(command, ranks, gamma1):
    """The cases of issue 31: forces 10 apart gave 49.764 +- 3e-4."""
    text = config_of("[45, 55, 65, 75]", 200, "1.0e4", "1.0e-4").replace("gamma1: 1", f"gamma1: {gamma1}")
    command.write("c.yaml", text)
    assert command("run", "c.yaml", ranks=ranks).returncode == 0
    shown = command("show", "c.h5").stdout
    text, error = re.search(
        r"F\*\* \(straight rod starts to flutter\): ([\d.]+) \(\+- ([\de.-]+)\)", shown
    ).groups()
    assert abs(float(text) - WINDOW[0]) <= float(error) < 1e-11


def test_a_threshold_below_the_first_force_is_told(tmp_path):
    found = searched(tmp_path, config_of("[60, 75]", 200, "1.0e4", "1.0e-4"))
    assert found["hopf_F"] == pytest.approx(WINDOW[:1], rel=1e-12)
    view = make_view(([60.0, 75], [200.0], [1e4], [1e-4], [1.0]), [0, 0], stored=())
    view.variables.update(found | {"linear_growth_rate": np.ones((2, 1, 1, 1, 1))})
    stored = StoredThresholds(view, "F")
    (line,) = lines_along(view.point_columns, "F")
    assert stored.thresholds_on_line(line) == []
    assert [point.position for point in stored.thresholds_up_to_end(line)] == pytest.approx(
        WINDOW[:1], rel=1e-12
    )
    (sentence,), _ = rod_and_arm_stability_lines(view, "F", stored.thresholds_up_to_end)
    assert sentence.startswith("F** (straight rod starts to flutter): 49.7580049161")
