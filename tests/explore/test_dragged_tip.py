"""A drag of the arm's tip on the page, without a browser: the bent arm, and the motion after it is let go."""

from dataclasses import fields
from io import BytesIO

import numpy as np
import pytest
from explore.test_page import ImmediateSolvers, page_with, run_callbacks
from PIL import Image

import rodsweep as rs
from rodsweep.explore.page import Page
from rodsweep.explore.page_state import PageState
from rodsweep.explore.pictures.card import BLANK_TITLE_LINE
from rodsweep.explore.pictures.moving_arm import SCREEN_SECONDS_PER_PERIOD
from rodsweep.explore.solving.dragged_tip import motion_in_page_units
from rodsweep.explore.solving.request_inputs import REQUEST_KINDS_AFTER_EVERY_CHANGE
from rodsweep.explore.solving.requests import SHAPE_COUNT, Reply, SolveRequest, answer_to
from rodsweep.post.figures.cycle.animation import motion_film
from rodsweep.post.figures.cycle.tip_path import SEGMENTS_BETWEEN_SHAPES, smooth_tip_path
from rodsweep.tasks.released_motion import ReleasedMotion

KINDS = (*REQUEST_KINDS_AFTER_EVERY_CHANGE, "bent", "motion", "film")


def drag(page: Page, phase: str, x: float, y: float) -> None:
    """What the browser tells of a drag, in the picture's unit of length."""
    page.contents.beating.grip_source.data = {"x": [x], "y": [y], "phase": [phase]}
    run_callbacks(page.document)


def ends(source) -> np.ndarray:
    """Tips of the shapes of a source, (shapes, 2)."""
    nodes = int(source.data["number"][0])
    return np.stack([np.reshape(source.data[name], (-1, nodes))[:, -1] for name in "xy"], axis=1)


def test_the_tip_follows_the_drag():
    page = page_with(ImmediateSolvers(KINDS))
    drag(page, "bent", 0.6, 0.5)
    bent = page.contents.beating.bent_source.data
    assert (bent["x"][-1], bent["y"][-1]) == pytest.approx((0.6, 0.5), abs=1e-6)


def test_a_fluttering_arm_that_is_let_go_moves_from_there_into_its_cycle():
    page = page_with(ImmediateSolvers(KINDS))
    drag(page, "let go", 0.6, 0.5)
    picture = page.contents.beating
    assert ends(picture.motion_source)[0] == pytest.approx((0.6, 0.5), abs=1e-6)
    cycle = rs.Rod(F=50, k1=1e4, k2=100, gamma3=0.01).cycle(shapes=48)
    assert ends(picture.reached_source)[:, 1] == pytest.approx(cycle.data["shape_y"].values[:, -1], abs=1e-5)
    assert picture.card.figure.title.text == "Let go at (0.6, 0.5) L: it beats"
    per_shape, period = picture.motion_source.tags
    assert period == SCREEN_SECONDS_PER_PERIOD
    # Returns of a motion that is not settled yet differ from the period by some percent.
    assert per_shape == pytest.approx(SCREEN_SECONDS_PER_PERIOD / 32, rel=0.1)


def test_the_drawn_path_of_the_tip_is_smooth_and_leads_through_the_shapes():
    page = page_with(ImmediateSolvers(KINDS))
    picture = page.contents.beating
    for each in (picture.shapes_source, picture.motion_source):
        path = np.stack([picture.path_source.data[name] for name in "xy"], axis=1)
        assert path[::SEGMENTS_BETWEEN_SHAPES][: len(ends(each))] == pytest.approx(ends(each), abs=1e-6)
        steps = np.diff(path, axis=0)
        turns = np.angle(np.exp(1j * np.diff(np.arctan2(steps[:, 1], steps[:, 0]))))
        assert np.degrees(np.abs(turns).max()) < 12  # 44 degrees in a path of straight lines between shapes
        drag(page, "let go", 0.6, 0.5)


def test_an_arm_below_flutter_that_is_let_go_comes_to_rest():
    page = page_with(ImmediateSolvers(KINDS), "F=20")
    drag(page, "let go", 0.6, -0.5)
    picture = page.contents.beating
    assert picture.card.figure.title.text == "Let go at (0.6, -0.5) L: it comes to rest"
    assert len(picture.reached_source.data["x"]) == 0
    tips = ends(picture.motion_source)
    assert tips[0] == pytest.approx((0.6, -0.5), abs=1e-6)
    assert abs(tips[-1, 1]) < 0.01


def test_a_drag_in_the_picture_of_an_arm_is_in_centimetres():
    page = page_with(ImmediateSolvers(KINDS), "tab=arm&length=12+cm")
    drag(page, "let go", 6.0, 5.0)
    picture = page.contents.beating
    assert ends(picture.motion_source)[0] == pytest.approx((6, 5), abs=1e-5)
    assert picture.card.figure.title.text.startswith("Let go at (6, 5) cm: ")


