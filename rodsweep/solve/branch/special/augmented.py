"""What is zero at a fold or a torus point, at any cycle near one with an eliminated matrix.

Minimally augmented systems (Govaerts 2000, ch. 4 and 10): a number g of a cycle comes from a linear system of
the cycle's linearised equations with a border. Here that system is solved with the factors of a cycle near
by, a vector of the cycle before as the start, and its residual at the cycle itself: no further elimination.
"""

from dataclasses import replace
from typing import Protocol

import numpy as np

from ....arrays import Array
from ....watch import report
from ...orbit.matrix.linearisation import jump_of
from ...orbit.matrix.phase import phase_change, phase_row
from ...orbit.matrix.workspace import NewtonWorkspace
from ...orbit.newton import relative_change
from ...orbit.orbit import Orbit
from ...point import Unsolvable
from ..bordered import LONGEST_STEP, BorderedMatrix, Condition, Scale, moment_of, moved
from .locating import REAL

TOLERANCE = 1e-9
"""Relative, to which a cycle and its function are solved: the latter is known to some 1e-8."""
SHARE = 0.01
"""The same in units of what the function says is left across the curve, where that is larger."""
LEAST_CONTRACTION, CAREFUL = 10.0, 3.0
"""Ratio of a correction to the one before in units of the distance from the matrix's cycle, 2 or 3 for
large cycles: the least that is believed, and by what factor one that was met may be too small at the next."""
SLUGGISH = 0.3
"""Ratio of a correction to the one before from which the matrix is made anew."""
STALLED = 1e-8
"""Correction that is rounding where it is not much smaller than the one before."""
MOST_CORRECTIONS = 30


class FamilyOfCycles(Protocol):
    """Cycles of two numbers about a curve, as far as what is zero on it must know them.

    border: direction of the branch in the scale, (3,); small: whether cycles are nearly as small as at a Hopf
    point; workspace: memory of the matrices.
    """

    @property
    def scale(self) -> Scale: ...
    @property
    def border(self) -> Array: ...
    @property
    def small(self) -> bool: ...
    @property
    def workspace(self) -> NewtonWorkspace: ...

    def function(self, matrix: BorderedMatrix) -> "FoldFunction | TorusFunction":
        """What is zero on the curve, at the cycle of a matrix."""


class NearbyCycles:
    """Cycles of a family near one whose matrix is eliminated, with what is zero on the curve."""

    def __init__(self, family: FamilyOfCycles, start: Orbit, contraction: float) -> None:
        """contraction: of corrections in the family before, or inf; it is learnt but for small cycles."""
        self.scale, self.border, self._family = family.scale, family.border, family
        self.contraction = contraction
        """Ratio of a correction to the one before in units of the matrix's distance."""
        self._eliminate(start)

    def _eliminate(self, orbit: Orbit) -> None:
        """Makes the matrix at an orbit, from which the cycles are at a relative distance."""
        self.matrix, self.distance = BorderedMatrix(orbit, self.scale, self._family.workspace), 0.0
        self.function = self._family.function(self.matrix)

    def predict(self, vectors: Array) -> None:
        """Takes vectors of the function, (count, N + 1) or (N + 1,), from which the next cycle's start."""
        self.function.start_from(vectors)

    def solved(self, orbit: Orbit, condition: Condition, slope: float, enough: float) -> tuple[Orbit, float]:
        """(the cycle near an orbit, the value there of the function); raises Unsolvable.

        slope: modulus of the function's about, across the curve; enough: relative error that is small enough.
        """
        last = 0.0
        for _ in range(MOST_CORRECTIONS):
            report()
            orbit, change = self._corrected(orbit, condition)
            distance = self.distance
            before = self.function.value(orbit)
            self.function.correct(orbit)
            value = self.function.value(orbit)
            off = max(change, abs(value - before) / slope)
            rate = off / last if last else min(1.0, self.contraction * distance)
            if last and not self._family.small:
                self.contraction = max(LEAST_CONTRACTION, CAREFUL * rate / distance)
            if off * min(rate, 1.0) <= max(enough, SHARE * abs(value) / slope):
                return orbit, value
            if last and rate > SLUGGISH:
                if off <= STALLED:
                    return orbit, value
                self._eliminate(orbit)
                off = 0.0
            last = off
        raise Unsolvable(f"the corrections of a cycle are at {change:.0e}")

    def _corrected(self, orbit: Orbit, condition: Condition) -> tuple[Orbit, float]:
        """(an orbit after one correction, its relative change); raises Unsolvable."""
        step = self.matrix.correction(orbit, self.border, condition.missed(orbit))
        change = max(relative_change(orbit, step[:-1]), abs(step[-1]) / self.scale.coordinate)
        if not change <= LONGEST_STEP:
            raise Unsolvable("there is no cycle near on the branch")
        self.distance += change
        return moved(orbit, self.scale.name, step), change


