"""Planes of rods: two parameters vary, each on a linear or a logarithmic axis scaled to [0, 1]."""

from dataclasses import dataclass
from functools import cached_property
from math import exp, inf, log
from typing import NamedTuple

from ..model.parameters import CRUSHING, PARAMETERS
from ..model.rod import Rod
from .arm.determinant import arm_determinant
from .parameter_path import ValueAlong, determinant_along
from .value import ROUND_OFF, Value, scaled_determinant

BEYOND_AN_END = 1e-12
"""Distance beyond the end of an axis that is rounding."""
SMALL_STEP = 1e-3
STENCIL = ((-2, 1 / 12), (-1, -8 / 12), (1, 8 / 12), (2, -1 / 12))
ONE_SIDED = ((0, -25 / 12), (1, 4.0), (2, -3.0), (3, 4 / 3), (4, -1 / 4))
"""Step along a scaled coordinate, and weights of differences of fourth order; beside a limit, one-sided."""
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


@dataclass(frozen=True)
class Plane:
    """All rods that differ from `rod` in the parameters of two axes only."""

    rod: Rod
    axes: tuple[PlaneAxis, PlaneAxis]

    @cached_property
    def standard(self) -> bool:
        """Whether all rods are uniform and of linear material, so that D has its closed form."""
        return self.rod.standard and all(axis.name != "taper" for axis in self.axes)

    def at(self, x: float, y: float) -> Rod:
        """The rod at scaled coordinates; ValueError where the model has none."""
        first, second = self.axes
        return self.rod.changed(**{first.name: first.value(x), second.name: second.value(y)})

    def determinant(self, w: complex, x: float, y: float) -> ValueOnPlane:
        """D at w and scaled coordinates, and its derivatives."""
        rod = self.at(x, y)
        if not self.standard:
            return self._of_arms(w, x, y)
        (D, D_w, _, S, noise), D_x = self._along(w, rod, self.axes[0])
        _, D_y = self._along(w, rod, self.axes[1])
        # The coordinates are rounded numbers: D cannot tell them from their neighbours.
        blur = noise + ROUND_OFF * (abs(D_x) + abs(D_y) + abs(w * D_w))
        return ValueOnPlane(D, D_w, D_x, D_y, S, blur)

    def value(self, w: complex, x: float, y: float) -> Value:
        """D at w and scaled coordinates, and its derivative by w."""
        rod = self.at(x, y)
        return scaled_determinant(w, rod.coefficients) if self.standard else arm_determinant(rod).value(w)

    def stencil(self, x: float, y: float, which: int) -> tuple[tuple[tuple[float, float], ...], float]:
        """((place, weight) of each value in a difference along an axis, its step): places are in steps."""
        h = self.small_step(x, y, which, SMALL_STEP)
        back = (x - 2 * h, y) if which == 0 else (x, y - 2 * h)
        return (STENCIL if self.holds(*back) else ONE_SIDED), h

    def _of_arms(self, w: complex, x: float, y: float) -> ValueOnPlane:
        """`determinant` of arms, with differences of fourth order for the derivatives by the coordinates."""
        D, D_w, S, noise = self.value(w, x, y)
        slopes = []
        for which in range(2):
            (places, h), slope = self.stencil(x, y, which), 0j
            for place, weight in places:
                there = self.value(w, *((x + place * h, y) if which == 0 else (x, y + place * h)))
                slope += weight * there.D * exp(there.S - S) / h
            slopes.append(slope)
        D_x, D_y = slopes
        blur = noise + ROUND_OFF * (abs(D_x) + abs(D_y) + abs(w * D_w))
        return ValueOnPlane(D, D_w, D_x, D_y, S, blur)

    @staticmethod
    def _along(w: complex, rod: Rod, axis: PlaneAxis) -> tuple[ValueAlong, complex]:
        """(D along the axis's parameter, its derivative by the scaled coordinate)."""
        value = determinant_along(w, rod.coefficients, rod.direction(axis.name))
        return value, value.D_p * axis.slope(getattr(rod, axis.name))

    def small_step(self, x: float, y: float, which: int, largest: float) -> float:
        """A step along an axis, at most `largest`, that changes the distance from crushing little."""
        rod, axis = self.at(x, y), self.axes[which]
        force = rod.crushing_force
        if force == inf or axis.name not in (*CRUSHING, "taper"):
            return largest
        # The area, and with it the crushing force, is quadratic in the taper and in proportion to k1.
        rate = {"F": 1.0, "k1": force / rod.k1}.get(axis.name, 2 * force / rod.taper)
        return min(largest, LITTLE * (force - rod.F) / (rate * axis.stretch(getattr(rod, axis.name))))

    def holds(self, x: float, y: float) -> bool:
        """Whether the model has a rod at these coordinates."""
        try:
            self.at(x, y)
        except ValueError:
            return False
        return True

    def uncrushed(self, x: float, y: float) -> bool:
        """Whether the rod at coordinates on the plane is not crushed."""
        values = {**self.rod.values} | {a.name: a.value(v) for a, v in zip(self.axes, (x, y), strict=True)}
        return values["F"] < values["k1"] * self.rod.build.crushing_share(values["taper"])
