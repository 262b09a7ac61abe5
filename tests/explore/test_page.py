"""The page of `explore` without a browser: what each change asks, and what each answer shows."""

import re
from dataclasses import replace
from html import unescape

import numpy as np
import pytest
from bokeh.document import Document
from bokeh.models import HoverTool, LogTicker

import rodsweep as rs
from rodsweep.errors import UserError
from rodsweep.explore.page import Page
from rodsweep.explore.page_contents import NO_CYCLE_CURVES_FOUND_SENTENCE
from rodsweep.explore.page_state import PageState
from rodsweep.explore.page_state_from_file import state_and_answers_from_file
from rodsweep.explore.pictures.card import AXIS_OPACITY_PROPERTIES, STABLE_COLOUR
from rodsweep.explore.pictures.diagram import (
    BOUNDARY_COLOURS,
    DiagramCell,
    diagram_cells,
    log_axis_ticker,
    unstable_count_grid,
    unstable_count_words,
)
from rodsweep.explore.pictures.growth_and_branches import threshold_title
from rodsweep.explore.pictures.numbers_table import NumbersTable, first_element_text
from rodsweep.explore.slider_scales import PictureAxis
from rodsweep.explore.solving.diagram_curves_and_unstable_counts import DiagramCurve
from rodsweep.explore.solving.diagrams import CRUSHED_UNSTABLE_COUNT, UNKNOWN_UNSTABLE_COUNT
from rodsweep.explore.solving.request_inputs import REQUEST_KINDS_AFTER_EVERY_CHANGE
from rodsweep.explore.solving.requests import (
    Reply,
    SolveRequest,
    answer_to,
    answer_variables,
    growth_answer,
)
from rodsweep.explore.templates_and_texts import SOLVE_STOPPED_SENTENCE, template_text
from rodsweep.verdict import relative_load

PLANE = """task: phase_diagram
parameters: {F: {start: 0, stop: 60, num: 31}, k1: [100, 200, 400], k2: 1.0e4, gamma3: 1.0e-4}
"""


class ImmediateSolvers:
    """Answers at once, in this process. requests: all that were asked."""

    def __init__(self, kinds: tuple[str, ...] = REQUEST_KINDS_AFTER_EVERY_CHANGE):
        self.kinds = kinds
        self.requests: list[SolveRequest] = []

    def ask(self, session, request, done, progress=None):
        self.requests.append(request)
        if request.kind not in self.kinds:
            return
        try:
            done(Reply("answer", answer_to(request), 0.0))
        except UserError as refusal:
            done(Reply("refused", {"sentence": str(refusal)}, 0.0))

    def cancel(self, session, kind):
        pass

    def cancel_session(self, session):
        pass


def run_callbacks(document: Document, seconds: bool = False) -> None:
    """Runs what waits for the next tick, or for a rest of the page."""
    for callback in document.session_callbacks:
        if hasattr(callback, "timeout") == seconds:
            remove = document.remove_timeout_callback if seconds else document.remove_next_tick_callback
            remove(callback)
            callback.callback()


def page_with(
    solvers: ImmediateSolvers, query: str = "", state: PageState | None = None, stored=None
) -> Page:
    page = Page(Document(), solvers, state or PageState(), stored)
    page.show_address(query)
    run_callbacks(page.document)
    return page


def shown(page: Page) -> dict[str, str]:
    """Numbers of the table by name."""
    text = unescape(page.contents.numbers.root.text)
    return dict(re.findall(r'<tr data-name="(\w+)"><td>[^<]*</td><td>([^<]*)</td>', text))


@pytest.mark.long
def test_pictures_and_numbers_are_those_of_the_solver():
    page = page_with(ImmediateSolvers())
    rod = rs.Rod(F=50, k1=1e4, k2=100, gamma3=0.01)
    spectrum, thresholds, cycle = rod.spectrum(modes=6), rod.thresholds(), rod.cycle()
    source = page.contents.spectrum.source.data
    assert source["growth"] == pytest.approx(spectrum.growth_rate, rel=1e-12)
    assert page.contents.spectrum.card.figure.title.text == "2 unstable modes, certified"
    assert shown(page)["F_hopf"] == first_element_text(thresholds.F_hopf)
    assert float(shown(page)["period"]) == pytest.approx(cycle.period, rel=1e-7)
    shapes = page.contents.beating.shapes_source.data
    nodes = int(shapes["number"][0])
    assert np.max(np.reshape(shapes["y"], (-1, nodes))[:, -1]) == pytest.approx(cycle.tip_y_max, rel=1e-2)
    assert page.contents.sign.text == ""


