"""Figures: which roots are followed, what is drawn, what cannot be; and the configs' own numbers."""

import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from conftest import ROOT
from matplotlib.colors import to_hex
from matplotlib.contour import QuadContourSet
from matplotlib.figure import Figure
from matplotlib.text import Text
from PIL import Image
from shown import HOPF, STABLE_AGAIN

import rodsweep as rs
from rodsweep.api.dataset import view_of_dataset
from rodsweep.config.document.reading import resolved_config, validated_config
from rodsweep.errors import InputError
from rodsweep.post.figures import DRAW_FUNCTION_BY_TASK, draw
from rodsweep.post.figures.grid_slices import slice_at_values
from rodsweep.post.figures.point_lists import label_point_numbers
from rodsweep.post.figures.request import FigureLook
from rodsweep.post.figures.spectra.spectra_along_line import (
    followed_or_all_roots,
    mark_thresholds,
    with_gaps_between_roots,
)
from rodsweep.post.figures.stability.class_bars import CLASS_COLOURS
from rodsweep.post.figures.stability.diagram_curves import mark_special_points_on_rows
from rodsweep.post.figures.stability.regions import (
    PIXEL_COUNT,
    ClassifiedPoints,
    DrawnPlane,
    pixel_classes,
)
from rodsweep.post.figures.stability.row_classes import pixel_classes_of_row
from rodsweep.post.figures.stability.threshold_lines import _groups_of_equal_lines
from rodsweep.post.figures.style import AXIS_LABELS, INVERSE_DRAG_LABEL, number_in_tex, scale_axis
from rodsweep.post.plane_curves import PlaneParameters
from rodsweep.post.summary import SUMMARY_FUNCTION_BY_TASK
from rodsweep.results.file.view import ResultView, read_view
from rodsweep.results.layouts.phase_diagram import STABILITY_CLASSES
from rodsweep.results.layouts.variables import stored_number_of_word
from rodsweep.solve.spectrum.search import SpectrumRequest, solve_spectrum
from rodsweep.tasks import TASKS
from rodsweep.tasks.running.job import job_of_file

NO_PIXELS = np.zeros((PIXEL_COUNT, PIXEL_COUNT), bool)
NO_POINTS = ClassifiedPoints(np.zeros((0, 2)), np.zeros(0, int))


def test_every_task_has_a_summary_and_a_figure():
    assert SUMMARY_FUNCTION_BY_TASK.keys() == DRAW_FUNCTION_BY_TASK.keys() == TASKS.keys()


def test_rightmost_and_smallest_roots_differ():
    growth = np.array([[5.0, 5.0, -1.0, -3.0]])
    frequency = np.array([[7.0, -7.0, 0.0, 0.0]])
    assert followed_or_all_roots(growth, frequency, "rightmost").tolist() == [[5 + 7j, 5 - 7j]]
    assert followed_or_all_roots(growth, frequency, "smallest").tolist() == [[-1 + 0j, -3 + 0j]]


def test_line_is_broken_where_another_root_takes_over():
    x = np.arange(8.0)
    w = np.stack([x + 0j, np.where(x < 5, 1.0, 200.0) + 0.1 * x], axis=1)
    broken_x, broken_w = with_gaps_between_roots(x, w)
    assert np.flatnonzero(np.isnan(broken_x)).tolist() == [5]
    assert np.isnan(broken_w[5]).all()


LINE = "task: spectrum\nparameters: {F: {start: 0, stop: 30, num: 16}, k1: 1e4, k2: 1e2, gamma3: 1e-2}\n"


@pytest.mark.long
@pytest.mark.parametrize(
    ("roots", "suffix"), [("smallest", "png"), ("rightmost", "pdf"), ("smallest", "svg")]
)
def test_line_of_spectra_is_drawn(command, suffix, roots):
    command.write("c.yaml", LINE)
    command.solved("c.yaml")
    run = command.drawn("plot", "c.h5", "-o", f"f.{suffix}", "--roots", roots)
    assert run.returncode == 0, run.stderr
    assert roots in run.stdout
    assert (command.directory / f"f.{suffix}").stat().st_size > 5000


def test_map_is_drawn_and_other_shapes_are_refused(command):
    command.write("c.yaml", LINE)
    command(
        "run", "c.yaml", "--set", "parameters.k2={start: 50, stop: 5e3, num: 7, spacing: log}", "-o", "map.h5"
    )
    assert "growth rate" in command.drawn("plot", "map.h5").stdout
    three = ["--set", "parameters.F=[1, 2]", "--set", "parameters.k1=[1e4, 2e4]"]
    command("run", "c.yaml", *three, "--set", "parameters.k2=[50, 100]", "-o", "three.h5")
    refused = command.drawn("plot", "three.h5")
    assert refused.returncode == 2
    assert "one or two" in refused.stderr
    with pytest.raises(InputError, match="must end in"):
        draw(read_view(command.directory / "map.h5"), command.directory / "f.frob")
    refused = command.drawn("plot", "map.h5", "--roots", "all")
    assert refused.returncode == 2
    assert "--roots all is for spectra along a line" in refused.stderr
    line = command.drawn("plot", "map.h5", "--roots", "all", "--at", "k2=50")
    assert "all stored roots" in line.stdout


def test_colours_of_a_map_change_sign_on_its_line_of_zero_growth(command, drawn):
    command.write("c.yaml", LINE)
    command("run", "c.yaml", "--set", "parameters.k2={start: 50, stop: 200, num: 7}")
    draw(read_view(command.directory / "c.h5"), command.directory / "f.png")
    filled, zero = (each for each in drawn[0].axes[0].collections if each.get_visible())
    assert 0.0 in filled.levels
    assert zero.levels.tolist() == [0.0]
    (line,) = (path.vertices for path in zero.get_paths())
    at = int(np.flatnonzero(filled.levels == 0.0)[0])
    edges = np.concatenate([filled.get_paths()[side].vertices for side in (at - 1, at)])
    assert all(np.abs(edges - vertex).sum(axis=1).min() < 1e-9 for vertex in line)


