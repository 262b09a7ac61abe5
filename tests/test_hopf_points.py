"""F** and the square-root law from files of limit cycles: how accurate, where drawn, what is told."""

import re

import numpy as np
import pytest
from conftest import ROOT
from known_cycles import UNSTABLE, growth_rate, make_view, store

from rodsweep.cli.job import make_job
from rodsweep.model.rod import Rod
from rodsweep.post.figures.cycle.amplitude import draw_amplitude
from rodsweep.post.figures.cycle.square_root import square_root_laws
from rodsweep.post.hopf_points import HopfPoint, ParameterLine, hopf_points, lines_over
from rodsweep.post.summary.stability import stability_lines
from rodsweep.solve.spectrum.search import SpectrumRequest, solve_spectrum

pytestmark = pytest.mark.filterwarnings("error::UserWarning")

HOPF = 27.4271941267593
"""Of configs/fig6.yaml, a 40-digit root of D."""
BEATS = np.full(99, 110.0)


def found(step, start=0.0):
    """The Hopf point of a smooth growth rate whose zero lies at 30, from points a step apart."""
    x = 30 + step * (np.arange(-4, 5) + 0.3) + start
    (point,) = hopf_points(x, growth_rate(x - 30), BEATS[: len(x)])
    return point


def test_a_hopf_point_is_found_to_fourth_order():
    errors = [abs(found(step).position - 30) for step in (2, 1, 0.5)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(4, abs=0.3)
    assert np.log2(errors[1] / errors[2]) == pytest.approx(4, abs=0.3)


@pytest.mark.parametrize("step", [0.1, 0.5, 1, 2, 4])
def test_the_error_of_a_hopf_point_is_not_larger_than_its_estimate(step):
    for start in np.linspace(-0.5, 0.5, 21) * step:
        point = found(step, start)
        assert abs(point.position - 30) <= point.error <= 0.02 * step


def test_forces_of_fig6_give_its_hopf_point_to_nine_digits():
    job = make_job(ROOT / "configs" / "fig6.yaml", ())
    F, *others = (job.points.columns[i] for i in range(4))
    rods = [Rod(force, *(float(values[0]) for values in others)) for force in F]
    w = [solve_spectrum(rod, SpectrumRequest(4, 1e-10, False)).eigenvalues[0] for rod in rods]
    (point,) = hopf_points(F, np.real(w), np.imag(w))
    assert abs(point.position - HOPF) <= point.error < 1e-7
    assert (point.text, point.destabilises) == ("27.4271941", True)


def test_a_window_of_flutter_has_a_hopf_point_at_each_end():
    x = np.arange(0.0, 200, 10)
    points = hopf_points(x, (x - 51) * (153 - x), BEATS[: len(x)])
    assert [(p.position, p.destabilises) for p in points] == [
        (pytest.approx(51), True),
        (pytest.approx(153), False),
    ]


def test_the_bracket_is_the_error_where_an_end_does_not_oscillate():
    x = np.array([0.0, 20, 40, 60])
    (point,) = hopf_points(x, np.array([-100.0, -30, 90, 460]), np.array([0.0, 0, 160, 230]))
    assert (point.position, point.error) == (pytest.approx(25), 20)
    assert point.text == "25"


def test_unknown_and_repeated_points_change_no_hopf_point():
    x = 30 + np.arange(-4, 5) + 0.3
    y = growth_rate(x - 30)
    (expected,) = hopf_points(x, y, BEATS[:9])
    shuffled = np.random.default_rng(0).permutation(np.r_[np.arange(9), np.arange(9)])
    x, y = np.append(x[shuffled], [30.0, np.inf]), np.append(y[shuffled], [np.nan, 1.0])
    assert hopf_points(x, y, BEATS[: len(x)]) == [expected]


@pytest.mark.parametrize(
    ("position", "error", "text"),
    [
        (155.6055, 0.0236, "155.6"),
        (29.1, 20, "29"),
        (27.427194126, 3e-8, "27.4271941"),
    ],
)
def test_a_hopf_point_is_written_to_the_digits_that_are_known(position, error, text):
    assert HopfPoint(position, error, True).text == text


THRESHOLD = HopfPoint(20.0, 1e-6, True)


def test_the_law_has_the_coefficient_to_which_the_cycles_tend_and_ends_where_they_leave_it():
    s = np.array([0.02, 0.05, 0.1, 0.2, 0.25, 0.26, 0.3])
    amplitude = 0.9 * np.sqrt(s * (1 - 1.2 * s))  # a fifth below the law at s = 0.2546
    F = np.r_[18, 20 * (1 + s)]
    (law,) = square_root_laws(F[::-1], np.r_[0, amplitude][::-1], [THRESHOLD])
    assert (law.coefficient, law.above, law.end) == (pytest.approx(0.9), True, pytest.approx(25))
    x, y = law.curve()
    assert (x[0], y[0], x[-1]) == (20, 0, law.end)
    assert y == pytest.approx(0.9 * np.sqrt((x - 20) / 20))


def test_cycles_that_shrink_towards_a_restabilization_have_a_law_below_it():
    F = np.array([18.0, 19, 19.5, 21])
    amplitude = np.r_[0.4 * np.sqrt((20 - F[:3]) / 20), 0]
    (law,) = square_root_laws(F, amplitude, [HopfPoint(20.0, 1e-6, False)])
    assert (law.coefficient, law.above, law.end) == (pytest.approx(0.4), False, 18)


def test_the_smaller_of_two_cycles_at_a_force_follows_the_law():
    F = np.array([19.5, 19.5, 19, 19, 19, 18.5])
    unstable = 0.4 * np.sqrt((20 - F) / 20)
    amplitude = np.where([False, True, False, True, False, True], unstable, [0.6, 0, 0.5, 0, 0, 0])
    (law,) = square_root_laws(F, amplitude, [THRESHOLD])
    assert (law.coefficient, law.above) == (pytest.approx(0.4), False)


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
    return [(float(line.get_xdata()[0]), line.get_color()) for line in axes.lines if line.get_ls() == ":"]


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
    top, bottom = ([x for x in axes.lines if x.get_color() == "0.45"] for axes in figure.axes)
    assert top == []
    x, y = bottom[0].get_data()
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
    assert stability_lines(view, ParameterLine.hopf_points) == []


def test_lines_over_a_parameter_hold_every_point_once_in_the_order_of_the_file():
    axes = ([20.0, 30, 40], [1e4], [200.0, 100], [1e-2], [1.0, 0.5])
    view = make_view(axes, [0] * 12, stored=())
    lines = list(lines_over(view, "F"))
    keys = [(line.parameters["k2"], line.parameters["gamma1"]) for line in lines]
    assert keys == [(200, 1), (200, 0.5), (100, 1), (100, 0.5)]
    assert sorted(np.concatenate([line.at for line in lines])) == list(range(12))
    for line in lines:
        assert line.x.tolist() == [20, 30, 40]
        assert {view.point_columns["k2"][i] for i in line.at} == {line.parameters["k2"]}


@pytest.mark.parametrize(
    ("view", "expected"),
    [
        (swept((100,), constant), "F** (straight rod starts to beat): 27.25"),
        (swept((100,), constant, (0.5, 1)), "F** (straight rod starts to beat): 27.25"),
        (swept((100, 1000), rising), "starts to beat): 26.3 for k2 = 100, 27.3 for k2 = 1000 (+- "),
        (swept(np.geomspace(10, 1e5, 9), rising), "F** (straight rod starts to beat): 25.3 to 29.3 (+- "),
        (swept((100, 1e9), rising), "F** (straight rod starts to beat): 26.3 (+- "),
        (swept((100, 1e9), rising), ", on 1 of 2 lines over F"),
    ],
)
def test_the_summary_tells_hopf_points_one_by_one_or_their_range(view, expected):
    (line,) = stability_lines(view, ParameterLine.hopf_points)
    assert expected in re.sub(r"\d+\.\d+", lambda number: f"{float(number[0]):.4g}", line)


def test_the_summary_tells_every_window_of_flutter_on_a_line():
    axes = (np.arange(0.0, 100, 2.5), [1e4], [1e2], [1e-2], [1.0])
    view = make_view(axes, [0] * 40, stored=())
    view.variables["linear_growth_rate"] = -np.cos((axes[0] + 1) * np.pi / 20).reshape(-1, 1, 1, 1, 1)
    for line, places in zip(
        stability_lines(view, ParameterLine.hopf_points), ([9, 49, 89], [29, 69]), strict=True
    ):
        positions = line.split(": ")[1].split(" (+-")[0].split(" and ")
        assert [float(text) for text in positions] == pytest.approx(places, abs=0.01)


def test_show_tells_hopf_points_of_a_file(command):
    axes = (F, [1e4], [1e2], [1e-2], [1.0])
    view = make_view(axes, [1, 1, 1, 0, 0, 0, 0], hopf=constant)
    view.variables["linear_growth_rate"][-1] *= -1
    store(view, command.directory / "arms.h5")
    shown = command("show", "arms.h5").stdout
    assert "F** (straight rod starts to beat): 27.2" in shown
    assert "restabilization (straight rod is stable again): 3" in shown
    assert "of 7 points: 4 cycle, 3 straight" in shown
