"""What `rodsweep show` says of limit cycles: their period and size, and how far they can be relied on."""

from collections.abc import Mapping

import numpy as np

from ...results.file.view import View
from ..hopf_points import HopfPoint, lines_over
from .ranges import span

FEW_LINES = 3
"""Lines over F whose Hopf points are named one by one."""
STABILITY_CHANGES = {
    True: "F** (straight rod starts to beat)",
    False: "restabilization (straight rod is stable again)",
}
"""What a Hopf point is called above which the rod is unstable, and one above which it is stable."""


def limit_cycle_summary(view: View, done: np.ndarray) -> list[str]:
    """The task's lines about the points that are `done`, a mask of the points' shape."""
    v = view.variables
    status = v["status"][done]
    counts = [f"{int((status == value).sum())} {word}" for value, word in view.flags.items() if value >= 0]
    lines = [f"of {status.size} points: {', '.join(counts)}"]
    rate, frequency = v["linear_growth_rate"][done], v["linear_frequency"][done]
    lines.append(f"straight rod: leading growth rate {span(rate)}, frequency {span(frequency)}")
    lines += stability_lines(view)
    values = {word: value for value, word in view.flags.items()}
    on_torus = done & (v["status"] == values.get("torus"))
    if on_torus.any():
        lines.append(
            f"tori: the cycles that they surround have multipliers {span(v['multiplier'][on_torus])}"
        )
    beats = done & (v["status"] == values.get("cycle"))
    return [*lines, *_cycle_lines(v, beats)] if beats.any() else lines


def stability_lines(view: View) -> list[str]:
    """Where the straight rod changes its stability along F, one line a kind; none where F is no axis."""
    if len(np.unique(view.point_columns["F"])) < 2:
        return []
    lines = list(lines_over(view, "F"))
    varied = [n for n in lines[0].parameters if len({line.parameters[n] for line in lines}) > 1]
    along = [line.hopf_points(view) for line in lines]
    texts = []
    for kind, words in STABILITY_CHANGES.items():
        of_kind = [[point for point in points if point.destabilises == kind] for points in along]
        found = {i: points for i, points in enumerate(of_kind) if points}
        if found:
            names = [", ".join(f"{name} = {line.parameters[name]:.6g}" for name in varied) for line in lines]
            texts.append(f"{words}: {_positions(found, names)}")
    return texts


def _positions(found: Mapping[int, list[HopfPoint]], names: list[str]) -> str:
    """The Hopf points on those of the named lines that have any: one by one where few, else their range."""
    points = [point for line in found.values() for point in line]
    error = f" (+- {max(point.error for point in points):.0e})"
    some = f", on {len(found)} of {len(names)} lines over F" if len(found) < len(names) else ""
    if all(point.agrees(points[0]) for point in points):
        return points[0].text + error + some
    if len(found) > FEW_LINES:
        first, *_, last = sorted(points, key=lambda point: point.position)
        return f"{first.text} to {last.text}{error}{some}"
    each = (" for ".join(filter(None, (" and ".join(p.text for p in found[i]), names[i]))) for i in found)
    return f"{', '.join(each)}{error}"


def _cycle_lines(v: Mapping[str, np.ndarray], beats: np.ndarray) -> list[str]:
    """Ranges over the points that end in a cycle, and the worst of their errors."""
    period = f"period: {span(v['period'][beats])} tau2"
    if "period_tau1" in v:
        period += f", {span(v['period_tau1'][beats])} tau1"
    ratio = v["frequency"][beats] / v["linear_frequency"][beats]
    return [
        f"{period}; frequency over the linear one: {span(ratio)}",
        f"tip: largest y {span(v['tip_y_max'][beats])} L, theta {span(v['tip_theta_max'][beats])} rad",
        f"tip: least x {span(v['tip_x_min'][beats])} L, largest x {span(v['tip_x_max'][beats])} L",
        f"energy injected: {span(v['injection_mean'][beats])} k3/(L tau2)",
        f"multiplier: {span(v['multiplier'][beats])}; returns waited for: "
        f"{span(v['periods'][beats].astype(float))}; least stretch: {span(v['least_stretch'][beats])}",
        f"worst relative errors: period {_worst(v['period_error'][beats])}, amplitude "
        f"{_worst(v['amplitude_error'][beats])}, other extrema "
        f"{_worst(v['extrema_error'][beats])}, energy balance {_worst(v['energy_imbalance'][beats])}, "
        f"multiplier {_worst(v['multiplier_error'][beats])}",
    ]


def _worst(values: np.ndarray) -> str:
    """The largest modulus of the finite values."""
    finite = np.abs(values[np.isfinite(values)])
    return f"{finite.max():.1e}" if finite.size else "not known"
