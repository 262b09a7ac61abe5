"""Phase diagrams: rows of a plane with all their changes, and the curves on which the changes lie.

A row is a path along one axis of the diagram. All changes on it are found (`along_path`),
so that the class of any of its points follows without solving there: the solves go where the class
changes, and the boundary is as sharp as Newton's method makes it. The curves are traced from the changes
of all rows (`rodsweep.determinant.curves`).
"""

import math
import time
from dataclasses import dataclass, replace
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from ...determinant.curves import Curve, corrected, equations_of, on_line, trace
from ...determinant.path import Path
from ...determinant.plane import Plane
from ...model.rod import Rod
from .along_path import Transitions, transitions
from .leading_eigenvalue import Untraceable
from .thresholds import SHORT_OF_CRUSHED, Thresholds, ThresholdStatus, nothing_found, outcome_of
from .unstable_modes import Kind

ROUNDED = 1e-12
"""Difference of two coordinates that is none."""
ON_CURVE = 1e-3
"""Relative distance of the eigenvalue below which a change may lie on a curve beside it."""
MOST_SECANTS = 20
SAME_ENDS = 1e-6
"""Distance of two ends, eigenvalues included, below which their curves are one: curves do not cross."""
AGREE = 1e-7
"""Distance, in units of the axis, below which a change lies on a curve."""


class Motion(IntEnum):
    """How a small deflection of the straight rod evolves.

    monotone, oscillatory: stable, and the slowest mode decays without or with oscillations. flutter: at
    least one mode grows. undecided: on a boundary within its error, or not known. crushed: F >= k1.
    """

    monotone = 0
    oscillatory = 1
    flutter = 2
    undecided = 3
    crushed = 4


@dataclass(frozen=True, slots=True)
class RowRequest:
    """What is asked of every row: the parameter that varies along it and its values, increasing."""

    name: str
    values: NDArray[np.float64]
    accuracy: float
    certify: bool
    crossings: int
    """Most changes that are kept."""


@dataclass(frozen=True, slots=True)
class Row:
    """One row: the class and the unstable modes at each value, shape (values,), and all changes along it."""

    motion: NDArray[np.int8]
    unstable_count: NDArray[np.int32]
    changes: Thresholds

    @property
    def status(self) -> ThresholdStatus:
        return self.changes.status

    @property
    def message(self) -> str:
        return self.changes.message


def solve_row(fixed: dict[str, float], request: RowRequest) -> Row:
    """The row on which the three parameters `fixed` do not vary; never raises."""
    started = time.perf_counter()
    values = request.values
    try:
        with np.errstate(all="ignore"):
            row = _searched(fixed, request)
    except (Untraceable, ArithmeticError, MemoryError, ValueError) as error:
        reason = str(error) or type(error).__name__
        row = _blank(ThresholdStatus.failed, values, Motion.undecided, reason)
    return replace(row, changes=replace(row.changes, seconds=time.perf_counter() - started))


def _searched(fixed: dict[str, float], request: RowRequest) -> Row:
    name, values = request.name, request.values
    F = values if name == "F" else np.full(len(values), fixed["F"])
    k1 = values if name == "k1" else np.full(len(values), fixed["k1"])
    alive = k1 * (1 - SHORT_OF_CRUSHED) > F
    crushed = k1 <= F
    if not alive.any():
        row = _blank(ThresholdStatus.ok, values, Motion.crushed)
        row.motion[~crushed] = Motion.undecided
        return row
    start, stop = float(values[alive][0]), float(values[alive][-1])
    if name == "F" and not alive.all():
        stop = fixed["k1"] * (1 - SHORT_OF_CRUSHED)
    if name == "k1" and not alive.all():
        start = fixed["F"] / (1 - SHORT_OF_CRUSHED) if fixed["F"] > 0 else start
    rod = Rod(**fixed | {name: start})
    found = transitions(Path(rod, name), start, stop, request.certify)
    motion, unstable = classes(found, values)
    # What is nearly crushed lies beyond the search.
    motion[crushed], unstable[crushed] = Motion.crushed, -1
    motion[~alive & ~crushed], unstable[~alive & ~crushed] = Motion.undecided, -1
    return Row(motion, unstable, outcome_of(found, stop, request))


def _blank(status: ThresholdStatus, values: NDArray[np.float64], motion: Motion, message: str = "") -> Row:
    """A row of one class without any change."""
    count = len(values)
    changes = nothing_found(status, float(values[-1]), message)
    return Row(np.full(count, motion, dtype=np.int8), np.full(count, -1, dtype=np.int32), changes)


