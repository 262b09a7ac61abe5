"""`rodsweep report`: one page that needs no network and says what the file holds, whatever the task."""

import re
import shutil
import subprocess
from dataclasses import replace

import numpy as np
import pytest
from explore.browser import Browser, needs_browser
from faults import small
from pages import read_page
from surveyed import RODS, only

from rodsweep.post.figures.cells import cell_centres, cell_edges
from rodsweep.post.report import write_report
from rodsweep.post.report.plain_label_text import plain_text_of_label
from rodsweep.post.summary import summary_of
from rodsweep.results.file.view import read_view
from rodsweep.tasks import TASKS

ROD = "k1: 1.0e4, k2: 1.0e2, gamma3: 1.0e-2"
CONFIGS = small.CONFIGS | {
    "criticality": f"task: criticality\nparameters: {{{ROD.replace('1.0e4', '[200, 1.0e4]')}}}\n",
    "branch": f"task: branch\nparameters: {{{ROD}}}\nbranch: {{start: 20, stop: 40}}\naccuracy: 1.0e-3\n",
}
KEPT = ["spectrum", "thresholds", "limit_cycle", "branch"]
"""Files of which every run of the tests makes a page; `make survey` makes that of every task."""
NASTY = "<script>alert('title')</script> & {{ 7 * 7 }} $x_1$"


def solved(command, name):
    command.write("points.csv", small.POINTS)
    command.write(f"{name}.yaml", CONFIGS[name])
    return command.solved(f"{name}.yaml")


PAGES: dict[str, str] = {}
"""Pages of the small files that were made here, by the names of their configs."""


def reported(command, name):
    """The page of a small file, beside it; made once for all tests."""
    solved(command, name)
    path = command.directory / f"{name}.html"
    if name not in PAGES:
        run = command.drawn("report", f"{name}.h5")
        assert run.returncode == 0, run.stderr
        assert run.stdout.startswith(f"wrote {name}.html: 1 result, ")
        PAGES[name] = path.read_text()
    path.write_text(PAGES[name])
    return read_page(path)


def test_there_is_a_small_file_of_every_task():
    assert CONFIGS.keys() >= TASKS.keys()


@pytest.mark.long
@pytest.mark.parametrize("name", only(KEPT, CONFIGS))
def test_a_page_of_every_task_is_whole_and_needs_no_network(command, name):
    page = reported(command, name)
    assert page.asked_for() == []
    assert len(page.texts("script")) == len(page.texts("style")) == 1
    assert page.texts("svg", role="img")
    assert page.texts("circle")
    headings = ["Figures", "Reliability", "Tables", "Config", "Provenance"]
    assert [h for h in page.texts("h2") if h != "Further results"] == headings


@pytest.mark.parametrize("name", only(KEPT, CONFIGS))
def test_the_page_says_what_show_says(command, name):
    page = reported(command, name)
    shown = " ".join(command("show", f"{name}.h5").stdout.split())
    (lead,) = page.texts("p", class_="lead")
    answer = " ".join(shown.split(f"task {read_view(command.directory / f'{name}.h5').task} ", 1)[1].split())
    assert answer.startswith(lead)
    summary = summary_of(read_view(command.directory / f"{name}.h5"))
    paragraphs = page.texts("p")
    for line in [*summary.answer, *summary.reliability, *summary.details, *summary.cost_and_provenance_lines]:
        assert " ".join(line.replace("`", "").split()) in ["", *paragraphs]
    for row in summary.statuses.rows:
        assert {row[0], row[1], row[2].replace("`", "")} <= set(page.texts("td"))


def test_no_label_on_a_page_is_left_in_tex(command):
    for name in CONFIGS if RODS else KEPT:
        for value in reported(command, name).values():
            assert not re.search(r"[$\\{}]", " ".join(value)), value


def test_the_numbers_in_tables_are_those_in_the_file(command):
    page = reported(command, "thresholds")
    rows = page.table("points")
    v = read_view(command.directory / "thresholds.h5").variables
    for name in ("F_onset", "F_hopf", "hopf_frequency"):
        assert [float(row[name]) for row in rows] == v[name].ravel().tolist()
    assert {row["status"] for row in rows} == {"ok"}


