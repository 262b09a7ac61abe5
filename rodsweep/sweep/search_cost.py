"""Estimated cost of searches for crossings and Hopf points along a parameter, and of phase diagrams, whose
rows along F may begin at a pull, F < 0."""

import sys
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..arrays import Array
from ..model.dispersion import sampled_arm
from ..model.rod import Rod
from .cost_estimate import CostEstimate, sampled_points_with_rod
from .points.points import Points

THRESHOLD_SEARCH_MS = 24.0
"""Time to search one rod for crossings along one parameter, in ms: mean over 72 rods, of which a few take
four times as long."""
SEARCH_CERTIFICATE_MS = 16.0
"""Time to certify that a search along one parameter missed no crossing, in ms: mean over the 72 rods of
THRESHOLD_SEARCH_MS."""
SOFT_SEARCH_MS_PER_F2_OVER_K2 = 0.014
"""Time to search one uniform rod for exchanges of the leading eigenvalue, divided by F^2/k2, in ms. F:
largest force of the search. The number of exchanges grows with F^2/k2: 30 rods with k2 from 0.3 to 3 took 0.8
to 3 times this time, for F up to 200."""
SOFT_ARM_MS_PER_F4_OVER_K2_SQUARED = 4e-4
"""Time to search a soft arm that is not uniform for crossings along F, divided by (F^2/k2)^2, in ms. F:
largest force; k2: of the thinnest section. Eight cones with F^2/k2 from 800 to 16000 took 0.3 to 2 times this
time."""
ARM_SEARCH_MS = 200.0
"""Time to search an arm that is not uniform for crossings along F, in ms: mean over 64 random arms, of which
half take 40 ms and a few soft arms 2000 ms."""
CURVES_OF_ARMS_SECONDS = 4.5
"""Time of the stability boundaries in a phase diagram of arms that are not uniform, with about 100 boundary
points, in s: 3.3, 4.6 and 5.3 were measured for cones, rubber and rubber segments. The time hardly depends on
the number of rows."""
CRITICALITY_OF_ARMS_SECONDS = 2.5
"""Time of the normal forms along the Hopf curves of a phase diagram of arms that are not uniform, in s: 0.7
to 3.8 s were measured for about 50 points."""
HOPF_SEARCH_MS = 25.0
"""Time to search one rod for Hopf points, in ms: mean over 90 rods."""
HOPF_CERTIFICATE_MS = 3.0
"""Time to certify that no Hopf point of a rod is missing, in ms: mean over the 90 rods of HOPF_SEARCH_MS."""
HOPF_NORMAL_FORMS_MS_PER_ROD = 18.0
"""Time of the normal forms of the two or three Hopf points of a rod, in ms: mean over the 90 rods of
HOPF_SEARCH_MS."""


def searches_cost(search_count: int, certify: bool, is_varying: bool) -> CostEstimate:
    """Estimated cost of `search_count` searches for crossings, each of one rod along one parameter. certify:
    whether each search is certified. is_varying: whether any arm is not uniform."""
    uniform_rod_ms = THRESHOLD_SEARCH_MS + (SEARCH_CERTIFICATE_MS if certify else 0)
    return CostEstimate(search_count * 1e-3 * (ARM_SEARCH_MS if is_varying else uniform_rod_ms))


def extra_seconds_of_soft_searches(points: Points, F_max: float, is_varying: bool) -> float:
    """Time of all searches along F in `points` beyond the time of stiff rods, in s. Where F^2/k2 is large,
    many exchanges of the leading eigenvalue and many crossings of the imaginary axis are found. F_max:
    largest force. is_varying: whether any arm is not uniform."""
    indices = sampled_points_with_rod(points)
    if not indices.size:
        return 0.0
    values = points.parameter_values_of_points(indices)
    min_area = np.minimum(np.asarray(values.get("taper", 1.0)), 1.0) ** 2
    with np.errstate(over="ignore"):
        # The search ends where the rod is crushed.
        F = np.maximum(np.minimum(F_max, values["k1"]), 0.0)
        exchanges = F**2 / (np.asarray(values["k2"]) * min_area)
        rod_ms = (
            SOFT_ARM_MS_PER_F4_OVER_K2_SQUARED * exchanges**2
            if is_varying
            else SOFT_SEARCH_MS_PER_F2_OVER_K2 * exchanges
        )
        # An infinite time could not be added, compared and printed like other times.
        return float(min(points.count * 1e-3 * float(np.mean(rod_ms)), sys.float_info.max / 4))


def thresholds_cost(points: Points, F_max: float, certify: bool, is_varying: bool) -> CostEstimate:
    """Estimated cost of the lists of thresholds of all rods in `points` for forces up to `F_max`. certify:
    whether each list is certified. is_varying: whether any arm is not uniform."""
    searches = searches_cost(points.count, certify, is_varying)
    return replace(
        searches, seconds=searches.seconds + extra_seconds_of_soft_searches(points, F_max, is_varying)
    )


def diagram_cost(
    row_count: int, certify: bool, is_varying: bool, has_curves: bool, has_criticality: bool
) -> CostEstimate:
    """Estimated cost of a phase diagram of `row_count` rows, without limit cycles. certify: whether each row
    is certified. is_varying: whether any arm is not uniform. has_curves, has_criticality: whether boundary
    curves and their criticality are computed; their cost is neglected for uniform rods."""
    searches = searches_cost(row_count, certify, is_varying)
    arm_seconds = CURVES_OF_ARMS_SECONDS * has_curves + CRITICALITY_OF_ARMS_SECONDS * has_criticality
    return replace(searches, seconds=searches.seconds + arm_seconds * is_varying)