def test_growth_rates_of_rubber_reach_beyond_the_force_that_crushes_linear_material():
    weak = PageState().with_values(F="10", k1="20")
    assert growth_answer(weak)["F"][-1] < 20
    rubber = growth_answer(replace(weak, law="fixed", F_max="60"))
    assert rubber["F"][-1] == 60
    assert np.isfinite(rubber["growth_rate"][:, 0]).all()


def test_a_change_of_the_load_asks_no_thresholds_again():
    solvers = ImmediateSolvers()
    page = page_with(solvers)
    solvers.requests.clear()
    page.change({"F": "60"})
    assert {request.kind for request in solvers.requests} == {"spectrum", "cycle"}
    solvers.requests.clear()
    page.change({"k2": "200"})
    assert {request.kind for request in solvers.requests} == set(REQUEST_KINDS_AFTER_EVERY_CHANGE)


def test_a_rod_at_rest_says_so_above_the_straight_arm():
    page = page_with(ImmediateSolvers(), "F=20")
    card = page.contents.beating.card
    assert (card.message.visible, card.figure.visible) == (True, True)
    assert "straight" in card.message.text
    shapes = page.contents.beating.shapes_source.data
    assert shapes["x"][-1] == pytest.approx(1 - 20 / 1e4)
    assert not np.any(shapes["y"])
    page.change({"F": "50"})
    run_callbacks(page.document)
    assert (card.message.visible, card.figure.visible) == (False, True)


def test_a_bad_value_asks_nothing_and_has_its_sentence():
    solvers = ImmediateSolvers()
    page = page_with(solvers)
    solvers.requests.clear()
    page.change({"k1": "<i>-1"})
    assert solvers.requests == []
    assert "k1" in page.contents.spectrum.card.message.text
    assert "<i>" not in page.contents.spectrum.card.message.text


@pytest.mark.parametrize("values", [{"k1": "40"}, {"taper": "-1"}])
def test_a_bad_value_cancels_the_requests_that_wait_for_a_rest(values):
    solvers = ImmediateSolvers()
    page = page_with(solvers)
    page.change({"F": "51"})
    run_callbacks(page.document)
    solvers.requests.clear()
    page.change(values)
    sentence = page.contents.branches.card.message.text
    run_callbacks(page.document, seconds=True)
    assert solvers.requests == []
    assert page.contents.branches.card.message.text == sentence


def test_the_sign_names_what_is_being_solved_until_it_is_answered():
    page = page_with(ImmediateSolvers(("spectrum", "thresholds")))
    assert page.contents.sign.text == "solving cycle, growth rates ..."


def test_the_page_knows_which_numbers_belong_to_an_earlier_state():
    page = page_with(ImmediateSolvers())
    assert page.contents.sign.kinds == []
    page.solvers.kinds = ("spectrum",)
    page.change({"k2": "90"})
    run_callbacks(page.document)
    assert page.contents.sign.kinds == ["cycle", "thresholds", "growth"]
    for kind in ("spectrum", "cycle", "thresholds"):
        assert f'<tbody class="{kind}">' in page.contents.numbers.root.text


def test_an_answer_to_an_old_request_is_shown_but_does_not_end_the_sign():
    kept = []
    solvers = ImmediateSolvers()
    solvers.ask = lambda session, request, done, progress: kept.append((request, done))
    page = page_with(solvers)
    page.change({"F": "60"})
    request, done = next(each for each in kept if each[0].kind == "spectrum")
    done(Reply("answer", answer_to(request), 0.0))
    run_callbacks(page.document)
    assert "spectrum" in page.contents.sign.text
    assert len(page.contents.spectrum.source.data["growth"]) > 0


@pytest.mark.long
def test_branches_wait_until_the_page_rests_and_cones_until_the_button():
    solvers = ImmediateSolvers()
    page = page_with(solvers)
    run_callbacks(page.document, seconds=True)
    assert {"branch", "diagram"} <= {request.kind for request in solvers.requests}
    solvers.requests.clear()
    page.change({"taper": "0.7"})
    run_callbacks(page.document, seconds=True)
    assert "branch" not in {request.kind for request in solvers.requests}
    page.solve("branch")
    assert solvers.requests[-1].kind == "branch"