def test_few_values_of_a_parameter_have_a_panel_each_with_its_own_thresholds(command, drawn):
    """A map would draw a line of zero growth between k1 = 200 and 1e4 where no rod was computed."""
    command.write("c.yaml", LINE.replace("30, num: 16", "190, num: 20").replace("1e-2}", "1e-4}"))
    command("run", "c.yaml", "--set", "parameters.k1=[200, 1e4]", "--set", "parameters.k2=1e4")
    said = draw(read_view(command.directory / "c.h5"), command.directory / "f.png")
    assert "in a panel for each k1" in said
    titles = [" ".join(axes.get_title(loc="left").split()) for axes in drawn[0].axes]
    assert len(titles) == 2
    assert "= 49.7580" in titles[0]
    assert "restabilization = 155.600" in titles[0]
    assert "= 37.6560" in titles[1]
    assert "restabilization" not in titles[1]


def test_one_row_of_a_diagram_is_a_bar_bounded_by_its_changes(command, drawn):
    rod = "{F: {start: 0, stop: 240, num: 13}, k1: [150, 200], k2: 1.0e4, gamma3: 1.0e-4, gamma1: 0.7}"
    command.write("c.yaml", f"task: phase_diagram\nparameters: {rod}\nphase_diagram: {{criticality: true}}\n")
    command.solved("c.yaml")
    row = slice_at_values(read_view(command.directory / "c.h5"), {"k1": 200.0})
    assert draw(row, command.directory / "f.png").endswith("f.png: behaviour of the rod over F")
    (bar,) = drawn[0].axes[0].collections
    edges, found = np.array(bar.get_coordinates()[0, :, 0]), np.array(bar.get_array()).ravel()
    changes = np.flatnonzero(np.diff(found)) + 1
    expected = [22.4709774737663, HOPF, STABLE_AGAIN, 200]
    assert edges[changes] == pytest.approx(expected, abs=240 / PIXEL_COUNT)
    assert [label.get_text().split("= ")[1] for label in drawn[0].axes[0].get_yticklabels()] == ["200$"]
    assert "0.7" in drawn[0].get_suptitle()


def test_a_stretch_of_a_row_without_a_computed_point_is_undecided():
    """Between the fold of cycles and F = k1 no force is computed: no state of a neighbour holds there."""
    changes = {"crossing_at": [[50.0]], "crossing_kind": [[2]], "cycle_special_F": [[199.0]]}
    variables = {
        "F": np.array([40.0, 100.0, 196.0, 200.0, 220.0]),
        "stable_states": np.array([[1, 2, 2, 5, 5]]),
        "status": np.zeros(1),
        "k1": np.array([200.0]),
    } | {name: np.array(values) for name, values in changes.items()}
    forces = variables["F"].tolist()
    tree = {
        "task": "phase_diagram",
        "parameters": {"F": forces, "k1": [200.0, 300.0], "k2": 1e4, "gamma3": 1e-4},
    }
    resolved = resolved_config(validated_config(tree))
    attributes = {"task": "phase_diagram", "config_resolved": json.dumps(resolved)}
    view = ResultView(Path("f.h5"), attributes, variables, ("k1",), {0: "ok"}, 0)
    edges = np.array([0.0, 50.0, 199.0, 200.0, 220.0])
    assert pixel_classes_of_row(view, "stable_states", PlaneParameters("F", "k1"), 0, edges).tolist() == [
        1,
        2,
        4,
        5,
    ]


def test_rows_that_make_no_plane_are_bars(command, drawn):
    rod = "{F: {start: 0, stop: 190, num: 20}, k1: [200, .inf], k2: 1.0e4, gamma3: 1.0e-4}"
    command.write("c.yaml", f"task: phase_diagram\nparameters: {rod}\n")
    command.solved("c.yaml")
    assert "for each k1" in draw(read_view(command.directory / "c.h5"), command.directory / "f.png")
    labels = [label.get_text() for label in drawn[0].axes[0].get_yticklabels()]
    assert [label.split("= ")[1] for label in labels] == ["200$", r"\infty$"]
    named = [text.get_text() for text in drawn[0].legends[0].get_texts()]
    assert named == ["monotone decay", "oscillatory decay", "flutter"]


@pytest.mark.long
def test_infinite_axis_values_and_odd_titles_are_drawn_or_refused_in_a_sentence(command):
    command.write("c.yaml", LINE)
    both = ["--set", "parameters.k2=[50, 100, .inf]", "--set", "title=cost in $ and \\frac"]
    command("run", "c.yaml", *both, "-o", "map.h5")
    assert command.drawn("plot", "map.h5").returncode == 0
    at = command.drawn("plot", "map.h5", "--at", "k2=inf", "-o", "at.png")
    assert (at.returncode, "panel" in at.stdout) == (0, False)
    command("run", "c.yaml", *both, "--set", "parameters.F=3", "-o", "line.h5")
    assert command.drawn("plot", "line.h5").returncode == 0
    for output in ("map.h5", ".", "figure"):
        refused = command.drawn("plot", "map.h5", "-o", output)
        assert refused.returncode == 2
        assert len(refused.stderr.splitlines()) == 1
    assert read_view(command.directory / "map.h5").variables["k2"][-1] == np.inf


EXPECTED = {
    "fig2a": [(37.6559805452711, +1)],
    "fig2b": [(27.4271941267593, +1)],
    "fig2c": [(49.7580049161915, +1), (155.600159298791, -1)],
    "fig2d": [],
}


@pytest.mark.parametrize("name", EXPECTED)
def test_config_changes_stability_where_its_head_comment_says(name):
    """Flutter sets in (+1) and ends (-1) at the forces of docs/method.md, to ten digits, and nowhere else."""
    path = ROOT / "configs" / f"{name}.yaml"
    head = path.read_text()
    job = job_of_file(path, ())
    F = job.points.columns[0]
    crossings = EXPECTED[name]
    request = SpectrumRequest(4, 1e-10, True)
    for force, direction in crossings:
        assert str(force) in head
        at = [solve_spectrum(_with_force(job, force * (1 + e)), request) for e in (-1e-10, 1e-10)]
        assert [r.unstable_count for r in at] == ([0, 2] if direction > 0 else [2, 0])
    for index in range(0, len(F), 25):
        expected = 2 * sum(direction for force, direction in crossings if F[index] > force)
        assert solve_spectrum(job.points.rod(index), request).unstable_count == expected


