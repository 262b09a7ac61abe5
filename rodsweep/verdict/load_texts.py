"""The load of an arm in the user's unit, and rounded numbers and ranges in sentences about an arm."""

from math import floor, log10

from ..model.arm.arm import SlenderArm
from ..model.arm.quantities import UNITS_AND_EXAMPLES
from ..model.units import split_quantity, unit_of, value_in_unit, with_si_prefix
from .flutter_over_drags import RangeOverDrags

ROUNDING_TOLERANCE = 1e-12
"""Relative tolerance when rounding down. Without this tolerance, 4.7 could be printed as 4.69."""


def three_digit_text(value: float) -> str:
    """`value` as text with three significant digits; with an exponent only from a million and below 1e-4."""
    rounded = float(f"{value:.3g}")
    return f"{rounded:.0f}" if 1000 <= abs(rounded) < 1e6 else f"{rounded:g}"


def three_digit_text_rounded_down(value: float) -> str:
    """A positive `value` as text with three significant digits, rounded down."""
    unit = 10.0 ** (floor(log10(value)) - 2)
    return three_digit_text(floor(value / unit * (1 + ROUNDING_TOLERANCE)) * unit)


def three_digit_range_text(low: float, high: float) -> str:
    """The range from `low` to `high` as text, with three significant digits; a single number if both ends
    round to the same number."""
    ends = [three_digit_text(low), three_digit_text(high)]
    return ends[0] if ends[0] == ends[1] else " to ".join(ends)


def percent_range_text(low: float, high: float) -> str:
    """The range between the fractions `low` and `high` as text in percent, rounded to integers, or to one
    significant digit below 1 percent; a single number if both ends round to the same number."""
    percents = [100 * value for value in sorted((low, high))]
    ends = [f"{value:.0f}" if value >= 1 else f"{value:.1g}" for value in percents]
    return ends[0] if ends[0] == ends[1] else " to ".join(ends)


TYPICAL_FLUTTER_FORCE = 36.0
"""Typical flutter force, in k3/L^2. If the user gave no load, loads are printed with the SI prefix (Pa, kPa)
that suits this force."""
MAX_TYPED_NUMBER_LENGTH = 6
"""A number of at most this many characters is reported as typed; a longer number is rounded to four
digits."""


class LoadFormatter:
    """Texts of the load of an arm in the user's unit; of a pressure if the user gave no load."""

    def __init__(self, arm: SlenderArm):
        self.name = arm.load_name or "pressure"
        """Key of the load, "pressure" or "force"; "pressure" if the user gave no load."""
        typed_load = getattr(arm, self.name)
        si_unit = UNITS_AND_EXAMPLES[self.name][0]
        self.unit = (
            unit_of(typed_load, si_unit)
            if typed_load is not None
            else with_si_prefix(TYPICAL_FLUTTER_FORCE * arm.load_scale, si_unit)[1]
        )
        """Unit in which loads are printed: the user's unit, or a prefixed SI unit without a load."""
        self.typed_text = (
            ""
            if typed_load is None
            else _shortened_load(typed_load, float(getattr(arm.si, self.name)), si_unit)
        )
        """The load as the user typed it, rounded by `_shortened_load` if long; empty without a load."""
        self.load_at_unit_force = value_in_unit(arm.load_scale, self.unit, si_unit)
        """The load that corresponds to F = 1, in `unit`."""

    def range_of_forces_text(self, forces: RangeOverDrags) -> str:
        """A range of forces in k3/L^2, as text in the unit of the load."""
        low, high = (F * self.load_at_unit_force for F in (forces.low, forces.high))
        return f"{three_digit_range_text(low, high)} {self.unit}"

    def rounded_down_text(self, F: float) -> str:
        """The force F in k3/L^2, as text in the unit of the load, rounded down to three digits."""
        return f"{three_digit_text_rounded_down(F * self.load_at_unit_force)} {self.unit}"


def _shortened_load(load: object, value: float, si_unit: str) -> str:
    """The load `load` as text: as the user typed it, or rounded to four digits if its number is long. A load
    given as a bare number is written as `value` with the SI unit `si_unit`."""
    if not isinstance(load, str):
        return f"{value:.4g} {si_unit}"
    # A number as typed is recognised by the reader; only computed loads have many digits.
    number_text = load.split()[0]
    if len(number_text) <= MAX_TYPED_NUMBER_LENGTH:
        return load.strip()
    return f"{split_quantity(load)[0]:.4g} {split_quantity(load)[1]}"
