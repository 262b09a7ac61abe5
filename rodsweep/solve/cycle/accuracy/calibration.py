"""Calibration: the measured errors of a mesh, reused for the cycles that are solved on it next.

The errors in space and in time fall with the mesh at rates that the decay of the orbit's coefficients
estimates; two measured meshes give the rates more accurately. The rates choose the cheapest sufficient mesh.
Along a chain of cycles the errors are measured at the first cycle on a mesh. At later cycles they are scaled
up as the orbit's tails grow.
"""

from dataclasses import dataclass, field, replace
from math import ceil, inf

import numpy as np

from ....arrays import Array
from ....determinant.exponents import EXPONENTS
from ....discretization.elements.resolution import RESOLUTION
from ...orbit.orbit import Orbit
from ...orbit.orbit_mesh import ORBIT_MESH, OrbitMesh
from ...orbit.path_differences import LARGEST_Y, PERIOD_CHANGE, WHOLE_PATH, WORST_EXTREMUM
from ...orbit.tails import lasting_tails, tails_of
from .calibration_settings import CALIBRATION
from .cycle_errors import CYCLE_ERRORS, CycleErrors, largest_error

MULTIPLIER = 4
"""Index of the largest multiplier's error, behind the indices of `path_differences`."""
ERROR_COUNT = 5
"""Number of error quantities."""


