"""The cycles and transients that a file holds, a `StoredCycle` for each point, and which a figure shows.

Samples and shapes of a cycle are at the times k T / n, k = 0 ... n - 1, over one period T: what follows the
last is the first.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ....arrays import Array
from ....errors import InputError
from ....results.file.view import View
from ...summary.ranges import rounded
from ..arm.quantities import at_point, given_quantities, quantity_text, replaced
from ..style import heading, parameter_text
from .units import NEEDED, PLAIN_UNITS, CycleUnits, units_of

MOST_CYCLES = 3
"""Cycles for which one figure has room, side by side."""
CYCLE_WORDS = ("cycle", "unstable")
"""Statuses of points that have a cycle, stable or not."""
SHAPES = ("shape_x", "shape_y", "shape_theta")
ENERGIES = ("energy", "injection", "dissipation")
TRACE = ("transient_time", "transient_x", "transient_y")
OPTIONS = dict.fromkeys(SHAPES, "shapes") | dict.fromkeys(TRACE, "transient")
"""What stores a variable; all others that are stored over a period are samples."""


@dataclass(frozen=True, slots=True)
class StoredCycle:
    """A point: its parameters, the period of its cycle, NaN without one, and its variables, in `units`."""

    number: int
    """Of the point in the file, from 1."""
    label: str
    """What tells it from the other cycles of the figure."""
    parameters: dict[str, float]
    period: float
    values: dict[str, Array]
    word: str = "cycle"
    """Its status."""
    units: CycleUnits = PLAIN_UNITS

    @property
    def tau1(self) -> float:
        """The short time scale gamma3/k2 in tau2; 0 where the rod has none, or is an arm in SI units."""
        if self.units.in_si:
            return 0.0
        return self.parameters["gamma3"] / self.parameters["k2"]

    @property
    def period_text(self) -> str:
        """The period, in TeX, with the digits that its error leaves; a line may end behind the T."""
        if self.units.in_si:
            return f"$T$ = {self.units.told_time(self.period)}"
        return self._period(self.period, r"\tau_2", r"T\,")

    @property
    def period_in_tau1(self) -> str:
        """The same in tau1, where the rod has that, as another line; else nothing."""
        return self._period(self.period / self.tau1, r"\tau_1") if 0 < self.tau1 < np.inf else ""

    def _period(self, value: float, unit: str, symbol: str = "") -> str:
        """A period in a unit, in TeX."""
        error = float(self.values["period_error"])
        return rf"${symbol}{{=}}$ ${in_tex(rounded(value, abs(value) * error))}\,{unit}$"

    @property
    def tip(self) -> tuple[Array, Array]:
        """x and y of the tip over a period: from the samples, or else from the shapes."""
        if "tip_x" in self.values:
            return self.values["tip_x"], self.values["tip_y"]
        return self.values["shape_x"][:, -1], self.values["shape_y"][:, -1]

    @property
    def has_trace(self) -> bool:
        """Whether its motion from the start is stored."""
        return TRACE[0] in self.values and bool(np.isfinite(self.values[TRACE[0]]).all())

    def heading(self, *lines: str) -> str:
        """The label, where there is one, above lines about the cycle, which a narrow panel has room for."""
        return "\n".join(filter(None, (self.label, *lines)))


def in_tex(number: str) -> str:
    """A number as `rounded` writes it, with its power of ten in TeX."""
    mantissa, _, power = number.partition("e")
    return rf"{mantissa}\times10^{{{int(power)}}}" if power else mantissa


@dataclass(frozen=True, slots=True)
class Selection:
    """The cycles of a figure."""

    cycles: list[StoredCycle]
    title: str
    """The file's title and the parameters that all cycles share."""
    left_out: str
    """What the message says of cycles for which there was no room; empty where there are none."""


def outcomes(view: View) -> NDArray[np.str_]:
    """The word for every point's status, shape (points,)."""
    return np.array([view.flags.get(int(s), "missing") for s in view.variables["status"].ravel()])


def chosen_cycles(view: View, points: Sequence[int], needs: Sequence[str]) -> Selection:
    """The cycles of the points that the user names, else the first; InputError where a need is not stored."""
    _refuse_missing(view, needs)
    words = outcomes(view)
    _refuse_bad_points(view, points)
    for number in points:
        if words[number - 1] != "cycle":
            word = words[number - 1].replace("_", " ")
            raise InputError(f"--point {number}: the point has no cycle to draw, its status is: {word}")
    return _selection(view, points, words == "cycle", "cycle")


