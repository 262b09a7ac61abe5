"""Cycles near a cycle with a factorised Newton matrix, corrected together with a test function of
`functions`.

Cycle and test function converge together; a new matrix is assembled only where the corrections converge
slowly.
"""

from typing import Protocol

from .....arrays import Array
from .....watch import report
from ....orbit.matrix.workspace import NewtonWorkspace
from ....orbit.newton import ORBIT_NEWTON, relative_change
from ....orbit.orbit import Orbit
from ....point import Unsolvable
from ...bordered.condition import BorderCondition, moved_orbit
from ...bordered.matrix import BorderedMatrix
from ...bordered.scale import Scale
from .functions import AUGMENTED, FoldFunction, TorusFunction


class CycleFamilyInterface(Protocol):
    """Interface of `NearbyCycleSolver` to a two-parameter family of cycles near a curve of special points.

    border: direction of the branch in components (deflection, log period, parameter), (3,). small: whether
    the cycles are so small that the fold function is divided by the deflection. workspace: memory of Newton's
    matrices.
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
        """The test function that is zero on the curve of special points, at the orbit of a bordered
        matrix."""


class NearbyCycleSolver:
    """Solver for cycles of a family, with their test function, near a cycle with a factorised Newton
    matrix."""

    def __init__(self, family: CycleFamilyInterface, start: Orbit, contraction: float) -> None:
        """start: orbit at which the first matrix is assembled. contraction: contraction rate of earlier
        corrections in the family, inf if unknown; it is updated here unless the cycles are small."""
        self.scale = family.scale
        self.border = family.border
        self._family = family
        self.contraction = contraction
        """Contraction rate: ratio of successive corrections, divided by the relative distance from the cycle
        of the matrix."""
        self._eliminate(start)

    def _eliminate(self, orbit: Orbit) -> None:
        """Assembles and factorises a new matrix at an orbit, and sets `distance`, the distance from this
        orbit, to 0."""
        self.matrix = BorderedMatrix(orbit, self.scale, self._family.workspace)
        self.distance = 0.0
        self.function = self._family.function(self.matrix)

    def predict(self, vectors: Array) -> None:
        """Sets the tangent, (N + 1,), or the eigenvector, (2, N + 1), from which the next correction of the
        test function starts."""
        self.function.start_from(vectors)

    def solved(
        self, orbit: Orbit, condition: BorderCondition, slope: float, enough: float
    ) -> tuple[Orbit, float]:
        """(the cycle near an orbit that fulfils `condition`, value of its test function); raises Unsolvable.

        slope: approximate modulus of the derivative of the test function across the curve. enough: relative
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
            # The first correction has no predecessor: the ratio is estimated from the distance from the
            # matrix's cycle.
            rate = off / last if last else min(1.0, self.contraction * distance)
            if last and not self._family.small:
                measured = AUGMENTED.contraction_safety * rate / distance
                self.contraction = max(AUGMENTED.min_contraction, measured)
            if off * min(rate, 1.0) <= max(enough, AUGMENTED.tolerance_share * abs(value) / slope):
                return orbit, value
            if last and rate > AUGMENTED.max_correction_ratio:
                if off <= AUGMENTED.rounding_correction:
                    return orbit, value
                self._eliminate(orbit)
                off = 0.0
            last = off
        raise Unsolvable(f"Newton's corrections of a cycle do not converge; the last step is {change:.0e}")

    def _corrected(self, orbit: Orbit, condition: BorderCondition) -> tuple[Orbit, float]:
        """(orbit after one correction with the present matrix, relative change of the orbit); raises
        Unsolvable."""
        step = self.matrix.correction(orbit, self.border, condition.residual(orbit))
        change = max(relative_change(orbit, step[:-1]), abs(step[-1]) / self.scale.coordinate_unit)
        if not change <= ORBIT_NEWTON.longest_step:
            raise Unsolvable("Newton's corrections find no cycle of the branch near their starting point")
        self.distance += change
        return moved_orbit(orbit, self.scale.name, step), change
