"""Energy of the beating arm over a period: injected power, dissipated power, and elastic energy."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from ....results.file.view import ResultView
from ...summary.number_texts import rounded_text
from ...summary.variable_errors import relative_power_error
from ..arm.quantities import NO_BREAK_SPACE
from ..style import BLUE, GREEN, VERMILION, draw_shared_legend, text_colour
from .selection import ENERGY_BUDGET_VARIABLE_NAMES, StoredCycle, chosen_cycles, rounded_number_in_tex

ENERGY_RATE_MARK_COUNT = 24
"""Number of times at which marks of dU/dt are drawn over the curve of injection minus dissipation."""


def draw_energy(view: ResultView, points: Sequence[int], is_narrow: bool = False) -> tuple[Figure, str]:
    """Returns (figure, description). The figure has a column of panels for each cycle: energy U; injection
    and dissipation; injection minus dissipation with marks of dU/dt.

    The marks are derivatives of the stored energy U, computed independently of the curve, and must lie on the
    curve. is_narrow: whether the legend has at most two columns.
    """
    selection = chosen_cycles(view, points, ENERGY_BUDGET_VARIABLE_NAMES)
    cycles = selection.cycles
    figure = Figure(figsize=(3.6 * len(cycles) + 1.0, 6.4), layout="constrained")
    heights = (1, 1.6, 1)
    panel_rows = figure.subplots(
        3, len(cycles), squeeze=False, sharex="col", sharey="row", height_ratios=heights
    )
    for panels, cycle in zip(panel_rows.T, cycles, strict=True):
        _draw_budget(panels, cycle)
        panels[0].set_title(cycle.heading(cycle.period_text, *_power_and_energy_imbalance_texts(cycle)))
    panel_rows[1, 0].set_ylim(bottom=min(0.0, panel_rows[1, 0].get_ylim()[0]))
    for axes, label in zip(panel_rows[:, 0], cycles[0].units.energy_and_power_labels, strict=True):
        axes.set_ylabel(label)
    draw_shared_legend(figure, column_count=2 if is_narrow else min(3, 1 + len(cycles)))
    figure.align_ylabels(panel_rows[:, 0])
    figure.suptitle(selection.title)
    return figure, "energy, injection and dissipation over a cycle" + selection.omissions_clause


def _power_and_energy_imbalance_texts(cycle: StoredCycle) -> tuple[str, str]:
    """Returns (mean power of the force, relative energy imbalance) as text, the power in the unit of the
    panels, rounded according to its error."""
    cycle_values = {name: float(cycle.values[name]) for name in ("injection_mean", "energy_imbalance")}
    error = relative_power_error(cycle.values)
    mean_text = rounded_number_in_tex(
        rounded_text(cycle_values["injection_mean"], abs(cycle_values["injection_mean"]) * float(error))
    )
    unit = cycle.units.names[3]
    power = f"mean power ${mean_text}$" + (f"{NO_BREAK_SPACE}{unit}" if unit else "")
    return power, f"imbalance {cycle_values['energy_imbalance']:.1e}"


def _draw_budget(panels: Sequence[Axes], cycle: StoredCycle) -> None:
    """Draws the three panels of a cycle over a period, from top to bottom: energy; injection and dissipation;
    injection minus dissipation, with marks of the derivative of the energy."""
    from ....discretization.elements.trigonometric import (  # compiled code
        interpolate_samples,
        time_derivative,
    )

    top, middle, bottom = panels
    phase = np.linspace(0, 1, 401, dtype=np.float64)
    time = phase * cycle.period
    budget_samples = (cycle.values[name] for name in ENERGY_BUDGET_VARIABLE_NAMES)
    energy, injection, dissipation = (interpolate_samples(values, phase) for values in budget_samples)
    top.plot(time, energy, color=text_colour(), lw=1.5)
    mean_power = float(cycle.values["injection_mean"])
    middle.axhline(mean_power, color="0.6", lw=0.9, ls=":", label="mean injection", zorder=1)
    middle.plot(time, injection, color=VERMILION, lw=1.5, label="injection")
    middle.plot(time, dissipation, color=BLUE, lw=1.5, ls="--", label="dissipation")
    bottom.axhline(0, color="0.8", lw=0.6, zorder=0)
    bottom.plot(time, injection - dissipation, color=GREEN, lw=1.5, label=r"injection $-$ dissipation")
    marks = np.arange(ENERGY_RATE_MARK_COUNT) / ENERGY_RATE_MARK_COUNT
    rate = interpolate_samples(time_derivative(cycle.values["energy"]), marks) / cycle.period
    rate = rate * cycle.units.power_unit_per_energy_rate
    bottom.plot(
        marks * cycle.period, rate, "o", color=text_colour(), mfc="none", ms=3.5, label="derivative of $U$"
    )
    bottom.set_xlabel(cycle.units.time_label)
    bottom.set_xlim(0, cycle.period)
    bottom.xaxis.set_major_locator(MaxNLocator(4, steps=[1, 2, 5, 10]))
