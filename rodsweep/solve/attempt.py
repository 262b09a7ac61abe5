"""One attempt at a rod's leading eigenvalues, and its two judges, which know nothing of meshes.

The Newton correction of D at each eigenvalue judges the mesh; the winding number of D judges whether
one is missing. What to do about it is `rodsweep.solve.spectrum`'s to decide.
"""

import math
from dataclasses import dataclass
from math import sqrt
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ..discretization.resolution import Resolution
from ..model.bounds import box_of, squared_amplification
from ..model.compilation import compiled
from ..model.determinant import newton_correction
from ..model.rod import Coefficients, Rod
from .certificate import Count, count_right_of
from .eigenpairs import eigen_solver

A_ROOT = 1e-2
"""Newton correction, in units of the length over which D changes, that still stands for a root of D."""
WAVES_A_NODE = 2.0
"""Largest |q| of an eigenvalue, in units of the nodes, that a mesh can stand for."""
REAL_BELOW = 1e-14
"""Relative imaginary part below which an eigenvalue is real: what rounding leaves of zero."""
WIDE_GAP = 0.05
"""Relative gap between two real parts that is wide enough to draw a line through."""
NO_GAP = 1e-6
"""Relative gap below which two real parts count as equal."""
MOST_LINES = 3
"""Lines tried before the count is given up."""
ON_THE_AXIS = 1e-13
"""Relative real part below which an eigenvalue is on the imaginary axis whatever its error estimate."""


class Wish(Protocol):
    """The part of a request that an attempt needs."""

    @property
    def accuracy(self) -> float: ...

    @property
    def vector_nodes(self) -> int: ...


@dataclass(frozen=True, slots=True)
class Found:
    """What one attempt found and what stands for a root of D: sorted as `rodsweep.model` states.

    w: complex, shape (k,); error: |D/D'| at each, wave: largest |q| of each, on_the_axis: whether it
    lies on the imaginary axis within its error, shape (k,); vectors: shape (unknowns, k), or None.
    """

    resolution: Resolution
    w: NDArray[np.complex128]
    error: NDArray[np.float64]
    wave: NDArray[np.float64]
    on_the_axis: NDArray[np.bool_]
    vectors: NDArray[np.complex128] | None

    def worst(self, modes: int) -> float:
        """Largest relative error estimate of the leading modes."""
        return float((self.error[:modes] / np.abs(self.w[:modes])).max())


@dataclass(frozen=True, slots=True)
class Verdict:
    """The count right of a line, and how many of the found eigenvalues lie there."""

    count: Count
    here: int
    clear: bool
    """Whether every found eigenvalue is farther from the line than twice its error."""

    @property
    def agrees(self) -> bool:
        return self.clear and self.count.number == self.here


def attempt(rod: Rod, resolution: Resolution, wanted: int, shift: float, request: Wish) -> Found:
    """The eigenvalues nearest the shift, at least `wanted` where they converge, without impostors.

    Rounding makes infinite eigenvalues finite: they are recognised by their size, because they lie
    outside the a-priori box or beyond what the mesh can resolve.
    """
    solver = eigen_solver(resolution)
    w, X = solver.solve(rod, shift, wanted, request.accuracy, request.vector_nodes > 0)
    most_waves = WAVES_A_NODE * solver.pencil.nodes
    order, w, error, wave, axis = _roots(w, rod.coefficients, sqrt(squared_amplification(rod)), most_waves)
    return Found(resolution, w, error, wave, axis, None if X is None else X[:, order])


@compiled
def _roots(
    w: NDArray[np.complex128], coefficients: Coefficients, amplification: float, most_waves: float
) -> tuple[NDArray, NDArray, NDArray, NDArray, NDArray]:
    """(indices, w, error, wave number, on the axis) of those w that stand for a root of D, sorted."""
    error = np.empty(len(w))
    wave = np.empty(len(w))
    keep = []
    for i in range(len(w)):
        if not (math.isfinite(w[i].real) and math.isfinite(w[i].imag)):
            continue
        if abs(w[i].imag) <= REAL_BELOW * abs(w[i]):
            w[i] = complex(w[i].real, 0.0)
        error[i], length, wave[i] = newton_correction(w[i], coefficients)
        real, imag = box_of(amplification, max(-w[i].real, 0.0))
        inside = w[i].real <= real and abs(w[i].imag) <= imag
        if error[i] <= A_ROOT * length and inside and wave[i] <= most_waves:
            keep.append(i)
    order = np.array(keep, dtype=np.int64)
    for n in range(1, len(order)):  # insertion: descending real part, then descending frequency
        i, at = order[n], n
        while at > 0:
            j = order[at - 1]
            if w[j].real > w[i].real or (w[j].real == w[i].real and w[j].imag >= w[i].imag):
                break
            order[at] = j
            at -= 1
        order[at] = i
    w, error, wave = w[order], error[order], wave[order]
    axis = np.empty(len(order), dtype=np.bool_)
    for n in range(len(order)):
        axis[n] = abs(w[n].real) <= max(4 * error[n], ON_THE_AXIS * abs(w[n]))
    return order, w, error, wave, axis


def judge(rod: Rod, found: Found, modes: int) -> Verdict:
    """Counts the eigenvalues right of a line below the last wanted and below every unstable mode."""
    for line in lines(found.w.real.tolist(), modes):
        count = count_right_of(line, rod)
        if count.number is not None:
            break
    here = int((found.w.real > line).sum())
    clear = bool((np.abs(found.w.real - line) > 2 * found.error).all())
    return Verdict(count, here, clear)


def lines(real: list[float], modes: int) -> list[float]:
    """Where to draw the line, best first: in gaps between the real parts, the first wide one foremost.

    Behind the last of them it is drawn through the unknown, where the count may ask for more.
    """
    target = min(real[modes - 1], 0.0)
    below = [target] + [x for x in real if x < target]
    gaps = []
    for right, left in zip(below[:-1], below[1:], strict=True):
        width = (right - left) / abs(left)
        if width > NO_GAP:
            gaps.append((min(width, WIDE_GAP), (left + right) / 2))
    gaps.sort(key=lambda gap: -gap[0])  # stable: of the wide ones the first stays foremost
    last = below[-1]
    behind = last - WIDE_GAP * (abs(last) if last < 0 else abs(real[0]) + 1.0)
    return [*(middle for _, middle in gaps[: MOST_LINES - 1]), behind]
