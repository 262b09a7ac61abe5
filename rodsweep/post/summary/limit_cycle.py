"""What `rodsweep show` says of limit cycles: their period and size, and how far they can be relied on."""

from collections.abc import Mapping

import numpy as np

from ...results.file.view import View
from ...results.layouts.limit_cycle import SECOND_STATES
from ..hopf_points import ParameterLine
from .ranges import span, to_error
from .stability import stability_lines


def limit_cycle_summary(view: View, done: np.ndarray) -> list[str]:
    """The task's lines about the points that are `done`, a mask of the points' shape."""
    v = view.variables
    status = v["status"][done]
    counts = [f"{int((status == value).sum())} {word}" for value, word in view.flags.items() if value >= 0]
    lines = [f"of {status.size} points: {', '.join(counts)}"]
    rate, frequency = v["linear_growth_rate"][done], v["linear_frequency"][done]
    lines.append(f"straight rod: leading growth rate {span(rate)}, frequency {span(frequency)}")
    lines += stability_lines(view, ParameterLine.hopf_points)
    values = {word: value for value, word in view.flags.items()}
    on_torus = done & (v["status"] == values.get("torus"))
    if on_torus.any():
        lines.append(
            f"tori: the cycles that they surround have multipliers {span(v['multiplier'][on_torus])}"
        )
    beats = done & (v["status"] == values.get("cycle"))
    orbit = done & np.isin(v["status"], [values[word] for word in ("cycle", "unstable") if word in values])
    if done.size == 1 and orbit.any():
        lines += orbit_lines(v, stable=bool(beats.any()))
    lines += _second_state_lines(v, done)
    return [*lines, *_cycle_lines(v, beats)] if beats.any() else lines


def orbit_lines(v: Mapping[str, np.ndarray], stable: bool) -> list[str]:
    """The numbers of the one cycle of a file to their errors, and whether it is stable.

    v: the variables of the file, each of a shape that begins with (1, 1, 1, 1, 1) or, in a list, (1,).
    """
    period, y = float(v["period"].max()), float(v["tip_y_max"].max())
    multiplier = to_error(v["multiplier"].max(), v["multiplier_error"].max())
    verdict = "stable: all others are below 1" if stable else "unstable: it is above 1"
    return [
        f"period: {to_error(period, period * v['period_error'].max())} tau2",
        f"largest y of the tip: {to_error(y, y * v['amplitude_error'].max())} L",
        f"largest Floquet multiplier but the one that is 1: {multiplier}; the cycle is {verdict}",
    ]


def _second_state_lines(v: Mapping[str, np.ndarray], done: np.ndarray) -> list[str]:
    """How many of the points that are `done` have another stable state, or may have one, and where."""
    numbers, lines = {word: number for number, word in SECOND_STATES}, []
    straight, cycle = (done & (v["second_state"] == numbers[word]) for word in ("straight", "cycle_possible"))
    if straight.any():
        lines.append(f"two states{_at(straight, done)}: the straight rod is stable too")
    if cycle.any():
        F = v["subcritical_F"][cycle]
        place = f"{F[0]:.9g}" if F.min() == F.max() else span(F)
        lines.append(
            f"a second state is possible{_at(cycle, done)}: the rod is straight, and its Hopf point at "
            f"F = {place} is subcritical, so that a larger start may lead to a cycle; the task branch "
            "follows it"
        )
    return lines


def _at(some: np.ndarray, done: np.ndarray) -> str:
    """At how many of the points that are `done`, masks of one shape; nothing where that is one."""
    return "" if done.sum() == 1 else f" at {int(some.sum())} of {int(done.sum())} points"


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
