"""Cycles near a cycle with an eliminated matrix, corrected together with their test function.

The test functions are those of `functions`. Cycle and test function converge together; a new matrix is
assembled only where the corrections become slow.
"""

from typing import Protocol

from .....arrays import Array
from .....watch import report
from ....orbit.matrix.workspace import NewtonWorkspace
from ....orbit.newton import ORBIT_NEWTON, relative_change
from ....orbit.orbit import Orbit
from ....point import Unsolvable
from ...bordered.condition import BorderCondition, moved
from ...bordered.matrix import BorderedMatrix
from ...bordered.scale import Scale
from .functions import AUGMENTED, FoldFunction, TorusFunction


class FamilyOfCycles(Protocol):
    """The two-parameter family of cycles about a curve, as far as test functions need it.

    border: direction of the branch in the scale, (3,). small: whether the cycles are almost as small as at a
    Hopf point. workspace: memory of the matrices.
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
        """The test function that is zero on the curve, at the cycle of a matrix."""


class NearbyCycles:
    """Cycles of a family near a cycle with an eliminated matrix, with the test function of the curve."""

    def __init__(self, family: FamilyOfCycles, start: Orbit, contraction: float) -> None:
        """contraction: rate of earlier corrections in the family, or inf; updated here unless cycles are
        small."""
        self.scale = family.scale
        self.border = family.border
        self._family = family
        self.contraction = contraction
        """Ratio of successive corrections over the distance from the matrix's cycle."""
        self._eliminate(start)

    def _eliminate(self, orbit: Orbit) -> None:
        """Assembles a new matrix at an orbit; `distance` from it restarts at 0."""
        self.matrix = BorderedMatrix(orbit, self.scale, self._family.workspace)
        self.distance = 0.0
        self.function = self._family.function(self.matrix)

    def predict(self, vectors: Array) -> None:
        """Sets the test function's vectors, (count, N + 1) or (N + 1,), from which the next correction
        starts."""
        self.function.start_from(vectors)

    def solved(
        self, orbit: Orbit, condition: BorderCondition, slope: float, enough: float
    ) -> tuple[Orbit, float]:
        """(the cycle near an orbit, its test function); raises Unsolvable.

        slope: approximate modulus of the test function's derivative across the curve. enough: relative
        tolerance.
        """
        last = 0.0
        for _ in range(AUGMENTED.max_corrections):
            report()
            orbit, change = self._corrected(orbit, condition)
            distance = self.distance
            before = self.function.value(orbit)
            self.function.correct(orbit)
            value = self.function.value(orbit)
            # The test function converges with its vectors; its change counts as a distance across the curve.
            off = max(change, abs(value - before) / slope)
            # The first correction has no predecessor: its contraction follows from the distance from the
            # matrix's cycle.
            rate = off / last if last else min(1.0, self.contraction * distance)
            if last and not self._family.small:
                measured = AUGMENTED.contraction_safety * rate / distance
                self.contraction = max(AUGMENTED.min_contraction, measured)
            if off * min(rate, 1.0) <= max(enough, AUGMENTED.function_share * abs(value) / slope):
                return orbit, value
            if last and rate > AUGMENTED.slow:
                if off <= AUGMENTED.rounding:
                    return orbit, value
                self._eliminate(orbit)
                off = 0.0
            last = off
        raise Unsolvable(f"Newton's corrections of a cycle do not converge; the last step is {change:.0e}")

    def _corrected(self, orbit: Orbit, condition: BorderCondition) -> tuple[Orbit, float]:
        """(orbit after one correction, relative change); raises Unsolvable."""
        step = self.matrix.correction(orbit, self.border, condition.residual(orbit))
        change = max(relative_change(orbit, step[:-1]), abs(step[-1]) / self.scale.coordinate)
        if not change <= ORBIT_NEWTON.longest_step:
            raise Unsolvable("Newton's corrections find no cycle of the branch near their starting point")
        self.distance += change
        return moved(orbit, self.scale.name, step), change