def _with_force(job, force):
    rod = job.points.rod(0)
    return rod.with_values(F=force)


@pytest.mark.parametrize(
    ("value", "written"),
    [
        (1e4, "10^{4}"),
        (1e-4, "10^{-4}"),
        (100.0, "10^{2}"),
        (-1e3, "-10^{3}"),
        (10.0, "10"),
        (200.0, "200"),
        (0.25, "0.25"),
        (49.758, "49.758"),
        (2.5e-4, r"2.5\times10^{-4}"),
        (3.16e5, r"3.16\times10^{5}"),
        (0.0, "0"),
        (np.inf, r"\infty"),
    ],
)
def test_powers_of_ten_are_written_as_such(value, written):
    assert number_in_tex(value) == written


def test_labels_of_dimensionless_parameters_have_no_unit():
    assert not any("[" in label for label in [*AXIS_LABELS.values(), INVERSE_DRAG_LABEL])


def test_flutter_is_marked_at_its_threshold_however_coarse_the_forces_are(command):
    command.write("c.yaml", LINE)
    command.solved("c.yaml")
    axes = Figure().subplots()
    mark_thresholds(axes, read_view(command.directory / "c.h5"), "F")
    onset, mark = axes.lines
    assert onset.get_xdata()[0] == pytest.approx(14.7993326711956, rel=1e-12)
    assert mark.get_xdata()[0] == pytest.approx(27.4271941267593, rel=1e-12)
    (shade,) = axes.patches
    assert shade.get_x() == pytest.approx(27.4271941267593, rel=1e-12)
    assert shade.get_x() + shade.get_width() == 30


def test_the_legend_names_no_flutter_where_there_is_none(command):
    command.write("c.yaml", LINE)
    command("run", "c.yaml", "--set", "parameters.F={start: 0, stop: 14, num: 11}")
    axes = Figure().subplots()
    mark_thresholds(axes, read_view(command.directory / "c.h5"), "F")
    assert axes.get_legend_handles_labels() == ([], [])


@pytest.mark.long
def test_fonts_of_a_pdf_are_embedded_as_type_42_and_images_have_300_dots_an_inch(command):
    command.write("c.yaml", LINE)
    command.solved("c.yaml")
    view = read_view(command.directory / "c.h5")
    draw(view, command.directory / "f.pdf")
    draw(view, command.directory / "f.png")
    written = (command.directory / "f.pdf").read_bytes()
    assert b"/Subtype /Type3" not in written
    assert b"/CIDFontType2" in written
    with Image.open(command.directory / "f.png") as image:
        assert image.info["dpi"] == pytest.approx((300, 300), abs=0.1)


def line_of_spectra(command):
    """A file of spectra over F, whose config has a title."""
    command.write("c.yaml", "title: Onset of a soft rod\n" + LINE)
    command.solved("c.yaml")
    return command.directory / "c.h5"


@pytest.mark.parametrize(("width", "inches"), [("single", 3.375), ("double", 7.0)])
def test_width_is_that_of_a_column_with_type_of_8_points(command, width, inches, monkeypatch):
    path, drawn = line_of_spectra(command), []
    monkeypatch.setattr(Figure, "savefig", lambda figure, *_, **__: drawn.append(figure))
    draw(read_view(path), path.with_suffix(".png"), look=FigureLook(width=width))
    (figure,) = drawn
    assert figure.get_size_inches()[0] == inches
    assert {text.get_fontsize() for text in figure.findobj(Text) if text.get_text()} == {8.0}


def test_title_stands_above_a_figure_only_where_it_is_asked_for(command, drawn):
    path = line_of_spectra(command)
    for look in (FigureLook(), FigureLook(title=True)):
        draw(read_view(path), path.with_suffix(".png"), look=look)
    assert ["Onset of a soft rod" in figure.get_suptitle() for figure in drawn] == [False, True]


def test_style_is_a_name_or_a_file_and_anything_else_is_refused(command, drawn):
    path = line_of_spectra(command)
    own = command.directory / "own.mplstyle"
    own.write_text("axes.facecolor: 123456\n")
    for style in ("ggplot", str(own)):
        draw(read_view(path), path.with_suffix(".png"), look=FigureLook(style=style))
    assert [to_hex(figure.axes[0].get_facecolor()) for figure in drawn] == ["#e5e5e5", "#123456"]
    for wrong in ("nosuch", "c.h5"):
        done = command.drawn("plot", "c.h5", "--style", wrong)
        assert (done.returncode, done.stderr.count("\n")) == (2, 1)
        assert f"{wrong} is neither a style of matplotlib nor a style file" in done.stderr


def test_few_digits_of_a_large_number_are_written_with_a_power_of_ten():
    assert [number_in_tex(value, 3) for value in (2236.07, 200.0, 999.9)] == [
        r"2.24\times10^{3}",
        "200",
        "10^{3}",
    ]


def drawn_of(command, monkeypatch, config, points=""):
    """(the figure, what plot says) of a config, with a list of points where its text is given."""
    drawn = []
    command.write("c.yaml", config)
    if points:
        command.write("p.csv", points)
    assert command("run", "c.yaml", "--fresh").returncode in (0, 1)
    monkeypatch.setattr(Figure, "savefig", lambda figure, *_, **__: drawn.append(figure))
    shown = draw(
        read_view(command.directory / "c.h5"), command.directory / "f.png", look=FigureLook(width="single")
    )
    return drawn[0], shown


def inside(figure):
    """Asserts that all legends lie within the figure, and outside the panels."""
    figure.draw_without_rendering()
    for legend in figure.legends:
        box = legend.get_window_extent()
        assert figure.bbox.x0 <= box.x0 < box.x1 <= figure.bbox.x1
        assert not any(box.overlaps(axes.get_window_extent()) for axes in figure.axes)


LIST = "F,k1,k2,gamma3\n50,1e4,1e2,1e-2\n3,200,1e4,1e-4\n10,1e4,inf,0\n"


