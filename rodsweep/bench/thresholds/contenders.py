"""The ways to an onset or a Hopf point that the thresholds benchmark compares, and their settings."""

from functools import partial
from math import nan
from pathlib import Path

from scipy.optimize import bisect, brentq

from ...solve.changes.thresholds import ThresholdsRequest, solve_thresholds
from ..machine import installed
from ..study import Contender
from .auto_07p import auto_program, hopf_by_auto
from .cases import HOPF, ONSET, FirstThreshold, ThresholdCase
from .pycont_lite import PYCONT_MODULE, hopf_by_pycont
from .spectra_by_force import (
    between,
    by_steps,
    discriminant,
    growth,
    interpolated_growth,
    leads_real,
    on_grid,
    square_root_law,
)

F_MAX = 200.0
GRIDS, LARGE_GRID = (50, 200), 800
TOLERANCES = (1e-3, 1e-6, 1e-12)
AUTO_SETTINGS = ((5.0, 1e-7), (1.0, 1e-4), (1.0, 1e-10))
"""(step in F, EPSS)."""
PYCONT_STEPS = (0.25, 0.5)
"""From 0.5 upwards it is chance on some rods whether it finds the Hopf point; quick runs do without 0.5."""
AUTO, PYCONT = "AUTO-07p", "PyCont-Lite"
RODSWEEP, SWEEP, CONTINUATION = "rodsweep", "grid and interpolation", "continuation"
BY_GRID = {
    ONSET: {"grid, between two forces": between, "grid, square-root law": square_root_law},
    HOPF: {"grid, linear interpolation": interpolated_growth},
}
BY_STEPS = {
    ONSET: {
        "steps, bisection on Im w > 0": partial(by_steps, bisect, leads_real),
        "steps, Brent on (w1 - w2)^2": partial(by_steps, brentq, discriminant),
    },
    HOPF: {"steps, Brent on Re w": partial(by_steps, brentq, growth)},
}


def contenders(kind: str, quick: bool) -> list[Contender]:
    """rodsweep and those that need SciPy only."""
    grids = GRIDS if quick else (*GRIDS, LARGE_GRID)
    return [
        Contender("rodsweep, all changes", "with proof", RODSWEEP, partial(own_threshold, kind, True)),
        Contender("rodsweep, all changes", "without proof", RODSWEEP, partial(own_threshold, kind, False)),
        *(
            Contender(name, f"{n} forces", SWEEP, partial(on_grid, estimate, n), n == LARGE_GRID)
            for name, estimate in BY_GRID[kind].items()
            for n in grids
        ),
        *(
            Contender(name, f"tolerance {tolerance:.0e}", SWEEP, partial(search, tolerance))
            for name, search in BY_STEPS[kind].items()
            for tolerance in TOLERANCES
        ),
    ]


def own_threshold(kind: str, certify: bool, case: ThresholdCase) -> FirstThreshold:
    """All changes of the rod, and of them the first of a kind."""
    result = solve_thresholds(case.k1, case.k2, case.gamma3, ThresholdsRequest(F_MAX, 1e-10, certify, 64))
    at = next((change.at for change in result.crossings if change.kind.name == kind), nan)
    return FirstThreshold(at, result.solves, determinants=result.boxes)


def continuation_codes(directory: Path, quick: bool) -> tuple[list[Contender], list[str]]:
    """Those that are here, and a line for each that is not; programs are compiled in the directory."""
    found, skipped = [], []
    if program := auto_program(directory):
        for step, tolerance in AUTO_SETTINGS:
            by_auto = partial(hopf_by_auto, program, step, tolerance)
            found.append(Contender(AUTO, f"step {step:g}, EPSS {tolerance:.0e}", CONTINUATION, by_auto))
    else:
        skipped.append(f"{AUTO} is skipped: it needs the program (Debian: auto-07p) and gfortran.")
    if module := installed(PYCONT_MODULE):
        for step in PYCONT_STEPS[: 1 if quick else None]:
            by_pycont = partial(hopf_by_pycont, module, step)
            found.append(Contender(PYCONT, f"step {step:g}", CONTINUATION, by_pycont, slow=True))
    else:
        skipped.append(f"{PYCONT} is skipped: it is not installed (extra `bench`).")
    return found, skipped