def chosen_traces(view: View, points: Sequence[int]) -> Selection:
    """The points that the user names, else the first whose motion is stored; InputError where none is."""
    _refuse_missing(view, TRACE)
    _refuse_bad_points(view, points)
    there = np.isfinite(view.variables[TRACE[0]][..., -1].ravel())
    for number in points:
        if not there[number - 1]:
            raise InputError(f"--point {number}: the point has no transient, its motion was not followed")
    return _selection(view, points, there, "transient")


def _refuse_missing(view: View, needs: Sequence[str]) -> None:
    """InputError where a variable is not stored."""
    for name in needs:
        if name not in view.variables:
            key = f"limit_cycle.{OPTIONS.get(name, 'samples')}"
            raise InputError(f"{view.path} holds no {name}; run with {key} > 0, which stores it")


def _selection(view: View, points: Sequence[int], drawable: NDArray[np.bool_], what: str) -> Selection:
    """The points by number, else the first of those that are drawable, shape (points,)."""
    there, words = np.flatnonzero(drawable), outcomes(view)
    if not there.size:
        states = ", ".join(sorted({word.replace("_", " ") for word in words.tolist()}))
        raise InputError(f"{view.path} holds no {what} that could be drawn; its points are: {states}")
    numbers = list(points) or [int(index) + 1 for index in there[:MOST_CYCLES]]
    columns = view.point_columns
    parameters = [{name: float(columns[name][n - 1]) for name in columns} for n in numbers]
    units = units_of(view, numbers)
    shared, own = points_told_apart(view, numbers)
    cycles = []
    for number, label, at, drawn_in in zip(numbers, own, parameters, units, strict=True):
        values = drawn_in.drawn(_values(view, number))
        period, word = float(values["period"]), str(words[number - 1])
        cycles.append(StoredCycle(number, label, at, period, values, word, drawn_in))
    left_out = ""
    if not points and there.size > len(cycles):
        left_out = f", the first {len(cycles)} of {there.size} {what}s (--point chooses others)"
    return Selection(cycles, heading(view, shared), left_out)


def _refuse_bad_points(view: View, points: Sequence[int]) -> None:
    """InputError where a figure has no room for the points, or one of them does not exist."""
    count = view.variables["status"].size
    if len(points) > MOST_CYCLES:
        raise InputError(
            f"--point is given {len(points)} times; one figure shows at most {MOST_CYCLES} points"
        )
    for number in points:
        if not 1 <= number <= count:
            raise InputError(f"--point {number}: {view.path} has the points 1 to {count}")


def _values(view: View, number: int) -> dict[str, Array]:
    """The variables at one point, each in its shape there."""
    of_point = view.of_point(number - 1).items()
    return {name: values for name, values in of_point if name not in (*view.parameters, "point")}


def told_apart(parameters: Sequence[dict[str, float]]) -> tuple[str, list[str]]:
    """(the parameters that all share, what tells each from the others), as text."""
    shared = {n: v for n, v in parameters[0].items() if all(other[n] == v for other in parameters)}
    own = [parameter_text({n: v for n, v in each.items() if n not in shared}) for each in parameters]
    return parameter_text(shared), own


def points_told_apart(view: View, numbers: Sequence[int]) -> tuple[str, list[str]]:
    """(what points numbered from 1 share, what tells each from the others): of arms their quantities."""
    if all(name in view.quantities for name in NEEDED):
        return arms_told_apart(view, numbers)
    columns = view.point_columns
    return told_apart([{name: float(columns[name][number - 1]) for name in columns} for number in numbers])


def arms_told_apart(
    view: View, numbers: Sequence[int], without: Collection[str] = ()
) -> tuple[str, list[str]]:
    """(what the arms at points numbered from 1 share, what tells each from the others), in typed units.

    without: quantities and parameters that are not told, as those along an axis of the figure.
    """
    texts = []
    for number in numbers:
        told = {n: quantity_text(view, n, at_point(view, n, number)) for n in given_quantities(view)}
        own = {name: parameter_text({name: value}) for name, value in replaced(view, number).items()}
        texts.append({name: text for name, text in (told | own).items() if name not in without})
    shared = {name: text for name, text in texts[0].items() if all(each[name] == text for each in texts)}
    labels = [", ".join(text for name, text in each.items() if name not in shared) for each in texts]
    return ", ".join(shared.values()), labels
