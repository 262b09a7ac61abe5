"""Branches of cycles as stored in a result file of the task `branch`: vertices, special points and stability.

A branch is a curve through cycles and special points. Floquet multipliers cross the unit circle only at
special points. A cycle with a multiplier that lies on the circle within its error therefore has the stability
of the other cycles between the same two special points, if these cycles have equal stability.
"""

from dataclasses import dataclass, fields
from itertools import pairwise
from math import nan

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..model.floquet import min_unstable_multiplier_count
from ..results.layouts.branch import END_REASONS, SPECIAL_KINDS
from .range_unions import ParameterRange, union_of_ranges

EARLY_STOP_REASONS = ("no_cycle_found", "list_full")
"""Reasons for which the continuation of a branch stopped before the end of the branch."""


@dataclass(frozen=True, slots=True)
class StoredSpecialPoint:
    """Special point of a branch. A field NAME has the value of the variable special_NAME; `kind` and `reason`
    are words."""

    kind: str
    at: float
    """Value of the followed parameter at the special point."""
    error: float
    """Estimate of the absolute error of `at`."""
    period: float
    """Period of the cycle at the special point, in tau2."""
    tip_y_max: float
    """Largest y of the tip at the special point, in L; 0 at a Hopf point."""
    reason: str
    unstable_after: int
    """At a Hopf point: number of unstable modes of the straight rod at slightly larger values of the
    parameter; -1 at other points."""
    meets: int
    """At a symmetry breaking: number, from 1, of the second branch that begins or ends there; -1: no
    branch."""
    amplitude_coefficient: float = nan
    """Coefficient a of a Hopf point, in L: the largest y of its cycles is |a| sqrt(|p/p_H - 1|) to leading
    order (p: followed parameter, p_H: its value `at` at the Hopf point); a < 0: the cycles are at smaller
    p."""
    period_error: float = nan
    """Estimate of the relative error of `period`."""
    tip_y_max_error: float = nan
    """Estimate of the relative error of `tip_y_max`."""


@dataclass(frozen=True, slots=True)
class StoredBranch:
    """Branch of cycles: a curve through n vertices, which are stored cycles and special points.

    parameter, tip_y_max, period: followed parameter, largest y of the tip in L, and period in tau2, at the
    vertices, (n,) each. Between two special points the parameter changes in one direction; a cycle that lies
    beyond one of these points by at most twice its error is moved to the point.
    """

    parameter: Array
    tip_y_max: Array
    period: Array
    stability: NDArray[np.integer]
    """Stability between neighbouring vertices, (n - 1,): 1 stable, 0 unstable, -1 unknown."""
    is_cycle: NDArray[np.bool_]
    """Mask of the vertices that are stored cycles, (n,)."""
    special_points: tuple[StoredSpecialPoint, ...]
    """Special points of the branch, in order along the branch."""

    @property
    def starts_outside_range(self) -> bool:
        """Whether the branch begins at an end of the range; it then continues beyond this end."""
        return self.special_points[0].kind == "end"

    @property
    def stable_ranges(self) -> list[ParameterRange]:
        """Ranges of the parameter in which the branch has a stable cycle."""
        pairs = [self.parameter[i : i + 2] for i in np.flatnonzero(self.stability == 1)]
        return union_of_ranges((min(pair), max(pair)) for pair in pairs)

    @property
    def special_point_parameter_errors(self) -> dict[float, float]:
        """Absolute error of the parameter at each special point, by parameter value."""
        return {float(special.at): special.error for special in self.special_points}

    @property
    def is_fully_known(self) -> bool:
        """Whether the branch was followed to its end and the stability of all cycles is known."""
        return self.special_points[-1].reason not in EARLY_STOP_REASONS and bool((self.stability >= 0).all())

    def scaled_curves_near_hopf_points(self) -> list[tuple[Array, Array, NDArray[np.integer]]]:
        """For each Hopf point at an end of the branch: (|p/p_H - 1|, y/|a|, stability) at the vertices up to
        the first fold.

        p: followed parameter. y: largest y of the tip. p_H, a: p and amplitude coefficient of the Hopf point.
        stability: between neighbouring vertices. Hopf points with unknown or zero a are skipped, and the
        vertex of the Hopf point is left out. Shapes (n,), (n,) and (n - 1,), n > 1.
        """
        curves = []
        for special, order in (
            (self.special_points[0], slice(None)),
            (self.special_points[-1], slice(None, None, -1)),
        ):
            a = special.amplitude_coefficient
            y = self.tip_y_max[order]
            if special.kind != "hopf" or y[0] != 0 or not np.isfinite(a) or a == 0:
                continue
            relative_distance = np.sign(a) * (self.parameter[order] / special.at - 1)
            turning_indices = np.flatnonzero(np.diff(relative_distance) <= 0)
            end = int(turning_indices[0]) + 1 if len(turning_indices) else len(relative_distance)
            if end > 2:
                curves.append(
                    (relative_distance[1:end], y[1:end] / abs(a), self.stability[order][1 : end - 1])
                )
        return curves