@pytest.mark.long
def test_a_file_brings_its_diagram_and_only_the_rest_is_solved(command):
    command.write("plane.yaml", PLANE)
    assert command("run", "plane.yaml").returncode == 0
    state, stored = state_and_answers_from_file(command.directory / "plane.h5")
    solvers = ImmediateSolvers()
    page = page_with(solvers, state=state, stored=stored)
    run_callbacks(page.document, seconds=True)
    assert (state.rod["k1"], state.second_parameter, state.F_max) == ("200", "k1", "60")
    assert "diagram" not in {request.kind for request in solvers.requests}
    counts = rs.open(command.directory / "plane.h5")["unstable_count"].squeeze()
    drawn = page.contents.diagram.cell_source.data
    assert max(drawn["unstable_count"]) == int(counts.max())


def test_the_reset_button_returns_to_what_was_drawn_last():
    page = page_with(ImmediateSolvers())
    axes = page.contents.growth.card.figure.x_range
    assert (axes.reset_start, axes.reset_end) == (axes.start, axes.end) == (0, 200)


def test_texts_to_share_wait_until_the_page_rests_and_what_the_buttons_copy_does_not():
    page = page_with(ImmediateSolvers(()))
    run_callbacks(page.document, seconds=True)
    page.change({"F": "61"})
    sharing = page.contents.sharing
    assert "F: 61" in sharing.shared_lines.config
    assert "F=61" in sharing.shared_lines.python
    assert "61" not in sharing.yaml.text + sharing.python.text + sharing.address.tags[0]
    run_callbacks(page.document, seconds=True)
    assert "F=61" in sharing.address.tags[0]
    assert "F: 61" in sharing.yaml.text
    assert "F=61" in sharing.address.text


def test_a_short_logarithmic_axis_has_ticks_in_its_lower_part_too():
    assert log_axis_ticker(90.0, 2200.0).ticks == [10, 20, 50, 100, 200, 500, 1000, 2000, 5000]
    assert isinstance(log_axis_ticker(1.0, 1e5), LogTicker)
    assert isinstance(log_axis_ticker(0.0, 1.0), LogTicker)


def test_the_diagram_names_its_areas_under_the_pointer_and_nothing_else():
    picture = page_with(ImmediateSolvers(())).contents.diagram
    counts = np.array([[0, 1, 2, UNKNOWN_UNSTABLE_COUNT, CRUSHED_UNSTABLE_COUNT]])
    cells = diagram_cells(np.arange(5.0), np.ones(1), counts)
    assert [unstable_count_words(cell.unstable_count) for cell in cells] == [
        "stable", "1 unstable mode", "2 unstable modes", "not searched, or not known", "crushed by the load",
    ]  # fmt: skip
    (hover,) = picture.card.figure.select(HoverTool)
    assert [renderer.data_source for renderer in hover.renderers] == [picture.cell_source]


def test_areas_of_a_diagram_end_at_its_curves_of_hopf_points():
    """A curve between the points, a window narrower than their distance, and a double eigenvalue."""
    y = np.array([1.0, 10.0])
    kinds_by_loads = {(0.2, 1.9): "hopf", (0.5, 0.5): "double", (1.95, 1.95): "hopf", (1.97, 1.97): "hopf"}
    found = {
        "x": np.array([0.0, 1.0, 2.0]), "y": y, "unstable_count": np.array([[0, 2, 2], [0, 0, 2]]),
        "curves": [DiagramCurve(np.array(x), y, kind) for x, kind in kinds_by_loads.items()],
        "between_x": np.full(2, 1.96), "between_y": y, "between_count": np.full(2, 4),
        "crushing_load": np.array([1.98, 19.8]),
    }  # fmt: skip
    sides, levels, counts = unstable_count_grid(found)
    middles = (sides[1:] + sides[:-1]) / 2
    for level, row in zip(np.log10(levels[1:] * levels[:-1]) / 2, counts, strict=True):
        hopf = 0.2 + 1.7 * level
        assert (row[middles < hopf - 0.01] == 0).all()
        assert (row[(middles > hopf + 0.01) & (middles < 1.94)] == 2).all()
        assert row[np.abs(middles - 1.96).argmin()] == 4
        assert row[-1] == (CRUSHED_UNSTABLE_COUNT if 1.98 * 10**level < sides[-2] else 2)
    assert (levels[0], levels[-1]) == pytest.approx((1, 10))
    assert unstable_count_grid(found | {"curves": found["curves"][1:2]}) is None
    rigid = unstable_count_grid(found | {"crushing_load": np.full(2, np.inf)})
    assert (rigid.unstable_counts[:, -1] == 2).all()


