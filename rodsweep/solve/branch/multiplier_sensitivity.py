"""Sensitivity of the largest multiplier of a cycle to errors of the mesh.

Along a branch the errors of large multipliers grow with the multipliers, so that relative errors change
slowly. Where the largest multiplier nearly coincides with another multiplier, the errors of both grow with
the reciprocal of their distance: both are roots of a quadratic polynomial. The errors of its coefficients
change slowly, but its discriminant is small.
"""

from dataclasses import dataclass

import numpy as np

from ...determinant.exponents import EXPONENT_SETTINGS
from ..cycle.accuracy.settings import MESH_ERROR_CALIBRATION_SETTINGS
from ..orbit.newton import ConvergedOrbit


@dataclass(frozen=True, slots=True, kw_only=True)
class MultiplierSensitivitySettings:
    """Settings for the sensitivity of the largest multiplier."""

    max_coalescence_distance: float = 0.3
    """Relative distance between two multipliers below which their errors are assumed to grow with the
    reciprocal of this distance. At larger distances the growth, at most 1/0.3, is left to the safety
    factor of 3 on errors of multipliers."""


MULTIPLIER_SENSITIVITY_SETTINGS = MultiplierSensitivitySettings()


@dataclass(frozen=True, slots=True)
class MultiplierErrorAmplification:
    """Sensitivity of the largest nontrivial multiplier of a cycle to errors of the mesh. modulus: modulus of
    this multiplier over the period, at least 1. amplification_by_near_multiplier: growth of its errors
    because another multiplier is near, at least 1."""

    modulus: float
    amplification_by_near_multiplier: float

    @classmethod
    def of_cycle(cls, solved: ConvergedOrbit) -> "MultiplierErrorAmplification":
        """The sensitivity at the cycle `solved`."""
        # Over a whole period h and -h coincide, although neither has an effect on the other.
        multipliers = solved.matrix.multipliers_over_solved_time_interval
        nontrivial = np.delete(multipliers, int(np.argmin(np.abs(multipliers - 1))))
        if not len(nontrivial):
            return cls(1.0, 1.0)
        index = int(np.argmax(np.abs(nontrivial)))
        others = np.delete(nontrivial, index)
        modulus = float(abs(nontrivial[index]))
        distance = float(np.abs(others - nontrivial[index]).min()) if len(others) else np.inf
        limit = MULTIPLIER_SENSITIVITY_SETTINGS.max_coalescence_distance * modulus
        return cls(
            max(modulus**solved.orbit.symmetry.solved_parts_per_period, 1.0),
            max(limit / max(distance, EXPONENT_SETTINGS.min_divisor), 1.0),
        )

    def error_from_quotient(self, error_quotient: float) -> float:
        """Error of the largest multiplier at this cycle. error_quotient: the error at a nearby cycle, divided
        by `error_growth_factor` at that cycle.

        The largest multiplier and the nearest other multiplier are roots of a quadratic polynomial with the
        discriminant d^2, d: distance of both, divided by the modulus. An error E of the discriminant changes
        the multiplier by E/d, relative to its modulus, but at most by sqrt(E), because the two multipliers
        may coincide.
        """
        relative_error = min(
            self.amplification_by_near_multiplier * error_quotient,
            max(
                (MULTIPLIER_SENSITIVITY_SETTINGS.max_coalescence_distance * error_quotient) ** 0.5,
                error_quotient,
            ),
        )
        return self.modulus * relative_error

    def error_from_mesh_difference(self, difference: float, removed_fraction: float) -> float:
        """Error of the largest multiplier, without safety factor, from its difference between two meshes.
        removed_fraction: fraction of the error that the finer mesh removes.

        difference: modulus of this difference. A mesh has an error in the logarithm of a multiplier, the
        growth over a period. Where the multipliers of both meshes differ by more than the modulus, this
        logarithm and not the multiplier is extrapolated, with the safety factor in the exponent: such a
        multiplier has no correct digit, and its true value may be larger by powers of ten.
        """
        if difference <= self.modulus:
            return difference / removed_fraction
        safety_factor = MESH_ERROR_CALIBRATION_SETTINGS.error_safety_factor
        exponent = safety_factor * np.log1p(difference / self.modulus) / removed_fraction
        growth = np.expm1(min(exponent, EXPONENT_SETTINGS.max_exponent))
        return float(self.modulus * growth / safety_factor)

    @property
    def error_growth_factor(self) -> float:
        """Product of `modulus` and `amplification_by_near_multiplier`."""
        return self.modulus * self.amplification_by_near_multiplier
