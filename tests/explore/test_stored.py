"""The page of a result file: its cycles, branches and curves are drawn, and only the rest is solved."""

from typing import NamedTuple

import numpy as np
import pytest
import xarray as xr
from explore.test_page import ImmediateSolvers, page_with, run_callbacks, shown
from surveyed import few

import rodsweep as rs
from rodsweep.explore.answers_from_file import AnswersFromFile
from rodsweep.explore.page import Page
from rodsweep.explore.page_state_from_file import state_and_answers_from_file, stored_diagram
from rodsweep.explore.pictures.card import TORUS_COLOUR
from rodsweep.explore.pictures.numbers_table import first_element_text
from rodsweep.explore.solving.requests import answer_to
from rodsweep.results.layouts.branch import SPECIAL_KINDS

ROD = "k1: 1.0e4, k2: 100, gamma3: 0.01"
CYCLES = f"task: limit_cycle\nparameters: {{F: [20, 40, 50], {ROD}}}\nlimit_cycle: {{shapes: 16}}\n"
BRANCH = f"task: branch\nparameters: {{{ROD}}}\nbranch: {{stop: 50}}\n"
PLANE = """task: phase_diagram
parameters: {F: {start: 60, stop: 110, num: 6}, k1: [150, 151], k2: 1.0e4, gamma3: 1.0e-4}
phase_diagram: {cycles: true, certify: false, cycle_accuracy: 1.0e-4}
"""


class NoSolvers(ImmediateSolvers):
    """Answers nothing, and keeps what was asked."""

    def __init__(self) -> None:
        super().__init__(())


class Filmed(NamedTuple):
    """Stands for a film; image: the cycle that it shows."""

    image: xr.Dataset


def opened_page(command, text: str, query: str = "") -> tuple[Page, NoSolvers]:
    """The page of the result of a config, after it has rested."""
    command.write("result.yaml", text)
    state, stored = state_and_answers_from_file(command.solved("result.yaml"))
    solvers = NoSolvers()
    page = page_with(solvers, query, state, stored)
    run_callbacks(page.document, seconds=True)
    return page, solvers


def asked(solvers: NoSolvers) -> set[str]:
    return {request.kind for request in solvers.requests}


@pytest.mark.long
def test_stored_cycles_are_drawn_and_not_solved_again(command):
    page, solvers = opened_page(command, CYCLES)
    data = rs.open(command.directory / "result.h5").squeeze()
    assert page.state.rod["F"] == "40"
    assert not {"cycle", "branch"} & asked(solvers)
    assert shown(page)["period"] == first_element_text(data["period"].sel(F=40).values)
    picture = page.contents.beating.shapes_source.data
    assert picture["y"] == pytest.approx(data["shape_y"].sel(F=40).values.ravel(), abs=1e-7)
    drawn = page.contents.branches.cycle_source.data
    assert drawn["F"] == pytest.approx([20, 40, 50])
    assert drawn["y"] == pytest.approx([0, *data["tip_y_max"].sel(F=[40, 50]).values])


def test_the_film_of_a_stored_cycle_is_drawn_from_its_stored_shapes(command, monkeypatch):
    page, solvers = opened_page(command, CYCLES)
    page.solve("film")
    request = solvers.requests[-1]
    stored = rs.open(command.directory / "result.h5").sel(F=[40])
    assert (request.kind, request.stored_cycle["shape_y"].equals(stored["shape_y"])) == ("film", True)
    monkeypatch.setattr("rodsweep.explore.solving.requests.plot", lambda cycle, what: Filmed(cycle))
    monkeypatch.setattr(rs.Rod, "cycle", None)  # no solve is needed
    assert answer_to(request)["gif"] is request.stored_cycle


@pytest.mark.parametrize(("shapes", "query"), few([(16, "F=41"), (16, "F=20"), (7, "")], 1))
def test_a_film_that_the_file_does_not_hold_is_solved(command, shapes, query):
    page, solvers = opened_page(command, CYCLES.replace("16", str(shapes)), query)
    page.solve("film")
    assert solvers.requests[-1].stored_cycle is None