def test_cells_join_neighbours_of_equal_count_and_fill_the_rows():
    counts = np.array([[0, 0, 2], [0, 2, 2]])
    found = diagram_cells(np.array([0.0, 1.0, 2.0]), np.array([1.0, 10.0]), counts)
    root = 10**0.5
    assert found == [
        DiagramCell(0.0, 1.5, pytest.approx(1 / root), pytest.approx(root), 0),
        DiagramCell(1.5, 2.0, pytest.approx(1 / root), pytest.approx(root), 2),
        DiagramCell(0.0, 0.5, pytest.approx(root), pytest.approx(10 * root), 0),
        DiagramCell(0.5, 2.0, pytest.approx(root), pytest.approx(10 * root), 2),
    ]


def test_a_long_solve_says_how_far_it_is_and_can_be_stopped():
    class Halfway(ImmediateSolvers):
        cancelled: list[str] = []

        def ask(self, session, request, done, progress=None):
            super().ask(session, request, done)
            if request.kind == "cycles":
                progress(Reply("progress", {"text": "curve 1 of <2>", "completed_fraction": 0.5}, 1.0))

        def cancel(self, session, kind):
            self.cancelled.append(kind)

    solvers = Halfway()
    page = page_with(solvers)
    sign = page.contents.sign
    assert page.contents.buttons["cycles"].visible
    run_callbacks(page.document)
    assert not sign.is_stoppable
    page.solve("cycles")
    run_callbacks(page.document)
    assert page.contents.sign.text == "solving folds and torus points (curve 1 of &lt;2&gt;, 50%) ..."
    assert sign.is_stoppable
    page.stop_long_solves()
    assert (sign.text, sign.is_stoppable, solvers.cancelled) == ("", False, ["cycles"])


def test_stopping_the_folds_leaves_the_diagram_and_stopping_a_motion_the_arm():
    solvers = ImmediateSolvers((*REQUEST_KINDS_AFTER_EVERY_CHANGE, "bent"))
    page = page_with(solvers)
    run_callbacks(page.document, seconds=True)
    diagram, *_ = [request for request in solvers.requests if request.kind == "diagram"]
    page._on_answer(diagram, Reply("refused", {"sentence": ""}, 0.0))
    page.solve("cycles")
    page.stop_long_solves()
    page.request_tip_answer("bent", (0.6, 0.5))
    run_callbacks(page.document)
    assert len(page.contents.beating.bent_source.data["x"]) > 0
    page.request_tip_answer("motion", (0.6, 0.5))
    page.stop_long_solves()
    assert len(page.contents.beating.bent_source.data["x"]) == 0
    solvers.requests.clear()
    page.change({"F": "51"})
    run_callbacks(page.document, seconds=True)
    assert "branch" in {request.kind for request in solvers.requests}
    assert "diagram" not in {request.kind for request in solvers.requests}


@pytest.mark.long
def test_a_search_that_finds_no_folds_says_so_above_the_diagram_as_fine_as_before():
    page = page_with(ImmediateSolvers(("diagram", "cycles")), "F_max=30")
    run_callbacks(page.document, seconds=True)
    run_callbacks(page.document)
    card, drawn = page.contents.diagram.card, dict(page.contents.diagram.cell_source.data)
    assert not card.message.visible
    page.solve("cycles")
    run_callbacks(page.document)
    assert (card.message.visible, card.message.text) == (True, NO_CYCLE_CURVES_FOUND_SENTENCE)
    assert card.figure.visible
    assert page.contents.diagram.cell_source.data == drawn


def test_folds_are_added_to_the_drawn_diagram_while_the_rod_is_inside():
    solvers = ImmediateSolvers(("diagram",))
    page = page_with(solvers, "F_max=30")
    run_callbacks(page.document, seconds=True)
    run_callbacks(page.document)
    for k2, around in (("300", "100"), ("2e3", "2e3")):
        page.change({"k2": k2})
        page.solve("cycles")
        assert (solvers.requests[-1].kind, solvers.requests[-1].state.visible_texts["k2"]) == (
            "cycles",
            around,
        )
    page.change({"k2": "300", "gamma3": "0.02"})
    page.solve("cycles")
    assert solvers.requests[-1].state.visible_texts["k2"] == "300"


