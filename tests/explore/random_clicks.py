"""Uses the page at random, in a headless browser: clicks, drags, sliders, fields, menus, buttons, way back.

`python tests/explore/random_clicks.py [SECONDS [SEED]]` prints the numbers of a run, and exits with 1 if the
console has an error, the memory of the server or of the page grows, or the page disagrees with the solver.
"""

import os
import re
import signal
import statistics
import subprocess
import sys
import time
from collections import Counter, deque
from html import unescape
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))
from explore.browser import Browser

from rodsweep.errors import UserError
from rodsweep.explore.page_state import MATERIAL_SECTION_BY_LAW, SECOND_PARAMETERS, TAB_DEFAULTS, PageState
from rodsweep.explore.slider_scales import SLIDER_SCALES

SECONDS = 600.0
SEED = 35
COMPARED_EVERY = 10
"""Number of actions between two comparisons with the solver."""
TOLERANCE = 1e-6
"""Largest relative difference between a number on the page, of 8 digits, and the number of the solver."""
SMALLEST = 1e-3
"""Numbers below this are compared absolutely."""
LARGEST_GROWTH = 1.1
"""Memory is flat if its median in the last third of a run is at most this times that in the second third."""
LONGEST_SOLVE = 60.0
"""Seconds after which a comparison leaves out the thresholds, because they are still being solved."""
RANGES = {
    "F": (-10, 100), "k1": (150, 1e6), "k2": (20, 1e5), "gamma3": (1e-4, 0.3), "gamma1": (0.3, 3),
    "taper": (0.7, 1.4), "length": (6, 16), "radius": (3, 6), "young": (50, 300), "viscosity": (1, 50),
    "pressure": (0, 8),
}  # fmt: skip
"""(lowest, highest) value of each control, in its unit."""
BAD_VALUES = ("abc", "", "-1", "nan", "1e400", "inf", "<b>x</b>", "0", "1,5", "10 furlongs")
BUTTONS = ("diagram", "branches", "cycles", "film", "stop", "save", "copy_yaml", "png", "svg")
FIGURES = ("diagram", "growth", "branches", "beating", "spectrum", "mode")
COLUMN_WIDTHS = (1280, 800, 500, 320)
ACTIONS = {
    "click": 4, "drag": 2, "slide": 4, "fill": 3, "fill_badly": 1.5, "choose": 1, "change_tab": 0.5,
    "let_go": 2, "press": 2.5, "go_back": 0.7, "resize": 0.5,
}  # fmt: skip
"""Relative frequency of each action, a method of `RandomUser`."""
MODEL = "Bokeh.documents[0].get_model_by_name"
PRESS = f"""
document.querySelector("details").open = true
HTMLAnchorElement.prototype.click = () => {{}}
const view = Bokeh.index.find_one({MODEL}(arguments[0] + "_button"))
view?.el.shadowRoot.querySelector("button")?.click()
"""
STATE = f"""
const value = (name) => {MODEL}(name).value, refusal = {MODEL}("spectrum_message")
const names = arguments[0][{MODEL}("tabs").active]
return {{values: Object.fromEntries(names.map((name) => [name, value(name + "_field")])), law: value("law"),
  across: value("across"), F_max: value("F_max"), kinds: {MODEL}("working").kinds,
  numbers: {MODEL}("numbers").text, refusal: refusal.visible ? refusal.text : ""}}
"""


COMPARED = (
    "growth_rate",
    "growth_rate_si",
    "frequency",
    "unstable_count",
    "F_onset",
    "F_hopf",
    "pressure_hopf",
)
"""Numbers of the page that are compared."""


