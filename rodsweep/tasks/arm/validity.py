"""Whether the model applies at each point of an arm's sweep, from the neglected effects at the arm's motion.

The rate of the motion depends on the task: the rate of the first Hopf point, of the leading oscillating mode,
or of the cycle. Of an arm at rest only compression and weight count. Where a motion may have been missed, the
validity is not known, unless compression or weight alone end the model.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from math import pi
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...config.arm.axes import ALL_BUT_LOAD, SLENDER
from ...config.arm.section import ArmSection
from ...config.schema import Config
from ...model.arm.arm import SlenderArm
from ...model.arm.neglected import HALF_LENGTH, Validity, effects_of, least_drag, worst_validity
from ...model.material.laws import LINEAR
from ...results.layouts.arm import EFFECTS, NOT_KNOWN
from ...results.layouts.phase_diagram import CLASSES
from ...results.layouts.thresholds import CROSSING_KINDS
from ...results.layouts.variables import STATUS
from ...solve.status import PointStatus
from ...sweep.points.points import Points

Record = Mapping[str, Any]
ARMS_KEPT = 64
"""Maximum number of cached arms."""
AT_REST: dict[str, tuple[str, ...]] = {
    "thresholds": ("accuracy_not_reached", "list_full"),
    "phase_diagram": ("accuracy_not_reached", "special_undecided", "special_full"),
}
"""Further statuses, by task, at which the arm is at rest if the file has no motion."""
HOPF_POINTS = [CROSSING_KINDS.index(kind) for kind in ("hopf", "hopf_reverse", "restabilization")]
"""Kinds of crossings that are Hopf points."""
MAY_FLUTTER = [value for value, name in CLASSES if name in ("flutter", "undecided")]
"""Classes of a rod in a phase diagram that may beat."""


@dataclass(frozen=True, slots=True)
class ArmMotion:
    """Motion of an arm at n points, (n, ...): frequency in 1/tau2, force F, amplitude of the tip in L."""

    frequency: Array
    F: Array | None = None
    """Force of each motion; None to take F from the points. An F of the points takes precedence."""
    amplitude: Array | float = HALF_LENGTH
    is_cycle: bool = False
    missed: NDArray[np.bool_] | bool = False
    """Whether a point moves although its frequency is not known, of the shape of the points."""


def _of_modes(record: Record) -> ArmMotion:
    """Motion of the leading oscillating mode; frequency NaN if no mode oscillates."""
    frequency = np.abs(record["frequency"])
    first = np.argmax(frequency > 0, axis=-1, keepdims=True)  # 0 if no mode oscillates
    leading = np.take_along_axis(frequency, first, axis=-1)[..., 0]
    return ArmMotion(np.where(leading > 0, leading, np.nan))


def _of_hopf_point(at: str) -> Callable[[Record], ArmMotion]:
    """Motion of the first Hopf point; `at`: name of the variable with its force."""

    def found(record: Record) -> ArmMotion:
        hopf = np.isin(record["crossing_kind"], HOPF_POINTS)
        first = np.argmax(hopf, axis=-1, keepdims=True)
        there = hopf.any(axis=-1)
        pair = (np.asarray(record[name], float) for name in ("crossing_frequency", at))
        frequency, F = (np.where(there, np.take_along_axis(v, first, axis=-1)[..., 0], np.nan) for v in pair)
        return ArmMotion(np.abs(frequency), F)

    return found


def _of_row(record: Record) -> ArmMotion:
    """Motion of the first Hopf point of a row; missed if rods of the row may beat although it has none."""
    beats = np.isin(record["class"], MAY_FLUTTER).any(axis=-1)
    return replace(_of_hopf_point("crossing_at")(record), missed=beats)


def _of_flutter(record: Record) -> ArmMotion:
    """Motion at the onset of flutter. The onset is stored even if the list of crossings is full."""
    frequency, F = (np.asarray(record[name], float) for name in ("hopf_frequency", "F_hopf"))
    return ArmMotion(np.abs(frequency), F)


def _of_cycle(record: Record) -> ArmMotion:
    frequency, amplitude = (np.asarray(record[name], float) for name in ("frequency", "tip_y_max"))
    return ArmMotion(frequency, None, np.where(np.isfinite(amplitude), amplitude, 0.0), is_cycle=True)


def _of_branches(record: Record) -> ArmMotion:
    period, F, amplitude = (np.asarray(record[name], float) for name in ("period", "branch_F", "tip_y_max"))
    return ArmMotion(2 * pi / period, F, amplitude, is_cycle=True)


MOTION_OF_TASK: dict[str, Callable[[Record], ArmMotion]] = {
    "spectrum": _of_modes,
    "modes": _of_modes,
    "thresholds": _of_flutter,
    "criticality": _of_hopf_point("crossing_F"),
    "phase_diagram": _of_row,
    "limit_cycle": _of_cycle,
    "branch": _of_branches,
}
"""Functions that compute the motion of an arm from the variables of a task."""


class ArmValidity:
    """Validity of the model at the points of a config's arm."""

    def __init__(self, config: Config, points: Points, statuses: Iterable[PointStatus] = ()):
        """`statuses`: all statuses of the task's points."""
        assert config.parameters.arm is not None
        self.section: ArmSection = config.parameters.arm
        self.points = points
        self.task = config.task
        at_rest = AT_REST.get(self.task, ())
        self.searched = [int(each) for each in statuses if each.succeeded or each.name in at_rest]
        """Statuses of points at which no motion was missed."""
        sections = [axis.size for name, axis in self.section.given.items() if name in ALL_BUT_LOAD]
        self.each = points.count // int(np.prod(sections)) if points.over else points.count
        """Number of consecutive points with the same arm."""
        self.arm = lru_cache(ARMS_KEPT)(_arm_of_number(self.section))

    def of(self, record: Record, index: int | NDArray[np.int64]) -> dict[str, Any]:
        """The variables of VALIDITY for a point, or for n points of one arm; records (n, ...), result
        (n,).
        """
        motion = MOTION_OF_TASK[self.task](record)
        missed = motion.missed | ~np.isin(record[STATUS.name], self.searched)
        arm = self._arm_of(int(np.ravel(index)[0]))
        return self._validity(arm, replace(motion, missed=missed), index)

    def at_rest(self) -> dict[str, Array]:
        """The variables of VALIDITY at all points with a rod, (n,), for an arm at rest."""
        found = []
        for first in range(0, self.points.count, self.each):
            indices = np.arange(first, first + self.each)
            if self.points.coverage is not None:
                indices = indices[self.points.coverage[indices] == SLENDER]
            if len(indices):
                nothing = ArmMotion(np.full(len(indices), np.nan))
                found.append(self._validity(self._arm_of(first), nothing, indices))
        return {name: np.concatenate([each[name] for each in found]) for name in found[0]}

    def _arm_of(self, index: int) -> SlenderArm:
        return self.arm(index // self.each if self.points.over else 0)

    def _validity(self, arm: SlenderArm, motion: ArmMotion, index: int | NDArray[np.int64]) -> dict[str, Any]:
        drag = arm.own_drag if "drag" in self.points.over else least_drag(arm)
        rate = motion.frequency / arm.tau2_with(drag)
        F = self._force(arm, motion, index)
        effects = effects_of(arm, rate, self._compressing(F, index), drag=drag, amplitude=motion.amplitude)
        counted = [effect for effect in effects if motion.is_cycle or not effect.of_cycles_only]
        excess = np.array([effect.excess for effect in counted])  # (effects, n, ...)
        validity = worst_validity(effects, of_cycles=motion.is_cycle)
        points = excess.reshape(len(counted), *np.shape(index), -1)  # the last axis: all motions of a point
        largest = np.nanmax(np.where(np.isnan(points), -1.0, points), axis=-1)
        worst = np.argmax(largest, axis=0)
        number = np.array([EFFECTS.index(effect.name.replace(" ", "_")) for effect in counted])[worst]
        at_worst = np.max(largest, axis=0)
        applies = validity.reshape(*np.shape(index), -1).max(axis=-1)
        moves = np.isfinite(rate).reshape(*np.shape(index), -1).any(axis=-1)
        # Compression or weight beyond its limit ends the model whatever the motion.
        known = moves | ~np.asarray(motion.missed) | (applies == Validity.does_not_apply)
        return {
            "model_applies": np.where(known, applies, NOT_KNOWN),
            "neglected_effect": np.where(known & (at_worst > 0), number, -1),
            "neglected_excess": np.where(known & (at_worst >= 0), at_worst, np.nan),
        }

    def _force(self, arm: SlenderArm, motion: ArmMotion, index: int | NDArray[np.int64]) -> Array:
        """F multiplied by the ratio of the arm's k1 to a k1 given beside it; nan without load."""
        own = self._column("k1", index)
        F = self._column("F", index) if "F" in self.points.names else motion.F
        if F is None:
            return np.asarray(np.nan)
        if own is None:
            return np.asarray(F)
        own = own.reshape(own.shape + (1,) * (np.ndim(F) - own.ndim))
        return np.asarray(F) * (arm.k1 / own)

    def _compressing(self, F: Array, index: int | NDArray[np.int64]) -> Array:
        """The force that would compress the base as much as F compresses the weakest section; nan for rubber.

        The law of rubber neglects no effect of compression, so the check does not concern rubber.
        """
        build = self.points.build_of(int(np.ravel(index)[0]))
        if build.law != LINEAR.law:
            return np.full(np.shape(F), np.nan)
        tapers = self._column("taper", index)
        shares = build.relative_crushing_forces(np.ones(()) if tapers is None else tapers)
        return np.asarray(F) / shares.reshape(shares.shape + (1,) * max(np.ndim(F) - shares.ndim, 0))

    def _column(self, name: str, index: int | NDArray[np.int64]) -> Array | None:
        """A parameter at a point, shape (), or at n points, (n,); None if the points lack the parameter."""
        if name not in self.points.names:
            return None
        return np.asarray(self.points.values_of(np.asarray(index))[name])


def _arm_of_number(section: ArmSection) -> Callable[[int], SlenderArm]:
    """Function from a number to the arm of one of the sections, without load.

    Numbers count in row-major order of the section's axes, which are made once: a point must not take the
    time of an axis.
    """
    axes = {name: axis.array() for name, axis in section.given.items() if name in ALL_BUT_LOAD}

    def arm(number: int) -> SlenderArm:
        places = np.unravel_index(number, [len(column) for column in axes.values()])
        return section.made({name: float(axes[name][i]) for name, i in zip(axes, places, strict=True)})

    return arm