def test_a_click_beside_a_stored_force_shows_its_cycle(command):
    page, solvers = opened_page(command, CYCLES)
    page._select_load(type("Click", (), {"x": 51.3}))
    assert page.state.rod["F"] == "50"
    assert "cycle" not in asked(solvers)


def test_a_stored_rod_at_rest_is_drawn_straight(command):
    page, solvers = opened_page(command, CYCLES, "F=20")
    assert "cycle" not in asked(solvers)
    assert page.contents.beating.card.message.text.startswith("the rod returns to the straight state")
    assert page.contents.beating.shapes_source.data["x"][-1] == pytest.approx(1 - 20 / 1e4)


@pytest.mark.parametrize("query", few(["F=41", "law=fixed", "k2=110", "gamma1=2", "taper=0.9"], 1))
def test_what_the_file_does_not_hold_is_solved(command, query):
    _, solvers = opened_page(command, CYCLES, query)
    assert "cycle" in asked(solvers)


def test_cycles_without_stored_shapes_are_solved_for_the_picture(command):
    _, solvers = opened_page(command, CYCLES.replace("{shapes: 16}", "{samples: 0}"))
    assert "cycle" in asked(solvers)


@pytest.mark.long
def test_stored_branches_are_drawn_and_solved_again_by_their_button_only(command):
    page, solvers = opened_page(command, BRANCH)
    data = rs.open(command.directory / "result.h5").squeeze()
    assert "branch" not in asked(solvers)
    pieces = page.contents.branches.branch_source.data
    of_cycles = max(pieces["y"], key=np.max)
    assert np.max(of_cycles) == pytest.approx(np.nanmax(data["tip_y_max"].values))
    assert pieces["dash"].count("dashed") == 1
    assert page.contents.branches.card.figure.title.text == "stored in result.h5"
    page.solve("branch")
    assert "branch" in asked(solvers)


@pytest.mark.long
def test_stored_curves_of_folds_are_drawn_in_the_diagram(command):
    page, solvers = opened_page(command, PLANE)
    data = rs.open(command.directory / "result.h5")
    assert not {"diagram", "cycles"} & asked(solvers)
    curves = page.contents.diagram.cycle_curve_source.data
    assert np.concatenate(curves["x"]) == pytest.approx(data["cycle_curve_F"].values)
    assert np.concatenate(curves["y"]) == pytest.approx(data["cycle_curve_k1"].values)
    assert set(curves["dash"]) == {"solid"}
    assert page.contents.diagram.legend.visible


def test_stored_curves_of_torus_points_are_drawn_dashed_in_a_colour_of_their_own(command):
    """On the smallest plane with folds, whose curves become torus points: real ones take 5 s."""
    command.write("result.yaml", PLANE)
    path = command.solved("result.yaml")
    state, _ = state_and_answers_from_file(path)
    data = rs.open(path).load()
    kind = data["cycle_curve_kind"]
    kind.values[:] = SPECIAL_KINDS.index("torus")
    page = page_with(
        NoSolvers(), state=state, stored=AnswersFromFile(path, data, state, stored_diagram(data, state))
    )
    curves = page.contents.diagram.cycle_curve_source.data
    assert list(zip(curves["colour"], curves["dash"], strict=True)) == [(TORUS_COLOUR, "dashed")]
    assert curves["x"][0] == pytest.approx(data["cycle_curve_F"].values)
    words = [item.label.value for item in page.contents.diagram.legend.items]
    assert (page.contents.diagram.legend.visible, words) == (True, ["folds of cycles", "torus points"])


def test_curves_of_folds_are_solved_by_their_button_only():
    solvers = NoSolvers()
    page = page_with(solvers)
    run_callbacks(page.document, seconds=True)
    assert "cycles" not in asked(solvers)
    page.solve("cycles")
    assert "cycles" in asked(solvers)
    assert "folds and torus points" in page.contents.sign.text


