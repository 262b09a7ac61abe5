"""The units in which figures of cycles are drawn: the paper's, or those of an arm in SI."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ....arrays import Array
from ....model.units import compact, written_in
from ....results.file.view import View
from ..arm_quantities import TOGETHER, at_point

LENGTHS = ("shape_x", "shape_y", "tip_x", "tip_y", "transient_x", "transient_y")
LENGTHS_OF_CYCLES = ("tip_x_min", "tip_x_max", "tip_y_max")
TIMES = ("period", "transient_time")
ENERGIES = ("energy",)
POWERS = ("injection", "dissipation", "injection_mean", "dissipation_mean")
SHORT_PERIOD = 0.1
"""Seconds; the time of a faster cycle has a prefix, as ms. One of hours stays in s."""
NEEDED = ("length", "tau2", "force_scale")
"""Quantities of an arm from which its units follow."""


@dataclass(frozen=True, slots=True)
class CycleUnits:
    """What the figure's axes are called, and its units in those of the rod at a point; by default the rod's.

    length: L in the unit of length that is drawn; time: tau2; energy: k3/L; power: k3/(L tau2).
    """

    length: float = 1.0
    time: float = 1.0
    energy: float = 1.0
    power: float = 1.0
    in_si: bool = False
    names: tuple[str, str, str, str] = ("L", r"$\tau_2$", "", "")
    """Units of length, time, energy and power."""

    def along(self, axis: str) -> str:
        """The label of a length along x or y."""
        return f"${axis}$ ({self.names[0]})" if self.in_si else f"${axis}/L$"

    @property
    def time_label(self) -> str:
        """The label of the time."""
        return f"time $t$ ({self.names[1]})" if self.in_si else r"time $t/\tau_2$"

    @property
    def budget_labels(self) -> tuple[str, str, str]:
        """The labels of energy, power, and the rate of the energy."""
        if self.in_si:
            _, _, energy, power = self.names
            return f"energy $U$\n({energy})", f"power\n({power})", rf"$\dot U$ ({power})"
        return "energy\n$U L/k_3$", "power\n" r"$\times\, L\tau_2/k_3$", r"$\dot U L\tau_2/k_3$"

    @property
    def power_of_rate(self) -> float:
        """The unit of energy over that of time, in the unit of power."""
        return self.power * self.time / self.energy

    def told_time(self, time: float) -> str:
        """A time in SI as text: `53.91 s`."""
        return f"{time:.4g}{TOGETHER}{self.names[1]}"

    def drawn(self, values: dict[str, Array]) -> dict[str, Array]:
        """Variables of a point, each of any shape, in these units."""
        factors = (
            dict.fromkeys((*LENGTHS, *LENGTHS_OF_CYCLES), self.length)
            | dict.fromkeys(TIMES, self.time)
            | dict.fromkeys(ENERGIES, self.energy)
            | dict.fromkeys(POWERS, self.power)
        )
        return {name: value * factors[name] if name in factors else value for name, value in values.items()}


PLAIN_UNITS = CycleUnits()


def units_of(view: View, numbers: Sequence[int]) -> list[CycleUnits]:
    """The units at points numbered from 1, with the same names at all; the rod's own where it is no arm."""
    if not all(name in view.quantities for name in NEEDED):
        return [PLAIN_UNITS] * len(numbers)
    lengths, times, forces = (np.array([at_point(view, name, n) for n in numbers]) for name in NEEDED)
    energies, powers = forces * lengths, forces * lengths / times
    period = float(np.nanmax(_at(view, "period", numbers) * times, initial=0.0))
    length = view.typed.get("length", "m")
    second = compact(period, "s")[1] if 0 < period < SHORT_PERIOD else "s"
    mean = np.nanmax(np.abs(_at(view, "injection_mean", numbers)) * powers, initial=0.0)
    watt, joule = compact(float(mean), "W")[1], compact(float(energies.max()), "J")[1]
    names = (length, second, joule, watt)
    drawn = zip(
        written_in(1.0, length, "m") * lengths,
        written_in(1.0, second, "s") * times,
        written_in(1.0, joule, "J") * energies,
        written_in(1.0, watt, "W") * powers,
        strict=True,
    )
    return [CycleUnits(float(a), float(t), float(e), float(p), True, names) for a, t, e, p in drawn]


def _at(view: View, name: str, numbers: Sequence[int]) -> Array:
    """A variable at points numbered from 1, shape (points,)."""
    return np.array([float(view.variables[name].ravel()[number - 1]) for number in numbers])
