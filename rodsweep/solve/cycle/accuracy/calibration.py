"""Calibration of a mesh: measured errors, reused for later cycles on the same mesh, and convergence rates.

The convergence rate in space is estimated from the decay of the orbit's coefficients, the order in time from
the number of stages; errors measured on two meshes give more accurate rates. The cheapest sufficient mesh
follows from the rates (`cheapest_mesh`). Along a chain of cycles the errors are measured at the first cycle
on a mesh, and scaled up at later cycles as the coefficient tails of the orbits grow.
"""

from dataclasses import dataclass, field, replace
from math import inf
from typing import Any

import numpy as np

from ....arrays import Array, list_of
from ....determinant.exponents import EXPONENT_SETTINGS
from ...orbit.coefficient_tails import coefficient_tails_of
from ...orbit.orbit import Orbit
from ...orbit.orbit_mesh import OrbitMesh
from .cycle_errors import CycleErrors, errors_with_safety_factors
from .error_indicators import (
    LAST_HARMONICS_INDEX,
    coefficient_tails_and_orbit_size,
    error_growth_factors,
    squared_tail_growth,
)
from .settings import MESH_ERROR_CALIBRATION_SETTINGS

ERROR_COUNT = 5
"""Length of each row of `mesh_errors`: four errors of `tip_path_differences`, and the multiplier's error."""

CHECKPOINT_FIELDS = dict(
    errors="mesh_errors",
    fall="log_space_error_decay_per_order",
    power="time_convergence_order",
    tails="coefficient_tails_and_orbit_size",
    indicators="error_indicators",
)
"""Fields of `MeshErrorCalibration` by the names of their arrays in a checkpoint."""


