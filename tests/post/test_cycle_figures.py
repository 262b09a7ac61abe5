"""Figures of limit_cycle: what is drawn of a cycle that is known in closed form, and what is refused."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from known_cycles import NAMES, SHAPES, arm, make_view, store
from matplotlib.animation import writers
from matplotlib.colors import to_rgb
from matplotlib.quiver import Quiver
from matplotlib.text import Annotation
from PIL import Image
from surveyed import few, survey_only

from rodsweep.discretization.elements.trigonometric import interpolate_samples, time_derivative
from rodsweep.errors import EnvironmentIncomplete, InputError
from rodsweep.post.figures import draw
from rodsweep.post.figures.cycle.amplitudes.amplitude import draw_amplitude
from rodsweep.post.figures.cycle.amplitudes.amplitude_series import amplitude_series
from rodsweep.post.figures.cycle.amplitudes.square_root_law import square_root_laws
from rodsweep.post.figures.cycle.animation import prepared_animation
from rodsweep.post.figures.cycle.energy import draw_energy
from rodsweep.post.figures.cycle.selection import chosen_cycles
from rodsweep.post.figures.cycle.shapes_and_tip_motion import (
    ARROW_LENGTH,
    draw_shapes_and_tip_motion,
    drawn_shapes_and_time_step,
)
from rodsweep.post.figures.limit_cycle import chosen_figure_kind
from rodsweep.post.figures.request import FigureRequest
from rodsweep.post.located_thresholds import LocatedThreshold

pytestmark = pytest.mark.filterwarnings("error::UserWarning")  # a layout that fails is only a warning

TWO = ([50.0], [1e4], [1e2], [1e-2], [1.0, 0.5])


def two_cycles(**words):
    return make_view(TWO, [0, 0], **words)


@pytest.mark.parametrize("n", [15, 16])
def test_interpolant_and_derivative_are_exact_for_harmonics(n):
    def f(t):
        last = np.cos(n * np.pi * t) if n % 2 == 0 else 0  # its derivative is zero at the samples
        return 2 + np.cos(2 * np.pi * t) - 3 * np.sin(10 * np.pi * t) + last

    t = np.linspace(-0.3, 1.9, 50)
    samples = np.arange(n) / n
    assert interpolate_samples(f(samples), t) == pytest.approx(f(t), abs=1e-12)
    exact = -2 * np.pi * np.sin(2 * np.pi * samples) - 30 * np.pi * np.cos(10 * np.pi * samples)
    assert time_derivative(f(samples)) == pytest.approx(exact, abs=1e-10)


@pytest.mark.parametrize("stored", [1, 8, 12, 16, 25, 48, 500])
def test_drawn_shapes_are_equally_spaced_in_time(stored):
    drawn, step = drawn_shapes_and_time_step(stored)
    assert drawn[0] == 0
    assert min(stored, 6) <= len(drawn) <= 12
    assert np.array(drawn) / stored == pytest.approx(np.arange(len(drawn)) * step)


def test_force_presses_on_the_tip_against_e1_in_the_colour_of_its_shape_and_later_is_darker():
    view = make_view(([50.0], [1e4], [1e2], [1e-2], [1.0]), [0])
    axes = draw_shapes_and_tip_motion(view, ())[0].axes[0]
    arrows = [a for a in axes.collections if isinstance(a, Quiver)]
    drawn, _ = drawn_shapes_and_time_step(SHAPES)
    assert len(arrows) == len(drawn) == 12
    v = {name: view.variables[f"shape_{name}"][0, 0, 0, 0, 0] for name in ("x", "y", "theta")}
    for place, arrow in zip(drawn, arrows, strict=True):
        theta = v["theta"][place, -1]
        assert arrow.pivot == "tip"
        assert arrow.get_offsets()[0] == pytest.approx([v["x"][place, -1], v["y"][place, -1]])
        assert [arrow.U[0], arrow.V[0]] == pytest.approx(
            [-ARROW_LENGTH * np.cos(theta), -ARROW_LENGTH * np.sin(theta)]
        )
    rods = [line for line in axes.lines if len(line.get_xdata()) == 21]
    colours = [to_rgb(line.get_color()) for line in rods]
    assert colours == [tuple(arrow.get_facecolor()[0, :3]) for arrow in arrows]
    grey = np.array(colours) @ (0.2126, 0.7152, 0.0722)
    assert (np.diff(grey) < 0).all()


def test_tip_is_drawn_in_its_own_period_with_the_clock_of_the_slowest():
    figure = draw_shapes_and_tip_motion(two_cycles(), ())[0]
    for number, (size, period) in enumerate(((50**0.5 / 16, 0.034), (50**0.5 / 12, 0.026))):
        upper, lower = figure.axes[2 + number], figure.axes[4 + number]
        time = lower.lines[0].get_xdata()
        assert time[-1] == pytest.approx(2 * 0.034)
        x, y, _ = arm(time / period, size)[0][..., -1]
        assert upper.lines[0].get_ydata() == pytest.approx(x, abs=1e-9)
        assert lower.lines[0].get_ydata() == pytest.approx(y, abs=1e-9)
        assert "two \\$ arms" in figure.get_suptitle()
        title = figure.axes[number].get_title()
        assert f"{{=}}$ ${period:g}\\,\\tau_2$\n${{=}}$ ${period * 1e4:g}\\,\\tau_1$" in title


def test_energy_marks_are_the_derivative_of_the_stored_energy_not_the_difference():
    view = two_cycles()
    for wrong in (0.0, 1.0):
        view.variables["energy"][..., 1, :] *= 1 + wrong  # the second cycle only
        for column, error in ((0, 0.0), (1, wrong)):
            bottom = draw_energy(view, ())[0].axes[4 + column]
            _, line, marks = bottom.lines
            at = np.interp(marks.get_xdata(), line.get_xdata(), line.get_ydata())
            size = np.abs(line.get_ydata()).max()
            assert np.abs(marks.get_ydata() - at).max() / size == pytest.approx(error, abs=1e-2)


SWEEP = ([20.0, 30.0, 40.0, 50.0], [1e4], [1e2], [1e-2], [1.0, 0.5])
SWEPT = [1, 1, 0, 0, 0, 3, 0, -1]


def test_amplitudes_are_zero_where_straight_and_unknown_where_there_is_no_cycle():
    expected = {1.0: [0, 30**0.5 / 16, 40**0.5 / 16, 50**0.5 / 16], 0.5: [0, 30**0.5 / 12, np.nan, np.nan]}
    grid = make_view(SWEEP, SWEPT)
    columns = [c.ravel() for c in np.meshgrid(*SWEEP, indexing="ij")]
    for view in (grid, make_view(columns, SWEPT, as_list=True)):
        lines = amplitude_series(view, "F")
        assert [line.constant_parameters["gamma1"] for line in lines] == [1.0, 0.5]
        for line in lines:
            wanted = expected[line.constant_parameters["gamma1"]]
            assert line.tip_y_max == pytest.approx(wanted, nan_ok=True)
            assert line.amplitude_x == pytest.approx(wanted, nan_ok=True)
            x, y = line.x_and_values_with_gaps(line.tip_y_max)
            assert np.isnan([x[1], y[1]]).all()
            assert x[[0, 2]].tolist() == [20, 30]


def test_points_without_a_known_amplitude_are_marked_and_named_but_missing_ones_are_not():
    figure = draw_amplitude([make_view(SWEEP, SWEPT)])[0]
    texts = [t.get_text() for t in figure.legends[0].get_texts()]
    assert texts == [r"$\tilde\gamma_1 = 1$", r"$\tilde\gamma_1 = 0.5$", "left the model (at the top)"]
    crosses = [line.get_xdata()[0] for line in figure.axes[0].lines if line.get_marker() == "x"]
    assert crosses == [40.0]


def test_period_and_power_are_drawn_where_there_are_cycles():
    view = make_view(SWEEP, SWEPT)
    figure = draw_amplitude([view])[0]
    for axes, name in zip(figure.axes[1::2], ("period", "injection_mean"), strict=True):
        lines = [line for line in axes.lines if len(line.get_xdata()) > 2]
        drawn = np.concatenate([line.get_ydata() for line in lines])
        stored = view.variables[name].ravel()
        assert sorted(drawn[np.isfinite(drawn)]) == sorted(stored[np.isfinite(stored)])


def test_a_list_that_goes_up_and_down_stays_in_its_order():
    F = [20.0, 30.0, 40.0, 30.0, 20.0]
    columns = (F, [1e4] * 5, [1e2] * 5, [1e-2] * 5, [1.0] * 5)
    (line,) = amplitude_series(make_view(columns, [1, 1, 0, 0, 1], as_list=True), "F")
    assert line.x.tolist() == F
    assert line.tip_y_max == pytest.approx([0, 0, 40**0.5 / 16, 30**0.5 / 16, 0])


def test_several_files_are_told_apart_by_name(tmp_path):
    one = (*SWEEP[:4], [1.0])
    views = [make_view(one, [1, 0, 0, 0], name="up.h5"), make_view(one, [0, 0, 0, 0], name="down.h5")]
    texts = [t.get_text() for t in draw_amplitude(views)[0].legends[0].get_texts()]
    assert texts == ["up", "down"]
    assert "amplitudes" in draw(views, tmp_path / "both.pdf")


def directed(view, way):
    config = {"limit_cycle": {"start": "neighbour", "along": "F", "direction": way}}
    return replace(view, attributes=view.attributes | {"config_resolved": json.dumps(config)})


@pytest.mark.parametrize("names", [("a.h5", "b.h5"), ("dataset", "dataset")])
def test_sweeps_up_and_down_are_told_apart_by_words_and_arrows(names):
    one = (*SWEEP[:4], [1.0])
    both = [make_view(one, [1, 1, 1, 1], name=name) for name in names]
    views = [directed(view, way) for view, way in zip(both, ("up", "down"), strict=True)]
    figure, _ = draw_amplitude(views)
    texts = [text.get_text() for text in figure.legends[0].get_texts()]
    assert [text.rsplit(" ")[-1] for text in texts[:2]] == ["rising", "falling"]
    for panel in figure.axes[::2]:
        arrows = [text for text in panel.texts if isinstance(text, Annotation)]
        assert [arrow.xy[0] > arrow.xyann[0] for arrow in arrows] == [True, False]
    assert not draw_amplitude(both)[0].axes[0].texts


FEW = {"stored": ()}


@pytest.mark.parametrize(
    ("view", "output", "points", "what"),
    [
        (two_cycles(), "f.png", (), "cycle"),
        (two_cycles(**FEW), "f.png", (), "cycle"),  # which then says what to store
        (two_cycles(), "f.gif", (), "animation"),
        (two_cycles(), "f.mp4", (), "animation"),
        (make_view(SWEEP, SWEPT), "f.png", (), "amplitude"),
        (make_view(SWEEP, SWEPT), "f.png", (3,), "cycle"),
        (make_view(SWEEP, [1, 1, 1, 1, 1, 1, 0, 0]), "f.png", (), "cycle"),
        (make_view(SWEEP, [1, 1, 1, 1, 1, 1, 0, 0], **FEW), "f.png", (), "amplitude"),
    ],
)
def test_the_file_suggests_its_figure(view, output, points, what):
    assert chosen_figure_kind(FigureRequest([view], Path(output), points=points)) == what


@pytest.mark.long
@pytest.mark.parametrize(
    ("gamma1", "suffix", "what"),
    [
        ([1.0], "png", "cycle"),
        pytest.param([1.0], "pdf", "amplitude", marks=survey_only),
        ([1.0], "svg", "energy"),
        pytest.param([1.0, 0.5, 0.25], "png", "amplitude", marks=survey_only),
    ],
)
def test_every_figure_is_drawn_in_every_format(tmp_path, what, suffix, gamma1):
    view = make_view((SWEEP[0] if what == "amplitude" else [50.0], *SWEEP[1:4], gamma1), 0 * np.ones(
        (4 if what == "amplitude" else 1) * len(gamma1)))  # fmt: skip
    output = tmp_path / f"f.{suffix}"
    assert draw(view, output, what=what).startswith(f"wrote {output}: ")
    assert output.stat().st_size > 5000


@pytest.mark.long
def test_animation_has_a_frame_for_each_shape_and_repeats_for_ever(tmp_path):
    output = tmp_path / "f.gif"
    assert f"{SHAPES} frames" in draw(two_cycles(), output)
    with Image.open(output) as film:
        assert (film.n_frames, film.info["loop"], film.info["duration"]) == (SHAPES, 0, 200)
        frames = []
        for k in range(SHAPES):
            film.seek(k)
            frames.append(np.asarray(film.convert("L"), float))
    assert all(np.abs(a - b).max() > 100 for a, b in zip(frames, frames[1:], strict=False))


def test_mp4_without_ffmpeg_says_what_is_missing(tmp_path, monkeypatch):
    monkeypatch.setattr(writers, "is_available", lambda name: False)
    with pytest.raises(EnvironmentIncomplete, match=r"needs ffmpeg.* a \.gif does not"):
        draw(two_cycles(), tmp_path / "f.mp4")
    assert not (tmp_path / "f.mp4").exists()


@pytest.mark.long
def test_first_cycles_are_drawn_unless_points_are_chosen(tmp_path):
    view = make_view(SWEEP, SWEPT)
    assert [c.number for c in chosen_cycles(view, (), ()).cycles] == [3, 4, 5]
    (cycle,) = chosen_cycles(view, (7,), ()).cycles
    assert (cycle.parameters["F"], cycle.parameters["gamma1"], cycle.period) == (50.0, 1.0, 0.034)
    assert cycle.tau1 == pytest.approx(1e-4)
    assert "the first 3 of 4 cycles" in draw(view, tmp_path / "f.png", what="cycle")
    assert "of 4 cycles" not in draw(view, tmp_path / "f.png", points=(4, 7))


def test_points_of_a_grid_are_numbered_with_the_last_axis_fastest():
    view = make_view(([40.0, 50.0], [1e3, 1e4, 1e5], [1e2], [1e-2], [1.0, 0.5]), [0] * 12)
    (cycle,) = chosen_cycles(view, (10,), ()).cycles
    assert [cycle.parameters[n] for n in NAMES] == [50.0, 1e4, 1e2, 1e-2, 0.5]
    assert float(cycle.values["tip_y_max"]) == pytest.approx(50**0.5 / 12)


def few_shapes():
    view = two_cycles()
    for name in ("shape_x", "shape_y", "shape_theta"):
        view.variables[name] = view.variables[name][..., :5, :]
    return view


GRID7 = (SWEEP[0], *SWEEP[1:4], list(np.arange(1, 8.0)))


@pytest.mark.parametrize(
    ("view", "words", "message"),
    [
        (two_cycles(stored=("samples",)), {}, "limit_cycle.shapes"),
        (two_cycles(stored=("samples",)), {"what": "animation"}, "limit_cycle.shapes"),
        (two_cycles(stored=("shapes",)), {"what": "energy"}, "limit_cycle.samples"),
        (few_shapes(), {"what": "animation"}, "5 shapes .* limit_cycle.shapes: 48"),
        (make_view(SWEEP, SWEPT), {"points": (9,)}, "points 1 to 8"),
        (make_view(SWEEP, SWEPT), {"points": (0,)}, "points 1 to 8"),
        (make_view(SWEEP, SWEPT), {"points": (6,)}, "its status is left the model; choose another"),
        (make_view(SWEEP, SWEPT), {"points": (3, 4, 5, 7)}, "at most 3 points"),
        (make_view(SWEEP, SWEPT), {"points": (3,), "what": "amplitude"}, "--point is given, but"),
        (make_view(TWO, [1, 4]), {}, "no cycle that could be drawn"),
        (make_view(SWEEP, [-1] * 8), {"what": "amplitude"}, r"no point of fake\.h5 is computed yet"),
        (make_view((*TWO[:4], [1.0]), [0]), {"what": "amplitude"}, "holds one point"),
        (make_view(GRID7, [0] * 28, **FEW), {"what": "amplitude"}, "gives 7 lines .* choose lines with --at"),
        ([two_cycles(), two_cycles()], {"what": "cycle"}, "only amplitudes of several files"),
    ],
)
def test_what_cannot_be_drawn_is_refused_in_one_sentence(tmp_path, view, words, message):
    output = tmp_path / ("f.gif" if words.get("what") == "animation" else "f.png")
    with pytest.raises(InputError, match=message) as refused:
        draw(view, output, **words)
    assert len(str(refused.value).splitlines()) == 1
    assert not output.exists()


@pytest.mark.parametrize(("what", "suffix"), [("cycle", "gif"), ("animation", "png"), ("energy", "mp4")])
def test_suffix_has_to_suit_the_figure(tmp_path, what, suffix):
    with pytest.raises(InputError, match="must end in"):
        draw(two_cycles(), tmp_path / f"f.{suffix}", what=what)


@pytest.mark.long
@pytest.mark.parametrize("as_list", few([True, False], 1))
def test_file_as_the_task_lays_it_out_is_drawn(command, as_list):
    """The figures name no variable that the file does not have."""
    columns = [np.ravel(c) for c in np.meshgrid(*TWO, indexing="ij")] if as_list else TWO
    view = make_view(columns, [0, 0], as_list=as_list)
    store(view, command.directory / "arms.h5")
    figures = {"e.pdf": ("--what", "energy", "-o", "e.pdf"), "two.png": ("--point", 2, "-o", "two.png")}
    if not as_list:
        figures |= {"arms.png": (), "arms.gif": ("--what", "animation")}
    for words in figures.values():
        drawn = command.drawn("plot", "arms.h5", *words)
        assert (drawn.returncode, drawn.stderr) == (0, "")
    assert {f.name for f in command.directory.iterdir()} == {"arms.h5", *figures}


def test_other_tasks_refuse_the_options_of_limit_cycle(command):
    command.write(
        "c.yaml",
        "task: spectrum\nparameters: {F: [0, 10, 20], k1: 1e4, k2: 1e2, gamma3: 1e-2}\n",
    )
    command("run", "c.yaml")
    for words, name in ((("--what", "cycle"), "--what"), (("--point", 1), "--point")):
        refused = command.drawn("plot", "c.h5", *words)
        assert refused.returncode == 2
        assert f"{name}" in refused.stderr
        assert len(refused.stderr.splitlines()) == 1
    assert command.drawn("plot", "c.h5").returncode == 0


def test_no_arrow_of_a_film_is_over_the_running_time():
    selection = chosen_cycles(make_view(([50.0], [np.inf], [np.inf], [0.0], [0.5, 1.0]), [0, 0]), (), ())
    figure, arms = prepared_animation(selection)
    for k in range(arms[0].frames):
        for moving in arms:
            moving.show_frame(k)
        figure.draw_without_rendering()
        for moving in arms:
            tip = moving.arrow.get_offsets()[0]
            tail = tip - np.array([moving.arrow.U[0], moving.arrow.V[0]])
            low = moving.axes.transData.transform([tail, tip])[:, 1].min()
            assert low > moving.text.get_window_extent().y1, k


@pytest.mark.parametrize("count", [2, 3, 5])
def test_the_coefficient_of_a_law_is_known_to_its_error(count):
    """Of amplitudes that leave the law: y^2 = a^2 d (1 - 1.5 d + 4 d^2), d the distance from F**."""
    a, hopf = 0.92, LocatedThreshold(38.0, 1e-9, "hopf")
    distance = np.array([0.03, 0.05, 0.09, 0.15, 0.2])[:count]
    y = a * np.sqrt(distance * (1 - 1.5 * distance + 4 * distance**2))
    (law,) = square_root_laws(hopf.position * (1 + distance), y, [hopf])
    assert 1e-4 * a < abs(law.coefficient - a) <= law.coefficient_error
