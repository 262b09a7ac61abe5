"""A solved cycle with measures, multipliers and errors, and the status that follows from these numbers."""

from dataclasses import dataclass

import numpy as np

from ....arrays import Complex
from ...orbit.measures import CycleMeasures, CycleMotion
from ...orbit.newton import ConvergedOrbit
from ...orbit.orbit import Orbit
from ..status import CycleStatus
from .amplitude_errors import relative_largest_y_rounding_error
from .calibration import MeshErrorCalibration
from .cycle_errors import CycleErrors, message_of_error
from .minimal_period import possible_period_divisor


@dataclass(frozen=True, eq=False)
class RefinedCycle:
    """A solved cycle with its measures, Floquet multipliers and errors.

    converged_orbit: orbit and matrix. calibration: source of the errors. motion: motion of the orbit over its
    period. multipliers: nontrivial multipliers, (multipliers,), by descending modulus.
    trivial_multiplier_error: distance of the computed trivial multiplier from 1.
    """

    converged_orbit: ConvergedOrbit
    calibration: MeshErrorCalibration
    motion: CycleMotion
    measures: CycleMeasures
    multipliers: Complex
    trivial_multiplier_error: float
    errors: CycleErrors

    @property
    def orbit(self) -> Orbit:
        return self.converged_orbit.orbit

    @property
    def largest_multiplier_modulus(self) -> float:
        """Largest modulus of the nontrivial multipliers; 0 if there is no nontrivial multiplier."""
        return float(np.abs(self.multipliers[0])) if len(self.multipliers) else 0.0

    @property
    def possible_period_divisor(self) -> int:
        """Number g such that the minimal period may be 1/g of the period; g = 1 proves the period minimal,
        and g = 0 means that all harmonics are 0."""
        return possible_period_divisor(self.motion, self.errors.extrema_error)

    @property
    def largest_multiplier_modulus_error(self) -> float:
        """Absolute error of `largest_multiplier_modulus`; the stability is undecided if this modulus differs
        from 1 by this error or less."""
        return max(self.trivial_multiplier_error, self.errors.multiplier_error)

    @property
    def is_stable(self) -> bool | None:
        """Whether all nontrivial multipliers lie inside the unit circle; None if the largest modulus is 1
        within its error."""
        excess = self.largest_multiplier_modulus - 1
        return None if abs(excess) <= self.largest_multiplier_modulus_error else excess < 0

    def _accuracy_message(self, accuracy: float) -> str:
        """Sentence on the errors that exceed the requested relative accuracy `accuracy`."""
        rounding = relative_largest_y_rounding_error(self.converged_orbit)
        if rounding > accuracy:
            return (
                "so close to a Hopf point or a fold, rounding errors may change the amplitude by a relative "
                f"{rounding:.3g}, more than the requested accuracy of {accuracy:g}"
            )
        return message_of_error(self.errors, accuracy)

    def status_and_message(self, accuracy: float) -> tuple[CycleStatus, str]:
        """Returns (status, message) of the cycle for a requested relative accuracy; the message is "" for a
        stable or unstable cycle."""
        if self.measures.least_stretch <= 0:
            return (
                CycleStatus.left_the_model,
                f"the axial stretch h1 falls to {self.measures.least_stretch:.3g} on the cycle",
            )
        if self.errors.largest_weighted_error > accuracy:
            return CycleStatus.not_settled, self._accuracy_message(accuracy)
        if self.possible_period_divisor != 1:
            message = (
                f"the period found may be {self.possible_period_divisor} times the minimal period: the "
                "harmonics that distinguish the two are within their errors"
            )
            return CycleStatus.not_settled, message
        if self.is_stable is None:
            return (
                CycleStatus.not_settled,
                "the stability is undecided: the largest modulus of a Floquet multiplier is 1 within its "
                f"error, {self.largest_multiplier_modulus_error:.0e}",
            )
        return (CycleStatus.cycle if self.is_stable else CycleStatus.unstable), ""