def classes(found: Transitions, values: NDArray[np.float64]) -> tuple[NDArray[np.int8], NDArray[np.int32]]:
    """(class, unstable modes) at each value of the parameter of a path, from the changes along it."""
    oscillates = np.full(len(values), found.oscillates_at_start)
    unstable = np.full(len(values), found.unstable_at_start, dtype=np.int32)
    blurred = np.zeros(len(values), dtype=bool)
    for crossing in found.crossings:
        beyond = values > crossing.at
        if crossing.kind in (Kind.onset, Kind.pair_leads, Kind.real_again, Kind.real_leads):
            oscillates[beyond] = crossing.kind in (Kind.onset, Kind.pair_leads)
        else:
            unstable[beyond] = crossing.unstable_after
        blurred |= np.abs(values - crossing.at) <= crossing.error
    low, high = found.open_range
    if not math.isnan(low):
        blurred |= (values >= low) & (values <= high)
        unstable[values > max([high, *(c.at for c in found.crossings)])] = found.unstable_at_end
    motion = np.where(oscillates, Motion.oscillatory, Motion.monotone).astype(np.int8)
    motion[unstable > 0] = Motion.flutter
    blurred |= unstable < 0
    motion[blurred] = Motion.undecided
    unstable[blurred] = -1
    return motion, unstable


@dataclass(frozen=True, slots=True)
class Seed:
    """A change on a row, as a start for a curve: values of both parameters and the eigenvalue there."""

    values: tuple[float, float]
    sign: float
    """0 for a Hopf point, else the sign of the double eigenvalue."""
    eigenvalue: float
    """The frequency of a Hopf point, or the double eigenvalue."""


def seed_of(values: tuple[float, float], kind: int, frequency: float, growth_rate: float) -> Seed | None:
    """The seed of a change, or None for an overtaking, which lies on neither kind of curve."""
    if kind in (Kind.hopf, Kind.hopf_reverse, Kind.restabilization):
        return Seed(values, 0.0, frequency)
    if kind in (Kind.onset, Kind.real_again):
        return Seed(values, math.copysign(1.0, growth_rate), growth_rate)
    return None


@dataclass(frozen=True, slots=True)
class Curves:
    """All curves of a diagram; how far the changes on rows lie from them, in units of the axis.

    untraced: changes on rows through which no curve could be followed.
    """

    curves: tuple[Curve, ...]
    agreement: float
    untraced: int


def curves_through(plane: Plane, seeds: list[Seed]) -> Curves:
    """The curves through all changes; each is followed once, and every change is then found on one."""
    curves: list[Curve] = []
    worst, untraced = 0.0, 0
    for seed in seeds:
        distance = min((_distance(plane, curve, seed) for curve in curves), default=math.inf)
        if distance > AGREE:
            x, y = (a.scaled(v) for a, v in zip(plane.axes, seed.values, strict=True))
            curve = trace(seed.sign, plane, (x, y), seed.eigenvalue)
            if curve is not None:
                distance = _distance(plane, curve, seed)
                if not any(_same(curve, other) for other in curves):
                    curves.append(curve)
        if distance > AGREE:
            untraced += 1
        else:
            worst = max(worst, distance)
    return Curves(tuple(curves), worst, untraced)


def _same(one: Curve, other: Curve) -> bool:
    """Whether two curves share an end: beside a crushed rod a change may not be found on its own curve."""
    ends = one.scaled[[0, -1], None] - other.scaled[None, [0, -1]]
    return one.sign == other.sign and float(np.abs(ends).max(axis=-1).min()) < SAME_ENDS


def _distance(plane: Plane, curve: Curve, seed: Seed) -> float:
    """How far along the first axis a change lies from the curve, at its place on the second axis."""
    if curve.sign != seed.sign:
        return math.inf
    x, y = (a.scaled(v) for a, v in zip(plane.axes, seed.values, strict=True))
    points = curve.scaled
    side = points[:, 1] - y
    side[np.abs(side) < ROUNDED] = 0.0
    if len(points) == 1:
        return float(abs(points[0, 0] - x)) if abs(side[0]) < AGREE else math.inf
    best = math.inf
    for i in np.flatnonzero(side[:-1] * side[1:] <= 0):
        a, b = points[i], points[i + 1]
        if not min(a[0], b[0]) - 0.1 <= x <= max(a[0], b[0]) + 0.1:
            continue
        there = _at_height(plane, curve.sign, a, b, y)
        if there is not None and abs(there[2] - math.log(abs(seed.eigenvalue))) < ON_CURVE:
            best = min(best, float(abs(there[0] - x)))
    return best


def _at_height(
    plane: Plane, sign: float, a: NDArray[np.float64], b: NDArray[np.float64], y: float
) -> NDArray[np.float64] | None:
    """The point (x, y, h) of a curve at the height y between two of its points, or None.

    First at once from the chord; where that guess is too far, by secants along the curve.
    """
    equations = equations_of(sign)
    share = (y - a[1]) / (b[1] - a[1]) if a[1] != b[1] else 0.0
    for _ in range(MOST_SECANTS):
        guess = a + share * (b - a)
        level = guess.copy()
        level[1] = y
        there = on_line(equations, plane, level, 1)
        if there is not None:
            return there[0]
        there = corrected(equations, plane, guess, (b - a) / np.linalg.norm(b - a))
        if there is None:
            return None
        a, b = (there[0], b) if (there[0][1] - y) * (b[1] - y) <= 0 else (a, there[0])
        share = (y - a[1]) / (b[1] - a[1]) if a[1] != b[1] else 0.0
    return None
