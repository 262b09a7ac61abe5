"""Computes every config of configs/ on two ranks, and draws every figure of docs/gallery.md.

    python docs/figures.py

Result files and figures for a paper (.pdf) go into results/, the pictures of the pages into docs/. `make
figures` runs this script; docs/generated.py takes the commands of the gallery from here.
"""

import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path

DOCS = Path(__file__).parent
CONFIGS = DOCS.parent / "configs"
RESULTS = DOCS.parent / "results"
BIN = Path(sys.executable).parent

BESIDE = {
    "hysteresis_up": ["configs/hysteresis_down.yaml"],
    "hysteresis_down": ["configs/hysteresis_up.yaml"],
    "rubber": [
        "configs/rubber.yaml --set material.section=fixed -o rubber_fixed.h5",
        "configs/rubber.yaml --set material.section=fixed --set material.law=linear -o rubber_linear.h5",
    ],
}
"""Words after `rodsweep run` of further runs that the figure of a config needs."""
HYSTERESIS = [("hysteresis.png", "hysteresis_up.h5 hysteresis_down.h5")]
DRAWN = {
    "beating_arm": [("beating_arm.gif", "beating_arm.h5"), ("beating_arm.png", "beating_arm.h5")],
    "fig3": [("fig3.png", "fig3.h5 --what lines")],
    "fig5": [("fig5.png", "fig5.h5"), ("energy.png", "fig5.h5 --what energy"), ("fig5.gif", "fig5.h5")],
    "hysteresis_up": HYSTERESIS,
    "hysteresis_down": HYSTERESIS,
    "rubber": [("rubber.png", "rubber_linear.h5 rubber_fixed.h5 rubber.h5")],
}
"""Pictures of a config, each with the words after `rodsweep plot`; of the others `plot NAME.h5` alone."""
FOR_A_PAPER = {"fig2.pdf": "fig2a.h5 fig2b.h5 fig2c.h5 fig2d.h5"}
"""Figures of several configs that the gallery does not show."""


def names() -> list[str]:
    """Names of all configs."""
    return [path.stem for path in sorted(CONFIGS.glob("*.yaml"))]


def pictures(name: str) -> list[tuple[str, str]]:
    """Pictures of a config, each with the words after `rodsweep plot`."""
    return DRAWN.get(name, [(f"{name}.png", f"{name}.h5")])


def commands(name: str) -> list[str]:
    """Commands that compute a config and draw its pictures, in the top directory of the clone."""
    runs = [f"configs/{name}.yaml", *BESIDE.get(name, [])]
    plots = (plot if picture == f"{name}.png" else f"{plot} -o {picture}" for picture, plot in pictures(name))
    return [*(f"rodsweep run {words}" for words in runs), *(f"rodsweep plot {words}" for words in plots)]


def run_in_results(words: Iterable[str | Path]) -> None:
    """Runs a command in results/; CalledProcessError if it fails."""
    subprocess.run(list(map(str, words)), cwd=RESULTS, check=True)


def compute() -> None:
    """Computes every config, and what its figure needs beside it, on two ranks."""
    for name in names():
        for words in (f"configs/{name}.yaml", *BESIDE.get(name, [])):
            config, *options = words.split()
            run_in_results(
                [BIN / "mpiexec", "-n", "2", BIN / "rodsweep", "run", DOCS.parent / config, *options]
            )


def draw() -> None:
    """Draws all figures."""
    for name in names():
        for picture, words in pictures(name):
            for place in (DOCS / picture, RESULTS / f"{Path(picture).stem}.pdf"):
                if picture.endswith(".png") or place.suffix != ".pdf":
                    run_in_results([BIN / "rodsweep", "plot", *words.split(), "-o", place])
    for picture, words in FOR_A_PAPER.items():
        run_in_results([BIN / "rodsweep", "plot", *words.split(), "-o", picture])


if __name__ == "__main__":
    RESULTS.mkdir(exist_ok=True)
    compute()
    draw()