def test_the_values_under_the_pointer_are_those_in_the_file(command):
    page = reported(command, "thresholds")
    v = read_view(command.directory / "thresholds.h5").variables
    forces = np.concatenate([v["F_onset"].ravel(), v["F_hopf"].ravel()])
    words = [lines for lines in page.values() if len(lines) == 2]
    read = [float(lines[1].rpartition(" = ")[2]) for lines in words]
    assert np.sort(read) == pytest.approx(np.sort(forces), rel=1e-7)
    maps = [lines for lines in page.values() if len(lines) == 3]
    mapped = sorted(float(lines[0].rpartition(": ")[2]) for lines in maps)
    assert mapped == pytest.approx(np.sort(forces), rel=1e-7)
    rods = {(float(a.rpartition(" = ")[2]), float(b.rpartition(" = ")[2])) for _, a, b in maps}
    assert rods == {(200, 100), (200, 1e4), (1e4, 100), (1e4, 1e4)}


def test_a_map_of_spectra_has_the_growth_rates_under_the_pointer(command):
    axes = "{F: {start: 5, stop: 45, num: 7}, k1: {start: 100, stop: 2.0e4, num: 7, spacing: log}"
    rest = "k2: 1.0e4, gamma3: 1.0e-4}"
    command.write("c.yaml", f"task: spectrum\nparameters: {axes}, {rest}\nspectrum: {{modes: 2}}\n")
    command.solved("c.yaml")
    assert command.drawn("report", "c.h5").returncode == 0
    rates = [float(v[0].rpartition(": ")[2]) for v in read_page(command.directory / "c.html").values()]
    stored = read_view(command.directory / "c.h5").variables["growth_rate"][..., 0].ravel()
    assert rates == pytest.approx(stored.tolist(), rel=1e-7)


@pytest.mark.long
def test_a_title_and_a_config_cannot_bring_markup(command):
    comment = "# <img src='http://example.org/x.png'>"
    command.write("c.yaml", f'title: "{NASTY}"\n{comment}\n{CONFIGS["thresholds"]}')
    command.solved("c.yaml")
    assert command.drawn("report", "c.h5", "-o", "p.html").returncode == 0
    page = read_page(command.directory / "p.html")
    assert page.texts("h1") == [NASTY]
    assert page.texts("title")[0] == NASTY
    assert len(page.texts("script")) == 1
    assert "alert" not in page.texts("script")[0]
    assert not page.texts("img")
    assert page.asked_for() == []


@pytest.mark.long
def test_a_page_of_a_part_says_what_is_missing(command):
    command.write("c.yaml", CONFIGS["thresholds"])
    assert command("run", "c.yaml", "--shard", "1/2", "-o", "c.h5").returncode == 0
    assert command.drawn("report", "c.h5").returncode == 0
    page = read_page(command.directory / "c.html")
    (told,) = [text for text in page.texts("p") if text.startswith("2 rods are not in this file")]
    assert "rodsweep merge" in told
    assert {"missing", "not computed yet"} <= set(page.texts("td"))
    assert [row["status"] for row in page.table("points")].count("missing") == 2


def test_a_page_without_a_computed_point_says_so(command):
    view = read_view(solved(command, "thresholds"))
    variables = dict(view.variables)
    for name, values in view.variables.items():
        if (
            values.shape[:1] == view.variables["status"].shape[:1]
            and values.dtype.kind == "f"
            and values.ndim > 1
        ):
            variables[name] = np.full_like(values, np.nan)
    variables["status"] = np.full_like(view.variables["status"], -1)
    write_report([replace(view, variables=variables)], command.directory / "p.html")
    page = read_page(command.directory / "p.html")
    assert page.texts("p", class_="lead") == ["no rod is computed yet"]
    assert any(
        text.startswith("No figure: no point of thresholds.h5 is computed yet") for text in page.texts("p")
    )


def test_points_that_failed_are_counted_with_their_reason_and_place(command):
    view = read_view(solved(command, "spectrum"))
    failed = next(value for value, word in view.status_flags.items() if word == "failed")
    status = view.variables["status"].copy()
    status[3:, 1] = failed
    write_report(
        [replace(view, variables=dict(view.variables) | {"status": status})], command.directory / "p.html"
    )
    page = read_page(command.directory / "p.html")
    cells = page.texts("td")
    place = cells.index("failed")
    assert cells[place + 1 : place + 3] == ["2", "F = 45 to 60, k1 = 10000"]
    assert len(cells[place + 3]) > 20
    assert sum(row["status"] == "failed" for row in page.table("points")) == 2


