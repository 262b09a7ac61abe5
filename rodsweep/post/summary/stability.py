"""What `rodsweep show` says of the forces at which the straight rod becomes unstable, or stable again."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from ...results.file.view import View
from ..hopf_points import HopfPoint, Located, ParameterLine, lines_over
from .arm import threshold_lines_in_si

FEW_LINES = 3
"""Lines over F whose thresholds are named one by one."""
THRESHOLDS = {
    "onset": "F* (straight rod starts to oscillate)",
    "hopf": "F** (straight rod starts to beat)",
    "restabilization": "restabilization (straight rod is stable again)",
}
"""What a threshold is called, by its kind."""


def stability_lines(view: View, found_on: Callable[[ParameterLine, View], Sequence[Located]]) -> list[str]:
    """Where the straight rod changes along F, one line for each kind of threshold; none where F is no axis.

    Of an arm a second line follows, in SI units.

    found_on: gives the thresholds on a line over F.
    """
    if len(np.unique(view.point_columns["F"])) < 2:
        return []
    lines = list(lines_over(view, "F"))
    varied = [n for n in lines[0].parameters if len({line.parameters[n] for line in lines}) > 1]
    names = [", ".join(f"{name} = {line.parameters[name]:.6g}" for name in varied) for line in lines]
    along = [found_on(line, view) for line in lines]
    texts = []
    for kind, words in THRESHOLDS.items():
        of_kind = [[point for point in points if point.kind == kind] for points in along]
        if found := {i: points for i, points in enumerate(of_kind) if points}:
            texts.append(f"{words}: {_positions(found, names)}")
            in_load = [(point, lines[i].at) for i, points in found.items() for point in points]
            texts += threshold_lines_in_si(view, in_load)
    return texts


def _positions(found: Mapping[int, list[Located]], names: list[str]) -> str:
    """The thresholds on those of the named lines that have any: one by one where few, else their range."""
    points = [point for line in found.values() for point in line]
    error = f" (+- {max(point.error for point in points):.0e})"
    some = f", on {len(found)} of {len(names)} lines over F" if len(found) < len(names) else ""
    if all(point.agrees(points[0]) for point in points):
        frequency = points[0].frequency if isinstance(points[0], HopfPoint) else np.nan
        beats = f", frequency {frequency:.6g} 1/tau2" if np.isfinite(frequency) else ""
        return points[0].text + error + some + beats
    if len(found) > FEW_LINES:
        first, *_, last = sorted(points, key=lambda point: point.position)
        return f"{first.text} to {last.text}{error}{some}"
    each = (" for ".join(filter(None, (" and ".join(p.text for p in found[i]), names[i]))) for i in found)
    return f"{', '.join(each)}{error}"