OF_ARM = "length: [8 cm, 10 cm], radius: 5 mm, young: 100 kPa, viscosity: 12 Pa s"
CYCLES_OF_ARMS = f"""task: limit_cycle
parameters: {{arm: {{{OF_ARM}, pressure: [1 kPa, 4.00004 kPa, 5 kPa]}}}}
limit_cycle: {{shapes: 16}}
"""
THRESHOLDS_OF_ARMS = f"task: thresholds\nparameters: {{arm: {{{OF_ARM}, law: neo_hookean}}}}\n"
BRANCH_OF_ARM = f"task: branch\nparameters: {{arm: {{{OF_ARM.replace('[8 cm, 10 cm]', '10 cm')}}}}}\n"
BRANCH_OF_ARM += "branch: {start: 30, stop: 40}\naccuracy: 1.0e-4\n"


@pytest.mark.long
def test_stored_cycles_of_arms_are_drawn_and_not_solved_again(command):
    page, solvers = opened_page(command, CYCLES_OF_ARMS)
    arms = rs.open(command.directory / "result.h5").sel(length=0.1)
    data = arms.isel(pressure=1)
    assert (page.state.tab, page.state.arm["pressure"]) == ("arm", "4 kPa")  # the control has five digits
    assert not {"cycle", "branch"} & asked(solvers)
    assert float(shown(page)["period_si"]) == pytest.approx(float(data["period_si"]), rel=1e-7)
    picture = page.contents.beating.shapes_source.data
    assert picture["y"] == pytest.approx(10 * data["shape_y"].values.ravel(), abs=1e-6)
    drawn = page.contents.branches.cycle_source.data
    assert drawn["F"] == pytest.approx([1, 4.00004, 5])
    assert drawn["y"] == pytest.approx([0, *10 * arms["tip_y_max"].values[1:]])
    loads = page.contents.branches.card.figure.x_range
    assert (loads.start < 1, loads.end > 5) == (True, True)  # no dot is cut at an edge
    page._select_load(type("Click", (), {"x": 4.9}))
    assert page.state.arm["pressure"] == "5 kPa"
    page.change({"length": "8 cm"})
    assert not {"cycle", "branch"} & asked(solvers)
    page.change({"pressure": "4.0003 kPa"})
    assert "cycle" in asked(solvers)


def test_stored_thresholds_of_arms_are_the_diagram(command):
    page, solvers = opened_page(command, THRESHOLDS_OF_ARMS)
    data = rs.open(command.directory / "result.h5")
    assert (page.state.law, page.state.second_parameter) == ("fixed", "length")
    assert "diagram" not in asked(solvers)
    drawn = page.contents.diagram.crossing_source.data
    stored = data["crossing_pressure"].values / 1e3
    assert np.sort(drawn["x"]) == pytest.approx(np.sort(stored[stored < 8]))
    assert set(drawn["y"]) == {8, 10}


def test_a_diagram_without_a_force_axis_is_solved_over_the_force(command):
    axes = "{k1: {start: 20, stop: 300, num: 6}, k2: [10, 100], F: 30, gamma3: 0}"
    page, solvers = opened_page(command, f"task: phase_diagram\nparameters: {axes}\n")
    assert (page.state.rod["F"], page.state.second_parameter) == ("30", "k1")
    assert {"diagram", "branch"} <= asked(solvers)


@pytest.mark.long
def test_a_stored_branch_of_an_arm_is_drawn(command):
    page, solvers = opened_page(command, BRANCH_OF_ARM)
    data = rs.open(command.directory / "result.h5").squeeze()
    assert "branch" not in asked(solvers)
    ys = np.concatenate(page.contents.branches.branch_source.data["y"])
    assert np.max(ys) == pytest.approx(100 * np.nanmax(data["tip_y_max_si"].values))
