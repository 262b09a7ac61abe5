"""The mesh on which a cycle reaches an accuracy at least cost.

A cycle on two meshes tells one error, not what of it comes from space and what from time. A third mesh, as
coarse as the one in space and as fine as the other in time, tells them apart; from there both errors go on as
they fall between the two.
"""

from dataclasses import replace
from math import ceil

import numpy as np

from ...discretization.resolution import LARGEST_ORDER
from ..point import Unsolvable
from .cycle_errors import coarse_errors, space_ratio
from .measures import CyclePath
from .newton import newton
from .orbit import Orbit
from .orbit_mesh import COARSER_ORDER, LEAST_INTERVALS, LEAST_ORDER, MOST_INTERVALS, OrbitMesh, mesh_of

AIM = 0.6
"""Share of the accuracy that a mesh is chosen for."""
FEWER_ORDERS, MORE_ORDERS = 2, 12
FEWER_INTERVALS, MORE_INTERVALS = 0.75, 4
"""By how many orders, and times how many intervals, the planned mesh may differ from one of known errors: on
coarser ones errors grow faster than they should."""
TOLERANCE = 1e-2
"""What Newton's method leaves on the third mesh, in units of the accuracy."""


def planned_mesh(coarse: Orbit, fine: Orbit, accuracy: float) -> OrbitMesh:
    """The cheapest mesh whose error, as two meshes tell it, is expected to reach the accuracy.

    Where the third mesh has no cycle, or no mesh is enough, one that is finer by a step in both.
    """
    here, rough = mesh_of(fine), mesh_of(coarse)
    try:
        between = newton(replace(rough, intervals=here.intervals).carry(fine), TOLERANCE * accuracy)
    except Unsolvable:
        return here.finer
    paths = CyclePath(coarse), CyclePath(between.orbit), CyclePath(fine)
    in_time, in_space = (coarse_errors(*pair).largest for pair in (paths[:2], paths[1:]))
    ratio = space_ratio(fine)
    lowest, highest = (
        max(LEAST_ORDER, here.order - FEWER_ORDERS),
        min(LARGEST_ORDER, here.order + MORE_ORDERS),
    )
    fewest = max(LEAST_INTERVALS, ceil(FEWER_INTERVALS * here.intervals))
    intervals = np.arange(fewest, min(MORE_INTERVALS * here.intervals, MOST_INTERVALS) + 1)
    fewer = np.array([replace(here, intervals=int(K)).coarser.intervals for K in intervals])
    time = in_time * ((rough.intervals - 1) / (fewer - 1)) ** (here.stages + 1)
    time_ratio = ((fewer - 1) / (intervals - 1)) ** (here.stages + 1)
    enough = []
    for order in range(lowest, highest + 1):
        space = in_space * ratio ** ((order - here.order) / COARSER_ORDER)
        reached = np.maximum(ratio, time_ratio) * (space + time) <= AIM * accuracy
        enough += [replace(here, order=order, intervals=int(K)) for K in intervals[reached][:1]]
    return min(enough, key=lambda mesh: mesh.cost, default=here.finer)
