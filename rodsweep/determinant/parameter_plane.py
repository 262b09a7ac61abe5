"""Planes of rods: two parameters vary, each on a linear or a logarithmic axis scaled to [0, 1]."""

from dataclasses import dataclass
from math import exp, log
from typing import NamedTuple

from ..model.parameters import CRUSHING, PARAMETERS
from ..model.rod import Rod
from .parameter_path import ValueAlong, determinant_along
from .value import ROUND_OFF

BEYOND_AN_END = 1e-12
"""Distance beyond the end of an axis that is rounding."""
LITTLE = 0.01
"""Share of the distance from a crushed rod that a small step may use."""


@dataclass(frozen=True, slots=True)
class PlaneAxis:
    """One axis of a plane: a parameter from `start` to `stop`, both finite, in equal steps or ratios."""

    name: str
    start: float
    stop: float
    logarithmic: bool = False

    def value(self, x: float) -> float:
        """The parameter at the scaled coordinate x; 0 is start and 1 is stop, also when x is rounded."""
        if -BEYOND_AN_END < x < 0 or 1 < x < 1 + BEYOND_AN_END:
            x = round(x)
        if self.logarithmic:
            return exp(log(self.start) + x * (log(self.stop) - log(self.start)))
        return self.start + x * (self.stop - self.start)

    def scaled(self, value: float) -> float:
        """The coordinate of a value of the parameter."""
        if self.logarithmic:
            return (log(value) - log(self.start)) / (log(self.stop) - log(self.start))
        return (value - self.start) / (self.stop - self.start)

    def stretch(self, value: float) -> float:
        """d(parameter)/dx at a value of the parameter."""
        return value * (log(self.stop) - log(self.start)) if self.logarithmic else self.stop - self.start

    def slope(self, value: float) -> float:
        """d(path variable)/dx at a value of the parameter; the variable of a stiffness k is 1/k."""
        along = self.stretch(value)
        return -along / value**2 if PARAMETERS[self.name].by_compliance else along


class ValueOnPlane(NamedTuple):
    """D and its derivatives by w and the scaled coordinates times exp(-S), and the rounding error of D."""

    D: complex
    D_w: complex
    D_x: complex
    D_y: complex
    S: float
    blur: float


@dataclass(frozen=True, slots=True)
class Plane:
    """All rods that differ from `rod` in the parameters of two axes only."""

    rod: Rod
    axes: tuple[PlaneAxis, PlaneAxis]

    def at(self, x: float, y: float) -> Rod:
        """The rod at scaled coordinates; ValueError where the model has none."""
        first, second = self.axes
        return self.rod.changed(**{first.name: first.value(x), second.name: second.value(y)})

    def determinant(self, w: complex, x: float, y: float) -> ValueOnPlane:
        """D at w and scaled coordinates, and its derivatives."""
        rod = self.at(x, y)
        (D, D_w, _, S, noise), D_x = self._along(w, rod, self.axes[0])
        _, D_y = self._along(w, rod, self.axes[1])
        # The coordinates are rounded numbers: D cannot tell them from their neighbours.
        blur = noise + ROUND_OFF * (abs(D_x) + abs(D_y) + abs(w * D_w))
        return ValueOnPlane(D, D_w, D_x, D_y, S, blur)

    @staticmethod
    def _along(w: complex, rod: Rod, axis: PlaneAxis) -> tuple[ValueAlong, complex]:
        """(D along the axis's parameter, its derivative by the scaled coordinate)."""
        value = determinant_along(w, rod.coefficients, rod.direction(axis.name))
        return value, value.D_p * axis.slope(getattr(rod, axis.name))

    def small_step(self, x: float, y: float, which: int, largest: float) -> float:
        """A step along an axis, at most `largest`, that changes the distance k1 - F from crushing little."""
        rod, axis = self.at(x, y), self.axes[which]
        if axis.name not in CRUSHING:
            return largest
        return min(largest, LITTLE * (rod.k1 - rod.F) / axis.stretch(getattr(rod, axis.name)))

    def holds(self, x: float, y: float) -> bool:
        """Whether the model has a rod at these coordinates."""
        try:
            self.at(x, y)
        except ValueError:
            return False
        return True

    def uncrushed(self, x: float, y: float) -> bool:
        """Whether the rod at coordinates on the plane is not crushed."""
        values = {axis.name: axis.value(v) for axis, v in zip(self.axes, (x, y), strict=True)}
        return values.get("F", self.rod.F) < values.get("k1", self.rod.k1)