def criticality_cost(points: Points, F_max: float, certify: bool, is_varying: bool) -> CostEstimate:
    """Estimated cost of the Hopf points and normal forms of all rods in `points` for forces up to `F_max`.
    certify: whether each search is certified. is_varying: whether any rod is not uniform."""
    search_ms = HOPF_SEARCH_MS + (HOPF_CERTIFICATE_MS if certify else 0)
    rod_ms = HOPF_NORMAL_FORMS_MS_PER_ROD + (ARM_SEARCH_MS if is_varying else search_ms)
    return CostEstimate(
        points.count * 1e-3 * rod_ms + extra_seconds_of_soft_searches(points, F_max, is_varying)
    )


MAX_SAMPLED_ROWS = 20
"""Largest number of rows of a phase diagram (rods searched along F) for which an estimate counts the first
boxes of the search under pulls, F < 0; counting takes up to 20 ms a row."""
COVERING_MS_PER_BOX = 0.11
"""Time to search one uniform rod under pulls, divided by the number of boxes from which the covering starts,
in ms: 0.07 to 0.15 for twelve rods with 98 to 2900 boxes."""
EXTRA_MS_FOR_PULL_BEYOND_SHEAR_STIFFNESS = 100.0
"""Further time to search one rod from a pull beyond its shear stiffness, in ms: 110 ms were measured for six
rods with k2 = 100."""
ARM_MS_PER_LARGEST_PULL = 0.6
"""Time to search an arm that is not uniform under pulls, divided by the largest pull in k3/L^2, in ms: 0.5 to
0.7 for a cone under pulls of 100 and 1000."""
MAX_UNRESOLVED_SEARCH_SECONDS = 30.0
"""Largest time of a search that no mesh resolves, in s: 0.07 to 30 s were measured for six arms and rods."""
UNDERESTIMATED_ROWS_TEXT = "rows that begin at a pull beyond the shear stiffness"
"""Kind of rows whose time is not estimated reliably: of fourteen rods under pulls F < -k2 nu some took ten
times as long as a rod under half or twice the pull."""


def pulled_rows_seconds_and_doubt(rods: Sequence[Rod], F_values: Array, row_count: int) -> tuple[float, str]:
    """Returns (time in s to search all rows below F = 0, underestimated rows). underestimated rows: kind of
    rows whose time may be many times as long; empty if there are none. rods: rods of evenly spaced rows, with
    any F. F_values: increasing forces along a row, (n,). row_count: number of rows."""
    pulls = F_values[F_values < 0]
    if not pulls.size or not rods:
        return 0.0, ""
    # The diagram itself begins a row at the first pull with a bound on its eigenvalues.
    starts = [_largest_searchable_pull(rod, pulls) for rod in rods]
    seconds_of_rows = [_pulled_row_seconds(rod, start) for rod, start in zip(rods, starts, strict=True)]
    # Beyond the shear stiffness g = nu + F c2 is negative somewhere along the arm.
    arms = (sampled_arm(rod.with_values(F=start)) for rod, start in zip(rods, starts, strict=True))
    is_beyond_shear_stiffness = any(float(np.min(arm.local_coefficients.g)) < 0 for arm in arms)
    return row_count * float(
        np.mean(seconds_of_rows)
    ), UNDERESTIMATED_ROWS_TEXT if is_beyond_shear_stiffness else ""


def _largest_searchable_pull(rod: Rod, pulls: Array) -> float:
    """Strongest of the `pulls` (increasing forces F < 0) from which a row of a phase diagram can be searched;
    0 if there is none. For arms that are not uniform, whose searchable pulls are not known in advance, the
    strongest pull."""
    if not rod.is_uniform_and_linear:
        return float(pulls[0])
    low = 0
    high = len(pulls)
    while low < high:  # the search itself bisects too
        middle = (low + high) // 2
        if _boxes_from_pull_to_zero(rod, float(pulls[middle])) is None:
            low = middle + 1
        else:
            high = middle
    return float(pulls[low]) if low < len(pulls) else 0.0


def _pulled_row_seconds(rod: Rod, start_pull: float) -> float:
    """Time to search one rod for crossings from the pull F = `start_pull` < 0 to F = 0, in s."""
    if not rod.is_uniform_and_linear:
        # No search lasts longer, because it gives up on rods that no mesh resolves.
        return min(1e-3 * ARM_MS_PER_LARGEST_PULL * -start_pull, MAX_UNRESOLVED_SEARCH_SECONDS)
    boxes = _boxes_from_pull_to_zero(rod, start_pull)
    covering_ms = COVERING_MS_PER_BOX * (0 if boxes is None else len(boxes))
    drive = start_pull * rod.with_values(F=start_pull).g
    exchanges_ms = (
        EXTRA_MS_FOR_PULL_BEYOND_SHEAR_STIFFNESS + SOFT_SEARCH_MS_PER_F2_OVER_K2 * drive if drive > 0 else 0.0
    )
    return 1e-3 * covering_ms + min(1e-3 * exchanges_ms, MAX_UNRESOLVED_SEARCH_SECONDS)


def _boxes_from_pull_to_zero(rod: Rod, pull: float) -> Array | None:
    """First boxes of the covering from F = `pull` to F = 0, (n, 4), rows as `CrossingBox`; None unless `pull`
    < 0 and an a-priori bound applies."""
    # Imported for rows under pulls only: these modules load the compiler.
    from ..determinant.certificate.first_crossing_boxes import first_crossing_boxes
    from ..determinant.parameter_path import ParameterPath

    return first_crossing_boxes(ParameterPath(rod.with_values(F=pull), "F"), pull, 0.0) if pull < 0 else None