class RandomUser:
    """A user who tries everything. counts: number of each action. log: the last actions."""

    def __init__(self, browser: Browser, url: str, seed: int):
        self.browser = browser
        self.url = url
        self.random = np.random.default_rng(seed)
        self.counts: Counter[str] = Counter()
        self.log: deque[str] = deque(maxlen=2 * COMPARED_EVERY)

    def act(self) -> None:
        """One random action, and a pause."""
        shares = np.array(list(ACTIONS.values()), dtype=float)
        action = str(self.random.choice(list(ACTIONS), p=shares / shares.sum()))
        self.counts[action] += 1
        self.log.append(f"{action} {getattr(self, action)()}")
        time.sleep(float(self.random.choice([0.05, 0.3, 1.5])))

    def one_of(self, names: Any) -> str:
        """A random element."""
        return str(self.random.choice(list(names)))

    def tab(self) -> str:
        """The visible tab."""
        return list(TAB_DEFAULTS)[self.browser.model("tabs", "active")]

    def set(self, name: str, value: object) -> str:
        """Changes a control as a user does."""
        self.browser.run(f"{MODEL}(arguments[0]).value = arguments[1]", name, value)
        return f"{name} = {value}"

    def drag_in(self, figure: str, count: int) -> str:
        """A drag through random places in a figure, if the figure is visible."""
        places = (0.03 + 0.94 * self.random.random((count, 2))).tolist()
        if not self.browser.model(f"{figure}_figure", "visible"):
            return f"{figure} is hidden"
        self.browser.drag_at_shares(f"{figure}_figure", places)
        return f"{figure} {places}"

    def click(self) -> str:
        """A click into a figure."""
        return self.drag_in(self.one_of(FIGURES), 1)

    def drag(self) -> str:
        """A drag through a figure."""
        return self.drag_in(self.one_of(FIGURES), 4)

    def let_go(self) -> str:
        """A drag of the tip."""
        return self.drag_in("beating", 5)

    def value(self, name: str) -> float:
        """A random value of a control, in its unit."""
        low, high = RANGES[name]
        share = self.random.random()
        logarithmic = SLIDER_SCALES[self.tab()][name].is_logarithmic
        return float(low * (high / low) ** share if logarithmic else low + share * (high - low))

    def slide(self) -> str:
        """A slider that is moved in five steps."""
        scales = SLIDER_SCALES[self.tab()]
        name = self.one_of(scales)
        ends = [scales[name].position(scales[name].text(self.value(name))) for _ in range(2)]
        for at in np.linspace(*ends, 5):
            self.set(f"{name}_slider", float(at))
            time.sleep(0.03)
        return f"{name} to {ends[-1]}"

    def fill(self) -> str:
        """A value in a field."""
        name = self.one_of([*SLIDER_SCALES[self.tab()], "F_max"])
        if name == "F_max":
            return self.set(name, f"{self.random.uniform(20, 120):.3g}")
        return self.set(f"{name}_field", SLIDER_SCALES[self.tab()][name].text(self.value(name)))

    def fill_badly(self) -> str:
        """A bad value in a field; the value before is written back after a moment, mostly."""
        name = self.one_of([f"{each}_field" for each in SLIDER_SCALES[self.tab()]] + ["F_max"])
        before = self.browser.model(name, "value")
        told = self.set(name, self.one_of(BAD_VALUES))
        time.sleep(0.3)
        if self.random.random() < 0.8:
            self.set(name, before)
        return told

    def choose(self) -> str:
        """A menu."""
        name, choices = (("law", MATERIAL_SECTION_BY_LAW), ("across", SECOND_PARAMETERS[self.tab()]))[
            self.random.integers(2)
        ]
        return self.set(name, self.one_of(choices))

    def change_tab(self) -> str:
        """The other tab."""
        self.browser.run(f"{MODEL}('tabs').active = 1 - {MODEL}('tabs').active")
        return ""

    def press(self) -> str:
        """A button; the folds take a minute, and are mostly stopped by what follows."""
        name = self.one_of(BUTTONS)
        self.browser.run(PRESS, name)
        return name

    def go_back(self) -> str:
        """Another address, and the way back."""
        self.browser.open(f"{self.url}?F={self.random.uniform(0, 60):.3g}&F_max=60")
        if self.random.random() < 0.5:
            self.browser._call("POST", "/back", {})
            self.browser.wait_for("window.Bokeh && Bokeh.documents.length && Bokeh.documents[0].is_idle")
        return ""

    def resize(self) -> str:
        """Another width of the window."""
        width = int(self.one_of(COLUMN_WIDTHS))
        self.browser.resize(width, 1200)
        return str(width)


