"""The page of `rodsweep explore` in a real browser: what a user sees and clicks."""

import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from html import unescape

import pytest
from explore.browser import LONGEST, Browser, needs_browser
from surveyed import few, survey_only

import rodsweep as rs
from rodsweep.errors import InputError
from rodsweep.explore.page_state import PageState
from rodsweep.explore.pictures.card import STABLE_COLOUR
from rodsweep.explore.pictures.numbers_table import first_element_text

pytestmark = needs_browser
SOLVED = "Bokeh.documents[0].get_model_by_name('working').text == ''"
ROD = rs.Rod(F=50, k1=1e4, k2=100, gamma3=0.01)


@pytest.fixture(scope="module")
def url() -> Iterator[str]:
    argv = [sys.executable, "-m", "rodsweep", "explore"]
    process = subprocess.Popen(argv, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    yield re.match(r"(http://127\.0\.0\.1:\d+/) ", process.stdout.readline())[1]
    process.send_signal(signal.SIGINT)
    process.wait(LONGEST)
    process.stdout.close()


@pytest.fixture(scope="module")
def opened(url) -> Iterator[Browser]:
    with Browser() as browser:
        browser.open(f"{url}?F_max=60")  # branches up to 200 take four times the time
        yield browser


@pytest.fixture
def browser(opened) -> Browser:
    """The page with the first rod, all solved."""
    change(opened, "F_field", "50")
    change(opened, "k2_field", "100")
    solved(opened)
    return opened


def change(browser: Browser, name: str, value: object) -> None:
    """Changes a control as a user does."""
    browser.run("Bokeh.documents[0].get_model_by_name(arguments[0]).value = arguments[1]", name, value)


def solved(browser: Browser) -> None:
    """Waits until nothing is being solved: the server has heard of the last change when it answers again."""
    time.sleep(0.3)
    browser.wait_for(SOLVED)


def numbers(browser: Browser) -> dict[str, str]:
    """Texts of the table by name of the variable."""
    text = unescape(browser.model("numbers", "text"))
    return dict(re.findall(r'<tr data-name="(\w+)"><td>[^<]*</td><td>([^<]*)</td>', text))


def test_the_numbers_on_the_page_are_those_of_the_solver(browser):
    shown, spectrum, cycle, thresholds = numbers(browser), ROD.spectrum(), ROD.cycle(), ROD.thresholds()
    for answer, names in (
        (spectrum, ("growth_rate", "frequency", "unstable_count")),
        (thresholds, ("F_onset", "F_hopf", "hopf_frequency")),
    ):
        assert {n: shown[n] for n in names} == {n: first_element_text(answer.data[n].values) for n in names}
    # The start of a cycle differs between the page, which had other rods before, and a new process.
    for name in ("period", "tip_y_max", "injection_mean", "dissipation_mean"):
        assert float(shown[name]) == pytest.approx(float(cycle.data[name]), rel=1e-6)


def test_the_count_is_certified_in_the_picture(browser):
    assert browser.model("spectrum_figure", "title.text") == "2 unstable modes, certified"


VIEW = "Bokeh.index.find_one(Bokeh.documents[0].get_model_by_name('beating_figure'))"


def test_the_animation_advances_without_painting_the_figure_again(browser):
    shape = "return Array.from(Bokeh.documents[0].get_model_by_name('arm_source').data.y)"
    first = browser.run(f"window.paints = 0; {VIEW}.repainted.connect(() => window.paints++); {shape}")
    assert len(first) > 10
    browser.wait_for(f"{shape.removeprefix('return ')}[{len(first) - 1}] != {first[-1]!r}")
    assert browser.run("return window.paints") == 0
    drawn = f"{VIEW}.canvas_view.overlays.canvas.nextSibling"
    blue = f"const image = {drawn}.getContext('2d').getImageData(0, 0, {drawn}.width, {drawn}.height)"
    assert (
        browser.run(f"{blue}; return image.data.filter((byte, i) => i % 4 == 2 && byte > 150).length") > 100
    )


TIPS = """
const tip = Bokeh.documents[0].get_model_by_name("arm_source").data
const path = Bokeh.documents[0].get_model_by_name("path_source").data
window.distances = []
function measure() {
  const [px, py] = [tip.x.at(-1), tip.y.at(-1)]
  let least = Infinity
  for (let k = 1; k < path.x.length; k++) {
    const [x, y] = [path.x[k - 1], path.y[k - 1]], [dx, dy] = [path.x[k] - x, path.y[k] - y]
    const share = Math.min(1, Math.max(0, ((px - x) * dx + (py - y) * dy) / (dx * dx + dy * dy)))
    least = Math.min(least, Math.hypot(px - x - share * dx, py - y - share * dy))
  }
  window.distances.push(least)
  if (window.distances.length < 100) requestAnimationFrame(measure)
}
measure()
"""
"""CycleMeasures, for 100 frames of the animation, the distance of the tip from its drawn path."""


def test_the_tip_of_the_animated_arm_runs_along_its_drawn_path(browser):
    browser.run(TIPS)
    browser.wait_for("window.distances.length == 100")
    assert max(browser.run("return window.distances")) < 1e-3  # straight lines between shapes: 3e-3


def test_a_saved_picture_has_the_arm_that_is_animated(browser):
    browser.run(
        "Bokeh.documents[0].get_model_by_name('picture').value = 'beating';"
        "HTMLAnchorElement.prototype.click = function () { window.picture = this.href };"
        "document.querySelector('details').open = true"
    )
    button = "Bokeh.index.find_one(Bokeh.documents[0].get_model_by_name('svg_button')).el.shadowRoot"
    browser.wait_for(f"{button}.querySelector('button')")
    browser.run(f"{button}.querySelector('button').click()")
    browser.wait_for("window.picture")
    browser.run("fetch(window.picture).then((file) => file.text()).then((text) => window.drawn = text)")
    browser.wait_for("window.drawn")
    assert STABLE_COLOUR in browser.run("return window.drawn")


def test_all_of_an_answer_comes_in_one_message(browser):
    browser.run(
        "const page = Bokeh.documents[0], apply = page.apply_json_patch.bind(page); window.patches = [];"
        "page.apply_json_patch = (patch, ...rest) => {"
        "  window.patches.push(patch.events.map((event) => page.get_model_by_id(event.model?.id)?.name));"
        "  apply(patch, ...rest) }"
    )
    change(browser, "F_field", "41")
    solved(browser)
    [answer] = [names for names in browser.run("return window.patches") if "spectrum_source" in names]
    assert {"spectrum_source", "mode_source", "numbers", "working"} <= set(answer)


def test_a_click_in_the_diagram_moves_the_point_and_everything_follows(browser):
    browser.wait_for("Bokeh.documents[0].get_model_by_name('cell_source').data.left.length > 0")
    browser.click("diagram_figure", 55.0, 300.0)
    browser.wait_for("Bokeh.documents[0].get_model_by_name('F_field').value != '50'")
    solved(browser)
    F, k2 = (float(browser.model(f"{name}_field", "value")) for name in ("F", "k2"))
    assert (F, k2) == (pytest.approx(55, abs=1), pytest.approx(300, rel=0.1))
    answer = rs.Rod(F=F, k1=1e4, k2=k2, gamma3=0.01).spectrum()
    assert numbers(browser)["growth_rate"] == first_element_text(answer.growth_rate)
    browser.wait_for(f"location.search.startsWith('?tab=rod&F={F:g}&')")  # written when the page has rested


def test_a_click_on_the_thresholds_moves_the_load(browser):
    browser.click("growth_figure", 45.0, 100.0)
    browser.wait_for("Bokeh.documents[0].get_model_by_name('F_field').value != '50'")
    assert float(browser.model("F_field", "value")) == pytest.approx(45, abs=1)


def mode(browser: Browser) -> str:
    """What the arm on the page does: beats, is bent, moves, has reached its cycle, or rests."""
    return browser.model("arm_source", "tags")[0]


@survey_only
def test_an_arm_that_is_dragged_by_its_tip_and_let_go_moves_into_its_cycle(browser):
    assert mode(browser) == "beats"
    browser.drag("beating_figure", [(0.9, 0.1), (0.8, 0.3), (0.7, 0.4), (0.6, 0.45)])
    browser.wait_for("Bokeh.documents[0].get_model_by_name('motion_source').data.x.length > 0")
    title = browser.model("beating_figure", "title.text")
    x, y = map(float, re.fullmatch(r"Let go at \((.*), (.*)\) L: it beats", title).groups())
    assert (x, y) == (pytest.approx(0.6, abs=0.02), pytest.approx(0.45, abs=0.02))
    browser.wait_for("Bokeh.documents[0].get_model_by_name('arm_source').tags[0] == 'reached'")
    change(browser, "F_field", "20")
    solved(browser)
    assert mode(browser) == "beats"  # a single shape, the straight arm
    browser.drag("beating_figure", [(0.9, 0.05), (0.9, 0.2)])
    browser.wait_for("Bokeh.documents[0].get_model_by_name('arm_source').tags[0] == 'rests'")
    tip = browser.run("return Array.from(Bokeh.documents[0].get_model_by_name('arm_source').data.y).at(-1)")
    assert abs(tip) < 0.01


@survey_only
def test_the_film_is_saved_as_a_gif(browser):
    browser.run(
        "HTMLAnchorElement.prototype.click = function () { window.film = [this.download, this.href] }"
    )
    browser.run(
        "Bokeh.index.find_one(Bokeh.documents[0].get_model_by_name('film_button')).el.shadowRoot"
        ".querySelector('button').click()"
    )
    browser.wait_for("window.film")
    browser.run("fetch(window.film[1]).then((file) => file.text()).then((text) => window.text = text)")
    browser.wait_for("window.text")
    assert browser.run("return [window.film[0], window.text.slice(0, 6)]") == ["explore.gif", "GIF89a"]


@pytest.mark.parametrize(
    ("name", "value"),
    few(
        [
            ("F", "abc"), ("F", ""), ("k1", "40"), ("k2", "<b>x</b>"),
            ("taper", "1e9"), ("F", "1e5"), ("F", "nan"), ("k1", "-1"), ("k1", "0"), ("k2", "1,5"),
            ("k2", "1e400"), ("gamma3", "-0.1"), ("gamma3", "inf"), ("gamma1", "0"), ("taper", "0"),
        ],
        2,
    ),
)  # fmt: skip
def test_a_bad_value_has_its_sentence_in_place_of_the_picture_until_it_is_mended(browser, name, value):
    before = browser.model(f"{name}_field", "value")
    change(browser, f"{name}_field", value)
    browser.wait_for("Bokeh.documents[0].get_model_by_name('spectrum_message').visible")
    with pytest.raises(InputError) as refusal:
        PageState().with_values(**{name: value}).rod_or_arm()
    assert unescape(browser.model("spectrum_message", "text")) == str(refusal.value)
    assert "<b>" not in browser.model("spectrum_message", "text")
    assert not browser.model("spectrum_figure", "visible")
    change(browser, f"{name}_field", before)
    browser.wait_for("Bokeh.documents[0].get_model_by_name('spectrum_figure').visible")
    assert not browser.model("spectrum_message", "visible")


def test_a_slider_that_never_rests_ends_at_its_last_value(browser):
    for step in range(20):
        change(browser, "F_slider", 40.0 + step)
    solved(browser)
    F = float(browser.model("F_field", "value"))
    assert pytest.approx(59.0) == F
    assert numbers(browser)["growth_rate"] == first_element_text(ROD.replace(F=F).spectrum().growth_rate)


def test_numbers_and_pictures_of_an_earlier_state_fade_until_they_are_solved(browser):
    opacity = "getComputedStyle(document.querySelector('{}')).opacity"
    slow = [opacity.format(each) for each in ("tbody.thresholds", "div.thresholds")]
    quick = [opacity.format(each) for each in ("tbody.spectrum", "div.spectrum")]
    change(browser, "F_max", "1e9")  # thresholds up to this force take minutes
    for each in slow:
        browser.wait_for(f"{each} < 1")
    assert [browser.run(f"return {each}") for each in quick] == ["1", "1"]
    change(browser, "F_max", "60")
    solved(browser)
    assert [browser.run(f"return {each}") for each in slow] == ["1", "1"]


def test_the_arrow_of_a_menu_is_seen_on_light_and_on_dark_pages(browser):
    menu = "Bokeh.index.find_one(Bokeh.documents[0].get_model_by_name('across')).el.shadowRoot"
    arrow = browser.run(f"return getComputedStyle({menu}.querySelector('select')).backgroundImage")
    assert re.findall(r'fill=\W*"(\w+)', arrow) == ["gray"]


def test_no_window_has_to_be_scrolled_sideways(browser):
    for width in (320, 500, 800, 1280):
        browser.resize(width, 1300)
        browser.wait_for(f"innerWidth == {width} && Bokeh.documents[0].is_idle")
        browser.wait_for("document.documentElement.scrollWidth <= document.documentElement.clientWidth")


def test_nothing_is_on_the_console(browser):
    assert browser.complaints() == []


def choose_file(browser: Browser, text: str) -> None:
    """Chooses a file with a text as the config to load, as a user does."""
    browser.run("document.querySelector('details').open = true")
    field = f"{LOAD}?.el.shadowRoot.querySelector('input[type=file]')"
    browser.wait_for(field)
    browser.run(
        "const files = new DataTransfer(); files.items.add(new File([arguments[0]], 'rod.yaml'));"
        f"const field = {field}; field.files = files.files; field.dispatchEvent(new Event('change'))",
        text,
    )


LOAD = "Bokeh.index.find_one(Bokeh.documents[0].get_model_by_name('load'))"


def test_the_same_file_can_be_loaded_twice(browser):
    for _ in range(2):
        choose_file(browser, ROD_43)
        browser.wait_for("Bokeh.documents[0].get_model_by_name('F_field').value == '43'")
        assert browser.model("F_max", "value") == "60"
        change(browser, "F_field", "50")
        solved(browser)
    change(browser, "k1_field", "1e4")


ROD_43 = "task: limit_cycle\nparameters: {F: 43, k1: 1.0e4, k2: 100, gamma3: 0.01}\n"


@survey_only
def test_a_page_that_was_left_ends_its_solves_and_the_way_back_leads_to_a_page_that_solves(url):
    with Browser() as other:
        other.open(f"{url}?F_max=1e9&F=47")  # thresholds up to this force take minutes
        other.wait_for("location.search.includes('F=47')")
        other.open(f"{url}?F_max=30&F=46")
        other.wait_for("Bokeh.documents[0].get_model_by_name('numbers').text.includes('F_hopf')")
        solved(other)
        other._call("POST", "/back", {})
        other.wait_for("Bokeh.documents?.[0]?.get_model_by_name('F_field')?.value == '47'")
        change(other, "F_max", "60")
        change(other, "F_field", "48")
        other.wait_for(f"Bokeh.documents[0].is_idle && {SOLVED}")
        assert numbers(other)["growth_rate"] == first_element_text(ROD.replace(F=48).spectrum().growth_rate)
        assert other.complaints() == []


@pytest.mark.long
def test_an_address_opens_the_same_page_and_an_arm_has_si_units(url, opened):
    opened.open(f"{url}?tab=arm&length=12+cm&pressure=5+kPa&F_max=60")
    opened.wait_for("Bokeh.documents[0].get_model_by_name('numbers').text.match('period_si.*pressure_hopf')")
    arm = rs.Arm(length="12 cm", radius="5 mm", young="100 kPa", viscosity="12 Pa s", pressure="5 kPa")
    shown = numbers(opened)
    assert opened.model("length_field", "value") == "12 cm"
    assert float(shown["pressure_hopf"]) == pytest.approx(arm.thresholds().pressure_hopf / 1e3, rel=1e-7)
    assert float(shown["period_si"]) == pytest.approx(arm.cycle().period_si, rel=1e-6)
    assert float(shown["tip_y_max_si"]) == pytest.approx(arm.cycle().tip_y_max_si * 100, rel=1e-6)
    assert opened.complaints() == []
