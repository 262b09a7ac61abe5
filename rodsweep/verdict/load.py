"""The load of an arm in the user's unit, and the rounding of numbers in sentences."""

from math import floor, log10

from ..model.arm.arm import SlenderArm
from ..model.arm.quantities import UNITS
from ..model.units import split_quantity, unit_of, value_in_unit, with_si_prefix
from .flutter import Span

TYPICAL_FLUTTER_FORCE = 36.0
"""Typical flutter force, in k3/L^2. If the user gave no load, the SI prefix of the load (Pa, kPa) is chosen
for this force."""
ROUNDING_TOLERANCE = 1e-12
"""Relative tolerance when rounding down. Without this tolerance, 4.7 could be printed as 4.69."""
MAX_TYPED_LENGTH = 6
"""A number of at most this many characters is reported as the user typed it; a longer number is rounded to
four digits."""


def three_digits(value: float) -> str:
    """`value` as text with three significant digits; with an exponent only from a million on and below
    1e-4.
    """
    short = float(f"{value:.3g}")
    return f"{short:.0f}" if 1000 <= abs(short) < 1e6 else f"{short:g}"


def range_text(low: float, high: float) -> str:
    """The range from `low` to `high` as text, with three significant digits; a single number if both ends
    round to the same number.
    """
    ends = [three_digits(low), three_digits(high)]
    return ends[0] if ends[0] == ends[1] else " to ".join(ends)


def percent_range_text(low: float, high: float) -> str:
    """The range between the fractions `low` and `high` as text in percent, rounded to integers, or to one
    significant digit below 1 percent; a single number if both ends round to the same number.
    """
    percents = [100 * value for value in sorted((low, high))]
    ends = [f"{value:.0f}" if value >= 1 else f"{value:.1g}" for value in percents]
    return ends[0] if ends[0] == ends[1] else " to ".join(ends)


class Load:
    """Load of an arm in the user's unit; a pressure if the user gave no load."""

    def __init__(self, arm: SlenderArm):
        self.name = arm.load or "pressure"
        given = getattr(arm, self.name)
        si = UNITS[self.name][0]
        self.unit = (
            unit_of(given, si)
            if given is not None
            else with_si_prefix(TYPICAL_FLUTTER_FORCE * arm.load_scale, si)[1]
        )
        self.typed_text = (
            "" if given is None else _shortened_load(given, float(getattr(arm.si, self.name)), si)
        )
        """The load as the user typed it, rounded by `_shortened_load` if long; empty if the arm has no
        load."""
        self.load_at_unit_force = value_in_unit(arm.load_scale, self.unit, si)
        """The load that corresponds to F = 1, in `unit`."""

    def of(self, forces: Span) -> str:
        """A range of forces in k3/L^2, as text in the unit of the load."""
        low, high = (F * self.load_at_unit_force for F in (forces.low, forces.high))
        return f"{range_text(low, high)} {self.unit}"

    def at_most(self, F: float) -> str:
        """The force F in k3/L^2, as text in the unit of the load, rounded down to three digits."""
        value = F * self.load_at_unit_force
        unit = 10.0 ** (floor(log10(value)) - 2)
        return f"{three_digits(floor(value / unit * (1 + ROUNDING_TOLERANCE)) * unit)} {self.unit}"


def _shortened_load(given: object, value: float, si: str) -> str:
    """The load `typed_text` as the user typed it, rounded to four digits if its number is long. A load given
    as a number is written in the SI unit `si`, in which it is `value`.
    """
    if not isinstance(given, str):
        return f"{value:.4g} {si}"
    number = given.split()[0]
    if len(number) <= MAX_TYPED_LENGTH:
        return given.strip()
    return f"{split_quantity(given)[0]:.4g} {split_quantity(given)[1]}"
