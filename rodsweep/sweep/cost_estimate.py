"""What a sweep will cost, before it starts: for spectra, unknowns and time a point from a sample."""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..discretization.elements.resolution import MOST_UNKNOWNS, expected_wave_number, resolution_for
from ..model.dispersion import most_amplified_wave
from .points.points import Points
from .points.stretches import Stretches

SAMPLE = 200
HARDER_IF_LARGER = frozenset({"k1", "F"})
"""Parameters of which the largest value decides what branches cost; of others the smallest."""
FIXED_MS, LINEAR_MS, CUBIC_MS = 0.03, 2.2e-3, 1.5e-7
"""Time of a solve with n unknowns: overhead, orthogonalisation and dense factorisation, measured."""
SPARSE_FROM, SPARSE_MS = 300, 8e-3
CERTIFICATE_MS = 0.15
FIRST_POINTS, FOLLOWED_MS = 2.0, 0.006
"""Points alone that the first point of a stretch costs as much as, and time of each point of it."""
LINE_MS, LINE_CERTIFICATE_MS = 24.0, 16.0
"""Time of a search for crossings along one parameter, a mean over 72 rods: some take four times as long."""
HOPF_SEARCH_MS, HOPF_CERTIFICATE_MS, HOPF_POINTS_MS = 25.0, 3.0, 18.0
"""Time of a search for the Hopf points of a rod, of its certificate, and of the normal forms of those that it
has, two or three: means over 90 rods."""
TWO_MESHES, FINER_MESH = 8.0, 4 / 3
"""Time of a spectrum on two meshes, in units of one that begins on one mesh: a mean over 800 rods; and the
unknowns of the second mesh in units of the first's."""
MODES_MS, GROWTH_MS = 1.5, 20.0
"""Time that the vectors take beside the eigenvalues, in units of the modes squared, because the mesh grows
with them, and that the growth takes: means over 24 rods."""
CYCLE_SECONDS, CHAINED_CYCLE_SECONDS, MARCHED_CYCLE_SECONDS = 0.1, 0.01, 0.25
"""Time of a limit cycle from the leading mode, and from its neighbour: about those of the benchmark; and by
time integration alone to 1e-5, the mean over 40 rods."""
BRANCH_SECONDS, BRANCH_ACCURACY, BRANCH_BENDING = 0.004, -0.17, 1.5
"""All branches of a rod take BRANCH_SECONDS F (accuracy/1e-7)^BRANCH_ACCURACY (1 + F/k2)^BRANCH_BENDING;
F is the largest of the range, or k1. Fourteen random rods (F up to 60 to 200, k2 from 12 to 9000, accuracies
from 1e-4 to 1e-9) took 0.3 to 21 s, all within a factor of three and most within two; some near F = k1 take
four times as long."""
MEMORY_PER_UNKNOWN = 40_000
BASE_MEMORY = 200_000_000


@dataclass(frozen=True, slots=True)
class Estimate:
    """For one core like that of docs/performance.md."""

    seconds: float
    """Time of the whole sweep on one rank."""
    memory: int = BASE_MEMORY
    """Bytes per rank."""
    unknowns: tuple[int, int] | None = None
    """Smallest and largest number of unknowns over the sample; None where there is no mesh."""
    too_large: int = 0
    """Sampled points whose mesh would exceed the limit."""


def estimate_lines(lines: int, certify: bool) -> Estimate:
    """The cost of searching `lines` rods for crossings, each along one parameter."""
    return Estimate(lines * 1e-3 * (LINE_MS + (LINE_CERTIFICATE_MS if certify else 0)))


def estimate_criticality(rods: int, certify: bool) -> Estimate:
    """The cost of the Hopf points of `rods` rods and their normal forms."""
    each = HOPF_SEARCH_MS + HOPF_POINTS_MS + (HOPF_CERTIFICATE_MS if certify else 0)
    return Estimate(rods * 1e-3 * each)


def estimate_branches(points: Points, along: str, reach: tuple[float, float], accuracy: float) -> Estimate:
    """The cost of the branches of cycles of all rods, each along a parameter from a value to another.

    points: the rods, without that parameter. accuracy: that of the cycles, relative.
    """
    indices = _sample(points)
    values: dict[str, Array | float] = points.values_of(indices) | {along: reach[along in HARDER_IF_LARGER]}
    F = np.clip(values["F"], 0.0, values["k1"])  # nothing that is pulled beats
    per_force = BRANCH_SECONDS * (accuracy / 1e-7) ** BRANCH_ACCURACY
    each = per_force * F * (1 + F / values["k2"]) ** BRANCH_BENDING
    return Estimate(float(np.mean(each)) * points.count if indices.size else 0.0)


def estimate_modes(spectra: Estimate, count: int, modes: int, growth: bool) -> Estimate:
    """The cost of modes at `count` points, `modes` each, from that of their eigenvalues alone."""
    more = count * 1e-3 * (MODES_MS * modes**2 + (GROWTH_MS if growth else 0))
    return replace(spectra, seconds=spectra.seconds + more, unknowns=None)


def estimate_followed(alone: Estimate, stretches: Stretches) -> Estimate:
    """The cost of spectra along stretches, from that of each point alone: of few points in full."""
    points = math.prod(stretches.shape)
    share = FIRST_POINTS * stretches.count / points
    return replace(alone, seconds=alone.seconds * min(1.0, share) + points * 1e-3 * FOLLOWED_MS)


def estimate_two_meshes(points: Points, modes: int, accuracy: float) -> Estimate:
    """The cost of spectra by Krylov-Schur on two meshes alone."""
    alone = estimate_spectra(points, modes, accuracy, certify=False)
    unknowns = alone.unknowns and (alone.unknowns[0], math.ceil(FINER_MESH * alone.unknowns[1]))
    return replace(alone, seconds=TWO_MESHES * alone.seconds, unknowns=unknowns)


def estimate_spectra(points: Points, modes: int, accuracy: float, certify: bool) -> Estimate:
    """The cost of a sweep from points spread evenly over it."""
    sizes = []
    for index in _sample(points):
        _, wave = most_amplified_wave(points.rod(int(index)))
        sizes.append(resolution_for(expected_wave_number(modes, wave), accuracy).unknowns)
    if not sizes:  # no rod covers any point of the sample
        return Estimate(0.0)
    n = np.minimum(np.array(sizes, dtype=float), MOST_UNKNOWNS)
    dense = FIXED_MS + LINEAR_MS * n + CUBIC_MS * n**3
    each = np.where(n <= SPARSE_FROM, dense, SPARSE_MS * n) + (CERTIFICATE_MS if certify else 0)
    memory = BASE_MEMORY + int(n.max()) * MEMORY_PER_UNKNOWN
    too_large = int((np.array(sizes) > MOST_UNKNOWNS).sum())
    return Estimate(float(each.mean()) * 1e-3 * points.count, memory, (min(sizes), max(sizes)), too_large)


def _sample(points: Points) -> NDArray[np.int64]:
    """The flat indices, (n,), of points spread evenly over a sweep that have a rod."""
    indices = np.unique(np.linspace(0, points.count - 1, min(SAMPLE, points.count)).astype(np.int64))
    return indices[[points.has_rod(int(index)) for index in indices]]
