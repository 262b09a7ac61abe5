"""The least stretch h1 of a cycle over the whole rod and period; the model is valid for h1 > 0 only."""

from dataclasses import dataclass
from math import inf

import numpy as np

from ....arrays import Array, Complex
from ....discretization.element_strains import index_before_jump
from ....discretization.elements.periodic import maxima, series_samples
from ...orbit.measures import CyclePath
from ...orbit.orbit import Orbit
from ..arc import ArcPoint


@dataclass(frozen=True, slots=True, kw_only=True)
class LeastStretchSettings:
    """Settings for the search for the least stretch of a cycle."""

    places_per_node: int = 8
    """Number of places per node at which the least stretch is sampled."""
    times_per_harmonic: int = 8
    """Number of times per harmonic at which the least stretch of one place is sampled."""
    place_tolerance: float = 1e-9
    """Tolerance of the place of the least stretch, in L; the stretch has the square of this as its error."""
    safe_at_nodes: float = 0.2
    """If h1 exceeds this limit at all nodes, h1 is positive between the nodes too."""
    safe_at_places: float = 0.02
    """If h1 exceeds this limit at all sampled places, h1 is positive everywhere: a resolved polynomial hardly
    varies more."""


LEAST_STRETCH = LeastStretchSettings()


def stretch_at(point: ArcPoint) -> float:
    """The least h1 of a cycle in space and time; the least nodal value if that is far from 0."""
    rough = point.cycle.measures.least_stretch
    if rough > LEAST_STRETCH.safe_at_nodes:
        return rough
    return least_stretch(point.cycle.path, LEAST_STRETCH.safe_at_places)


def stretch_of(orbit: Orbit) -> float:
    """`stretch_at` for an orbit alone."""
    rough = orbit.form.least_stretch(orbit.points)
    if rough > LEAST_STRETCH.safe_at_nodes:
        return rough
    return least_stretch(CyclePath(orbit), LEAST_STRETCH.safe_at_places)


def least_stretch(path: CyclePath, enough: float = inf) -> float:
    """The least h1 of a cycle over the whole rod and the whole period.

    enough: if the least sampled value exceeds this, that value is returned without a search between the
    samples.
    """
    from scipy.optimize import minimize_scalar  # slow import: 0.1 s, for few runs

    form = path.orbit.form
    grid = form.mesh
    c = path.strain_coefficients[:, 0]

    def least_of(coefficients: Complex) -> Array:
        at = -np.ascontiguousarray(coefficients)
        return -maxima(at, series_samples(at, LEAST_STRETCH.times_per_harmonic * len(c)))

    def least(u: Array) -> Array:
        return least_of(c @ grid.evaluation_by_element(u).T)

    before = [index_before_jump(int(node), grid.order) for node in form.nodal.jumps]
    at_jumps = float(least_of(c[:, before + [place + 1 for place in before]]).min(initial=inf))
    places = np.linspace(0.0, 1.0, LEAST_STRETCH.places_per_node * len(grid.positions))
    values = least(places)
    best = int(np.argmin(values))
    rough = min(float(values[best]), at_jumps)
    if rough > enough:
        return rough
    ends = places[max(best - 1, 0)], places[min(best + 1, len(places) - 1)]
    tolerance = {"xatol": LEAST_STRETCH.place_tolerance}
    found = minimize_scalar(
        lambda u: float(least(np.array([u]))[0]), bounds=ends, method="bounded", options=tolerance
    )
    return min(rough, float(found.fun))