def test_one_spectrum_is_drawn_as_its_eigenvalues_in_the_complex_plane(command, monkeypatch):
    config = "task: spectrum\nparameters: {F: 50, k1: 1e4, k2: 1e2, gamma3: 1e-2}\nspectrum: {modes: 4}\n"
    figure, shown = drawn_of(command, monkeypatch, config)
    assert "complex plane" in shown
    with pytest.raises(InputError, match="--roots rightmost is for spectra along a line"):
        draw(read_view(command.directory / "c.h5"), command.directory / "f.png", roots="rightmost")
    inside(figure)
    growing, decaying = figure.axes[0].lines[:2]
    assert growing.get_xdata() == pytest.approx([252.90241] * 2, rel=1e-7)
    assert growing.get_ydata() == pytest.approx([202.12569, -202.12569], rel=1e-7)
    assert decaying.get_xdata() == pytest.approx([-331.49731, -1599.4628], rel=1e-7)


def test_points_of_a_list_of_arms_are_labelled_by_words_of_the_quantities():
    quantities = {"drag": np.array([0, 2]), "poisson": np.array([0.3, 0.5]), "young": np.array([1e5, 2e5])}
    axes = Figure().subplots()
    view = SimpleNamespace(
        quantities=quantities,
        variables={"status": np.zeros(2)},
        is_grid=False,
        typed_units={"young": "kPa"},
    )
    label_point_numbers(axes, view, 2)
    assert axes.get_xlabel() == "drag\nPoisson's ratio\nYoung's modulus (kPa)"
    texts = [label.get_text() for label in axes.get_xticklabels()]
    assert texts == ["likeliest\n0.3\n100", "most rotational\n0.5\n200"]


def test_list_of_spectra_is_drawn_over_its_points_or_over_what_alone_varies(command, monkeypatch):
    config = "task: spectrum\nparameters: {points: p.csv}\nspectrum: {modes: 3}\n"
    figure, _ = drawn_of(command, monkeypatch, config, LIST)
    inside(figure)
    assert [axes.get_xlabel() for axes in figure.axes] == ["", "point of the list"]
    marks = [line for line in figure.axes[0].lines if line.get_marker() in ("o", "s")]
    assert sum(len(line.get_xdata()) for line in marks) == 9
    view = read_view(command.directory / "c.h5")
    assert "eigenvalues of every point" in draw(view, command.directory / "f.png", roots="all")
    with pytest.raises(InputError, match="--roots smallest is for spectra along a line"):
        draw(view, command.directory / "f.png", roots="smallest")
    same = "F,k1,k2,gamma3\n" + "".join(f"10,1e4,{k2},1e-2\n" for k2 in (300, 100, 200))  # as many as modes
    figure, _ = drawn_of(command, monkeypatch, config, same)
    assert figure.axes[0].get_xlabel() == AXIS_LABELS["k2"]
    assert figure.axes[0].lines[0].get_xdata().tolist() == [100, 200, 300]


def test_one_rod_is_drawn_as_a_bar_of_its_classes_with_its_thresholds(command, monkeypatch):
    config = "task: thresholds\nparameters: {k1: 200, k2: 1e4, gamma3: 1e-4}\n"
    figure, _ = drawn_of(command, monkeypatch, config)
    inside(figure)
    edges = [(bar.get_x(), bar.get_x() + bar.get_width()) for bar in figure.axes[0].patches]
    at = [0, 22.4709774737663, 49.7580049161915, 155.600159298791]
    assert [start for start, _ in edges] == pytest.approx(at, rel=1e-10)
    assert [end for _, end in edges][:3] == pytest.approx(at[1:], rel=1e-10)
    colours = [to_hex(bar.get_facecolor()).upper() for bar in figure.axes[0].patches]
    assert colours == [CLASS_COLOURS[w] for w in ("monotone", "oscillatory", "flutter", "oscillatory")]
    marks = [line.get_xdata().item() for line in figure.axes[0].lines]
    assert marks == pytest.approx(at[1:], rel=1e-10)


def test_a_bar_is_not_stored_beyond_a_full_list_of_crossings(command, monkeypatch):
    config = "task: thresholds\nparameters: {k1: 200, k2: 1e4, gamma3: 1e-4}\nthresholds: {crossings: 1}\n"
    figure, _ = drawn_of(command, monkeypatch, config)
    colours = [to_hex(bar.get_facecolor()).upper() for bar in figure.axes[0].patches]
    assert colours == [CLASS_COLOURS[word] for word in ("monotone", "not stored")]
    entries = [text.get_text() for legend in figure.legends for text in legend.get_texts()]
    assert entries[:2] == ["monotone decay", "not stored"]


def test_list_of_rods_has_a_bar_for_each_in_its_order(command, monkeypatch):
    config = "task: thresholds\nparameters: {points: p.csv}\n"
    rods = "k1,k2,gamma3\n200,1e4,1e-4\n1e4,1e2,1e-2\n"
    figure, _ = drawn_of(command, monkeypatch, config, rods)
    inside(figure)
    hopf = next(line for line in figure.axes[0].lines if line.get_marker() == "s")
    first = {rod: F for rod, F in zip(*(data[::-1] for data in hopf.get_data()), strict=True)}
    assert [first[1], first[2]] == pytest.approx([49.7580049161915, 27.4271941267593], rel=1e-10)


DIAGRAM = """task: phase_diagram
parameters:
  F: {start: 0, stop: 200, num: 6}
  k1: {start: 30, stop: 1000, num: 5, spacing: log}
  k2: 1.0e4
  gamma3: 1.0e-4
phase_diagram: {curves: true}
"""


@pytest.mark.long
def test_phase_diagram_has_its_edge_as_a_line_marks_apart_and_a_legend_inside(command, monkeypatch):
    command.write("c.yaml", DIAGRAM)
    command.solved("c.yaml")
    drawn = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, *_, **__: drawn.append(figure))
    for width in ("single", "double"):
        draw(read_view(command.directory / "c.h5"), command.directory / "f.png", look=FigureLook(width=width))
        figure = drawn[-1]
        figure.draw_without_rendering()
        axes, (legend,) = figure.axes[0], figure.legends
        box = legend.get_window_extent()
        assert figure.bbox.x0 <= box.x0
        assert box.x1 <= figure.bbox.x1
        assert not box.overlaps(axes.get_tightbbox())
        (edge,) = (each for each in axes.collections if isinstance(each, QuadContourSet))
        F, k1 = np.concatenate([path.vertices for path in edge.get_paths()]).T
        assert len(F) > 100
        assert pytest.approx(k1, rel=1e-4) == F  # a pixel is 4e-3 of k1
        marks = [line for line in axes.lines if line.get_marker() not in (None, "None", "")]
        assert len(marks) == len({line.get_marker() for line in marks}) == 2
        entries = " ".join(text.get_text() for text in legend.get_texts())
        assert all(symbol in entries for symbol in (r"$\tilde F_*$", r"$\tilde F_{**}$"))


