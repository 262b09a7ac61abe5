"""The cycles and transients that a file holds, a `StoredCycle` for each point, and which a figure shows.

Samples and shapes of a cycle are at the times k T / n, k = 0 ... n - 1, over one period T: what follows the
last is the first.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ....arrays import Array
from ....errors import InputError
from ....results.file.view import View
from ..style import heading, parameter_text

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
    """A point: its parameters, the period in tau2 of its cycle, NaN without one, and all variables there."""

    number: int
    """Of the point in the file, from 1."""
    label: str
    """What tells it from the other cycles of the figure."""
    parameters: dict[str, float]
    period: float
    values: dict[str, Array]
    word: str = "cycle"
    """Its status."""

    @property
    def tau1(self) -> float:
        """The short time scale gamma3/k2 in tau2; 0 where the rod has none."""
        return self.parameters["gamma3"] / self.parameters["k2"]

    @property
    def tip(self) -> tuple[Array, Array]:
        """x and y of the tip in L over a period: from the samples, or else from the shapes."""
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
    shared, own = told_apart(parameters)
    cycles = []
    for number, label, at in zip(numbers, own, parameters, strict=True):
        values = _values(view, number)
        period, word = float(values["period"]), str(words[number - 1])
        cycles.append(StoredCycle(number, label, at, period, values, word))
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
    shape = view.variables["status"].shape
    return {
        name: data.reshape(-1, *data.shape[len(shape) :])[number - 1]
        for name, data in view.variables.items()
        if data.shape[: len(shape)] == shape and name not in (*view.parameters, "point")
    }


def told_apart(parameters: Sequence[dict[str, float]]) -> tuple[str, list[str]]:
    """(the parameters that all share, what tells each from the others), as text."""
    shared = {n: v for n, v in parameters[0].items() if all(other[n] == v for other in parameters)}
    own = [parameter_text({n: v for n, v in each.items() if n not in shared}) for each in parameters]
    return parameter_text(shared), own