def test_folds_of_an_arm_are_asked_around_the_arm_and_refused():
    solvers = ImmediateSolvers(("diagram", "cycles"))
    page = page_with(solvers, "tab=arm&F_max=20")
    run_callbacks(page.document, seconds=True)
    run_callbacks(page.document)
    page.solve("cycles")  # a click that comes when the tab has just changed
    run_callbacks(page.document)
    assert "on the tab Rod" in page.contents.diagram.card.message.text


def test_folds_of_a_solved_diagram_are_all_that_is_solved():
    state = PageState(F_max="30")
    drawn, found = (answer_to(SolveRequest(kind, state)) for kind in ("diagram", "cycles"))
    assert found["unstable_count"] is drawn["unstable_count"]


def test_a_legend_names_all_colours_of_boundaries():
    looks = template_text("page.css")
    colours = re.findall(r"#\w+", "".join(re.findall(r"^\.lines .*$", looks, re.MULTILINE)))
    assert {*colours} == {*BOUNDARY_COLOURS.values(), STABLE_COLOUR}


def test_a_failure_takes_the_sign_and_the_button_away():
    class Failing(ImmediateSolvers):
        def ask(self, session, request, done, progress=None):
            super().ask(session, request, done)
            if request.kind == "cycles":
                progress(Reply("progress", {"text": "point 1 of 8", "completed_fraction": None}, 1.0))
                done(Reply("failed", {"sentence": "the solver ended unexpectedly"}, 2.0))

    page = page_with(Failing())
    page.solve("cycles")
    run_callbacks(page.document)
    assert page.contents.sign.text == ""
    assert not page.contents.sign.is_stoppable
    assert page.contents.diagram.card.message.text == "the solver ended unexpectedly"


def test_the_pictures_of_an_arm_are_in_si_units():
    page = page_with(ImmediateSolvers(("spectrum", "thresholds", "growth")), "tab=arm&F_max=60")
    arm = rs.Arm(length="10 cm", radius="5 mm", young="100 kPa", viscosity="12 Pa s", pressure="4 kPa")
    spectrum, growth = page.contents.spectrum, page.contents.growth
    answer, thresholds = arm.spectrum(), arm.thresholds(F_max=60)
    assert not page.contents.buttons["cycles"].visible
    labels = [axis.axis_label for axis in (*spectrum.card.figure.axis, *growth.card.figure.axis)]
    assert labels == ["growth rate (1/s)", "frequency (Hz)", "pressure (kPa)", "growth rate (1/s)"]
    assert spectrum.source.data["growth"][0] == pytest.approx(float(answer.growth_rate_si[0]))
    assert spectrum.source.data["frequency"][0] == pytest.approx(float(answer.frequency_hz[0]))
    assert len(growth.rate_source.data["F"]) > 100
    at = np.interp(3.2, growth.rate_source.data["F"], growth.rate_source.data["first"])
    softer = arm.replace(pressure="3.2 kPa").spectrum()
    assert at == pytest.approx(float(softer.growth_rate_si[0]), rel=1e-3)
    onset, hopf = (float(at) / 1e3 for at in (thresholds.pressure_onset, thresholds.pressure_hopf))
    title = f"Oscillates from {onset:.5g} kPa, flutters from {hopf:.5g} kPa (certified)"
    lines = growth.card.figure.title.text.splitlines()
    assert " ".join(lines) == title
    assert max(map(len, lines)) <= 46  # a longer line would be cut
    assert growth.threshold_source.data["frequency"][1] == pytest.approx(float(thresholds.frequency_hopf_hz))


def test_a_stopped_solve_has_a_sentence_in_place_of_its_picture():
    page = page_with(ImmediateSolvers(("spectrum", "thresholds", "growth")))
    run_callbacks(page.document, seconds=True)
    page.stop_long_solves()
    contents = page.contents
    for picture in (contents.branches, contents.diagram, contents.beating):
        assert picture.card.message.text == SOLVE_STOPPED_SENTENCE
        assert not picture.card.figure.visible
    assert page.contents.sign.text == ""


def test_pictures_without_an_answer_have_no_axes():
    """Empty axes from 0 to 1 once looked like an answer."""
    page = page_with(ImmediateSolvers(kinds=("spectrum",)))
    contents = page.contents
    for card in contents.cards:
        alphas = {getattr(axis, name) for axis in card.figure.axis for name in AXIS_OPACITY_PROPERTIES}
        assert alphas == ({1.0} if card in (contents.spectrum.card, contents.mode.card) else {0.0})


