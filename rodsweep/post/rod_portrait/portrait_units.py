"""Units of a portrait: dimensionless for a rod, SI units with prefixes for an arm."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import tau

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from ...model.arm.quantities import LOAD_SCALE_NAME_BY_LOAD
from ...results.file.view import ResultView
from ..figures import style
from ..range_unions import ParameterRange
from ..summary.arm.arm_texts import factor_and_printing_unit
from ..summary.number_texts import parameter_ranges_text, rounded_text

THRESHOLD_SUPERSCRIPTS_AND_WORDS = {"onset": ("*", "onset"), "hopf": ("**", "flutter")}
"""(superscript of the symbol, word) of a threshold, by kind."""
LABELLED_NUMBERS_OF_DECADE = (1.0, 2.0, 5.0)
"""Numbers of each decade that have tick labels on a logarithmic axis in SI units."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Unit:
    """Unit of a portrait. name: symbol of the unit. factor_from_dimensionless: value, in this unit, of a
    quantity whose dimensionless value is 1."""

    name: str
    factor_from_dimensionless: float = 1.0

    def text(self, value: float, error: float) -> str:
        """`value` as text with the unit, rounded according to its absolute error `error`. Both arguments are
        dimensionless and are converted to the unit."""
        factor = self.factor_from_dimensionless
        return f"{rounded_text(factor * value, factor * error)} {self.name}"


@dataclass(frozen=True, slots=True, kw_only=True)
class PortraitUnits:
    """Units of force, length, time and frequency in the portrait of a rod or an arm. load_kind: kind of the
    arm's load; empty for a rod."""

    force: Unit
    length: Unit
    time: Unit
    frequency: Unit
    load_kind: str = ""

    def coordinate_label(self, axis: str) -> str:
        """Label of an axis for a coordinate of shapes. axis: "x" or "y"."""
        return f"${axis}$ ({self.length.name})" if self.load_kind else f"${axis}/L$"

    def load_phrase(self, text: str) -> str:
        """Phrase for the load: "F = 50" for a rod, "a pressure of 400 Pa" for an arm. text: one or more
        loads, as numbers in the unit of the portrait."""
        return f"a {self.load_kind} of {text} {self.force.name}" if self.load_kind else f"F = {text}"

    def load_text(self, F: float, error: float = 0.0) -> str:
        """The load at the dimensionless force F as text, rounded according to the absolute error of F."""
        return self.load_phrase(
            rounded_text(
                self.force.factor_from_dimensionless * F, self.force.factor_from_dimensionless * error
            )
        )

    def load_ranges_text(self, ranges: Sequence[ParameterRange], errors: Mapping[float, float]) -> str:
        """Ranges of the load as text. ranges: ranges of the dimensionless force. errors: absolute errors of
        the ends, by end."""
        factor = self.force.factor_from_dimensionless
        scaled_ranges = [(factor * low, factor * high) for low, high in ranges]
        scaled_errors = {factor * end: factor * error for end, error in errors.items()}
        return self.load_phrase(parameter_ranges_text(scaled_ranges, scaled_errors))

    def frequency_text(self, omega: float) -> str:
        """Angular frequency `omega`, in 1/tau2, as text; for an arm, as a frequency in Hz."""
        return f"{self.frequency.factor_from_dimensionless * omega:.6g} {self.frequency.name}"

    @property
    def panel_axis_labels(self) -> tuple[str, str, str]:
        """Labels of the axes of the load, the largest y of the tip, and the period."""
        if not self.load_kind:
            return style.AXIS_LABELS["F"], "largest $y/L$ of the tip", r"period$/\tau_2$"
        y_label = f"largest $y$ of the tip ({self.length.name})"
        return f"{self.load_kind} ({self.force.name})", y_label, f"period ({self.time.name})"

    def mode_title(self, kind: str, F: float) -> str:
        """Title of the panel of a mode at the threshold F of the given kind."""
        symbol, word = THRESHOLD_SUPERSCRIPTS_AND_WORDS[kind]
        if self.load_kind:
            return f"mode at {word},\n{self.load_title(F)}"
        return rf"mode at ${style.TEX_SYMBOLS['F']}_{{{symbol}}} = {F:.6g}$"

    def load_title(self, F: float) -> str:
        """The load at the dimensionless force F as the title of a panel."""
        text = f"{self.force.factor_from_dimensionless * F:.6g}"
        return f"{text} {self.force.name}" if self.load_kind else rf"${style.TEX_SYMBOLS['F']} = {text}$"


ROD_UNITS = PortraitUnits(
    force=Unit(name=""), length=Unit(name="L"), time=Unit(name="tau2"), frequency=Unit(name="rad/tau2")
)
"""Units of the portrait of a rod; forces are in k3/L^2."""


def portrait_units(view: ResultView, load_kind: str, largest: float) -> PortraitUnits:
    """Units of the portrait of a rod or an arm. load_kind: "force" or "pressure", kind of the load of an arm.
    largest: largest dimensionless force in the portrait, for which the SI prefix of the load is chosen."""
    if not view.quantities:
        return ROD_UNITS
    force, length, tau2 = (
        float(view.quantities[quantity_name].ravel()[0])
        for quantity_name in (LOAD_SCALE_NAME_BY_LOAD[load_kind], "length", "tau2")
    )

    def unit(si: str, scale: float, largest: float) -> Unit:
        factor, name = factor_and_printing_unit(view, si, largest)
        return Unit(name=name, factor_from_dimensionless=scale * factor)

    return PortraitUnits(
        force=unit("N" if load_kind == "force" else "Pa", force, force * largest),
        length=unit("m", length, length),
        time=unit("s", tau2, tau2),
        frequency=Unit(name="Hz", factor_from_dimensionless=1 / (tau * tau2)),
        load_kind=load_kind,
    )


def rescale_panel(axes: Axes, x: float, y: float) -> None:
    """Converts the panel to other units: multiplies the coordinates of all curves and marks by the factors x
    and y, and the horizontal coordinates of all bars and spans by x. Resets the tick labels of a logarithmic
    y axis if y is not 1."""
    for line in axes.lines:
        line.set_data(x * np.asarray(line.get_xdata()), y * np.asarray(line.get_ydata()))
    for area in axes.patches:
        assert isinstance(area, Rectangle)  # a bar or a span along x
        area.set(x=x * area.get_x(), width=x * area.get_width())
    axes.relim()
    axes.autoscale_view()
    if y != 1 and axes.get_yscale() == "log":
        axes.yaxis.set_major_locator(LogLocator(subs=LABELLED_NUMBERS_OF_DECADE))
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axes.yaxis.set_minor_formatter(NullFormatter())
