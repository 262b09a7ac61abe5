"""The least stretch h1 of a cycle over the whole rod and the whole period: at h1 = 0 the model ends."""

from math import inf

import numpy as np

from ....arrays import Array
from ....discretization.elements.periodic import maxima, samples_of
from ...orbit.measures import CyclePath
from ...orbit.orbit import Orbit
from ..arc import ArcPoint

PLACES = 8
"""Places in a node's neighbourhood at which the least stretch is looked for."""
SAFE_STRETCH = 0.2
"""Least h1 at the nodes above which it is positive between them too."""
SAFE_AT_PLACES = 0.02
"""The same at PLACES places between two nodes, which a polynomial that is resolved hardly leaves."""


def stretch_at(point: ArcPoint) -> float:
    """The least h1 of a cycle in space and time, or of its nodes where that is far from 0."""
    rough = point.cycle.measures.least_stretch
    return rough if rough > SAFE_STRETCH else least_stretch(point.cycle.path, SAFE_AT_PLACES)


def stretch_of(orbit: Orbit) -> float:
    """The same of an orbit alone."""
    rod, pull = orbit.form.nodal, orbit.form.layout.field(orbit.points, "n1")
    nodes = pull.shape[-1]
    rough = float((rod.rest[0, :nodes] + rod.compliance[0, :nodes] * pull).min())
    return rough if rough > SAFE_STRETCH else least_stretch(CyclePath(orbit), SAFE_AT_PLACES)


def least_stretch(path: CyclePath, enough: float = inf) -> float:
    """The least h1 of a cycle over the whole rod and the whole period.

    enough: a least value at PLACES times as many places as nodes that is as good as the true one.
    """
    from scipy.optimize import minimize_scalar  # a tenth of a second of every start

    grid, c = path.orbit.form.mesh, path.strain_coefficients[:, 0]

    def least(u: Array) -> Array:
        at = -np.ascontiguousarray(c @ grid.evaluation(u).T)
        return -maxima(at, samples_of(at, 8 * len(c)))

    places = np.linspace(0.0, 1.0, PLACES * len(grid.positions))
    values = least(places)
    best = int(np.argmin(values))
    if values[best] > enough:
        return float(values[best])
    ends = places[max(best - 1, 0)], places[min(best + 1, len(places) - 1)]
    found = minimize_scalar(
        lambda u: float(least(np.array([u]))[0]), bounds=ends, method="bounded", options={"xatol": 1e-9}
    )
    return min(float(values[best]), float(found.fun))
