"""What `rodsweep show` says of the forces at which the straight rod becomes unstable, or stable again."""

from collections.abc import Callable, Mapping

import numpy as np

from ...results.file.view import View
from ..hopf_points import HopfPoint, ParameterLine, lines_over

FEW_LINES = 3
"""Lines over F whose Hopf points are named one by one."""
STABILITY_CHANGES = {
    True: "F** (straight rod starts to beat)",
    False: "restabilization (straight rod is stable again)",
}
"""What a Hopf point is called above which the rod is unstable, and one above which it is stable."""


def stability_lines(view: View, found_on: Callable[[ParameterLine, View], list[HopfPoint]]) -> list[str]:
    """Where the straight rod changes its stability along F, one line a kind; none where F is no axis.

    found_on: gives the Hopf points on a line over F.
    """
    if len(np.unique(view.point_columns["F"])) < 2:
        return []
    lines = list(lines_over(view, "F"))
    varied = [n for n in lines[0].parameters if len({line.parameters[n] for line in lines}) > 1]
    names = [", ".join(f"{name} = {line.parameters[name]:.6g}" for name in varied) for line in lines]
    along = [found_on(line, view) for line in lines]
    texts = []
    for kind, words in STABILITY_CHANGES.items():
        of_kind = [[point for point in points if point.destabilises == kind] for points in along]
        if found := {i: points for i, points in enumerate(of_kind) if points}:
            texts.append(f"{words}: {_positions(found, names)}")
    return texts


def _positions(found: Mapping[int, list[HopfPoint]], names: list[str]) -> str:
    """The Hopf points on those of the named lines that have any: one by one where few, else their range."""
    points = [point for line in found.values() for point in line]
    error = f" (+- {max(point.error for point in points):.0e})"
    some = f", on {len(found)} of {len(names)} lines over F" if len(found) < len(names) else ""
    if all(point.agrees(points[0]) for point in points):
        frequency = points[0].frequency
        beats = f", frequency {frequency:.6g} 1/tau2" if np.isfinite(frequency) else ""
        return points[0].text + error + some + beats
    if len(found) > FEW_LINES:
        first, *_, last = sorted(points, key=lambda point: point.position)
        return f"{first.text} to {last.text}{error}{some}"
    each = (" for ".join(filter(None, (" and ".join(p.text for p in found[i]), names[i]))) for i in found)
    return f"{', '.join(each)}{error}"
