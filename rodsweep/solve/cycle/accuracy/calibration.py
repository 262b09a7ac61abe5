"""The errors of a mesh, which finer meshes measured, for a cycle and those that follow on the same mesh.

How fast both parts fall, hence which mesh costs least, the decay of the orbit's coefficients tells, and
better two meshes that were measured. Where many cycles follow on one mesh, its errors are measured at the
first of them; at the others both parts are larger by as much as the orbit's tails make them.
"""

from dataclasses import dataclass, field, replace
from math import ceil, inf

import numpy as np

from ....arrays import Array
from ....discretization.elements.resolution import LARGEST_ORDER
from ...orbit.orbit import Orbit
from ...orbit.orbit_mesh import (
    LEAST_INTERVALS,
    LEAST_ORDER,
    MOST_INTERVALS,
    OrbitMesh,
)
from ...orbit.path_differences import APART, HEIGHT, OTHERS, PERIOD
from ...orbit.tails import lasting_tails, tails_of
from .cycle_errors import LEAST_CLAIM, ROUNDING, CycleErrors, largest_error

SAFETY = 3.0
HEIGHT_SHARE, PERIOD_SHARE, OTHERS_SHARE, SHARE_IN_TIME = 0.16, 0.16, 1.6, 0.004
"""Shares of the distance between the tip's paths that count at least as an error: a number may agree by luck,
and no more do so at the next cycle. In time they differ most in theta, which is stiff and matters least."""
EACH_OTHERS = 2.0
"""Errors of period and largest y in units of the larger one of both, at least. Both are as small as the
squares of the tails; that the errors of both change their sign near the same mesh is rare. Without it one
cycle in a thousand was off by more than its estimate, by up to 4.5 times."""
AIM = 0.5
"""Share of the accuracy that a mesh is chosen for."""
FALL_BY_DECAY, LEAST_FALL, LARGEST_FALL = 1.6, 0.5, 2.2
"""The fall of errors in space per order, natural logarithm: in units of the decay of the coefficients, whose
squares they follow (1.4 to 2 were seen), and its bounds."""
POWER_BY_STAGES, STEEPEST = 1.5, 2.0
"""Order in time: in units of the stages where it was not measured, and the largest in units of the least,
which is one more than the stages."""
FEWER_ORDERS, FEWER_INTERVALS, MOST_ORDERS, MOST_GROWTH = 3, 0.6, 12, 4
"""By how many orders, and times how many intervals, a mesh that is planned may differ."""
FARTHEST, LARGEST_GROWTH = 0.2, 4.0
"""Relative change of the parameter, and growth of the errors, beyond which it is made anew."""
SHRUNK = 0.75
"""Share of the orbit's size below which it is, too: near the Hopf point at which cycles die the error of the
largest y grows fast from where it happened to change its sign."""
KEPT = 0.5
"""Least part of an error, in units of the last measurement on the same mesh and of the change of the tails
since: a part that changes its sign is small at one cycle and as large as before three cycles later."""
LEAST_TAIL = 1e-15
MULTIPLIER = 4
"""Place of the largest multiplier's error, behind those of `path_differences`."""
PARTS = 5


