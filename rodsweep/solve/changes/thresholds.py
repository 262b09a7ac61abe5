"""All stability changes of one straight rod as the follower force grows from 0 (paper, Sec. VI)."""

import math
import time
from dataclasses import dataclass, replace
from enum import IntEnum
from typing import Protocol

import numpy as np

from ...determinant.path import Path
from ...model.rod import Rod
from .along_path import Transitions, transitions
from .leading_eigenvalue import Untraceable
from .unstable_modes import Crossing, Kind

SHORT_OF_CRUSHED = 1e-6
"""How far below k1, relatively, the search ends where F_max lies beyond: at F = k1 the rod is crushed."""


class ThresholdStatus(IntEnum):
    """Outcome of a search for thresholds, as `rodsweep.solve.spectrum.status.Status` is for spectra."""

    ok = 0
    not_certified = 1
    window_open = 2
    accuracy_not_reached = 3
    list_full = 4
    failed = 5

    @property
    def sentence(self) -> str:
        """Cause and remedy."""
        return SENTENCES[self]


SENTENCES = {
    ThresholdStatus.ok: (
        "every change is found, as accurate as asked for, and proved complete where asked for"
    ),
    ThresholdStatus.not_certified: (
        "the changes are accurate, but a count of the unstable modes between them could not be decided or "
        "does not agree, or it is not proved which eigenvalue leads; `certify: false` accepts that"
    ),
    ThresholdStatus.window_open: (
        "within the open range two crossings are about to meet, so it is undecided whether a window of "
        "flutter opens and closes there; move a parameter slightly"
    ),
    ThresholdStatus.accuracy_not_reached: (
        "a change is less accurate than asked for and its error says by how much, as where two changes are "
        "about to meet; ask for a lower accuracy there"
    ),
    ThresholdStatus.list_full: "there are more changes than the list holds; raise the option crossings",
    ThresholdStatus.failed: "the search failed and nothing is stored; the log has its message",
}


class Wish(Protocol):
    """What the requests of a rod and of a row have in common."""

    @property
    def accuracy(self) -> float: ...

    @property
    def certify(self) -> bool: ...

    @property
    def crossings(self) -> int: ...


@dataclass(frozen=True, slots=True)
class ThresholdsRequest:
    """What is asked of every rod: the largest force, a relative accuracy of each threshold, a proof."""

    F_max: float
    accuracy: float
    certify: bool
    crossings: int
    """Most changes that will be kept."""


@dataclass(frozen=True, slots=True)
class Thresholds:
    """The changes along a path up to the value `end` of its parameter, F or another, in increasing order.

    open_range: (from, to), nan where nothing is
    open. boxes, solves: evaluations of D and eigenproblems that it took.
    """

    status: ThresholdStatus
    crossings: tuple[Crossing, ...]
    end: float
    unstable_at_end: int
    open_range: tuple[float, float]
    certified: bool
    boxes: int
    solves: int
    seconds: float
    message: str = ""


def solve_thresholds(k1: float, k2: float, gamma3: float, request: ThresholdsRequest) -> Thresholds:
    """All changes for one rod; failures are a status, never an exception."""
    started = time.perf_counter()
    end = min(request.F_max, k1 * (1 - SHORT_OF_CRUSHED))
    try:
        with np.errstate(all="ignore"):
            found = transitions(Path(Rod(0.0, k1, k2, gamma3), "F"), 0.0, end, request.certify)
        outcome = outcome_of(found, end, request)
    except (Untraceable, ArithmeticError, MemoryError) as error:
        outcome = nothing_found(ThresholdStatus.failed, end, str(error) or type(error).__name__)
    return replace(outcome, seconds=time.perf_counter() - started)


def outcome_of(found: Transitions, end: float, wish: Wish) -> Thresholds:
    """What is kept of the changes along a path, and how far it can be relied on."""
    return Thresholds(
        status=status_of(found, wish),
        crossings=found.crossings,
        end=end,
        unstable_at_end=found.unstable_at_end,
        open_range=found.open_range,
        certified=found.proved,
        boxes=found.boxes,
        solves=found.solves,
        seconds=0.0,
        message=found.why_not,
    )


def nothing_found(status: ThresholdStatus, end: float, message: str = "") -> Thresholds:
    """The outcome where nothing was searched, or the search failed."""
    certified = status == ThresholdStatus.ok
    return Thresholds(status, (), end, -1, (math.nan, math.nan), certified, 0, 0, 0.0, message)


def status_of(found: Transitions, wish: Wish) -> ThresholdStatus:
    """How far a list of changes can be relied on; what matters most is said first."""
    if not math.isnan(found.open_range[0]):
        return ThresholdStatus.window_open
    if len(found.crossings) > wish.crossings:
        return ThresholdStatus.list_full
    if any(c.error > wish.accuracy * abs(c.at) for c in found.crossings):
        return ThresholdStatus.accuracy_not_reached
    if wish.certify and not found.proved:
        return ThresholdStatus.not_certified
    return ThresholdStatus.ok


def warm_up() -> None:
    """Loads what is compiled and created at first use, so that no point pays for it."""
    solve_thresholds(1e4, 1e4, 1e-4, ThresholdsRequest(40.0, 1e-8, True, 4))


def filament_hopf() -> float:
    """Fc, where the filament (k1 = k2 = inf, gamma3 = 0) starts to flutter (De Canio et al. 2017)."""
    found = transitions(Path(Rod(0.0, math.inf, math.inf, 0.0), "F"), 0.0, 60.0)
    return next(c.at for c in found.crossings if c.kind == Kind.hopf)
