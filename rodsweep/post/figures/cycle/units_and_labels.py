"""Units and axis labels in figures of cycles: dimensionless units of the paper, or SI units for an arm."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....arrays import Array
from ....model.units import value_in_unit, with_si_prefix
from ....results.file.view import ResultView
from ...tables.rows_and_columns import arm_quantities_at_points
from ..arm.quantities import NO_BREAK_SPACE

LENGTH_VARIABLE_NAMES = ("shape_x", "shape_y", "tip_x", "tip_y", "transient_x", "transient_y")
"""Names of variables that are lengths, with values over a period, along a shape, or over a transient."""
CYCLE_LENGTH_VARIABLE_NAMES = ("tip_x_min", "tip_x_max", "tip_y_max")
"""Names of variables that are lengths, with one value for each cycle."""
TIME_VARIABLE_NAMES = ("period", "transient_time")
"""Names of variables that are times."""
ENERGY_VARIABLE_NAMES = ("energy",)
"""Names of variables that are energies."""
POWER_VARIABLE_NAMES = ("injection", "dissipation", "injection_mean", "dissipation_mean")
"""Names of variables that are powers."""
MAX_PREFIXED_TIME_IN_SECONDS = 0.1
"""If the longest period is below this value, in s, times have a prefix such as ms."""
NumberOrArray = Any
"""A number, or an array with a number for each point, (points,)."""
SI_UNITS_OF_SCALES = ("m", "s", "J", "W")
"""SI units of length, time, energy and power."""
QUANTITIES_REQUIRED_FOR_UNITS = ("length", "tau2", "force_scale")
"""Quantities of an arm from which the units of a figure are computed."""


@dataclass(frozen=True, slots=True)
class CycleUnits:
    """Units of a figure of cycles; by default dimensionless.

    length, time, energy, power: the scales L, tau2, k3/L and k3/(L tau2) in the units of the figure, as
    numbers, or as arrays, (points,), for several points.
    """

    length: NumberOrArray = 1.0
    time: NumberOrArray = 1.0
    energy: NumberOrArray = 1.0
    power: NumberOrArray = 1.0
    in_si: bool = False
    """Whether the units are SI units, with prefixes."""
    names: tuple[str, str, str, str] = ("L", r"$\tau_2$", "", "")
    """Names of the units of length, time, energy and power, as TeX."""

    def axis_label(self, axis: str) -> str:
        """Label, with the unit, of an axis for a coordinate. axis: "x" or "y"."""
        return f"${axis}$ ({self.names[0]})" if self.in_si else f"${axis}/L$"

    @property
    def time_label(self) -> str:
        """Label of a time axis, with the unit."""
        return f"time $t$ ({self.names[1]})" if self.in_si else r"time $t/\tau_2$"

    @property
    def panel_labels(self) -> tuple[str, str, str, str]:
        """Labels of the panels with a parameter as abscissa: (x_max - x_min)/2 and y_max of the tip, period,
        power."""
        if self.in_si:
            length, time, _, power = self.names
            tip = rf"tip $(x_{{\max}} - x_{{\min}})/2$ ({length})", rf"tip $y_{{\max}}$ ({length})"
            return *tip, f"period $T$ ({time})", f"mean power ({power})"
        tip = r"tip $(x_{\max} - x_{\min})/2L$", r"tip $y_{\max}/L$"
        return *tip, r"period $T/\tau_2$", r"mean power $\times\,L\tau_2/k_3$"

    @property
    def energy_and_power_labels(self) -> tuple[str, str, str]:
        """Labels of the panels with energy, power, and rate of change of energy."""
        if self.in_si:
            _, _, energy, power = self.names
            return f"energy $U$\n({energy})", f"power\n({power})", rf"$\dot U$ ({power})"
        return "energy\n$U L/k_3$", "power\n" r"$\times\, L\tau_2/k_3$", r"$\dot U L\tau_2/k_3$"

    @property
    def power_unit_per_energy_rate(self) -> float:
        """The quotient (unit of energy)/(unit of time) of the figure, expressed in the figure's unit of
        power."""
        return self.power * self.time / self.energy

    def time_text(self, time: float) -> str:
        """A time with its unit as text, such as `53.91 s`; only for SI units."""
        return f"{time:.4g}{NO_BREAK_SPACE}{self.names[1]}"

    def converted(self, values: dict[str, Array]) -> dict[str, Array]:
        """The variables `values` of a point, of any shape, by name, converted to these units."""
        factors: dict[str, NumberOrArray] = (
            dict.fromkeys((*LENGTH_VARIABLE_NAMES, *CYCLE_LENGTH_VARIABLE_NAMES), self.length)
            | dict.fromkeys(TIME_VARIABLE_NAMES, self.time)
            | dict.fromkeys(ENERGY_VARIABLE_NAMES, self.energy)
            | dict.fromkeys(POWER_VARIABLE_NAMES, self.power)
        )
        return {name: value * factors[name] if name in factors else value for name, value in values.items()}


DIMENSIONLESS_UNITS = CycleUnits()
"""Dimensionless units of the paper."""


def units_at_points(view: ResultView, numbers: Sequence[int]) -> list[CycleUnits]:
    """Units at each point, with equal names of the units at all points; dimensionless if the file has no arm.
    numbers: numbers of the points, from 1."""
    (units,) = units_of_files([view], [np.array(numbers, int) - 1])
    if not units.in_si:
        return [units] * len(numbers)
    scales = zip(units.length, units.time, units.energy, units.power, strict=True)
    return [
        CycleUnits(float(length), float(time), float(energy), float(power), True, units.names)
        for length, time, energy, power in scales
    ]


def units_of_files(views: Sequence[ResultView], indices: Sequence[NDArray[np.int64]]) -> list[CycleUnits]:
    """Units for the points of each file, with factors of shape (n,); dimensionless if a file has no arm.
    indices: indices of the points of each file, (n,)."""
    if not all(name in view.quantities for view in views for name in QUANTITIES_REQUIRED_FOR_UNITS):
        return [DIMENSIONLESS_UNITS] * len(views)
    scales = []
    for view, chosen in zip(views, indices, strict=True):
        L, tau2, force = (
            arm_quantities_at_points(view)[name][chosen] for name in QUANTITIES_REQUIRED_FOR_UNITS
        )
        scales.append((L, tau2, force * L, force * L / tau2))
    of_files = list(zip(views, indices, scales, strict=True))
    period = max(
        _largest_absolute_in_units(view, "period", chosen, scale[1]) for view, chosen, scale in of_files
    )
    mean_power = max(
        _largest_absolute_in_units(view, "injection_mean", chosen, scale[3])
        for view, chosen, scale in of_files
    )
    largest_energy = max(float(np.nanmax(scale[2])) for scale in scales)
    names = (
        views[0].typed_units.get("length", "m"),
        with_si_prefix(period, "s")[1] if 0 < period < MAX_PREFIXED_TIME_IN_SECONDS else "s",
        with_si_prefix(largest_energy, "J")[1],
        with_si_prefix(mean_power, "W")[1],
    )
    factors = [value_in_unit(1.0, unit, si) for unit, si in zip(names, SI_UNITS_OF_SCALES, strict=True)]
    units = []
    for scale in scales:
        length, time, energy, power = (unit * si for unit, si in zip(factors, scale, strict=True))
        units.append(CycleUnits(length, time, energy, power, in_si=True, names=names))
    return units


def _largest_absolute_in_units(
    view: ResultView, name: str, indices: NDArray[np.int64], factors: Array
) -> float:
    """Maximum of |v| f over the points with the indices `indices`, (n,); 0 if no value is finite. v: variable
    `name`. f: `factors`, (n,)."""
    return float(np.nanmax(np.abs(view.variables[name].ravel()[indices]) * factors, initial=0.0))