@dataclass(frozen=True, eq=False)
class Calibration:
    """space, time: what of the error of a mesh comes from each, (5,): `path_differences`, and the largest
    multiplier's, absolute.

    fall: of errors in space per order, natural logarithm, (5,); power: of the intervals with which those in
    time fall, (5,); tails: `lasting_tails` and the orbit's size where it was made, (3,); reach: relative
    change of the parameter since; growth: of both parts at an orbit since, (2,).
    """

    mesh: OrbitMesh
    space: Array
    time: Array
    fall: Array
    power: Array
    tails: Array
    reach: float
    growth: Array = field(default_factory=lambda: np.ones(2))

    def arrays(self) -> dict[str, Array]:
        """All of it but the growth, which each orbit has anew: errors (5,), tails (3,), reach and mesh."""
        errors = {name: getattr(self, name) for name in ("space", "time", "fall", "power", "tails")}
        numbers = {"reach": np.array(self.reach), "calibrated_mesh": np.array(self.mesh.numbers)}
        return errors | numbers

    @classmethod
    def from_arrays(cls, arrays: dict[str, Array]) -> "Calibration":
        """The reverse of `arrays`, of the shapes given there."""
        mesh = OrbitMesh(*map(int, arrays["calibrated_mesh"]))
        errors = {name: arrays[name] for name in ("space", "time", "fall", "power", "tails")}
        return cls(mesh=mesh, reach=float(arrays["reach"]), **errors)

    def at(self, orbit: Orbit, change: float) -> "Calibration":
        """The same for an orbit of the next point, after a relative change of the parameter."""
        tails = _tails(orbit)
        dies = tails[-1] < SHRUNK * self.tails[-1]
        return replace(self, growth=_growth(self.tails, tails), reach=inf if dies else self.reach + change)

    def on_branch(self, orbit: Orbit) -> "Calibration":
        """The same where cycles are told apart by the moment at the clamp: then none dies before another."""
        growth = _growth(self.tails, _tails(orbit) * np.array([1.0, 1.0, 0.0]) + self.tails * (0.0, 0.0, 1.0))
        return replace(self, growth=growth)

    @property
    def outdated(self) -> "Calibration":
        """One that tells no more than how fast errors fall."""
        return replace(self, reach=inf)

    @property
    def holds(self) -> bool:
        """Whether it tells the errors of the orbit."""
        return self.reach <= FARTHEST and float(self.growth.max()) <= LARGEST_GROWTH

    def lasts(self, change: float) -> bool:
        """Whether it may tell the errors after a further relative change of the parameter."""
        return self.reach + change <= FARTHEST

    def least(self, orbit: Orbit) -> tuple[Array, Array]:
        """The least of both parts, (5,) each, at an orbit for which this mesh is measured again."""
        in_space, in_time = KEPT * np.minimum(_change(self.tails, _tails(orbit)), 1.0)
        return in_space * self.space, in_time * self.time

    def errors(self, accuracy: float) -> CycleErrors:
        """Errors of the orbit.

        The larger growth counts for both parts of the errors of the other extrema and of the multiplier: one
        part grew 2.7 times as much as its own tail. For period and largest y, whose errors choose the mesh,
        that would cost a tenth of the time of a sweep.
        """
        in_space, in_time = self.growth
        stated = _stated(self.space * in_space, self.time * in_time, accuracy)
        larger = float(self.growth.max())
        stated[2:] = _stated(self.space * larger, self.time * larger, accuracy)[2:]
        return CycleErrors(*stated.tolist())

    def planned(self, accuracy: float) -> OrbitMesh:
        """The cheapest mesh that is expected to reach the accuracy."""
        here = self.mesh
        lowest = max(LEAST_ORDER, here.order - FEWER_ORDERS)
        orders = np.arange(lowest, min(LARGEST_ORDER, here.order + MOST_ORDERS) + 1)
        fewest = max(LEAST_INTERVALS, ceil(FEWER_INTERVALS * here.intervals))
        intervals = np.arange(fewest, min(MOST_GROWTH * here.intervals, MOST_INTERVALS) + 1)
        # Beyond what is known all falls as the paths do, and in time with the least power.
        least = np.minimum(self.fall, self.fall[APART])
        fall = np.where(orders < here.order, self.fall[:, None], least[:, None])
        space = self.space[:, None] * np.exp(fall * (here.order - orders))
        power = np.where(intervals < here.intervals, self.power[:, None], here.stages + 1)
        time = self.time[:, None] * ((here.intervals - 1) / (intervals - 1)) ** power
        errors = _stated(space[:, :, None], time[:, None, :], accuracy)
        enough = largest_error(*errors[:3]) <= AIM * accuracy
        meshes = [
            replace(here, order=int(orders[i]), intervals=int(intervals[np.argmax(enough[i])]))
            for i in np.flatnonzero(enough.any(axis=1))
        ]
        return min(meshes, key=lambda mesh: mesh.cost, default=here.finer)