@dataclass(frozen=True, eq=False)
class MeshErrorCalibration:
    """Measured errors of a mesh at an orbit, with convergence rates. mesh_errors: errors due to the elements
    and errors due to the time intervals, (2, 5): relative errors of the period, of the largest y, of the
    extremum with the largest error and of the tip's path, and the absolute error of the largest nontrivial
    multiplier."""

    mesh: OrbitMesh
    mesh_errors: Array
    log_space_error_decay_per_order: Array
    """Decrease of ln(error) in space if the order of the elements increases by 1, (5,)."""
    time_convergence_order: Array
    """Order of convergence of the errors in time, (5,)."""
    coefficient_tails_and_orbit_size: Array
    """Coefficient tail in space of each element, coefficient tail in time, and size of the measured orbit,
    (elements + 2,), from `error_indicators.coefficient_tails_and_orbit_size`."""
    parameter_change_since_measurement: float
    """Sum of the relative changes of the parameter since the measurement; inf if the errors do not apply."""
    error_indicators: Array = field(default_factory=lambda: np.full(3, inf))
    """`error_indicators` of the measured orbit, (3,); inf if unknown."""
    error_growth_since_measurement: Array = field(default_factory=lambda: np.ones(2))
    """Estimated growth factors of the errors in space and in time since the measurement, (2,)."""
    last_harmonics_change: float = 0.0
    """Increase of the tip path's last harmonics (third of `error_indicators`) since the measurement."""

    def arrays(self) -> dict[str, Array]:
        """All fields except growth factors and `last_harmonics_change` as named arrays, for a checkpoint."""
        errors = {name: getattr(self, field) for name, field in CHECKPOINT_FIELDS.items()}
        scalars = {
            "reach": np.array(self.parameter_change_since_measurement),
            "calibrated_mesh": self.mesh.as_array,
        }
        return errors | scalars

    @classmethod
    def from_arrays(cls, arrays: dict[str, Array]) -> "MeshErrorCalibration":
        """The calibration from the named arrays that `MeshErrorCalibration.arrays` returns."""
        mesh = OrbitMesh.from_array(arrays["calibrated_mesh"])
        errors: dict[str, Any] = {field: arrays[name] for name, field in CHECKPOINT_FIELDS.items()}
        return cls(mesh=mesh, parameter_change_since_measurement=float(arrays["reach"]), **errors)

    def with_errors_scaled_on_chain(
        self, orbit: Orbit, change: float, indicators: Array
    ) -> "MeshErrorCalibration":
        """This calibration with the errors scaled to a later orbit of a chain;
        `parameter_change_since_measurement` is inf if the orbit has shrunk too much. change: relative change
        of the parameter since the previous orbit. indicators: `error_indicators` of the later orbit, (3,)."""
        tails = coefficient_tails_and_orbit_size(orbit)
        # Errors are relative to the size of the orbit; at a much smaller cycle they are measured again.
        measured_tails = self.coefficient_tails_and_orbit_size
        has_shrunk = tails[-1] < MESH_ERROR_CALIBRATION_SETTINGS.min_orbit_size_ratio * measured_tails[-1]
        growth = error_growth_factors(measured_tails, tails)
        # The tail in time may belong to a field on which the cycle hardly depends; the lost energy is a sum.
        indicator_growth = (indicators / self.error_indicators)[:LAST_HARMONICS_INDEX].max()
        growth[1] = max(growth[1], float(indicator_growth))
        relative_parameter_change = inf if has_shrunk else self.parameter_change_since_measurement + change
        return replace(
            self,
            error_growth_since_measurement=growth,
            last_harmonics_change=float((indicators - self.error_indicators)[LAST_HARMONICS_INDEX]),
            parameter_change_since_measurement=relative_parameter_change,
        )

    def with_errors_scaled_on_branch(self, orbit: Orbit) -> "MeshErrorCalibration":
        """This calibration with the errors scaled to a later orbit of a branch by the growth of the tails
        alone: on a branch, errors are compared at equal arc length and do not grow as orbits shrink."""
        # The size of the earlier orbit replaces that of the later one, so that only the tails count.
        present_tails = coefficient_tails_and_orbit_size(orbit)
        present_tails[-1] = self.coefficient_tails_and_orbit_size[-1]
        growth = error_growth_factors(self.coefficient_tails_and_orbit_size, present_tails)
        return replace(self, error_growth_since_measurement=growth)

    @property
    def with_outdated_errors(self) -> "MeshErrorCalibration":
        """This calibration with `parameter_change_since_measurement` = inf: only its convergence rates are
        valid."""
        return replace(self, parameter_change_since_measurement=inf)

    @property
    def is_valid(self) -> bool:
        """Whether the scaled errors apply: `parameter_change_since_measurement` and
        `error_growth_since_measurement` are within their limits."""
        settings = MESH_ERROR_CALIBRATION_SETTINGS
        is_near = self.parameter_change_since_measurement <= settings.max_relative_parameter_change
        return is_near and float(self.error_growth_since_measurement.max()) <= settings.max_error_growth

    @property
    def is_measured_at_orbit(self) -> bool:
        """Whether the errors were measured at the orbit to which they are scaled; if the errors in space were
        kept from an earlier orbit, whether the errors in time were measured at this orbit."""
        return self.parameter_change_since_measurement == 0 or (
            self.last_harmonics_change == 0 and bool((self.error_growth_since_measurement == 1).all())
        )

    @property
    def can_reuse_space_errors(self) -> bool:
        """Whether a new measurement on the same mesh reuses the scaled errors in space and measures only the
        errors in time: the errors are valid, and the mesh has several elements. A finer mesh in space, with a
        higher order in every element, is then expensive."""
        return self.mesh.element_count > 1 and self.is_valid

    @property
    def space_errors_scaled_to_orbit(self) -> Array:
        """Errors in space, (5,), scaled to the orbit: those of period and largest y by the growth of the
        errors in space, the other three by the larger of the growth factors in space and in time."""
        growth = np.full(ERROR_COUNT, self.error_growth_since_measurement.max())
        growth[:2] = self.error_growth_since_measurement[0]
        scaled: Array = self.mesh_errors[0] * growth
        return scaled

    def is_valid_after_parameter_change(self, change: float) -> bool:
        """Whether the errors may still apply after a further relative change `change` of the parameter."""
        return (
            self.parameter_change_since_measurement + change
            <= MESH_ERROR_CALIBRATION_SETTINGS.max_relative_parameter_change
        )

    def min_remeasured_errors(self, orbit: Orbit) -> Array:
        """Lower limits, (2, 5), of the errors in space and in time newly measured at `orbit` on this mesh:
        `min_remeasured_error_ratio` times the errors of this calibration, decreased with the squared
        tails."""
        shrinkage = np.minimum(
            squared_tail_growth(
                self.coefficient_tails_and_orbit_size, coefficient_tails_and_orbit_size(orbit)
            ),
            1.0,
        )
        limits: Array = (MESH_ERROR_CALIBRATION_SETTINGS.min_remeasured_error_ratio * shrinkage)[
            :, None
        ] * self.mesh_errors
        return limits

    def estimated_cycle_errors(self, accuracy: float) -> CycleErrors:
        """Error estimates of the orbit to which this calibration is scaled, each at least a fraction of the
        relative accuracy `accuracy`. Errors of the multiplier and of extrema other than the largest y are
        scaled by the larger of the two growth factors, because one was seen to grow 2.7 times as much as its
        own tail."""
        growth = self.error_growth_since_measurement
        space_errors, time_errors = self.mesh_errors * growth[:, None]
        errors = errors_with_safety_factors(space_errors, time_errors, accuracy)
        space_errors, time_errors = self.mesh_errors * growth.max()
        errors[2:] = errors_with_safety_factors(space_errors, time_errors, accuracy)[2:]
        # Extrema other than the largest y lie between time nodes, where harmonics are cut off.
        errors[2] += MESH_ERROR_CALIBRATION_SETTINGS.extrema_error_per_last_harmonics * max(
            self.last_harmonics_change, 0.0
        )
        return CycleErrors(*list_of(errors))