@dataclass(frozen=True, eq=False)
class Calibration:
    """Errors of a mesh in space and in time, (5,) each: `path_differences` and the largest multiplier's.

    All errors are relative, but the multiplier's is absolute.
    """

    mesh: OrbitMesh
    space: Array
    time: Array
    fall: Array
    """Decay of errors in space per order, natural logarithm, (5,)."""
    power: Array
    """Order of errors in time, (5,)."""
    tails: Array
    """`lasting_tails` and the orbit's size at the calibration, (3,)."""
    reach: float
    """Relative change of the parameter since the calibration."""
    growth: Array = field(default_factory=lambda: np.ones(2))
    """Factors by which the errors in space and in time have grown to a later orbit, (2,)."""

    def arrays(self) -> dict[str, Array]:
        """Named arrays: errors and rates (5,), tails (3,), reach and mesh; growth belongs to one orbit."""
        errors = {name: getattr(self, name) for name in ("space", "time", "fall", "power", "tails")}
        numbers = {"reach": np.array(self.reach), "calibrated_mesh": self.mesh.numbers}
        return errors | numbers

    @classmethod
    def from_arrays(cls, arrays: dict[str, Array]) -> "Calibration":
        """The calibration from stored `arrays`, with the shapes given there."""
        mesh = OrbitMesh.from_numbers(arrays["calibrated_mesh"])
        errors = {name: arrays[name] for name in ("space", "time", "fall", "power", "tails")}
        return cls(mesh=mesh, reach=float(arrays["reach"]), **errors)

    def at(self, orbit: Orbit, change: float) -> "Calibration":
        """The calibration for the orbit of the next point, after a relative change of the parameter."""
        tails = _tails(orbit)
        # Errors are relative to the size: of a cycle that shrinks they must be measured anew.
        dies = tails[-1] < CALIBRATION.min_size_ratio * self.tails[-1]
        return replace(self, growth=_growth(self.tails, tails), reach=inf if dies else self.reach + change)

    def on_branch(self, orbit: Orbit) -> "Calibration":
        """The calibration for an orbit of a branch that is parametrised by the moment at the clamp.

        The moment fixes the size of each cycle, so that no error grows because cycles shrink.
        """
        growth = _growth(self.tails, _tails(orbit) * np.array([1.0, 1.0, 0.0]) + self.tails * (0.0, 0.0, 1.0))
        return replace(self, growth=growth)

    @property
    def outdated(self) -> "Calibration":
        """A copy that is used for its convergence rates only: its errors no longer apply."""
        return replace(self, reach=inf)

    @property
    def holds(self) -> bool:
        """Whether the calibration still applies to the orbit."""
        return self.reach <= CALIBRATION.max_reach and float(self.growth.max()) <= CALIBRATION.max_growth

    def lasts(self, change: float) -> bool:
        """Whether the calibration may apply after a further relative change of the parameter."""
        return self.reach + change <= CALIBRATION.max_reach

    def least(self, orbit: Orbit) -> tuple[Array, Array]:
        """Smallest errors in space and in time, (5,) each, of a new calibration of this mesh at an orbit."""
        in_space, in_time = CALIBRATION.min_repeated_share * np.minimum(
            _change(self.tails, _tails(orbit)), 1.0
        )
        return in_space * self.space, in_time * self.time

    def errors(self, accuracy: float) -> CycleErrors:
        """Errors of the orbit.

        The larger growth applies to both parts of the errors of multiplier and other extrema, because one
        part was seen to grow 2.7 times as much as the tail. For period and largest y, whose errors choose the
        mesh, the larger growth would cost a tenth of a sweep's time.
        """
        in_space, in_time = self.growth
        stated = _stated(self.space * in_space, self.time * in_time, accuracy)
        larger = float(self.growth.max())
        # Extrema and multipliers mix both parts of the error, so the larger growth counts for them.
        stated[2:] = _stated(self.space * larger, self.time * larger, accuracy)[2:]
        return CycleErrors(*stated.tolist())

    def planned(self, accuracy: float) -> OrbitMesh:
        """The cheapest mesh that is expected to reach the accuracy."""
        present = self.mesh
        lowest = max(ORBIT_MESH.min_order, present.order - CALIBRATION.max_fewer_orders)
        orders = np.arange(lowest, min(RESOLUTION.max_order, present.order + CALIBRATION.max_more_orders) + 1)
        fewest = max(ORBIT_MESH.min_intervals, ceil(CALIBRATION.min_interval_ratio * present.intervals))
        most = min(CALIBRATION.max_interval_ratio * present.intervals, ORBIT_MESH.max_intervals)
        intervals = np.arange(fewest, most + 1)
        # Rates are measured up to the present mesh. On finer meshes errors may fall no faster than the paths'
        # distance, and in time with the smallest order.
        least = np.minimum(self.fall, self.fall[WHOLE_PATH])
        fall = np.where(orders < present.order, self.fall[:, None], least[:, None])
        space = self.space[:, None] * np.exp(fall * (present.order - orders))
        # Towards finer meshes the order is taken at its smallest, since it was measured on coarser ones.
        power = np.where(intervals < present.intervals, self.power[:, None], present.stages + 1)
        time = self.time[:, None] * (present.full_intervals / (intervals - 1)) ** power
        errors = _stated(space[:, :, None], time[:, None, :], accuracy)
        enough = largest_error(*errors[:3]) <= CALIBRATION.planned_error * accuracy
        meshes = [
            replace(present, order=int(orders[i]), intervals=int(intervals[np.argmax(enough[i])]))
            for i in np.flatnonzero(enough.any(axis=1))
        ]
        return min(meshes, key=lambda mesh: mesh.cost, default=present.finer)


def _stated(space: Array, time: Array, accuracy: float) -> Array:
    """Errors of `CycleErrors`, (4, ...), from the parts of the error in space and in time, (5, ...) each."""
    whole = CALIBRATION.safety * (space + time)
    apart = space[WHOLE_PATH] + time[WHOLE_PATH]
    in_time = CALIBRATION.share_in_time * time[WHOLE_PATH]
    parts = [np.maximum(part[PERIOD_CHANGE], part[LARGEST_Y]) for part in (space, time)]
    either = CALIBRATION.mutual_bound * (parts[0] + parts[1])
    of_period = CALIBRATION.period_share * space[WHOLE_PATH] + in_time
    of_height = CALIBRATION.height_share * space[WHOLE_PATH] + in_time
    stated = [
        np.maximum(np.maximum(whole[PERIOD_CHANGE], of_period), either),
        np.maximum(np.maximum(whole[LARGEST_Y], of_height), either),
        np.maximum(whole[WORST_EXTREMUM], CALIBRATION.others_share * apart),
        whole[MULTIPLIER],
    ]
    least: Array = np.maximum(np.array(stated), max(CYCLE_ERRORS.min_claim * accuracy, CYCLE_ERRORS.rounding))
    return least


