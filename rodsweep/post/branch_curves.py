"""Branches of cycles from a file of the task branch: curves and their stability, and ranges of the parameter.

A branch is a curve through its cycles and its special points in their order. Where multipliers cross the
circle there is a special point: a cycle with one on the circle within its error is as stable as those between
the same special points that have none, if these are of one kind.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise
from math import nan

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..model.parameters import LINEAR_PARAMETERS
from ..results.file.view import View
from ..results.layouts.branch import END_REASONS, SPECIAL_KINDS

HOPF, FOLD, END = (SPECIAL_KINDS.index(kind) for kind in ("hopf", "fold", "end"))
SAME_PLACE = 1e-9
"""Relative distance of the ends of two ranges below which they are one."""

Range = tuple[float, float]


@dataclass(frozen=True, slots=True)
class SpecialOfBranch:
    """A special point as the file has it."""

    kind: str
    at: float
    error: float
    period: float
    tip_y_max: float
    reason: str
    unstable_after: int
    meets: int
    amplitude_coefficient: float = nan
    period_error: float = nan
    tip_y_max_error: float = nan


@dataclass(frozen=True, slots=True)
class CurveOfCycles:
    """A branch. at, y, period: at its vertices in order, (n,); cycles: which of these are stored ones, (n,).

    stable: of the pieces between, (n - 1,): 1 stable, 0 unstable, -1 not known.
    """

    at: Array
    y: Array
    period: Array
    stable: NDArray[np.integer]
    cycles: NDArray[np.bool_]
    special: tuple[SpecialOfBranch, ...]

    @property
    def stable_ranges(self) -> list[Range]:
        """The values of the parameter that have a stable cycle of the branch."""
        pieces = np.flatnonzero(self.stable == 1)
        return union((min(self.at[i : i + 2]), max(self.at[i : i + 2])) for i in pieces)

    def beside_hopf_points(self) -> list[tuple[Array, Array, NDArray[np.integer]]]:
        """From each Hopf point of known a to where the branch first turns back: |at/at_H - 1|, y/|a|, stable.

        Of the shapes (n,), (n,) and (n - 1,), n > 1; the Hopf point itself, at 0, is left out.
        """
        found = []
        for special, order in ((self.special[0], slice(None)), (self.special[-1], slice(None, None, -1))):
            a, y = special.amplitude_coefficient, self.y[order]
            if special.kind != "hopf" or y[0] != 0 or not np.isfinite(a) or a == 0:
                continue
            away = np.sign(a) * (self.at[order] / special.at - 1)
            turns = np.flatnonzero(np.diff(away) <= 0)
            end = int(turns[0]) + 1 if len(turns) else len(away)
            if end > 2:
                found.append((away[1:end], y[1:end] / abs(a), self.stable[order][1 : end - 1]))
        return found


def followed_parameter(view: View) -> str:
    """The parameter along which branches are followed."""
    names = {str(name) for name in view.variables}
    return next(name for name in LINEAR_PARAMETERS if f"branch_{name}" in names)


def branches_not_told(view: View, rod: int) -> int:
    """How many branches of a rod have special points for which the list has no room."""
    v = view.of_point(rod)
    return max(int(v["branch_count"]), 0) - _told(v)


def _told(v: dict[str, Array]) -> int:
    """The number of branches of a rod, the first ones, whose special points are all in the list."""
    listed = v["special_branch"][v["special_kind"] > 0]
    if len(listed) >= v["special_count"]:
        return max(int(v["branch_count"]), 0)
    return int(listed.max(initial=1)) - 1


def curves_of(view: View, rod: int) -> list[CurveOfCycles]:
    """The branches of a rod, by its place among all points, whose special points are all in the list."""
    along, v = followed_parameter(view), view.of_point(rod)
    curves = []
    for number in range(1, _told(v) + 1):
        cycles = np.flatnonzero(v["branch"] == number)
        special = np.flatnonzero(v["special_branch"] == number)
        before = special[v["special_point"][special] == 0]
        order: list[tuple[bool, int]] = [(False, int(i)) for i in before]
        for place in cycles:
            order.append((True, int(place)))
            order += [(False, int(i)) for i in special[v["special_point"][special] == place + 1]]
        values = [
            (v[f"branch_{along}"][i], v["tip_y_max"][i], v["period"][i])
            if is_cycle
            else (v["special_at"][i], v["special_tip_y_max"][i], v["special_period"][i])
            for is_cycle, i in order
        ]
        at, y, period = np.array(values, dtype=float).reshape(-1, 3).T
        counts = [int(v["unstable_multipliers"][i]) if is_cycle else None for is_cycle, i in order]
        is_cycle = np.array([cycle for cycle, _ in order], dtype=bool)
        stable, specials = stability_of_pieces(counts), _specials(v, special)
        curves.append(CurveOfCycles(at, y, period, stable, is_cycle, specials))
    return curves


def stability_of_pieces(counts: list[int | None]) -> NDArray[np.integer]:
    """Of the pieces between n vertices, (n - 1,), by the counts of unstable multipliers at these: -1 where
    undecided, None at special points."""
    stable = [-1] * (len(counts) - 1)
    special = [i for i, count in enumerate(counts) if count is None]
    for start, end in pairwise([0, *special, len(counts) - 1]):
        known = [count for count in counts[start : end + 1] if count is not None and count >= 0]
        for i in range(start, end):
            beside = [count for count in counts[i : i + 2] if count in known] or known
            if len({count == 0 for count in beside}) == 1:
                stable[i] = int(beside[0] == 0)
    return np.array(stable, dtype=int)


def _specials(v: dict[str, Array], places: Iterable[int]) -> tuple[SpecialOfBranch, ...]:
    return tuple(
        SpecialOfBranch(
            SPECIAL_KINDS[int(v["special_kind"][i])],
            float(v["special_at"][i]),
            float(v["special_error"][i]),
            float(v["special_period"][i]),
            float(v["special_tip_y_max"][i]),
            END_REASONS[int(v["special_reason"][i])],
            int(v["special_unstable_after"][i]),
            int(v["special_meets"][i]),
            float(v["special_amplitude_coefficient"][i]),
            float(v["special_period_error"][i]),
            float(v["special_tip_y_max_error"][i]),
        )
        for i in places
    )


def straight_ranges(view: View, rod: int, ends: Range) -> tuple[list[Range], list[Range]]:
    """(where the straight rod is stable, where it is not) between the ends of a range, if all is told."""
    v = view.of_point(rod)
    if branches_not_told(view, rod):
        return [], []
    hopf = v["special_kind"] == HOPF
    at, first = np.unique(v["special_at"][hopf], return_index=True)
    after = v["special_unstable_after"][hopf][first]
    edges = [ends[0], *(float(a) for a in at), max(ends[1], *at) if len(at) else ends[1]]
    counts = [int(v["unstable_at_start"]), *(int(count) for count in after)]
    stable: list[Range] = []
    unstable: list[Range] = []
    for count, low, high in zip(counts, edges[:-1], edges[1:], strict=True):
        if count >= 0:
            (unstable if count else stable).append((low, high))
    return union(stable), union(unstable)


def union(ranges: Iterable[Range]) -> list[Range]:
    """Ranges that touch or overlap, as one each, in increasing order."""
    found: list[Range] = []
    for low, high in sorted((float(a), float(b)) for a, b in ranges):
        if found and low <= found[-1][1] * (1 + SAME_PLACE):
            found[-1] = found[-1][0], max(high, found[-1][1])
        else:
            found.append((low, high))
    return found


def both(some: list[Range], others: list[Range]) -> list[Range]:
    """What two lists of ranges have in common."""
    common = [(max(a, c), min(b, d)) for a, b in some for c, d in others]
    return [(low, high) for low, high in common if high > low * (1 + SAME_PLACE)]