@pytest.mark.parametrize(
    ("parameters", "flutters"),
    [
        (
            "{taper: {start: 0.3, stop: 2, num: 8}, F: {start: 0, stop: 60, num: 20}, "
            "k1: 100, k2: 1000, gamma3: 0.01}",
            (50.0, 0.76),
        ),
        ("{k1: {start: 20, stop: 300, num: 15}, k2: [10, 30, 100], F: 30, gamma3: 0}", (32.0, 12.0)),
    ],
)
def test_regions_of_a_diagram_end_where_the_force_crushes_the_rod(command, monkeypatch, parameters, flutters):
    figure, _ = drawn_of(command, monkeypatch, f"task: phase_diagram\nparameters: {parameters}\n")
    classes = figure.axes[0].images[0].get_array()
    view = read_view(command.directory / "c.h5")
    F, k1 = (view.variables[name] for name in ("F", "k1"))
    x, y = F, view.variables["taper" if "taper" in view.variables else "k2"]
    if "taper" in view.variables:
        F = DrawnPlane.pixel_centres(F)
        k1 = 100 * np.minimum(1, DrawnPlane.pixel_centres(y)[:, None] ** 2)
    else:
        x, k1 = k1, DrawnPlane.pixel_centres(k1)
    crushed = np.broadcast_to(k1 <= F, classes.shape)
    assert np.array_equal(classes == stored_number_of_word("crushed", STABILITY_CLASSES), crushed)
    at = (
        np.abs(DrawnPlane.pixel_centres(axis) - place).argmin()
        for axis, place in ((x, flutters[0]), (y, flutters[1]))
    )
    column, row = at
    assert classes[row, column] == stored_number_of_word("flutter", STABILITY_CLASSES)


def test_classes_are_bounded_by_a_curve_however_few_points_are_computed():
    """Below the parabola y = x^2 class 1, above it class 2, from four points."""
    x = np.linspace(0, 1, 200)
    places = ClassifiedPoints(
        np.array([[0.1, 0.9], [0.05, 0.1], [0.9, 0.1], [0.95, 0.8]]), np.array([2, 2, 1, 1])
    )
    table = pixel_classes(places, places, [np.column_stack([x, x**2])], NO_PIXELS, 0)
    centres = (np.arange(PIXEL_COUNT) + 0.5) / PIXEL_COUNT
    off = centres[:, None] - centres[None, :] ** 2
    away = np.abs(off) > 3 / PIXEL_COUNT
    assert np.array_equal(table[away], np.where(off > 0, 2, 1)[away])


def test_a_region_between_curves_without_a_computed_point_has_the_class_of_a_place_known_otherwise():
    rails = [np.array([[0.0, y], [1.0, y]]) for y in (0.5, 0.52)]
    computed = ClassifiedPoints(np.array([[0.5, 0.2], [0.5, 0.8]]), np.array([1, 2]))
    further = ClassifiedPoints(np.array([[0.3, 0.51]]), np.array([3]))
    middle = int(0.51 * PIXEL_COUNT)
    assert (pixel_classes(computed, further, rails, NO_PIXELS, 0)[middle] == 3).all()
    assert (pixel_classes(computed, NO_POINTS, rails, NO_PIXELS, 0)[middle] == 0).all()
    hidden = [np.array([[0.0, y], [1.0, y]]) for y in (0.5, 0.503)]  # the lines over the rails cover it
    assert set(pixel_classes(computed, NO_POINTS, hidden, NO_PIXELS, 0).ravel()) == {1, 2}


def test_all_stored_roots_are_drawn_where_asked(command, drawn):
    command.write("c.yaml", LINE + "spectrum: {modes: 5}\n")
    command.solved("c.yaml")
    view = read_view(command.directory / "c.h5")
    modes = replace(view, attributes={**view.attributes, "task": "modes"})
    with pytest.raises(InputError, match="--roots is for results of spectrum, and this is a result of modes"):
        draw(modes, command.directory / "f.png", roots="all")
    assert "all stored roots" in draw(view, command.directory / "f.png", roots="all")
    real = next(line for line in drawn[0].axes[0].lines if line.get_marker() == "o")
    assert sorted(real.get_ydata()) == sorted(view.variables["growth_rate"].ravel())


def test_a_figure_of_a_run_without_a_point_says_so(command):
    command.write("c.yaml", LINE)
    command.solved("c.yaml")
    view = read_view(command.directory / "c.h5")
    status = np.full_like(view.variables["status"], -1)
    nothing = {"status": status, "growth_rate": np.nan * view.variables["growth_rate"]}
    empty = replace(view, variables={**view.variables, **nothing})
    with pytest.raises(
        InputError, match=r"no point of .*c\.h5 is computed yet; `rodsweep run` continues the run"
    ):
        draw(empty, command.directory / "f.png")


def test_a_section_between_the_values_of_a_long_axis_names_its_neighbours(command):
    command.write("c.yaml", LINE)
    assert command("run", "c.yaml", "--set", "parameters.F={start: 0, stop: 20, num: 21}").returncode == 0
    view = read_view(command.directory / "c.h5")
    for value, sentence in (
        (7.25, "it has F = 0 to 20; the nearest values are 7 and 8"),
        (99.0, "it has F = 0 to 20; the nearest values are 19 and 20"),
        (-1.0, "it has F = 0 to 20; the nearest values are 0 and 1"),
    ):
        with pytest.raises(InputError, match=f"{sentence}$"):
            slice_at_values(view, {"F": value})


