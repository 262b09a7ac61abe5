"""Test functions of folds and torus points, evaluated at any cycle near a cycle with an eliminated matrix.

Minimally augmented systems (Govaerts 2000, ch. 4 and 10): the test function g of a cycle follows from a
bordered linear system of the linearised equations. That system is corrected here with the factors of a
neighbouring cycle, the previous vector as the start and the residual at the cycle itself, without another
elimination.
"""

from dataclasses import dataclass, replace

import numpy as np

from .....arrays import Array
from ....orbit.matrix.linearisation import jump_of
from ....orbit.matrix.phase import phase_change, phase_row
from ....orbit.orbit import Orbit
from ....point import Unsolvable
from ...bordered.matrix import BorderedMatrix
from ...bordered.scale import deflection_of
from ..point import LOCATING


@dataclass(frozen=True, slots=True, kw_only=True)
class AugmentedSettings:
    """Settings for iterating cycle, test function and null vectors with the factors of a nearby cycle's
    matrix.
    """

    tolerance: float = 1e-9
    """Relative tolerance of a cycle and its test function, which is thus known to about 1e-8."""
    function_share: float = 0.01
    """Tolerance in units of the distance from the curve that the test function indicates; the larger
    tolerance counts."""
    min_contraction: float = 10.0
    """Lower limit of the assumed contraction rate: ratio of successive corrections over the distance from the
    matrix's cycle. The true rate is 2 or 3 for large cycles; a larger one is on the safe side."""
    contraction_safety: float = 3.0
    """Safety factor on a measured contraction rate, for the next cycle."""
    slow: float = 0.3
    """Ratio of successive corrections above which a new matrix is assembled."""
    rounding: float = 1e-8
    """Size below which a correction that hardly decreases is rounding error: the iteration stops."""
    max_corrections: int = 30
    """Maximum number of corrections of one cycle."""
    inverse_shift: float = 1e-9
    """Relative distance of inverse iteration's shift from the eigenvalue, which keeps the matrix regular."""
    inverse_iterations: int = 2
    """Number of inverse iterations; each damps other eigenvectors by the ratio of shift and gap."""


AUGMENTED = AugmentedSettings()


class FoldFunction:
    """Test function of folds: the derivative dp/dl of the parameter along the branch; the border measures l.

    small: whether the function is divided by the deflection, because it vanishes at a Hopf point too.
    """

    def __init__(self, matrix: BorderedMatrix, border: Array, small: bool) -> None:
        self.matrix = matrix
        self.border = border
        self.small = small
        tangent = matrix.direction(border)
        self.vectors = tangent / (matrix.scale.moved(matrix.orbit, tangent) @ border)

    def value(self, orbit: Orbit) -> float:
        """The test function from the present tangent."""
        rises = float(self.vectors[-1] / self.matrix.scale.coordinate)
        # Beside a Hopf point the rate vanishes with the amplitude; divided by it the function stays regular.
        return rises * self.matrix.scale.deflection / deflection_of(orbit) if self.small else rises

    def start_from(self, tangent: Array) -> None:
        """Sets the tangent, (N + 1,), that is corrected next."""
        self.vectors = tangent

    def correct(self, orbit: Orbit) -> None:
        """Corrects the tangent once at a cycle; the equation for the tangent is linear."""
        matrix = self.matrix
        tangent = self.vectors
        p = orbit.semidiscrete
        change = replace(orbit, values=tangent[:-1])
        columns, ends = matrix.residual_variations(orbit, tangent[None])
        row = np.empty(len(orbit.start))
        phase_row(orbit.start, p.rod, p.matrices, row)
        along = orbit.form.change(matrix.scale.name)
        shift = phase_change(orbit.start, along, p.rod, p.matrices)
        closing = matrix.closing(jump_of(change.points, p), columns, ends)
        of_phase = shift * tangent[-1] - row @ change.start
        right = np.array([*closing, of_phase, 1 - self.border @ matrix.scale.moved(orbit, tangent)])
        self.vectors = tangent + matrix.solved(self.border, right, columns[:, :, 0], 1.0)


class TorusFunction:
    """Test function of torus points: |mu| - 1 of the complex pair nearest to the unit circle, from its
    eigenvector."""

    def __init__(self, matrix: BorderedMatrix) -> None:
        self.matrix = matrix
        pair = crossing_pair(matrix)
        if pair is None:
            raise Unsolvable("the multipliers that cross the unit circle have become real")
        self.multiplier = pair
        p = matrix.orbit.semidiscrete
        self.shifted = matrix.propagator - (1 + AUGMENTED.inverse_shift) * pair * p.symmetry
        start = np.ones(len(p.mass), dtype=complex)
        for _ in range(AUGMENTED.inverse_iterations):
            start = np.linalg.solve(self.shifted, p.symmetry @ start)
            start /= np.linalg.norm(start)
        self.border = start.conj()
        K, s, n = matrix.orbit.states.shape
        self.vectors = matrix.back_substitute(_parts(start), np.zeros((K, s, 2, n)))
        n = len(start)
        self.bordered = np.zeros((n + 1, n + 1), dtype=complex)
        self.bordered[:n, :n] = matrix.propagator - pair * p.symmetry
        self.bordered[:n, n] = -p.symmetry @ start
        self.bordered[n, :n] = self.border

    def value(self, orbit: Orbit) -> float:
        """The test function from the present multiplier."""
        return abs(self.multiplier) - 1

    def start_from(self, parts: Array) -> None:
        """Sets the real and imaginary part of the eigenvector, (2, N + 1), that is corrected next."""
        self.vectors = parts

    def correct(self, orbit: Orbit) -> None:
        """Corrects the multiplier and its eigenvector once at a cycle."""
        columns, ends = self.matrix.residual_variations(orbit, self.vectors)
        n = ends.shape[1]
        start, end = (part[0] + 1j * part[1] for part in (self.vectors[:, :n], self.vectors[:, -2 - n : -2]))
        right = np.append(self.multiplier * (orbit.semidiscrete.symmetry @ start), 1 - self.border @ start)
        right[:-1] -= end + ends[0] + 1j * ends[1]
        change = np.linalg.solve(self.bordered, right)
        self.multiplier += complex(change[-1])
        self.vectors = self.vectors + self.matrix.back_substitute(_parts(change[:-1]), columns)


def correct_fully(function: FoldFunction | TorusFunction, orbit: Orbit) -> None:
    """Corrects a test function at a cycle until its value is known to rounding; raises Unsolvable."""
    value = function.value(orbit)
    last = np.inf
    for _ in range(AUGMENTED.max_corrections):
        function.correct(orbit)
        before = value
        value = function.value(orbit)
        change = abs(value - before)
        if change <= LOCATING.function_tolerance or (change > last / 2 and change <= AUGMENTED.rounding):
            return
        if change > last:
            break
        last = change
    raise Unsolvable("the iteration for the test function of the special point does not converge")


def _parts(vector: Array) -> Array:
    """Real and imaginary part of a vector, (2, n)."""
    return np.array([vector.real, vector.imag])


def crossing_pair(matrix: BorderedMatrix) -> complex | None:
    """Complex multiplier nearest to the unit circle, over half a period and the reflection; None if all are
    real."""
    h = matrix.partial_multipliers
    pairs = h[np.abs(h.imag) > LOCATING.real_multiplier * np.abs(h)]
    return complex(pairs[np.argmin(np.abs(np.abs(pairs) - 1))]) if len(pairs) else None