def test_the_largest_force_of_an_arm_is_given_as_a_pressure_too():
    page = page_with(ImmediateSolvers(kinds=()), "tab=arm&F_max=60")
    title = page.contents.controls.F_max.title
    pressure = float(re.fullmatch(r"Largest force F \(k3/L\^2\): ([\d.]+) kPa", title)[1])
    arm = rs.Arm(**page.state.arm).replace(pressure=f"{pressure} kPa")
    assert rs.Rod(arm=arm).parameters["F"] == pytest.approx(60.0, rel=1e-3)
    page.change(tab="rod")
    assert page.contents.controls.F_max.title == "Largest force F (k3/L^2)"


def test_a_title_of_the_thresholds_never_needs_a_new_layout():
    """Its second line was cut, and parts of it stayed, until a later answer moved the frame."""
    page = page_with(ImmediateSolvers(kinds=()))
    growth = page.contents.growth.card
    before = growth.figure.title.text
    page.contents.show("thresholds", answer_to(SolveRequest("thresholds", page.state)), page.state)
    assert before.count("\n") == growth.figure.title.text.count("\n") == 1


@pytest.mark.parametrize("viscosity, caveat", [("1 mPa s", "the model does not apply: "), ("20 Pa s", "")])
def test_the_numbers_of_an_arm_stand_below_the_validity_of_the_model(viscosity, caveat):
    arm = rs.Arm(length="14 cm", radius="4 mm", young="100 kPa", viscosity=viscosity, pressure="0.6 kPa")
    table = NumbersTable()
    table.show("spectrum", answer_variables(arm.spectrum()))
    table.show("thresholds", answer_variables(arm.thresholds()))
    assert table.root.text.startswith(f'<p class="caveat">{caveat}' if caveat else "<table>")
    assert "flutters from" in table.root.text


def test_the_flutter_threshold_of_a_relative_load_is_solved_by_a_solver_process(monkeypatch):
    """The page searched for the threshold itself, and no other page was answered meanwhile."""
    state = PageState(tab="arm").with_values(pressure="1.2 of flutter")
    flutter_kPa = rs.Arm(**state.arm).replace(pressure="1.2 of flutter").loaded.si.pressure / 1e3
    solvers = ImmediateSolvers(kinds=())
    with monkeypatch.context() as patch:
        patch.setattr(relative_load, "first_hopf_force", lambda rod: pytest.fail("solved in the page"))
        page = page_with(solvers, state=state)
        page.change({"pressure": "1.3 of flutter"})
        page.change({"pressure": "1.2 of flutter"})
    request = [request for request in solvers.requests if request.kind == "load"][-1]
    assert page.contents.sign.text.startswith("solving load, ")
    page._on_answer(request, Reply("answer", answer_to(request), 0.0))
    for picture in (page.contents.growth, page.contents.branches):
        assert picture.load_line.location == pytest.approx(flutter_kPa, rel=1e-8)
    assert page.contents.diagram.point_source.data["x"] == pytest.approx([flutter_kPa], rel=1e-8)
    solvers.requests.clear()
    page.change({"pressure": "3 kPa"})
    assert "load" not in {request.kind for request in solvers.requests}
    assert page.contents.growth.load_line.location == pytest.approx(3.0)


def test_a_config_with_a_relative_load_opens_with_this_load(tmp_path):
    """It was refused, though the control of the pressure takes such a load."""
    config = tmp_path / "c.yaml"
    arm = "length: 10 cm, radius: 5 mm, young: 100 kPa, viscosity: 12 Pa s"
    config.write_text(
        f"task: limit_cycle\nparameters: {{arm: {{{arm}, pressure: [1.1 of flutter, 1.2 of flutter]}}}}\n"
    )
    state, stored = state_and_answers_from_file(config)
    assert (state.arm["pressure"], stored) == ("1.2 of flutter", None)
    assert "1.2 of flutter" in state.yaml("limit_cycle")


def test_the_title_of_growth_rates_says_where_the_oscillation_of_an_arm_ends():
    load = PictureAxis("pressure (kPa)", 0.5)
    names = {"F_onset": 10.0, "F_hopf": np.nan, "F_restabilization": np.nan, "pressure_hopf": np.nan}
    answer = {**names, "kinds": ["onset", "real_again"], "crossing_F": np.array([10.0, 30.0]), "certified": 1}
    assert threshold_title(answer, load) == "Oscillates from 5 kPa to 15 kPa (certified)"
