"""Figures: which roots are followed, what is drawn, what cannot be; and the configs' own numbers."""

import numpy as np
import pytest
from conftest import ROOT
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.text import Text
from PIL import Image

from rodsweep.cli.job import make_job
from rodsweep.cli.tasks import TASKS
from rodsweep.errors import InputError
from rodsweep.post.figures import FIGURES, draw
from rodsweep.post.figures.request import Look
from rodsweep.post.figures.spectrum import _mark_flutter, broken, followed_roots
from rodsweep.post.figures.style import INVERSE_DRAG, LABELS, number
from rodsweep.post.summary import SUMMARIES
from rodsweep.results.file.view import read_view
from rodsweep.solve.spectrum.search import SpectrumRequest, solve_spectrum


def test_every_task_has_a_summary_and_a_figure():
    assert SUMMARIES.keys() == FIGURES.keys() == TASKS.keys()


def test_rightmost_and_smallest_roots_differ():
    growth = np.array([[5.0, 5.0, -1.0, -3.0]])
    frequency = np.array([[7.0, -7.0, 0.0, 0.0]])
    assert followed_roots(growth, frequency, "rightmost").tolist() == [[5 + 7j, 5 - 7j]]
    assert followed_roots(growth, frequency, "smallest").tolist() == [[-1 + 0j, -3 + 0j]]


def test_line_is_broken_where_another_root_takes_over():
    x = np.arange(8.0)
    w = np.stack([x + 0j, np.where(x < 5, 1.0, 200.0) + 0.1 * x], axis=1)
    broken_x, broken_w = broken(x, w)
    assert np.flatnonzero(np.isnan(broken_x)).tolist() == [5]
    assert np.isnan(broken_w[5]).all()


LINE = "task: spectrum\nparameters: {F: {start: 0, stop: 30, num: 16}, k1: 1e4, k2: 1e2, gamma3: 1e-2}\n"


@pytest.mark.parametrize("suffix", ["png", "pdf", "svg"])
@pytest.mark.parametrize("roots", ["smallest", "rightmost"])
def test_line_of_spectra_is_drawn(command, suffix, roots):
    command.write("c.yaml", LINE)
    command("run", "c.yaml")
    run = command("plot", "c.h5", "-o", f"f.{suffix}", "--roots", roots)
    assert run.returncode == 0, run.stderr
    assert roots in run.stdout
    assert (command.directory / f"f.{suffix}").stat().st_size > 5000


def test_map_is_drawn_and_other_shapes_are_refused(command):
    command.write("c.yaml", LINE)
    command(
        "run", "c.yaml", "--set", "parameters.k2={start: 50, stop: 5e3, num: 5, spacing: log}", "-o", "map.h5"
    )
    assert "growth rate" in command("plot", "map.h5").stdout
    command("run", "c.yaml", "--set", "parameters.F=3", "-o", "point.h5")
    refused = command("plot", "point.h5")
    assert refused.returncode == 2
    assert "one or two" in refused.stderr
    with pytest.raises(InputError, match="must end in"):
        draw(read_view(command.directory / "map.h5"), command.directory / "f.frob", "smallest")


def test_infinite_axis_values_and_odd_titles_are_drawn_or_refused_in_a_sentence(command):
    command.write("c.yaml", LINE)
    both = ["--set", "parameters.k2=[50, 100, .inf]", "--set", "title=cost in $ and \\frac"]
    command("run", "c.yaml", *both, "-o", "map.h5")
    assert command("plot", "map.h5").returncode == 0
    command("run", "c.yaml", *both, "--set", "parameters.F=3", "-o", "line.h5")
    assert command("plot", "line.h5").returncode == 0
    for output in ("map.h5", ".", "figure"):
        refused = command("plot", "map.h5", "-o", output)
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
    job = make_job(path, ())
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
    return type(rod)(force, rod.k1, rod.k2, rod.gamma3)


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
    assert number(value) == written


def test_labels_of_dimensionless_parameters_have_no_unit():
    assert not any("[" in label for label in [*LABELS.values(), INVERSE_DRAG])


def test_flutter_is_marked_at_its_threshold_however_coarse_the_forces_are(command):
    command.write("c.yaml", LINE)
    command("run", "c.yaml")
    axes = Figure().subplots()
    _mark_flutter(axes, read_view(command.directory / "c.h5"), "F")
    (mark,) = axes.lines
    assert mark.get_xdata()[0] == pytest.approx(27.4271941267593, rel=1e-12)
    (shade,) = axes.patches
    assert shade.get_x() == pytest.approx(27.4271941267593, rel=1e-12)
    assert shade.get_x() + shade.get_width() == 30


def test_the_legend_names_no_flutter_where_there_is_none(command):
    command.write("c.yaml", LINE)
    command("run", "c.yaml", "--set", "parameters.F={start: 0, stop: 20, num: 11}")
    axes = Figure().subplots()
    _mark_flutter(axes, read_view(command.directory / "c.h5"), "F")
    assert axes.get_legend_handles_labels() == ([], [])


def test_fonts_of_a_pdf_are_embedded_as_type_42_and_images_have_300_dots_an_inch(command):
    command.write("c.yaml", LINE)
    command("run", "c.yaml")
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
    assert command("run", "c.yaml").returncode == 0
    return command.directory / "c.h5"


@pytest.mark.parametrize(("width", "inches"), [("single", 3.375), ("double", 7.0)])
def test_width_is_that_of_a_column_with_type_of_8_points(command, width, inches, monkeypatch):
    path, drawn = line_of_spectra(command), []
    monkeypatch.setattr(Figure, "savefig", lambda figure, *_: drawn.append(figure))
    draw(read_view(path), path.with_suffix(".png"), look=Look(width=width))
    (figure,) = drawn
    assert figure.get_size_inches()[0] == inches
    assert {text.get_fontsize() for text in figure.findobj(Text) if text.get_text()} == {8.0}


def test_title_stands_above_a_figure_only_where_it_is_asked_for(command, monkeypatch):
    path, drawn = line_of_spectra(command), []
    monkeypatch.setattr(Figure, "savefig", lambda figure, *_: drawn.append(figure.get_suptitle()))
    for look in (Look(), Look(title=True)):
        draw(read_view(path), path.with_suffix(".png"), look=look)
    assert ["Onset of a soft rod" in title for title in drawn] == [False, True]


def test_style_is_a_name_or_a_file_and_anything_else_is_refused(command, monkeypatch):
    path, colours = line_of_spectra(command), []
    own = command.directory / "own.mplstyle"
    own.write_text("axes.facecolor: 123456\n")
    monkeypatch.setattr(Figure, "savefig", lambda figure, *_: colours.append(figure.axes[0].get_facecolor()))
    for style in ("ggplot", str(own)):
        draw(read_view(path), path.with_suffix(".png"), look=Look(style=style))
    assert [to_hex(colour) for colour in colours] == ["#e5e5e5", "#123456"]
    for wrong in ("nosuch", "c.h5"):
        done = command("plot", "c.h5", "--style", wrong)
        assert (done.returncode, done.stderr.count("\n")) == (2, 1)
        assert f"{wrong} is neither a style of matplotlib's nor a style file" in done.stderr


def test_few_digits_of_a_large_number_are_written_with_a_power_of_ten():
    assert [number(value, 3) for value in (2236.07, 200.0, 999.9)] == [r"2.24\times10^{3}", "200", "10^{3}"]
