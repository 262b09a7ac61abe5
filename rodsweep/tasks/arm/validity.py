"""Validity of the model at each point of an arm's sweep, from the size of the effects that the model
neglects.

The effects depend on the rate of the motion: the frequency of the first Hopf point, of the leading
oscillating mode, of the cycle, or of the mode with which an arm without a cycle decays, depending on the
task. If nothing oscillates, only compression and weight are tested. If the solver may have missed an unstable
mode or a cycle, the validity is unknown, unless compression or weight exceeds its limit.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from math import pi
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...config.arm.axes import NON_LOAD_KEYS
from ...config.arm.section import ArmConfig
from ...config.arm.status import SLENDER
from ...config.base_config import Config
from ...model.arm.arm import SlenderArm
from ...model.arm.neglected import LARGE_AMPLITUDE, Validity, neglected_effects, smallest_drag, worst_validity
from ...model.material.laws import LINEAR_CONSTITUTIVE_LAW
from ...results.layouts.phase_diagram import STABILITY_CLASSES
from ...results.layouts.si_variables import NEGLECTED_EFFECTS, UNKNOWN_VALIDITY_NUMBER
from ...results.layouts.thresholds import HOPF_CROSSING_CODES
from ...results.layouts.variables import STATUS_VARIABLE
from ...solve.cycle.status import CycleStatus
from ...solve.status import PointStatus
from ...sweep.points.points import Points

ValuesByVariable = Mapping[str, Any]
"""Variables of a point, or of several points, by name."""
CACHED_ARM_COUNT = 64
"""Maximum number of arms cached by an `ArmValidity`."""
STATUSES_TREATED_AS_REST: dict[str, tuple[str, ...]] = {
    "thresholds": ("accuracy_not_reached", "list_full"),
    "phase_diagram": ("accuracy_not_reached", "special_undecided", "special_full"),
}
"""Unsuccessful statuses, by task, with which an arm without a stored Hopf point is nevertheless at rest."""
DIAGRAM_CLASSES_WITH_POSSIBLE_FLUTTER = [
    value for value, name in STABILITY_CLASSES if name in ("flutter", "undecided")
]
"""Values of the variable class, in a phase diagram, of rods that flutter or may flutter."""


@dataclass(frozen=True, slots=True)
class ArmMotion:
    """Motions of an arm at n points, from which the neglected effects are computed; arrays (n, ...).

    frequency: angular frequency in 1/tau2, NaN for an arm at rest. amplitude: largest y of the tip in L.
    is_cycle: whether the motions are limit cycles.
    """

    frequency: Array
    F: Array | None = None
    """Follower force of each motion, used if F is not a parameter of the points; None if unknown."""
    amplitude: Array | float = LARGE_AMPLITUDE
    is_cycle: bool = False
    may_be_missed: NDArray[np.bool_] | bool = False
    """Whether the solver may have missed a motion at each of the n points, (n,), or at all."""


def _motion_of_modes(record: ValuesByVariable) -> ArmMotion:
    """Motion of the fastest growing mode among those that oscillate; frequency NaN if none does."""
    frequency = np.abs(record["frequency"])
    first_oscillating = np.argmax(frequency > 0, axis=-1, keepdims=True)  # 0 if no mode oscillates
    leading = np.take_along_axis(frequency, first_oscillating, axis=-1)[..., 0]
    return ArmMotion(np.where(leading > 0, leading, np.nan))


def _motion_at_hopf_point_function(F_name: str) -> Callable[[ValuesByVariable], ArmMotion]:
    """Function from the variables of points to the motion at their first Hopf point; frequency and F are NaN
    without a Hopf point. F_name: name of the variable with the forces of the crossings."""

    def motion(record: ValuesByVariable) -> ArmMotion:
        is_hopf = np.isin(record["crossing_kind"], HOPF_CROSSING_CODES)
        first_hopf_index = np.argmax(is_hopf, axis=-1, keepdims=True)
        exists = is_hopf.any(axis=-1)
        pair = (np.asarray(record[name], float) for name in ("crossing_frequency", F_name))
        frequency, F = (
            np.where(exists, np.take_along_axis(values, first_hopf_index, axis=-1)[..., 0], np.nan)
            for values in pair
        )
        return ArmMotion(np.abs(frequency), F)

    return motion


def _motion_of_row(record: ValuesByVariable) -> ArmMotion:
    """Motion at the first Hopf point of a row. may_be_missed: whether a rod of the row may flutter."""
    has_flutter = np.any(np.isin(record["class"], DIAGRAM_CLASSES_WITH_POSSIBLE_FLUTTER), axis=-1)
    return replace(_motion_at_hopf_point_function("crossing_at")(record), may_be_missed=has_flutter)


def _motion_at_flutter(record: ValuesByVariable) -> ArmMotion:
    """Motion at the first Hopf point, read from F_hopf, because a full list of crossings may lack this
    point."""
    frequency, F = (np.asarray(record[name], float) for name in ("hopf_frequency", "F_hopf"))
    return ArmMotion(np.abs(frequency), F)


def _motion_of_cycle(record: ValuesByVariable) -> ArmMotion:
    """Motion on the limit cycle, or of the leading mode of an arm that becomes straight, with amplitude 0."""
    frequency, amplitude = (np.asarray(record[name], float) for name in ("frequency", "tip_y_max"))
    decays = (record[STATUS_VARIABLE.name] == int(CycleStatus.straight)) & (record["linear_frequency"] > 0)
    frequency = np.where(decays, record["linear_frequency"], frequency)
    return ArmMotion(frequency, None, np.where(np.isfinite(amplitude), amplitude, 0.0), is_cycle=True)


def _cycle_motions_of_all_branches(record: ValuesByVariable) -> ArmMotion:
    """Motions on the cycles of all branches."""
    period, F, amplitude = (np.asarray(record[name], float) for name in ("period", "branch_F", "tip_y_max"))
    return ArmMotion(2 * pi / period, F, amplitude, is_cycle=True)


MOTION_OF_TASK: dict[str, Callable[[ValuesByVariable], ArmMotion]] = {
    "spectrum": _motion_of_modes,
    "modes": _motion_of_modes,
    "thresholds": _motion_at_flutter,
    "criticality": _motion_at_hopf_point_function("crossing_F"),
    "phase_diagram": _motion_of_row,
    "limit_cycle": _motion_of_cycle,
    "branch": _cycle_motions_of_all_branches,
}
"""Function from the variables of a point to the motions of the arm, by task."""


class ArmValidity:
    """Computes the VALIDITY_VARIABLES, which state whether the model applies to the arms of a config."""

    def __init__(self, config: Config, points: Points, statuses: Iterable[PointStatus] = ()):
        """statuses: all statuses that points of the task can have."""
        assert config.parameters.arm is not None
        self.section: ArmConfig = config.parameters.arm
        self.points = points
        self.task = config.task
        at_rest = STATUSES_TREATED_AS_REST.get(self.task, ())
        self.searched_statuses = [int(each) for each in statuses if each.succeeded or each.name in at_rest]
        """Stored values of the statuses with which the solver is known to have missed no motion."""
        sections = [axis.size for name, axis in self.section.quantity_axes.items() if name in NON_LOAD_KEYS]
        self.points_per_arm = points.count // int(np.prod(sections)) if points.arm_axes else points.count
        """Number of consecutive points with the same arm."""
        self.arm_by_number = lru_cache(CACHED_ARM_COUNT)(_arm_by_number_function(self.section))
        """Function from the number of an arm (`_arm_by_number_function`) to the arm; caches the last arms."""

    def variables_of_points(self, record: ValuesByVariable, index: int | NDArray[np.int64]) -> dict[str, Any]:
        """The VALIDITY_VARIABLES for one point, or for n points with the same arm, (n,).

        record: variables of the points, (n, ...). index: index of the point, or indices, (n,).
        """
        motion = MOTION_OF_TASK[self.task](record)
        may_be_missed = motion.may_be_missed | ~np.isin(record[STATUS_VARIABLE.name], self.searched_statuses)
        arm = self._arm_of(int(np.ravel(index)[0]))
        return self._validity_variables(arm, replace(motion, may_be_missed=may_be_missed), index)

    def variables_at_rest(self) -> dict[str, Array]:
        """The VALIDITY_VARIABLES, as if the arms did not move, (n,), at the n points whose arm is slender
        enough for the rod model, in the order of the points."""
        parts = []
        for start in range(0, self.points.count, self.points_per_arm):
            indices = np.arange(start, start + self.points_per_arm)
            if self.points.validity_codes is not None:
                indices = indices[self.points.validity_codes[indices] == SLENDER]
            if len(indices):
                no_motion = ArmMotion(np.full(len(indices), np.nan))
                parts.append(self._validity_variables(self._arm_of(start), no_motion, indices))
        return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}

    def _arm_of(self, index: int) -> SlenderArm:
        return self.arm_by_number(index // self.points_per_arm if self.points.arm_axes else 0)

    def _validity_variables(
        self, arm: SlenderArm, motion: ArmMotion, index: int | NDArray[np.int64]
    ) -> dict[str, Any]:
        drag = arm.chosen_drag if "drag" in self.points.arm_axes else smallest_drag(arm)
        rate = motion.frequency / arm.tau2_with(drag)
        F = self._force_times_arm_over_given_k1(arm, motion, index)
        base_force = self._force_of_equal_base_compression(F, index)
        effects = neglected_effects(arm, rate, base_force, drag=drag, amplitude=motion.amplitude)
        relevant = [effect for effect in effects if motion.is_cycle or not effect.is_of_cycles_only]
        excesses = np.array([effect.value_over_limit for effect in relevant])  # (effects, n, ...)
        validity = worst_validity(effects, of_cycles=motion.is_cycle)
        # The last axis holds all motions of a point.
        excesses_by_point = excesses.reshape(len(relevant), *np.shape(index), -1)
        largest = np.nanmax(np.where(np.isnan(excesses_by_point), -1.0, excesses_by_point), axis=-1)
        effect_index = np.argmax(largest, axis=0)
        numbers_of_relevant = [NEGLECTED_EFFECTS.index(effect.name.replace(" ", "_")) for effect in relevant]
        effect_numbers = np.array(numbers_of_relevant)[effect_index]
        forces = np.broadcast_to(base_force, excesses.shape[1:]).reshape(*np.shape(index), -1)
        is_pulled = -np.fmin.reduce(forces, axis=-1) > np.fmax.reduce(forces, axis=-1)
        is_extension = is_pulled & (effect_numbers == NEGLECTED_EFFECTS.index("compression"))
        effect_numbers = np.where(is_extension, NEGLECTED_EFFECTS.index("extension"), effect_numbers)
        at_worst = np.max(largest, axis=0)
        validities = validity.reshape(*np.shape(index), -1).max(axis=-1)
        has_motion = np.isfinite(rate).reshape(*np.shape(index), -1).any(axis=-1)
        # Compression or weight beyond its limit ends the model whatever the motion.
        is_known = has_motion | ~np.asarray(motion.may_be_missed) | (validities == Validity.does_not_apply)
        return {
            "model_applies": np.where(is_known, validities, UNKNOWN_VALIDITY_NUMBER),
            "neglected_effect": np.where(is_known & (at_worst > 0), effect_numbers, -1),
            "neglected_excess": np.where(is_known & (at_worst >= 0), at_worst, np.nan),
        }

    def _force_times_arm_over_given_k1(
        self, arm: SlenderArm, motion: ArmMotion, index: int | NDArray[np.int64]
    ) -> Array:
        """F (k1 of the arm)/(k1 in the config) if the config gives k1 in addition to the arm, so that F/k1 is
        kept, else F; NaN if the arm has no load. index: index of the point, or indices, (n,)."""
        k1 = self._parameter_values("k1", index)
        F = self._parameter_values("F", index) if "F" in self.points.names else motion.F
        if F is None or k1 is None:
            return np.asarray(np.nan if F is None else F)
        k1 = k1.reshape(k1.shape + (1,) * (np.ndim(F) - k1.ndim))
        return np.asarray(F) * (arm.k1 / k1)

    def _force_of_equal_base_compression(self, F: Array, index: int | NDArray[np.int64]) -> Array:
        """The force that compresses the section at the base as much as F compresses the weakest section; NaN
        for rubber, whose law includes large compression. F: forces. index: of their point, or of each,
        (n,)."""
        material = self.points.material_of(int(np.ravel(index)[0]))
        if material.law != LINEAR_CONSTITUTIVE_LAW.law_name:
            return np.full(np.shape(F), np.nan)
        tapers = self._parameter_values("taper", index)
        ratios = material.crushing_forces_over_k1(np.ones(()) if tapers is None else tapers)
        return np.asarray(F) / ratios.reshape(ratios.shape + (1,) * max(np.ndim(F) - ratios.ndim, 0))

    def _parameter_values(self, name: str, index: int | NDArray[np.int64]) -> Array | None:
        """Value of the parameter `name` at a point, shape (), or at n points, (n,); None if the points do not
        have this parameter. index: index of the point, or indices, (n,)."""
        if name not in self.points.names:
            return None
        return np.asarray(self.points.parameter_values_of_points(np.asarray(index))[name])


def _arm_by_number_function(section: ArmConfig) -> Callable[[int], SlenderArm]:
    """Function from a number to the arm with this number, without load. Arms are numbered in row-major order
    of the axes of the config's section `arm`. The axes are evaluated once, because their evaluation takes
    longer than a point."""
    axes = {name: axis.array() for name, axis in section.quantity_axes.items() if name in NON_LOAD_KEYS}

    def arm(number: int) -> SlenderArm:
        position = np.unravel_index(number, [len(column) for column in axes.values()])
        return section.arm_of({name: float(axes[name][i]) for name, i in zip(axes, position, strict=True)})

    return arm