@pytest.mark.long
def test_several_files_make_one_page(command):
    solved(command, "thresholds")
    solved(command, "modes")
    run = command("report", "thresholds.h5", "modes.h5", "-o", "both.html")
    assert run.returncode == 0
    page = read_page(command.directory / "both.html")
    assert page.texts("h1") == ["thresholds", "modes"]
    links = [a["href"] for name, a, _ in page.elements if name == "a"]
    assert links == ["#result-1", "#result-2"]
    assert [a.get("id") for name, a, _ in page.elements if name == "article"] == ["result-1", "result-2"]


def test_the_page_names_no_machine(command):
    reported(command, "thresholds")
    hosts = read_view(command.directory / "thresholds.h5").attributes["hosts"]
    text = (command.directory / "thresholds.html").read_text()
    assert str(command.directory) not in text
    words = re.sub(r"<svg.*?</svg>|<style.*?</style>", "", text, flags=re.DOTALL)
    assert not re.search(rf"\b{re.escape(str(hosts))}\b", words)


POINT_AT_FIRST = """<script>
addEventListener("load", () => {
  const circle = document.querySelector(".values circle");
  const place = circle.getBoundingClientRect();
  const at = { clientX: place.x + place.width / 2, clientY: place.y + place.height / 2, bubbles: true };
  circle.dispatchEvent(new PointerEvent("pointermove", at));
});
</script></body>"""
"""Moves the pointer to the first value of a page."""


@pytest.mark.skipif(not shutil.which("chromium"), reason="chromium is not installed")
def test_the_value_under_the_pointer_is_shown_in_a_browser(command):
    page = reported(command, "thresholds")
    path = command.directory / "pointed.html"
    path.write_text(page.text.replace("</body>", POINT_AT_FIRST))
    switches = ("--headless=new", "--no-sandbox", "--disable-gpu", "--enable-logging=stderr", "--dump-dom")
    argv = ["chromium", *switches, f"file://{path}"]
    run = subprocess.run(argv, capture_output=True, text=True, timeout=120, check=True)
    assert re.search(r'<div id="value"[^>]*>([^<]*)</div>', run.stdout)[1].split("\n") == page.values()[0]
    assert not re.search(r"<circle[^>]*><title>", run.stdout)  # or the browser would show the text as well
    assert "CONSOLE" not in run.stderr


@pytest.mark.parametrize(
    ("label", "text"),
    [
        (r"follower force $\tilde F$", "follower force F"),
        (r"largest growth rate $\mathrm{Re}\,\omega_1\,\tau_2$", "largest growth rate Re ω1 τ2"),
        (r"onset $\tilde F_*$ in $k_3/L^2$", "onset F* in k3/L^2"),
        (r"$\Theta_1^\dagger$", "Θ1†"),
        (r"$\tilde k_1 = 2.5\times10^{-4}$, 5 \$", "k1 = 2.5×10^-4, 5 $"),
        (r"$\dot U L$", "dU/dt L"),
        ("energy\n$U L/k_3$", "energy U L/k3"),
    ],
)
def test_labels_become_plain_text(label, text):
    assert plain_text_of_label(label) == text


def test_centres_of_cells_are_the_values_that_made_the_edges():
    even = np.array([1.0, 2.0, 5.0, 5.5, 8.0])
    assert cell_centres(cell_edges(even)) == pytest.approx(even, rel=1e-14)
    logarithmic = np.array([1.0, 2.0, 50.0, 1e4])
    assert cell_centres(np.log(cell_edges(logarithmic))) == pytest.approx(np.log(logarithmic), abs=1e-14)


@pytest.mark.long
@needs_browser
def test_a_figure_is_dark_on_a_dark_page(command):
    reported(command, "phase_diagram")
    with Browser(dark=True) as browser:
        browser.show((command.directory / "phase_diagram.html").as_uri())
        box = "document.querySelector('.picture svg').getBoundingClientRect()"
        corner = browser.run(f"const box = {box}; return [box.left + 3, box.top + 3]")
        paper, figure = ([*browser.screenshot().getpixel(place)] for place in ((2, 2), tuple(corner)))
        assert figure == pytest.approx(paper, abs=2)
        assert max(paper) < 40
        assert browser.complaints() == []