class Checks:
    """Comparisons with the solver, messages of the console, and memory in MB by place."""

    def __init__(self, user: RandomUser, pid: int):
        self.user = user
        self.pid = pid
        self.compared = self.refused = self.unsolved = 0
        self.problems: list[str] = []
        self.memory: dict[str, list[float]] = {"server": [], "solvers": [], "page": []}

    def check(self) -> None:
        """Compares the page with the solver, and looks at console and memory."""
        self._compare(self._settled())
        browser = self.user.browser
        self.problems += [f"console: {each}" for each in browser.complaints()]
        command(browser, "HeapProfiler.collectGarbage")
        self.memory["page"].append(command(browser, "Runtime.getHeapUsage")["usedSize"] / 1e6)
        self.memory["server"].append(resident(self.pid))
        self.memory["solvers"].append(sum(map(resident, descendants(self.pid))))

    def _settled(self) -> dict[str, Any]:
        """The content of the page when spectrum and thresholds are solved, or after LONGEST_SOLVE."""
        time.sleep(1.0)
        end = time.monotonic() + LONGEST_SOLVE
        names = [list(values) for values in TAB_DEFAULTS.values()]
        while True:
            found: dict[str, Any] = self.user.browser.run(STATE, names)
            if not {"spectrum", "thresholds"} & {*found["kinds"]} or time.monotonic() > end:
                return found
            time.sleep(0.2)

    def _compare(self, shown: dict[str, Any]) -> None:
        tab = self.user.tab()
        known = {name: shown[name] for name in ("law", "across", "F_max")}
        state = PageState(tab=tab, **{tab: shown["values"]}, **known)
        numbers = dict(
            re.findall(r'data-name="(\w+)"><td>[^<]*</td><td>([^<]*)<', unescape(shown["numbers"]))
        )
        try:
            state.largest_force()
            answers = [state.rod_or_arm().spectrum(modes=6, progress=False)]
            if "thresholds" in shown["kinds"]:
                self.unsolved += 1
            else:
                answers.append(state.rod_or_arm().thresholds(F_max=state.largest_force(), progress=False))
        except UserError as refusal:
            self.refused += 1
            if unescape(shown["refusal"]) != str(refusal):
                self._add_problem(state, f"{shown['refusal']!r}, solver: {str(refusal)!r}")
            return
        self.compared += 1
        for answer in answers:
            for name in {*COMPARED} & {*numbers} & {*answer.data}:
                own = float(np.ravel(answer.data[name].values)[0])
                own *= 1e-3 if name.startswith("pressure") else 1.0
                if not abs(float(numbers[name]) - own) <= TOLERANCE * max(abs(own), SMALLEST):
                    self._add_problem(state, f"{name} = {numbers[name]}, solver: {own:.8g}")
        if not {"growth_rate", "growth_rate_si"} & {*numbers}:
            self._add_problem(state, f"no growth rate; the page says {shown['refusal']!r}")

    def _add_problem(self, state: PageState, text: str) -> None:
        self.problems.append(f"{state.address()}: {text}; last actions: {list(self.user.log)}")

    def report(self) -> bool:
        """Prints all numbers; returns whether there was no problem."""
        counts = self.user.counts
        print(f"{counts.total()} actions: {', '.join(f'{n} {name}' for name, n in counts.most_common())}")
        print(f"compared {self.compared} times, {self.unsolved} without thresholds; {self.refused} refusals")
        for place, values in self.memory.items():
            third = max(1, len(values) // 3)
            before = statistics.median(values[third : 2 * third] or values)
            last = statistics.median(values[-third:])
            print(f"MB of the {place}: first {values[0]:.0f}, second third {before:.0f}, last {last:.0f}")
            if place != "solvers" and last > LARGEST_GROWTH * before:
                self.problems.append(f"the memory of the {place} grows")
        print("\n".join(self.problems) or "no problem")
        return not self.problems


def command(browser: Browser, name: str) -> Any:
    """Result of a command of the Chrome DevTools Protocol."""
    return browser._call("POST", "/goog/cdp/execute", {"cmd": name, "params": {}})


def resident(pid: int) -> float:
    """Resident memory of a process in MB; 0 if it has ended."""
    try:
        return int(Path(f"/proc/{pid}/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6
    except FileNotFoundError:
        return 0.0


def descendants(pid: int) -> list[int]:
    """Processes that a process, or one of these processes, has started."""
    run = subprocess.run(["ps", "-A", "-o", "pid=,ppid="], capture_output=True, text=True, check=True)
    rows = [tuple(map(int, line.split())) for line in run.stdout.splitlines()]
    found = [pid]
    for parent in found:
        found += [child for child, its in rows if its == parent]
    return found[1:]


def main() -> None:
    """Runs for the given time, and prints the result."""
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else SECONDS
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else SEED
    print(f"seed {seed}, {seconds:g} s", flush=True)
    page = subprocess.Popen([sys.executable, "-m", "rodsweep", "explore"], stdout=subprocess.PIPE, text=True)
    assert page.stdout is not None
    try:
        url = page.stdout.readline().split()[0]
        with Browser() as browser:
            browser.open(f"{url}?F_max=60")
            user = RandomUser(browser, url, seed)
            checks = Checks(user, page.pid)
            end = time.monotonic() + seconds
            while time.monotonic() < end:
                for _ in range(COMPARED_EVERY):
                    user.act()
                checks.check()
            is_good = checks.report()
    finally:
        page.send_signal(signal.SIGINT)
        page.wait()
    sys.exit(0 if is_good else 1)


if __name__ == "__main__":
    main()
