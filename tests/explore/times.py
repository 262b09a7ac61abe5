"""Prints the median time from a click in the diagram to the painted pictures, in a headless browser."""

import signal
import statistics
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))
from explore.browser import Browser

CLICKS = 24
PICTURES = {"spectrum": "spectrum", "shapes": "beating", "threshold": "growth"}
"""Figure painted with the data of each source."""
WATCH = """
const model = (name) => Bokeh.documents[0].get_model_by_name(name)
window.times = {}
document.addEventListener("pointerup", () => { window.times = {start: performance.now()} }, true)
for (const [name, figure] of Object.entries(arguments[0])) {
  const source = model(name + "_source")
  let is_due = false
  source.connect(source.properties.data.change, () => { is_due = true })
  const painted = () => { window.times[name] ??= performance.now() - window.times.start }
  Bokeh.index.find_one(model(figure + "_figure")).repainted.connect(() => {
    if (is_due) setTimeout(painted, 0)
    is_due = false
  })
}
"""


def main() -> None:
    """Starts the page, clicks, and prints medians in milliseconds."""
    argv = [sys.executable, "-m", "rodsweep", "explore"]
    page = subprocess.Popen(argv, stdout=subprocess.PIPE, text=True)
    assert page.stdout is not None
    found: dict[str, list[float]] = {name: [] for name in PICTURES}
    try:
        url = page.stdout.readline().split()[0]
        with Browser() as browser:
            browser.open(f"{url}?F_max=60")
            for source, column in (("branch", "F"), ("cell", "left")):
                browser.wait_for(
                    f"Bokeh.documents[0].get_model_by_name('{source}_source').data.{column}.length"
                )
            browser.run(WATCH, PICTURES)
            places = np.random.default_rng(1).permuted(
                [np.linspace(30, 58, CLICKS), np.geomspace(60, 400, CLICKS)], axis=1
            )
            for F, k2 in places.T:
                browser.click("diagram_figure", F, k2)
                browser.wait_for(" && ".join(f"window.times.{name}" for name in PICTURES))
                time.sleep(1.5)  # until the slow pictures follow too
                for name, times in found.items():
                    times.append(browser.run("return window.times[arguments[0]]", name))
    finally:
        page.send_signal(signal.SIGINT)
        page.wait()
    for name, times in found.items():
        print(f"{PICTURES[name]}: {statistics.median(times):.0f} ms")


if __name__ == "__main__":
    main()
