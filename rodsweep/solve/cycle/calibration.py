"""The errors of a mesh, calibrated by finer ones, for the cycles of a chain that are solved on it.

Two meshes of which one is coarser tell the fine one's error only by what it should be in units of the coarse
one's, which must be pessimistic. Where many cycles follow on one mesh, two finer meshes, one in space and one
in time, measure it at the first of them; at the others both parts are larger by as much as the squares of the
orbit's tails are, in absolute units. Two coarser meshes tell how fast both parts fall, hence which mesh costs
least.
"""

from dataclasses import dataclass, field, replace
from math import ceil, inf

import numpy as np

from ...arrays import Array
from ...discretization.resolution import LARGEST_ORDER
from .cycle_errors import LEAST_CLAIM, ROUNDING, CycleErrors
from .measures import CyclePath
from .newton import Converged, at_orbit, multiplier_change, multipliers_of, newton
from .orbit import Orbit
from .orbit_mesh import (
    LEAST_INTERVALS,
    LEAST_ORDER,
    MOST_INTERVALS,
    OrbitMesh,
    mesh_of,
    tails_of,
)
from .path_differences import APART, HEIGHT, OTHERS, PERIOD, path_differences

MORE_ORDERS, MORE_INTERVALS = 2, 1.4
"""What the finer meshes have more of."""
TOLERANCE, DISTANCE = 1e-2, 1e-3
"""What Newton's method leaves on the other meshes, in units of the accuracy, and how far from the orbit the
matrix may be that their multipliers are of."""
SAFETY = 3.0
HEIGHT_SHARE, PERIOD_SHARE, SHARE_IN_TIME = 0.08, 0.16, 0.005
"""Shares of the distance between the tip's paths that count at least as an error: a number may agree by luck,
and no more do so at the next cycle. In time they differ most in theta, which is stiff and matters least."""
AIM = 0.7
"""Share of the accuracy that a mesh is chosen for."""
LEAST_FALL, LARGEST_FALL = 0.5, 2.2
"""Bounds of the fall of errors in space per order, natural logarithm."""
STEEPEST = 2.0
"""Largest order in time, in units of the least, which is one more than the stages."""
FEWER_ORDERS, FEWER_INTERVALS, MOST_ORDERS, MOST_GROWTH = 3, 0.6, 12, 4
"""By how many orders, and times how many intervals, a mesh that is planned may differ."""
FARTHEST, LARGEST_GROWTH = 0.12, 2.0
"""Relative change of the parameter, and growth of the errors, beyond which it is made anew."""
MULTIPLIER = 4
"""Place of the largest multiplier's error, behind those of `path_differences`."""
PARTS = 5


@dataclass(frozen=True, eq=False)
class Calibration:
    """space, time: what of the mesh's error comes from each, (5,): `path_differences`, and the largest
    multiplier's, absolute.

    fall: of errors in space per order, natural logarithm, (5,); power: of the intervals with which those in
    time fall, (5,); tails: squared, in space and in time, where it was made, (2,); reach: relative change of
    the parameter since; growth: of both parts at an orbit since, (2,).
    """

    space: Array
    time: Array
    fall: Array
    power: Array
    tails: Array
    reach: float
    growth: Array = field(default_factory=lambda: np.ones(2))

    def pack(self) -> Array:
        """All of it as a flat array, (LENGTH,)."""
        return np.concatenate([self.space, self.time, self.fall, self.power, self.tails, [self.reach]])

    @classmethod
    def unpack(cls, flat: Array) -> "Calibration":
        """The reverse of `pack`, from its array, (LENGTH,)."""
        space, time, fall, power = flat[: 4 * PARTS].reshape(4, PARTS)
        return cls(space, time, fall, power, flat[4 * PARTS : -1], float(flat[-1]))

    def at(self, orbit: Orbit, change: float) -> "Calibration":
        """The same for an orbit of the next point, after a relative change of the parameter."""
        return replace(self, growth=np.maximum(_squares(orbit) / self.tails, 1.0), reach=self.reach + change)

    @property
    def outdated(self) -> "Calibration":
        """One that tells no more than how fast errors fall."""
        return replace(self, reach=inf)

    @property
    def holds(self) -> bool:
        """Whether it tells the errors of the orbit."""
        return self.reach <= FARTHEST and float(self.growth.max()) <= LARGEST_GROWTH

    def errors(self, accuracy: float) -> CycleErrors:
        """Of the orbit."""
        in_space, in_time = self.growth
        return _stated(self.space * in_space, self.time * in_time, accuracy)

    def planned(self, here: OrbitMesh, accuracy: float) -> OrbitMesh:
        """The cheapest mesh that is expected to reach the accuracy; here: the one that is calibrated."""
        lowest = max(LEAST_ORDER, here.order - FEWER_ORDERS)
        highest = min(LARGEST_ORDER, here.order + MOST_ORDERS)
        fewest = max(LEAST_INTERVALS, ceil(FEWER_INTERVALS * here.intervals))
        most = min(MOST_GROWTH * here.intervals, MOST_INTERVALS)
        enough: list[OrbitMesh] = []
        for order in range(lowest, highest + 1):
            # Beyond what is known all falls as the paths do, and in time with the least power.
            fall = self.fall if order < here.order else np.minimum(self.fall, self.fall[APART])
            space = self.space * np.exp(fall * (here.order - order))
            for K in range(fewest, most + 1):
                mesh = replace(here, order=order, intervals=K)
                if enough and mesh.cost >= enough[-1].cost:
                    break
                power = self.power if here.intervals > K else here.stages + 1
                time = self.time * ((here.intervals - 1) / (K - 1)) ** power
                if _stated(space, time, accuracy).largest <= AIM * accuracy:
                    enough.append(mesh)
                    break
        return enough[-1] if enough else here.finer