def mesh_error_calibration(
    mesh: OrbitMesh, errors: Array, orbit: Orbit, nearby: MeshErrorCalibration | None
) -> MeshErrorCalibration:
    """Calibration of a mesh from its errors measured at `orbit`, in space and in time, (2, 5), with
    convergence rates. nearby: calibration at a nearby orbit, on any mesh. If the two meshes have the same
    elements of different order, their errors give the rate in space; if they have different numbers of
    intervals, the order in time. Otherwise the rates of `nearby` are kept. If `nearby` is None, the rates are
    estimated from the orbit's coefficients and the number of stages."""
    tails = coefficient_tails_and_orbit_size(orbit)
    if nearby is None:
        decay = (
            MESH_ERROR_CALIBRATION_SETTINGS.error_to_coefficient_decay_ratio
            * coefficient_tails_of(orbit).log_coefficient_decay_per_order
        )
        space_decay = _limited_log_space_error_decay(np.full(ERROR_COUNT, decay))
        time_convergence_order: Array = np.full(
            ERROR_COUNT, MESH_ERROR_CALIBRATION_SETTINGS.time_order_per_stage * orbit.stage_count
        )
        return MeshErrorCalibration(mesh, errors, space_decay, time_convergence_order, tails, 0.0)
    previous_mesh = nearby.mesh
    space_decay = nearby.log_space_error_decay_per_order
    time_convergence_order = nearby.time_convergence_order
    if previous_mesh.order != mesh.order and previous_mesh.has_same_edges_and_order_ratios(mesh):
        log_ratio = _log_ratio(nearby.mesh_errors[0], errors[0])
        space_decay = _limited_log_space_error_decay(log_ratio / (mesh.order - previous_mesh.order))
    if previous_mesh.interval_count != mesh.interval_count and previous_mesh.grading == mesh.grading:
        time_convergence_order = _measured_time_order(nearby.mesh_errors[1], errors[1], previous_mesh, mesh)
    return MeshErrorCalibration(mesh, errors, space_decay, time_convergence_order, tails, 0.0)


def _limited_log_space_error_decay(decay: Array) -> Array:
    """The rates `decay`, (5,), the decrease of ln(error) per order, clipped to their allowed range."""
    settings = MESH_ERROR_CALIBRATION_SETTINGS
    limited_decay: Array = np.clip(
        decay, settings.min_log_space_error_decay_per_order, settings.max_log_space_error_decay_per_order
    )
    return limited_decay


def _measured_time_order(
    first_errors: Array, second_errors: Array, previous: OrbitMesh, mesh: OrbitMesh
) -> Array:
    """Order of convergence of the errors in time, (5,). first_errors, second_errors: errors in time, (5,)
    each, on the meshes `previous` and `mesh` with different numbers of time intervals."""
    # Radau IIA has the order 2 stages - 1, which stiff problems may reduce to stages + 1.
    min_order = mesh.stage_count + 1
    log_interval_ratio = np.log(
        mesh.solved_duration_in_full_intervals / previous.solved_duration_in_full_intervals
    )
    max_order = MESH_ERROR_CALIBRATION_SETTINGS.max_time_order_per_smallest_order * min_order
    order: Array = np.clip(_log_ratio(first_errors, second_errors) / log_interval_ratio, min_order, max_order)
    return order


def _log_ratio(first_errors: Array, second_errors: Array) -> Array:
    """Natural logarithm of first_errors/second_errors, arrays of a common shape; 0 is replaced by a tiny
    number."""
    min_error = EXPONENT_SETTINGS.min_divisor
    log_ratio: Array = np.log(np.maximum(first_errors, min_error) / np.maximum(second_errors, min_error))
    return log_ratio
