"""What `rodsweep show` says of limit cycles: their period and size, and how far they can be relied on."""

from collections.abc import Mapping

import numpy as np

from ...results.file.view import View
from .ranges import span


def limit_cycle_summary(view: View, done: np.ndarray) -> list[str]:
    """The task's lines about the points that are `done`, a mask of the points' shape."""
    v = view.variables
    status = v["status"][done]
    counts = [f"{int((status == value).sum())} {word}" for value, word in view.flags.items() if value >= 0]
    lines = [f"of {status.size} points: {', '.join(counts)}"]
    rate, frequency = v["linear_growth_rate"][done], v["linear_frequency"][done]
    lines.append(f"straight rod: leading growth rate {span(rate)}, frequency {span(frequency)}")
    cycle = next((value for value, word in view.flags.items() if word == "cycle"), None)
    beats = done & (v["status"] == cycle)
    return [*lines, *_cycle_lines(v, beats)] if beats.any() else lines


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
        f"{_worst(v['amplitude_error'][beats])}, energy balance {_worst(v['energy_imbalance'][beats])}, "
        f"closure {_worst(v['closure'][beats])}",
    ]


def _worst(values: np.ndarray) -> str:
    """The largest modulus of the finite values."""
    finite = np.abs(values[np.isfinite(values)])
    return f"{finite.max():.1e}" if finite.size else "not known"