class FoldFunction:
    """dp/dl, the rise of the parameter along the branch, from its tangent; l is what the border measures.

    small: whether the moment is divided out, for at a Hopf point it is zero too.
    """

    def __init__(self, matrix: BorderedMatrix, border: Array, small: bool) -> None:
        self.matrix, self.border, self.small = matrix, border, small
        tangent = matrix.direction(border)
        self.vectors = tangent / (matrix.scale.moved(matrix.orbit, tangent) @ border)

    def value(self, orbit: Orbit) -> float:
        """That of the tangent as it is."""
        rises = float(self.vectors[-1] / self.matrix.scale.coordinate)
        return rises * self.matrix.scale.moment / moment_of(orbit) if self.small else rises

    def start_from(self, tangent: Array) -> None:
        """Takes the tangent, (N + 1,), that is corrected next."""
        self.vectors = tangent

    def correct(self, orbit: Orbit) -> None:
        """One correction of the tangent at a cycle, where what is corrected to 0 is linear in it."""
        matrix, tangent, p = self.matrix, self.vectors, orbit.semidiscrete
        change = replace(orbit, values=tangent[:-1])
        columns, ends = matrix.varied(orbit, tangent[None])
        row = np.empty(len(orbit.start))
        phase_row(orbit.start, p.rod, p.matrices, row)
        along = orbit.form.change(matrix.scale.name)
        shift = phase_change(orbit.start, along, p.rod, p.matrices)
        right = np.empty(len(row) + 2)
        right[:-2] = jump_of(change.points, p) - ends[0]
        right[-2] = shift * tangent[-1] - row @ change.start
        right[-1] = 1 - self.border @ matrix.scale.moved(orbit, tangent)
        self.vectors = tangent + matrix.solved(self.border, right, columns[:, :, 0], 1.0)


class TorusFunction:
    """|mu| - 1 of the pair of multipliers nearest to the circle, from its eigenvector."""

    def __init__(self, matrix: BorderedMatrix) -> None:
        self.matrix = matrix
        pair = crossing_pair(matrix)
        if pair is None:
            raise Unsolvable("the multipliers that cross the circle have become real")
        self.multiplier, p = pair, matrix.orbit.semidiscrete
        self.shifted = matrix.propagator - (1 + INVERSE_SHIFT) * pair * p.symmetry
        start = np.ones(len(p.mass), dtype=complex)
        for _ in range(INVERSE_ITERATIONS):
            start = np.linalg.solve(self.shifted, p.symmetry @ start)
            start /= np.linalg.norm(start)
        self.border = start.conj()
        K, s, n = matrix.orbit.states.shape
        self.vectors = matrix.spread(_parts(start), np.zeros((K, s, 2, n)))
        n = len(start)
        self.bordered = np.zeros((n + 1, n + 1), dtype=complex)
        self.bordered[:n, :n] = matrix.propagator - pair * p.symmetry
        self.bordered[:n, n] = -p.symmetry @ start
        self.bordered[n, :n] = self.border

    def value(self, orbit: Orbit) -> float:
        """That of the multiplier as it is."""
        return abs(self.multiplier) - 1

    def start_from(self, parts: Array) -> None:
        """Takes the eigenvector, its real and imaginary part, (2, N + 1), that is corrected next."""
        self.vectors = parts

    def correct(self, orbit: Orbit) -> None:
        """One correction of multiplier and eigenvector at a cycle."""
        columns, ends = self.matrix.varied(orbit, self.vectors)
        n = ends.shape[1]
        start, end = (part[0] + 1j * part[1] for part in (self.vectors[:, :n], self.vectors[:, -2 - n : -2]))
        right = np.append(self.multiplier * (orbit.semidiscrete.symmetry @ start), 1 - self.border @ start)
        right[:-1] -= end + ends[0] + 1j * ends[1]
        change = np.linalg.solve(self.bordered, right)
        self.multiplier += complex(change[-1])
        self.vectors = self.vectors + self.matrix.spread(_parts(change[:-1]), columns)


INVERSE_SHIFT, INVERSE_ITERATIONS = 1e-9, 2
"""Relative distance of the shift of inverse iteration from the eigenvalue, and how often."""


def _parts(vector: Array) -> Array:
    """Real and imaginary part of a vector, (2, n)."""
    return np.array([vector.real, vector.imag])


def crossing_pair(matrix: BorderedMatrix) -> complex | None:
    """Of complex multipliers, over half a period and the reflection, the one nearest to the circle."""
    h = matrix.returns
    pairs = h[np.abs(h.imag) > REAL * np.abs(h)]
    return complex(pairs[np.argmin(np.abs(np.abs(pairs) - 1))]) if len(pairs) else None
