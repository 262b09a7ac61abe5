"""Scales of the sliders (unit, range, linear or logarithmic), and axes of the pictures."""

from dataclasses import dataclass
from math import inf, isfinite, isnan, log10
from typing import NamedTuple

from ..errors import InputError
from ..model.arm.quantities import GIVEN_QUANTITIES
from ..model.parameters import PARAMETERS
from ..model.units import quantity_in_si
from ..post.summary.arm.arm_texts import printed_quantity_name
from .page_state import PageState, dimensionless_parameters_of, float_or_text


@dataclass(frozen=True, kw_only=True)
class SliderScale:
    """Scale of the slider for one parameter of a rod, or one quantity of an arm, with the name `name`.

    low, high: values at the ends of the slider, in `unit`.
    """

    name: str
    label: str
    """Text above the slider, with the unit."""
    low: float
    high: float
    is_logarithmic: bool = True
    """Whether the slider is logarithmic."""
    unit: str = ""
    """Unit of an arm's quantity; empty for a rod's parameter, which is dimensionless."""
    factor_from_si: float = 1.0
    """Factor that converts a value from SI units to `unit`."""
    is_upper_end_inf: bool = False
    """Whether the upper end of the slider means inf instead of `high`."""

    def text(self, value: float) -> str:
        """`value`, a number in `unit`, as text with the unit."""
        written = f"{value:.5g}"
        return f"{written} {self.unit}" if self.unit else written

    def value(self, text: str) -> float | None:
        """Value, in `unit`, of a text that the user typed, such as "10 cm"; None for an invalid text."""
        try:
            if self.unit:
                quantity = GIVEN_QUANTITIES[self.name]
                return quantity_in_si(self.name, text, quantity.unit, quantity.example) * self.factor_from_si
            number = float_or_text(text)
        except InputError:
            return None
        return number if isinstance(number, float) else None

    @property
    def end_positions(self) -> tuple[float, float]:
        """Slider positions of the two ends: `low` and `high`, or their common logarithms for a logarithmic
        slider."""
        return (log10(self.low), log10(self.high)) if self.is_logarithmic else (self.low, self.high)

    def position(self, text: str) -> float | None:
        """Slider position for a text that the user typed, clipped to the ends; None if the text is invalid or
        NaN."""
        value = self.value(text)
        start, end = self.end_positions
        if value is None or isnan(value):
            return None
        if value == inf:
            return end
        if self.is_logarithmic:
            value = log10(value) if value > 0 else start
        return min(max(value, start), end)

    def text_at(self, position: float) -> str:
        """Value at a slider position, as text."""
        if self.is_upper_end_inf and position >= self.end_positions[1]:
            return "inf"
        value = 10**position if self.is_logarithmic else position
        assert isfinite(value)
        return self.text(value)


class PictureAxis(NamedTuple):
    """Axis of a picture. label: text with the unit; for a length, only the unit. factor_from_dimensionless:
    value, in this unit, of a quantity whose dimensionless value is 1."""

    label: str
    factor_from_dimensionless: float


def load_axis(state: PageState) -> PictureAxis:
    """Axis of the load: the force F for a rod, the pressure in kPa for an arm."""
    if state.tab == "rod":
        return PictureAxis("force F (k3/L^2)", 1.0)
    arm = state.with_values(pressure="1 kPa").rod_or_arm()
    return PictureAxis("pressure (kPa)", 1 / dimensionless_parameters_of(arm)["F"])


def length_axis(state: PageState) -> PictureAxis:
    """Axis of a length: in units of L for a rod, in cm for an arm."""
    scale = SLIDER_SCALES["arm"]["length"]
    length = scale.value(state.arm["length"]) if state.tab == "arm" else None
    return PictureAxis("L", 1.0) if length is None else PictureAxis(scale.unit, length)


def _rod_scale(
    name: str, lowest_value: float, highest_value: float, logarithmic: bool = True, has_inf: bool = False
) -> SliderScale:
    """Scale of a rod's parameter `name`. lowest_value, highest_value: values at the ends of the slider.
    has_inf: whether the upper end means inf."""
    parameter = PARAMETERS[name]
    unit = "" if parameter.unit == "1" else f" ({parameter.unit})"
    label = f"{name}: {parameter.meaning}{unit}"
    return SliderScale(
        name=name,
        label=label,
        low=lowest_value,
        high=highest_value,
        is_logarithmic=logarithmic,
        is_upper_end_inf=has_inf,
    )


def _arm_scale(
    name: str, lowest_value: float, highest_value: float, unit: str, factor: float, logarithmic: bool = True
) -> SliderScale:
    """Scale of an arm's quantity `name`. lowest_value, highest_value: values at the ends of the slider, in
    `unit`. factor: factor from SI units to `unit`."""
    label = f"{printed_quantity_name(name)} ({unit})"
    return SliderScale(
        name=name,
        label=label,
        low=lowest_value,
        high=highest_value,
        unit=unit,
        factor_from_si=factor,
        is_logarithmic=logarithmic,
    )


ROD_SLIDERS = (
    _rod_scale("F", -20, 200, logarithmic=False),
    _rod_scale("k1", 10, 1e7, has_inf=True),
    _rod_scale("k2", 1, 1e7, has_inf=True),
    _rod_scale("gamma3", 1e-6, 10),
    _rod_scale("gamma1", 0.1, 10),
    _rod_scale("taper", 0.3, 2, logarithmic=False),
)
ARM_SLIDERS = (
    _arm_scale("length", 1, 100, "cm", 1e2),
    _arm_scale("radius", 0.5, 50, "mm", 1e3),
    _arm_scale("young", 1, 1e4, "kPa", 1e-3),
    _arm_scale("viscosity", 1e-2, 1e3, "Pa s", 1.0),
    _arm_scale("pressure", 0, 20, "kPa", 1e-3, logarithmic=False),
)
SLIDER_SCALES = {
    tab: {s.name: s for s in scales} for tab, scales in (("rod", ROD_SLIDERS), ("arm", ARM_SLIDERS))
}
"""Scale of every slider, by tab and by name of the parameter or quantity."""