def stored_branch(v: dict[str, Array], parameter_name: str, number: int) -> StoredBranch:
    """Branch with the given number, from 1. v: variables of the file at the point of the rod, by name,
    (...,). parameter_name: parameter along which the branch is followed."""
    cycles = np.flatnonzero(v["branch"] == number)
    special = np.flatnonzero(v["special_branch"] == number)
    special_before = special[v["special_point"][special] == 0]
    order: list[tuple[bool, int]] = [(False, int(i)) for i in special_before]
    for index in cycles:
        order.append((True, int(index)))
        order += [(False, int(i)) for i in special[v["special_point"][special] == index + 1]]
    values = [
        (v[f"branch_{parameter_name}"][i], v["tip_y_max"][i], v["period"][i])
        if is_cycle
        else (v["special_at"][i], v["special_tip_y_max"][i], v["special_period"][i])
        for is_cycle, i in order
    ]
    x, y, period = np.array(values, dtype=float).reshape(-1, 3).T
    errors = np.array([v[f"branch_{parameter_name}_error"][i] if is_cycle else 0.0 for is_cycle, i in order])
    x = _parameter_clipped_at_special_points(
        x, errors * np.abs(x), np.array([not is_cycle for is_cycle, _ in order])
    )
    crossing = zip(v["unstable_multipliers"], v["multiplier"], v["multiplier_error"], strict=True)
    outside = [
        min_unstable_multiplier_count(int(count), float(size), float(error))
        for count, size, error in crossing
    ]
    counts = [outside[i] if is_cycle else None for is_cycle, i in order]
    is_cycle = np.array([cycle for cycle, _ in order], dtype=bool)
    points = tuple(_special_point(v, i) for i in special)
    return StoredBranch(x, y, period, stability_between_vertices(counts), is_cycle, points)


def _parameter_clipped_at_special_points(x: Array, error: Array, is_special: NDArray[np.bool_]) -> Array:
    """The parameter at the vertices of a branch, (n,); cycles are moved by at most twice their absolute error
    into the parameter range between the special points before and after them. x, error: parameter at the
    vertices, and its absolute error, (n,) each. is_special: mask of the special points, (n,)."""
    x = x.copy()
    for start, end in pairwise(np.flatnonzero(is_special)):
        interior = slice(start + 1, end)
        inner_x = np.clip(x[interior], *sorted((x[start], x[end])))
        x[interior] = np.where(np.abs(inner_x - x[interior]) <= 2 * error[interior], inner_x, x[interior])
    return x


def _special_point(v: dict[str, Array], index: int) -> StoredSpecialPoint:
    """Special point at index `index` of the stored list. v: variables of the file at the point of the rod, by
    name."""
    values = {field.name: v[f"special_{field.name}"][index].item() for field in fields(StoredSpecialPoint)}
    texts = {"kind": SPECIAL_KINDS[values["kind"]], "reason": END_REASONS[values["reason"]]}
    return StoredSpecialPoint(**values | texts)


def stability_between_vertices(counts: list[int | None]) -> NDArray[np.integer]:
    """Stability between neighbouring vertices of a branch, (n - 1,): 1 stable, 0 unstable, -1 unknown.

    counts: least number of unstable multipliers at n vertices; -1 if unknown, None at special points.
    """
    stable = [-1] * (len(counts) - 1)
    unknown_indices = [i for i, count in enumerate(counts) if count is None]
    for start, end in pairwise([0, *unknown_indices, len(counts) - 1]):
        known_counts = [count for count in counts[start : end + 1] if count is not None and count >= 0]
        for i in range(start, end):
            neighbours = [count for count in counts[i : i + 2] if count in known_counts] or known_counts
            if len({count == 0 for count in neighbours}) == 1:
                stable[i] = int(neighbours[0] == 0)
    return np.array(stable, dtype=int)