LENGTH = 4 * PARTS + 3
"""Of a packed calibration."""


def _stated(space: Array, time: Array, accuracy: float) -> CycleErrors:
    """The estimates for what a mesh differs by from finer ones, (5,)."""
    whole = SAFETY * (space + time)
    least, in_time = max(LEAST_CLAIM * accuracy, ROUNDING), SHARE_IN_TIME * time[APART]
    return CycleErrors(
        float(max(whole[PERIOD], PERIOD_SHARE * space[APART] + in_time, least)),
        float(max(whole[HEIGHT], HEIGHT_SHARE * space[APART] + in_time, least)),
        float(max(whole[OTHERS], space[APART] + time[APART], least)),
        float(max(whole[MULTIPLIER], least)),
    )


def _squares(orbit: Orbit) -> Array:
    """Of both tails in units of sqrt(energy), (2,)."""
    tails, size = tails_of(orbit), orbit.size
    return np.array([(size * max(tail, 1e-15)) ** 2 for tail in (tails.space, tails.time)])


def calibrated(found: Converged, accuracy: float, before: Calibration | None = None) -> Calibration:
    """The calibration of the mesh of an orbit; raises Unsolvable.

    before: of an orbit near by, on this mesh or another, whose errors fall alike; None: that is measured too.
    """
    orbit, here = found.orbit, mesh_of(found.orbit)
    path, rough = CyclePath(orbit), here.coarser

    def difference(mesh: OrbitMesh) -> Array:
        other = newton(mesh.carry(orbit), TOLERANCE * accuracy)
        change = multiplier_change(multipliers_of(found)[0], multipliers_of(at_orbit(other, DISTANCE))[0])
        return np.append(path_differences(path, CyclePath(other.orbit)), change)

    longer, least = ceil(MORE_INTERVALS * here.intervals), here.stages + 1
    space = difference(replace(here, order=here.order + MORE_ORDERS))
    time = difference(replace(here, intervals=longer))
    # The finer mesh has an error in time itself.
    whole = time / (1 - ((here.intervals - 1) / (longer - 1)) ** least)
    if before:
        return replace(before, space=space, time=whole, tails=_squares(orbit), reach=0.0, growth=np.ones(2))
    fall = _logarithm(difference(replace(here, order=rough.order)), space) / (here.order - rough.order)
    steps = np.log((here.intervals - 1) / (rough.intervals - 1))
    power = _logarithm(difference(replace(here, intervals=rough.intervals)), time) / steps
    fall, power = np.clip(fall, LEAST_FALL, LARGEST_FALL), np.clip(power, least, STEEPEST * least)
    return Calibration(space, whole, fall, power, _squares(orbit), 0.0)


def _logarithm(before: Array, after: Array) -> Array:
    """Of the quotient of errors that may be 0, of any shape."""
    quotient: Array = np.log(np.maximum(before, 1e-300) / np.maximum(after, 1e-300))
    return quotient