def _stated(space: Array, time: Array, accuracy: float) -> Array:
    """What `CycleErrors` holds, (4, ...), of meshes that differ by (5, ...) from finer ones."""
    whole, apart = SAFETY * (space + time), space[APART] + time[APART]
    in_time = SHARE_IN_TIME * time[APART]
    either = EACH_OTHERS * sum(np.maximum(part[PERIOD], part[HEIGHT]) for part in (space, time))
    stated = [
        np.maximum(np.maximum(whole[PERIOD], PERIOD_SHARE * space[APART] + in_time), either),
        np.maximum(np.maximum(whole[HEIGHT], HEIGHT_SHARE * space[APART] + in_time), either),
        np.maximum(whole[OTHERS], OTHERS_SHARE * apart),
        whole[MULTIPLIER],
    ]
    least: Array = np.maximum(np.array(stated), max(LEAST_CLAIM * accuracy, ROUNDING))
    return least


def _tails(orbit: Orbit) -> Array:
    """In space and in time, no less than rounding, and the orbit's size, (3,)."""
    return np.append(np.maximum(lasting_tails(orbit), LEAST_TAIL), orbit.size)


def _growth(before: Array, after: Array) -> Array:
    """Of both parts of the error with the tails and the size, (3,) each; what falls is not relied on, (2,).

    Errors are as large as the squares of the tails in absolute units. Where a cycle dies at a Hopf point,
    which the mesh puts elsewhere, that of its size is as large as the reciprocal of its square.
    """
    growth: Array = np.maximum(_change(before, after), 1.0) * max((before[2] / after[2]) ** 2, 1.0)
    return growth


def _change(before: Array, after: Array) -> Array:
    """Ratio of the squares of the tails, in absolute units, in space and in time, (2,); (3,) each."""
    change: Array = ((after * after[2] / (before * before[2])) ** 2)[:2]
    return change


def calibration_of(
    here: OrbitMesh, space: Array, time: Array, orbit: Orbit, before: Calibration | None
) -> Calibration:
    """The calibration of a mesh with both parts of its error, (5,) each, and how fast they fall.

    orbit: on it, or near by. before: of an orbit near by, on this mesh or another, which tells how fast
    errors fall; without it the orbit does.
    """
    tails = _tails(orbit)
    if before is None:
        decay = FALL_BY_DECAY * tails_of(orbit).decay
        fall = np.full(PARTS, min(max(decay, LEAST_FALL), LARGEST_FALL))
        power = np.full(PARTS, POWER_BY_STAGES * orbit.stages)
        return Calibration(here, space, time, fall, power, tails, 0.0)
    there, fall, power = before.mesh, before.fall, before.power
    if there.order != here.order and there.elements == here.elements:
        fall = _fall(before.space, space, here.order - there.order)
    if there.intervals != here.intervals:
        power = _power(before.time, time, there, here)
    return Calibration(here, space, time, fall, power, tails, 0.0)


def _fall(before: Array, after: Array, orders: int) -> Array:
    """Of errors in space per order, from those before to those so many orders on, (5,) each."""
    fall: Array = np.clip(_logarithm(before, after) / orders, LEAST_FALL, LARGEST_FALL)
    return fall


def _power(before: Array, after: Array, there: OrbitMesh, here: OrbitMesh) -> Array:
    """Of the intervals with which errors in time fall, from those of one mesh to those of another, (5,)."""
    least = here.stages + 1
    steps = np.log((here.intervals - 1) / (there.intervals - 1))
    power: Array = np.clip(_logarithm(before, after) / steps, least, STEEPEST * least)
    return power


def _logarithm(before: Array, after: Array) -> Array:
    """Of the quotient of errors that may be 0, of any shape."""
    quotient: Array = np.log(np.maximum(before, 1e-300) / np.maximum(after, 1e-300))
    return quotient