def test_a_change_of_the_rod_forgets_the_motion():
    page = page_with(ImmediateSolvers(KINDS))
    drag(page, "let go", 0.6, 0.5)
    page.change({"F": "60"})
    run_callbacks(page.document)
    picture = page.contents.beating
    assert (len(picture.motion_source.data["x"]), len(picture.bent_source.data["x"])) == (0, 0)
    assert picture.card.figure.title.text == BLANK_TITLE_LINE


def test_an_answer_to_another_place_of_the_tip_is_not_shown():
    kept = []
    solvers = ImmediateSolvers()
    page = page_with(solvers)
    solvers.ask = lambda session, request, done, progress: kept.append((request, done))
    drag(page, "let go", 0.6, 0.5)
    drag(page, "let go", 0.5, -0.5)
    request, done = kept[0]
    done(Reply("answer", answer_to(request), 0.0))
    run_callbacks(page.document)
    assert len(page.contents.beating.motion_source.data["x"]) == 0
    assert page.contents.sign.text == "solving motion ..."


@pytest.mark.parametrize("place", [(40.0, -3.0), (0.0, 0.0), (-1.0, 0.0)])
def test_every_place_of_the_pointer_bends_the_arm(place):
    found = answer_to(SolveRequest("bent", PageState(), place))
    assert np.isfinite([found["x"], found["y"]]).all()


@pytest.mark.long
def test_the_film_shows_the_shapes_of_a_period():
    page = page_with(ImmediateSolvers(("film",)))
    given = []
    page.contents.sharing.save_film = given.append
    page.solve("film")
    run_callbacks(page.document)
    assert len(given) == 1
    film = Image.open(BytesIO(given[0]))
    assert (film.format, film.n_frames) == ("GIF", SHAPE_COUNT)


def test_the_film_of_an_arm_that_was_let_go_is_that_of_its_motion():
    solvers = ImmediateSolvers(("cycle",))
    page = page_with(solvers, "tab=arm")
    film = page._callbacks()["film"]
    film()
    assert solvers.requests[-1].tip is None
    drag(page, "let go", 6.0, 5.0)
    film()
    assert (solvers.requests[-1].kind, solvers.requests[-1].tip) == ("film", pytest.approx((0.6, 0.5)))
    page.change({"pressure": "1.1 kPa"})
    film()
    assert solvers.requests[-1].tip is None  # the motion was that of another arm


def test_the_film_of_a_motion_is_in_the_units_of_the_page():
    x, y = np.array([[0.0, 1.0], [0.0, 0.9]]), np.array([[0.0, 0.1], [0.0, 0.2]])
    found = dict.fromkeys(field.name for field in fields(ReleasedMotion)) | {"x": x, "y": y}
    assert found.keys() >= {"shape_interval"}
    found["shape_interval"] = 0.5
    state = PageState(tab="arm")
    motion = motion_in_page_units(state, found)
    assert (motion.length, motion.units) == (pytest.approx(10), ("cm", "s"))
    assert motion.shape_interval == pytest.approx(0.5 * state.rod_or_arm().tau2)
    assert motion.y[:, -1] == pytest.approx([1, 2])
    film = Image.open(BytesIO(motion_film(motion)))
    assert (film.format, film.n_frames) == ("GIF", 2)


@pytest.mark.parametrize("is_closed", [True, False])
def test_the_path_between_shapes_is_that_of_a_smooth_motion(is_closed):
    turns = 1.0 if is_closed else 0.6
    phase = 2 * np.pi * np.linspace(0, turns, 33)
    places = np.stack([np.cos(phase), np.sin(2 * phase)], axis=1)
    path = smooth_tip_path(places[: 32 if is_closed else 33], is_closed)
    fine = 2 * np.pi * np.linspace(0, turns, len(path))
    # Central differences of sin(2 phase) have the error h^2/6 (2 w)^3, of which a cubic has a quarter of h.
    assert path == pytest.approx(np.stack([np.cos(fine), np.sin(2 * fine)], axis=1), abs=4e-3)
    assert len(path) == 32 * SEGMENTS_BETWEEN_SHAPES + 1


def test_two_shapes_have_a_straight_path():
    places = np.array([[0.0, 0.0], [1.0, 2.0]])
    assert smooth_tip_path(places, is_closed=False).tolist() == places.tolist()


def test_a_rod_without_a_cycle_has_no_film():
    page = page_with(ImmediateSolvers(KINDS), "F=20")
    page.solve("film")
    run_callbacks(page.document)
    assert "no cycle to film" in page.contents.beating.card.message.text
    assert page.contents.sign.text == ""