def test_a_section_of_a_grid_is_what_a_run_of_its_own_gives(command, monkeypatch):
    command.write("c.yaml", LINE)
    command("run", "c.yaml", "--set", "parameters.k2=[50, 100]", "--set", "spectrum.modes=3", "-o", "grid.h5")
    command("run", "c.yaml", "--set", "spectrum.modes=3", "-o", "line.h5")
    cut = slice_at_values(read_view(command.directory / "grid.h5"), {"k2": 100.0})
    line = read_view(command.directory / "line.h5")
    assert cut.variables["status"].shape == line.variables["status"].shape
    for name in ("F", "k2", "growth_rate", "frequency"):
        assert cut.variables[name] == pytest.approx(line.variables[name], rel=1e-9, abs=1e-9)
    for words, said in (
        (("--at", "k2=70"), "no point there; it has k2 = 50, 100"),
        (("--at", "k3=1"), "has no such axis"),
        (("--at", "k2"), "--at k2 must be NAME=VALUE, such as k1=150"),
        (("--at", "k2=50", "--at", "k2=100"), "--at k2 is given twice (50 and 100)"),
        (
            ("--width", "tall"),
            "width = 'tall' is not allowed; choose single, double, or a length such as '89 mm'",
        ),
        (("--width", "1 km"), "from 64 to 508 mm"),
        (("--what", "map"), "is for results of thresholds"),
    ):
        refused = command.drawn("plot", "grid.h5", *words)
        assert (refused.returncode, refused.stderr.count("\n")) == (2, 1)
        assert said in refused.stderr


THRESHOLDS = """task: thresholds
parameters: {k1: [150, 200, .inf], k2: {start: 100, stop: 1.0e4, num: 4, spacing: log}, gamma3: 1.0e-4}
"""


@pytest.mark.long
def test_thresholds_of_every_value_are_lines_or_cells_of_a_map(command, monkeypatch):
    figure, shown = drawn_of(command, monkeypatch, THRESHOLDS)
    assert "critical forces against k2 for every k1" in shown
    view = read_view(command.directory / "c.h5")
    stored = np.concatenate(
        [view.variables[f"F_{name}"].ravel() for name in ("onset", "hopf", "restabilization")]
    )
    lines = np.concatenate([line.get_ydata() for line in figure.axes[0].lines])
    assert sorted(lines[np.isfinite(lines)]) == sorted(stored[np.isfinite(stored)])
    drawn = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, *_, **__: drawn.append(figure))
    assert "k1 = inf has no place" in draw(view, command.directory / "f.png", what="map")
    for axes, name in zip(drawn[0].axes, ("F_onset", "F_hopf"), strict=False):
        (mesh,) = axes.collections
        cells = np.ma.asarray(mesh.get_array()).reshape(4, 2)
        values = view.variables[name][:2, :, 0].T
        assert cells.filled(np.nan) == pytest.approx(values, nan_ok=True)


@pytest.mark.parametrize(
    ("low", "high", "written"),
    [(30, 900, ["50", "100", "200", "500"]), (3e4, 4e5, [r"5\times10^{4}", "10^{5}", r"2\times10^{5}"])],
)
def test_ticks_of_an_axis_are_all_written_the_same_way(low, high, written):
    axes = Figure().subplots()
    scale_axis(axes, "x", np.geomspace(low, high, 5))
    axes.set_xlim(low, high)
    axes.figure.draw_without_rendering()
    shown = [
        text.get_text().strip("$")
        for value, text in zip(axes.get_xticks(), axes.get_xticklabels(), strict=True)
        if low <= value <= high
    ]
    assert shown == written


def test_lines_that_cannot_be_told_apart_are_one():
    rise = np.linspace(1, 2, 5)
    lines = {0: np.tile(rise, (3, 1)), 4: np.tile(1.001 * rise, (3, 1)), 9: np.tile(0.5 * rise, (3, 1))}
    assert _groups_of_equal_lines(lines) == [[0, 4], [9]]
    lines[4] = lines[4].copy()
    lines[4][2] = np.nan
    assert _groups_of_equal_lines(lines) == [[0], [4], [9]]


@pytest.mark.long
def test_several_lines_of_spectra_are_panels_of_one_figure(command, drawn):
    for name, k1 in (("a", 200), ("b", 1e4)):
        axes = f"F: {{start: 0, stop: 60, num: 13}}, k1: {k1}, k2: 1.0e4, gamma3: 1.0e-4"
        command.write(f"{name}.yaml", f"task: spectrum\nparameters: {{{axes}}}\nspectrum: {{modes: 4}}\n")
        command("run", f"{name}.yaml")
    views = [read_view(command.directory / f"{name}.h5") for name in "ab"]
    assert "for each of 2 files" in draw(views, command.directory / "f.png")
    titles = [axes.get_title(loc="left") for axes in drawn[0].axes]
    assert [title[:3] for title in titles] == ["(a)", "(b)"]
    assert "49.758" in titles[0]
    assert "37.656" in titles[1]
    assert len(drawn[0].legends) == 1
    command.write("m.yaml", f"task: modes\nparameters: {{{axes}}}\nmodes: {{modes: 1, growth: false}}\n")
    command.solved("m.yaml")
    command.write("t.yaml", "task: thresholds\nparameters: {k1: 200, k2: 1.0e4, gamma3: 1.0e-4}\n")
    command.solved("t.yaml")
    refused = command.drawn("plot", "a.h5", "t.h5", "-o", "x.png")
    assert (refused.returncode, refused.stderr.count("\n")) == (2, 1)
    assert "only lines of spectra" in refused.stderr
    assert (
        "only results of limit_cycle, spectrum or thresholds can share a figure"
        in command.drawn("plot", "m.h5", "m.h5", "-o", "x.png").stderr
    )
    alone = command.drawn("plot", "t.h5", "t.h5", "-o", "x.png")
    assert (alone.returncode, alone.stderr.count("\n")) == (2, 1)


