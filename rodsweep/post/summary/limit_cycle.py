"""What `rodsweep show` says of limit cycles: where the rod beats, how, and how far that can be relied on."""

from collections.abc import Callable, Mapping

import numpy as np

from ...model.parameters import LINEAR_PARAMETERS
from ...results.file.view import View
from ...results.layouts.limit_cycle import SECOND_STATES
from ...wording import counted, some_of
from ..hopf_points import StoredChanges
from .arm.arm import region_of_arms
from .errors import span_of
from .ranges import error_text, span, to_error
from .stability import stability_lines
from .told import Told, in_brackets, region, varied

OUTCOMES = {"cycle": "beats", "straight": "stays straight"}
"""How a point that ended so is called; the other statuses speak for themselves."""


def limit_cycle_summary(view: View, done: np.ndarray) -> Told:
    """The task's sentences about the points that are `done`, a mask of the points' shape."""
    v = view.variables
    values = {word: value for value, word in view.flags.items()}
    beats = done & (v["status"] == values.get("cycle"))
    orbit = done & np.isin(v["status"], [values[word] for word in ("cycle", "unstable") if word in values])
    stability, of_arm = _stability(view)
    answer = [outcome_line(view, done, region), *stability, *_second_state_lines(v, done)]
    if view.quantities and done.size > 1 and not beats[done].all():
        of_arm.insert(0, outcome_line(view, done, region_of_arms))
    trust, details = _proof_lines(v), [_straight_line(v, done)]
    on_torus = done & (v["status"] == values.get("torus"))
    if on_torus.any():
        multipliers = span_of(v, "multiplier", on_torus)
        details.append(f"tori: the cycles that they surround have multipliers {multipliers}")
    if done.size == 1 and orbit.any():
        answer[1:1] = orbit_lines(v, stable=bool(beats.any()))
    elif beats.any():
        answer[1:1] = _size_lines(v, beats)
        trust.insert(0, _error_line(v, beats))
    return Told(answer, trust, [*details, *(_cycle_lines(v, beats) if beats.any() else [])], of_arm)


def outcome_line(view: View, done: np.ndarray, region: Callable[[View, np.ndarray], str]) -> str:
    """What became of how many points, and where these lie.

    done: a mask of the points' shape; region: says where the points of such a mask lie.
    """
    status, whole = view.variables["status"], counted(int(done.sum()), "point")
    masks = {word: done & (status == value) for value, word in view.flags.items() if value >= 0}
    there = {OUTCOMES.get(word, word.replace("_", " ")): mask for word, mask in masks.items() if mask.any()}
    if len(there) == 1:
        word = next(iter(there))
        alone = done.size == 1 and word in OUTCOMES.values()
        return f"the rod {word}" if alone else f"{word} at all {whole}"
    told = (f"{word} at {int(mask.sum())}{in_brackets(region(view, mask))}" for word, mask in there.items())
    return f"of {whole}: {', '.join(told)}"


def _stability(view: View) -> tuple[list[str], list[str]]:
    """Where the straight rod changes along F, or along the other parameters where F is no axis.

    Then the same of an arm along F, in its own units.
    """
    names = [name for name in LINEAR_PARAMETERS if name in varied(view)]
    lines, of_arm = list[str](), list[str]()
    for name in names[:1] if "F" in names else names:
        found = stability_lines(view, name, StoredChanges(view, name).up_to)
        lines, of_arm = [*lines, *found[0]], [*of_arm, *found[1]]
    return lines, of_arm


def _proof_lines(v: Mapping[str, np.ndarray]) -> list[str]:
    """Whether it is proved that no Hopf point is missing; none where no line was searched."""
    lines = int(v["hopf_lines"]) if "hopf_lines" in v else 0
    if not lines:
        return []
    proved = some_of(int(v["hopf_lines_proved"]), lines, "line")
    return [f"that no Hopf point is missing between the points is proved on {proved}"]


def _straight_line(v: Mapping[str, np.ndarray], done: np.ndarray) -> str:
    """The leading eigenvalue of the straight rods."""
    rate, frequency = (span_of(v, f"linear_{name}", done) for name in ("growth_rate", "frequency"))
    return f"straight rod: leading growth rate {rate} 1/tau2, frequency {frequency} rad/tau2"


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
        lines.append(
            f"a second state is possible{_at(cycle, done)}: the rod is straight, and its Hopf point at "
            f"F = {span(v['subcritical_F'][cycle])} is subcritical, so that a larger start may lead to a "
            "cycle; the task branch follows it"
        )
    return lines


def _at(some: np.ndarray, done: np.ndarray) -> str:
    """At how many of the points that are `done`, masks of one shape; nothing where that is one."""
    return "" if done.sum() == 1 else f" at {some_of(some.sum(), done.sum(), 'point')}"


def _size_lines(v: Mapping[str, np.ndarray], beats: np.ndarray) -> list[str]:
    """The period and the size of the cycles of several points."""
    period, y = (span_of(v, name, beats) for name in ("period", "tip_y_max"))
    return [f"period: {period} tau2; largest y of the tip: {y} L"]


def _cycle_lines(v: Mapping[str, np.ndarray], beats: np.ndarray) -> list[str]:
    """What else is known of the cycles, over the points that end in one."""
    ratio = v["frequency"][beats] / v["linear_frequency"][beats]
    tips = (
        f"{what} {span_of(v, f'tip_{name}', beats)} {unit}"
        for what, name, unit in (
            ("least x", "x_min", "L"), ("largest x", "x_max", "L"), ("largest theta", "theta_max", "rad"),
        )
    )  # fmt: skip
    lines = [f"frequency {span_of(v, 'frequency', beats)} rad/tau2, "
             f"over that of the leading mode {span(ratio, ratio * v['period_error'][beats])}"]  # fmt: skip
    if "period_tau1" in v:
        lines.append(f"period: {span_of(v, 'period_tau1', beats)} tau1")
    return [
        *lines,
        f"tip: {', '.join(tips)}",
        f"power of the force, mean: {span_of(v, 'injection_mean', beats)} k3/(L tau2)",
        f"multiplier: {span_of(v, 'multiplier', beats)}; returns waited for: "
        f"{span(v['periods'][beats])}; least stretch: {span_of(v, 'least_stretch', beats)}",
    ]


def _error_line(v: Mapping[str, np.ndarray], beats: np.ndarray) -> str:
    """The worst errors of the cycles."""
    names = {
        "period": "period_error",
        "amplitude": "amplitude_error",
        "other extrema": "extrema_error",
        "energy balance": "energy_imbalance",
        "multiplier": "multiplier_error",
    }
    told = (f"{word} {_worst(v[name][beats])}" for word, name in names.items())
    return f"worst errors: {', '.join(told)}; that of multipliers is absolute, the others are relative"


def _worst(values: np.ndarray) -> str:
    """The largest modulus of the finite values."""
    finite = np.abs(values[np.isfinite(values)])
    return error_text(float(finite.max())) if finite.size else "not known"
