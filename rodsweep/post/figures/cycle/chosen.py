"""The limit cycles that a file holds, one `Cycle` for each point, and which of them a figure is to show.

Samples and shapes of a cycle are at the times k T / n, k = 0 ... n - 1, over one period T: what follows the
last is the first.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ....errors import InputError
from ....results.file.view import View
from ..style import SYMBOLS, heading

MOST_CYCLES = 3
"""Cycles for which one figure has room, side by side."""
SHAPES = ("shape_x", "shape_y", "shape_theta")
ENERGIES = ("energy", "injection", "dissipation")
ASKED_BY = {name: "shapes" for name in SHAPES} | {name: "samples" for name in ENERGIES}
"""The option of limit_cycle that stores a variable."""

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Cycle:
    """A point's cycle.

    parameters: by name; period in tau2; values: every variable of the file at this point.
    """

    number: int
    """Of the point in the file, from 1."""
    parameters: dict[str, float]
    period: float
    values: dict[str, Array]

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


def point_columns(view: View) -> dict[str, Array]:
    """Every parameter at every point, shape (points,): the points of a grid with the last axis fastest."""
    columns = [view.variables[name] for name in view.parameters]
    if view.is_grid:
        columns = [table.ravel() for table in np.meshgrid(*columns, indexing="ij")]
    return dict(zip(view.parameters, columns, strict=True))


def outcomes(view: View) -> NDArray[np.str_]:
    """The word of every point's status, shape (points,)."""
    return np.array([view.flags.get(int(s), "missing") for s in view.variables["status"].ravel()])


def chosen_cycles(view: View, points: Sequence[int], needs: Sequence[str]) -> list[Cycle]:
    """The cycles of the points that the user names, else the first ones; with all variables `needs`.

    Raises InputError where a variable was not stored, a point does not exist or is not a cycle.
    """
    for name in needs:
        if name not in view.variables:
            key = f"limit_cycle.{ASKED_BY[name]}"
            raise InputError(f"{view.path} holds no {name}; run with {key} > 0, which stores it")
    words = outcomes(view)
    if len(points) > MOST_CYCLES:
        raise InputError(
            f"--point is given {len(points)} times; one figure shows at most {MOST_CYCLES} points"
        )
    for number in points:
        if not 1 <= number <= len(words):
            raise InputError(f"--point {number}: {view.path} has the points 1 to {len(words)}")
        if words[number - 1] != "cycle":
            word = words[number - 1].replace("_", " ")
            raise InputError(f"--point {number}: the point has no cycle to draw, its status is: {word}")
    if not (words == "cycle").any():
        raise InputError(f"{view.path} holds no cycle that could be drawn")
    numbers = list(points) or [int(i) + 1 for i in np.flatnonzero(words == "cycle")[:MOST_CYCLES]]
    return [_cycle(view, number) for number in numbers]


def _cycle(view: View, number: int) -> Cycle:
    rank = view.variables["status"].ndim
    values = {
        name: data.reshape(-1, *data.shape[rank:])[number - 1]
        for name, data in view.variables.items()
        if data.shape[:rank] == view.variables["status"].shape and name not in (*view.parameters, "point")
    }
    parameters = {name: float(column[number - 1]) for name, column in point_columns(view).items()}
    return Cycle(number, parameters, float(values["period"]), values)


def headings(view: View, cycles: Sequence[Cycle]) -> tuple[str, list[str]]:
    """(the file's title and the parameters that all cycles share, what tells each cycle from the others)."""
    shared = {n for n in view.parameters if len({c.parameters[n] for c in cycles}) == 1}
    common = parameter_text({n: v for n, v in cycles[0].parameters.items() if n in shared})
    each = [parameter_text({n: v for n, v in c.parameters.items() if n not in shared}) for c in cycles]
    return heading(view.attributes.get("title", ""), common), each


def parameter_text(parameters: dict[str, float]) -> str:
    """Parameters and their values, in one line."""
    return ", ".join(f"${SYMBOLS[name]}$ = {value:.6g}" for name, value in parameters.items())


def left_out(view: View, points: Sequence[int], cycles: Sequence[Cycle]) -> str:
    """What the message says of cycles for which there was no room; empty where there are none."""
    number = int((outcomes(view) == "cycle").sum())
    if points or number == len(cycles):
        return ""
    return f", the first {len(cycles)} of {number} cycles (--point chooses others)"


def periodic(samples: Array, phase: NDArray[np.floating]) -> Array:
    """The trigonometric interpolant of samples over one period, shape (n,), at any phases t/T."""
    n = len(samples)
    c = np.fft.rfft(samples) / n
    c[1 : (n + 1) // 2] *= 2  # each stands for its conjugate too, but for the mean and an even n's last
    return np.real(np.exp(2j * np.pi * np.outer(phase, np.arange(len(c)))) @ c)


def derivative(samples: Array) -> Array:
    """The derivative in the phase t/T of the trigonometric interpolant, at the samples, shape (n,)."""
    n = len(samples)
    c = 2j * np.pi * np.arange(n // 2 + 1) * np.fft.rfft(samples)
    if n % 2 == 0:
        c[-1] = 0  # a cosine that is sampled at its extrema only
    return np.fft.irfft(c, n)
