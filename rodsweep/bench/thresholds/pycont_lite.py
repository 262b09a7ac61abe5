"""The Hopf point by PyCont-Lite, within this process."""

import contextlib
import io
from math import ceil, isnan, nan
from typing import Any

import numpy as np

from ...arrays import Array
from .cases import FirstThreshold, ThresholdCase
from .reduction import reduced

DIFFERENCE_STEP = 1e-8
"""Of the code's differences, which are exact on a linear field, and in its search for the root."""
CHECKED = 5
"""The code looks for special points after so many steps."""
PYCONT_MODULE = "pycont"
"""Of PyCont-Lite, which is an optional extra (`bench`)."""
HEAD_START, BEYOND_HOPF = 0.1, 6.0
"""Where it starts, as a share of the way from onset to Hopf point, and how far beyond it ends."""


def hopf_by_pycont(pycont: Any, step: float, case: ThresholdCase) -> FirstThreshold:
    """PyCont-Lite from where a pair leads already: through the onset it loses what it follows.

    It cannot be told to stop at the first Hopf point and so is stopped soon after.
    """
    M0, M1, M2 = reduced(case)
    last = case.top if isnan(case.hopf) else case.hopf
    start, end = case.onset + HEAD_START * (last - case.onset), min(last + BEYOND_HOPF, case.top)
    products = 0

    def field(u: Array, F: float) -> Array:
        nonlocal products
        products += 1
        return M0 @ u + F * (M1 @ u + F * (M2 @ u))

    options = {
        "rdiff": DIFFERENCE_STEP,
        "initial_directions": "increase_p",
        "param_max": end,
        "bifurcation_detection": False,
        "analyze_stability": False,
        "hopf_detection": True,
        "limit_cycle_continuation": False,
    }
    steps = ceil((end - start) / step) + CHECKED
    with contextlib.redirect_stdout(io.StringIO()), np.errstate(all="ignore"):
        found = pycont.arclengthContinuation(
            field, np.zeros(len(M0)), start, step / 1e3, step, step, steps, options, 0
        )
    forces = [float(event.p) for event in found.events if event.kind == "HB"]
    return FirstThreshold(forces[0] if forces else nan, products=products)