def test_thresholds_of_several_files_are_lines_of_one_figure(command, drawn):
    """A colour for each law; a file over another axis is refused."""
    for name, law in (("a", "linear"), ("b", "neo_hookean")):
        axes = "k1: [150, 300, 600], k2: 1.0e4, gamma3: 1.0e-4"
        text = (
            f"task: thresholds\nparameters: {{{axes}}}\nmaterial: {{law: {law}}}\nthresholds: {{F_max: 80}}\n"
        )
        command.write(f"{name}.yaml", text)
        command.solved(f"{name}.yaml")
    views = [read_view(command.directory / f"{name}.h5") for name in "ab"]
    assert "critical forces against k1 of 2 files" in draw(views, command.directory / "f.png")
    (axes,) = drawn[0].axes
    hopf = [line.get_ydata() for line in axes.lines if line.get_marker() == "s" and len(line.get_ydata())]
    for line, view in zip(hopf, views, strict=True):
        np.testing.assert_array_equal(line, view.variables["F_hopf"].ravel())
    labels = [text.get_text() for text in drawn[0].legends[0].get_texts()]
    assert labels[-2:] == ["linear", "neo-Hookean, fixed section"]
    command.write("t.yaml", "task: thresholds\nparameters: {k1: 200, k2: [1.0e3, 1.0e4], gamma3: 1.0e-4}\n")
    command.solved("t.yaml")
    refused = command.drawn("plot", "a.h5", "t.h5", "-o", "x.png")
    assert (refused.returncode, refused.stderr.count("\n")) == (2, 1)
    assert "grids over one parameter, the same in every file" in refused.stderr


def test_folds_of_rows_are_marked_where_no_curve_goes_through_them():
    """Of three folds on rows two lie on the curve, one of them between its points."""
    variables = {
        "F": np.linspace(0, 100, 11),
        "k1": np.array([100.0, 150.0, 200.0]),
        "status": np.zeros(3),
        "cycle_special_kind": np.array([[2, 0], [2, 1], [2, 0]]),
        "cycle_special_F": np.array([[50.0, np.nan], [70.0, 60.0], [55.0, np.nan]]),
        "cycle_curve_number": np.array([1, 1]),
        "cycle_curve_kind": np.array([2, 2]),
        "cycle_curve_F": np.array([50.0, 60.0]),
        "cycle_curve_k1": np.array([100.0, 300.0]),
    }
    view = ResultView(Path("f.h5"), {"task": "phase_diagram"}, variables, ("k1",), {0: "ok"}, 0)
    axes = Figure().subplots()
    mark_special_points_on_rows(axes, view, PlaneParameters("F", "k1"))
    (folds,) = axes.lines
    assert folds.get_xydata().tolist() == [[70.0, 150.0]]
    bare = {name: values for name, values in variables.items() if not name.startswith("cycle_curve")}
    mark_special_points_on_rows(axes, replace(view, variables=bare), PlaneParameters("F", "k1"))
    assert len(axes.lines[1].get_xydata()) == 3


def test_a_fold_beside_an_extremum_of_its_curve_lies_on_it():
    """The chords of a curve that is flat there are farther from the fold along the row than across it."""
    F = 83.8 + 1.6 * np.arange(-8, 5)
    variables = {
        "F": np.array([50.0, 120.0]),
        "k1": np.array([132.5, 133.051, 135.0]),
        "status": np.zeros(3),
        "cycle_special_kind": np.array([[0], [2], [0]]),
        "cycle_special_F": np.array([[np.nan], [83.0], [np.nan]]),
        "cycle_curve_number": np.ones(13),
        "cycle_curve_kind": np.full(13, 2),
        "cycle_curve_F": F,
        "cycle_curve_k1": 133 + 0.051 * ((F - 79) / 4) ** 2,
    }
    view = ResultView(Path("f.h5"), {"task": "phase_diagram"}, variables, ("k1",), {0: "ok"}, 0)
    axes = Figure().subplots()
    mark_special_points_on_rows(axes, view, PlaneParameters("F", "k1"))
    assert not axes.lines


def figure_of(task, **words):
    """The figure of a sweep as it is written."""
    figures = []
    draw(
        view_of_dataset(rs.sweep(task, progress=False, **words), Path("d.h5")),
        Path("f.png"),
        figure_callback=figures.append,
    )
    return figures[0]


def test_a_diagram_far_from_crushing_has_neither_its_edge_nor_the_partial_beam():
    """Both lay beyond its axes, and the legend told of the system."""
    rows = {"k1": [480.0, 1e4, 1e6], "k2": 1e5, "gamma3": 1e-5, "F": {"start": 0.0, "stop": 90.0, "num": 7}}
    figure = figure_of("phase_diagram", **rows)
    texts = [text.get_text() for legend in figure.legends for text in legend.get_texts()]
    assert not any("partial" in text or "k_1 =" in text for text in texts)
    (axes,) = figure.axes
    ends = (axes.get_xlim(), axes.get_ylim())
    for line in axes.lines:
        for (low, high), values in zip(ends, line.get_data(), strict=True):
            assert np.all((low * (1 - 1e-9) <= values) & (values <= high * (1 + 1e-9)))


ARM = {"length": "13 cm", "radius": "3.6 mm", "poisson": 0.24, "viscosity": "0.5 Pa s"}


def test_normal_forms_of_an_arm_over_its_drags_are_drawn():
    """Drags move gamma3 and gamma1 together, which are no map."""
    figure = figure_of("criticality", arm=ARM | {"young": "12 kPa", "drag": ["least", "most"]}, F_max=60.0)
    assert "predicted" in figure.axes[0].get_ylabel()
    assert sum(line.get_marker() == "o" for line in figure.axes[0].lines) >= 2


def test_one_arm_with_a_load_relative_to_flutter_has_the_figure_of_a_rod():
    """A grid over its quantities with one point has no axis for a map."""
    figure = figure_of("spectrum", arm=ARM | {"young": "12 kPa", "pressure": "1.2 of flutter"})
    assert figure.axes[0].get_xlabel() == r"$\mathrm{Re}\,\omega\,\tau_2$"


def test_a_bar_of_frequencies_that_are_all_0_does_not_reach_below():
    load = {"young": ["12 kPa", "13 kPa"], "length": ["13 cm", "14 cm"], "pressure": "0.01 kPa"}
    figure = figure_of("spectrum", arm=ARM | load)
    (bar,) = (axes for axes in figure.axes if axes.get_ylabel() == "leading frequency (Hz)")
    assert bar.get_ylim()[0] == 0