def _tails(orbit: Orbit) -> Array:
    """Tails in space and in time, at least rounding errors, and the orbit's size, (3,)."""
    return np.append(np.maximum(lasting_tails(orbit), CALIBRATION.min_tail), orbit.size)


def _growth(before: Array, after: Array) -> Array:
    """Growth of the errors in space and in time, (2,), at least 1.

    before, after: tails in space and in time, and size, (3,) each.

    Absolute errors grow as the squares of the tails. Where a cycle ends at a Hopf point, whose position
    depends on the mesh, the error of its size grows as the reciprocal of the squared size. A decrease is not
    relied on.
    """
    # Errors are of second order in the tails; a decrease is not trusted, hence at least 1.
    growth: Array = np.maximum(_change(before, after), 1.0) * max((before[2] / after[2]) ** 2, 1.0)
    return growth


def _change(before: Array, after: Array) -> Array:
    """Ratio of the squared absolute tails in space and in time, (2,), from tails and size, (3,) each."""
    change: Array = ((after * after[2] / (before * before[2])) ** 2)[:2]
    return change


def calibration_of(
    mesh: OrbitMesh, space: Array, time: Array, orbit: Orbit, before: Calibration | None
) -> Calibration:
    """Calibration of a mesh with errors in space and in time, (5,) each.

    orbit: orbit on the mesh or nearby. before: calibration at a nearby orbit, on any mesh, with the rates at
    which errors fall; None to take the rates from the orbit's coefficients.
    """
    tails = _tails(orbit)
    if before is None:
        decay = CALIBRATION.fall_by_decay * tails_of(orbit).decay
        fall = np.full(ERROR_COUNT, min(max(decay, CALIBRATION.min_fall), CALIBRATION.max_fall))
        power = np.full(ERROR_COUNT, CALIBRATION.power_by_stages * orbit.stages)
        return Calibration(mesh, space, time, fall, power, tails, 0.0)
    previous = before.mesh
    fall = before.fall
    power = before.power
    if previous.order != mesh.order and previous.edges == mesh.edges:
        fall = _fall(before.space, space, mesh.order - previous.order)
    if previous.intervals != mesh.intervals:
        power = _power(before.time, time, previous, mesh)
    return Calibration(mesh, space, time, fall, power, tails, 0.0)


def _fall(before: Array, after: Array, orders: int) -> Array:
    """Decay of errors in space per order, (5,), from errors before and after added orders, (5,) each."""
    fall: Array = np.clip(_logarithm(before, after) / orders, CALIBRATION.min_fall, CALIBRATION.max_fall)
    return fall


def _power(before: Array, after: Array, previous: OrbitMesh, mesh: OrbitMesh) -> Array:
    """Order of errors in time, (5,), from errors, (5,) each, on two meshes with different intervals."""
    # Twice the stages minus one is the order of Radau IIA; stages + 1 is the least that stiff problems keep.
    least = mesh.stages + 1
    steps = np.log(mesh.full_intervals / previous.full_intervals)
    power: Array = np.clip(_logarithm(before, after) / steps, least, CALIBRATION.max_power_ratio * least)
    return power


def _logarithm(before: Array, after: Array) -> Array:
    """Logarithm of the quotient of two errors, of any shape; an error may be 0."""
    least = EXPONENTS.least_divisor
    quotient: Array = np.log(np.maximum(before, least) / np.maximum(after, least))
    return quotient
