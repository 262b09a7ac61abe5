"""A cycle with its measures, multipliers and errors, and its verdict: stable, unstable or undecided."""

from dataclasses import dataclass

import numpy as np

from ....arrays import Complex
from ...orbit.measures import CyclePath, Measures
from ...orbit.newton import ConvergedOrbit
from ...orbit.orbit import Orbit
from ..status import CycleStatus
from .calibration import Calibration
from .cycle_errors import CycleErrors
from .minimal_period import undecided_divisor


@dataclass(frozen=True, eq=False)
class RefinedCycle:
    """A cycle with its measures, multipliers and errors.

    calibration: source of the errors. multipliers: nontrivial multipliers, (rank - 1,), by descending
    modulus. trivial_error: distance of the trivial multiplier from 1.
    """

    fine: ConvergedOrbit
    calibration: Calibration
    path: CyclePath
    measures: Measures
    multipliers: Complex
    trivial_error: float
    errors: CycleErrors

    @property
    def orbit(self) -> Orbit:
        return self.fine.orbit

    @property
    def largest_multiplier(self) -> float:
        """Largest modulus of the nontrivial multipliers."""
        return float(np.abs(self.multipliers[0])) if len(self.multipliers) else 0.0

    @property
    def divisor(self) -> int:
        """Factor by which the minimal period may be shorter; 1 proves the period minimal."""
        return undecided_divisor(self.path, self.errors.extrema_error)

    @property
    def margin(self) -> float:
        """Error of the largest multiplier's modulus: a modulus nearer to 1 leaves the stability open."""
        return max(self.trivial_error, self.errors.multiplier_error)

    @property
    def stable(self) -> bool | None:
        """Whether all nontrivial multipliers lie in the unit circle; None if the margin leaves this open."""
        beyond = self.largest_multiplier - 1
        return None if abs(beyond) <= self.margin else beyond < 0

    def verdict(self, accuracy: float) -> tuple[CycleStatus, str]:
        """(status of the cycle, the reason why it is not a stable cycle)."""
        if self.measures.least_stretch <= 0:
            return CycleStatus.left_the_model, f"h1 = {self.measures.least_stretch:.3g} on the cycle"
        if self.errors.largest > accuracy:
            return CycleStatus.not_settled, "the cycle's errors exceed the requested accuracy"
        if self.divisor != 1:
            shorter = f"a period that is {self.divisor} times shorter cannot be excluded"
            return CycleStatus.not_settled, shorter
        if self.stable is None:
            return CycleStatus.not_settled, f"its largest multiplier is 1 within {self.margin:.0e}"
        return (CycleStatus.cycle if self.stable else CycleStatus.unstable), ""