def test_growing_roots_are_drawn_unless_other_roots_are_chosen(command, monkeypatch):
    """At k2 = 20 the two smallest roots decay, and a pair behind them grows."""
    rod = "{F: 40, k1: {start: 100, stop: 300, num: 8}, k2: 20, gamma3: 1.0e-4}"
    _, shown = drawn_of(command, monkeypatch, f"task: spectrum\nparameters: {rod}\n")
    view = read_view(command.directory / "c.h5")
    assert (view.variables["growth_rate"].max(axis=-1) > 0).all()
    assert "the two rightmost roots" in shown
    assert "smallest" in draw(view, command.directory / "f.png", roots="smallest")


@pytest.mark.parametrize(
    ("parameters", "inside", "word"),
    [
        # between the restabilization at F = 174.6 and the crushing force 180
        (
            "{F: {start: 0, stop: 200, num: 21}, gamma3: [0.1, 0.5, 1], k1: 180, k2: 2000}",
            (177.0, 0.9),
            "oscillatory",
        ),
        # between crushing at k1 = 120 and the onset at 124.8
        ("{F: 120, k1: [60, 150, 300, 600], k2: [5000, 1.0e4], gamma3: 1.0e-3}", (121.0, 9900.0), "monotone"),
    ],
)
def test_an_outer_part_of_a_row_without_a_computed_point_has_its_own_class(
    command, monkeypatch, parameters, inside, word
):
    figure, _ = drawn_of(command, monkeypatch, f"task: phase_diagram\nparameters: {parameters}\n")
    classes = figure.axes[0].images[0].get_array()
    view = read_view(command.directory / "c.h5")
    line, row = ("F", "gamma3") if "180" in parameters else ("k1", "k2")
    column, line_of_pixels = (
        np.abs(DrawnPlane.pixel_centres(view.variables[name]) - place).argmin()
        for name, place in zip((line, row), inside, strict=True)
    )
    assert classes[line_of_pixels, column] == stored_number_of_word(word, STABILITY_CLASSES)


def test_what_a_figure_leaves_out_is_said(command, monkeypatch):
    plane = "{k1: {start: 50, stop: 300, num: 5}, k2: [10, 100, .inf], F: 30, gamma3: 0}"
    _, shown = drawn_of(command, monkeypatch, f"task: phase_diagram\nparameters: {plane}\n")
    assert "k2 = inf has no place on an axis and is left out" in shown
    arm = "{length: [10 cm, 12 cm], radius: [4 mm, 5 mm], young: 100 kPa, viscosity: [1 Pa s, 2 Pa s]}"
    _, shown = drawn_of(command, monkeypatch, f"task: thresholds\nparameters: {{arm: {arm}}}\n")
    assert "only for viscosity 1 Pa s (of 2 values)" in shown


def test_panels_of_numbers_that_only_cycles_have_say_that_there_is_no_cycle(command, drawn):
    command.write(
        "c.yaml",
        "task: limit_cycle\nparameters: {F: [5, 10], k1: 200, k2: 1.0e4, gamma3: 1.0e-3}\naccuracy: 1.0e-3\n",
    )
    command.solved("c.yaml")
    draw(read_view(command.directory / "c.h5"), command.directory / "f.png")
    empty = [axes for axes in drawn[0].axes if [text.get_text() for text in axes.texts] == ["no cycle"]]
    assert [axes.get_ylabel().split()[0] for axes in empty] == ["period", "mean"]


@pytest.mark.parametrize(
    "parameters, names",
    [
        ("{F: {start: 1, stop: 60, num: 9}, k1: [100, 120, 150, 200, 300, 500, .inf], k2: 1.0e4}", "k1"),
        ("{F: 20, k1: [100, 150, .inf], k2: [50, .inf]}", "k1"),
        ("{F: 20, k1: [100, 150, .inf], k2: 50}", "k1"),
        ("{F: {start: 1, stop: 60, num: 9}, k1: [100, .inf], k2: 1.0e4}", ""),
    ],
)
def test_figures_of_spectra_name_the_infinite_values_that_have_no_place(command, parameters, names):
    command.write("c.yaml", f"task: spectrum\nparameters: {parameters[:-1]}, gamma3: 1.0e-3}}\n")
    command.solved("c.yaml")
    shown = draw(read_view(command.directory / "c.h5"), command.directory / "f.png")
    clause = f"; {names} = inf has no place on an axis and is left out"
    assert shown.endswith(clause) if names else "left out" not in shown


@pytest.mark.parametrize(
    ("task", "varied"),
    [
        ("thresholds", {"load_kind": "force"}),
        ("thresholds", {"load_kind": "force", "poisson": [0.4, 0.5]}),
        ("spectrum", {"force": "40 mN"}),
        ("spectrum", {"force": rs.linspace("30 mN", "40 mN", 3)}),
        ("modes", {"force": "40 mN"}),
        ("criticality", {"load_kind": "force"}),
    ],
)
def test_figures_of_an_arm_name_its_quantities_above_its_parameters(task, varied):
    arm = {"length": "14 cm", "radius": "4 mm", "young": "100 kPa", "viscosity": "10 Pa s"}
    figure = rs.plot(rs.sweep(task, arm=arm | varied, progress=False)).figure()
    title = figure.get_suptitle().replace("\N{NO-BREAK SPACE}", " ").replace("\n", " ")
    assert title.startswith("length 14 cm, radius 4 mm, Young's modulus 100 kPa, viscosity 10 Pa s")
    assert ("force 40 mN" in title) == (varied.get("force") == "40 mN")


CROWDED_DIAGRAM = """task: phase_diagram
parameters: {F: {start: 0, stop: 3000, num: 4}, k1: [6.0e3, 3.0e4], k2: 1.0e4, gamma3: 1.0e-4}
phase_diagram: {crossings: CROSSINGS}
"""


@pytest.mark.parametrize(
    ("crossings", "said"), [(6, "curves through 12 of 18 crossings of the rows"), (16, "")]
)
def test_curves_that_the_rows_have_no_room_for_are_said_to_be_missing(command, monkeypatch, crossings, said):
    figure, _ = drawn_of(command, monkeypatch, CROWDED_DIAGRAM.replace("CROSSINGS", str(crossings)))
    assert ("crossings" in figure.get_suptitle()) == bool(said)
    assert said in figure.get_suptitle()
