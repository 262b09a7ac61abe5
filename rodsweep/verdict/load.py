"""The load of an arm in the words and the unit in which it was given, and numbers as sentences have them."""

from math import floor, log10

from ..model.arm.arm import SlenderArm
from ..model.arm.quantities import UNITS
from ..model.units import compact, split, unit_of, written_in
from .flutter import Span

FLUTTER_ABOUT = 36.0
"""F at which arms flutter, roughly: which prefix a pressure has where none is given."""
ROUNDING = 1e-12
"""Relative error of a number that has three digits but for it."""
LONGEST_GIVEN = 6
"""Characters of a load's number that are repeated as they were given."""


def digits(value: float) -> str:
    """A number to three digits, without exponent below a million."""
    short = float(f"{value:.3g}")
    return f"{short:.0f}" if 1000 <= abs(short) < 1e6 else f"{short:g}"


def rounded(low: float, high: float) -> str:
    """A range to three digits; one number where its ends look alike."""
    ends = [digits(low), digits(high)]
    return ends[0] if ends[0] == ends[1] else " to ".join(ends)


def rounded_percent(low: float, high: float) -> str:
    """A range of shares in percent, without decimals but for small ones."""
    percents = [100 * value for value in sorted((low, high))]
    ends = [f"{value:.0f}" if value >= 1 else f"{value:.1g}" for value in percents]
    return ends[0] if ends[0] == ends[1] else " to ".join(ends)


class Load:
    """What pushes the arm; without load, a pressure that might."""

    def __init__(self, arm: SlenderArm):
        self.name = arm.load or "pressure"
        given, si = getattr(arm, self.name), UNITS[self.name][0]
        self.unit = (
            unit_of(given, si) if given is not None else compact(FLUTTER_ABOUT * arm.load_scale, si)[1]
        )
        self.given = "" if given is None else _short(given, float(getattr(arm.si, self.name)), si)
        """The load as it was given, of four digits where it has more than six."""
        self.scale = written_in(arm.load_scale, self.unit, si)
        """How much of it F = 1 is."""

    def of(self, forces: Span) -> str:
        """A range of forces in k3/L^2, as this load."""
        return f"{rounded(forces.low * self.scale, forces.high * self.scale)} {self.unit}"

    def at_most(self, F: float) -> str:
        """A force in k3/L^2 as this load, cut to three digits."""
        value = F * self.scale
        unit = 10.0 ** (floor(log10(value)) - 2)
        return f"{digits(floor(value / unit * (1 + ROUNDING)) * unit)} {self.unit}"


def _short(given: object, value: float, si: str) -> str:
    """A load as it was given, or with four digits where it has many; value: the same in SI."""
    if not isinstance(given, str):
        return f"{value:.4g} {si}"
    number = given.split()[0]
    if len(number) <= LONGEST_GIVEN:
        return given.strip()
    return f"{split(given)[0]:.4g} {split(given)[1]}"
