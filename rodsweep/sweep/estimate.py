"""What a spectrum sweep will cost, before it starts: unknowns and time a point, from a sample."""

from dataclasses import dataclass

import numpy as np

from ..discretization.resolution import MOST_UNKNOWNS, expected_wave_number, resolution_for
from ..model.dispersion import most_amplified_wave
from .grid import Points

SAMPLE = 200
FIXED_MS, LINEAR_MS, CUBIC_MS = 0.15, 1.0e-3, 1.2e-7
"""Time of a solve with n unknowns: overhead, orthogonalisation and dense factorisation, measured."""
SPARSE_FROM, SPARSE_MS = 300, 8e-3
CERTIFICATE_MS = 0.2
MEMORY_PER_UNKNOWN = 40_000
BASE_MEMORY = 200_000_000


@dataclass(frozen=True, slots=True)
class Estimate:
    """For one core like that of the README's benchmark."""

    unknowns: tuple[int, int]
    """Smallest and largest number of unknowns over the sample."""
    seconds: float
    """Time of the whole sweep on one rank."""
    memory: int
    """Bytes per rank."""
    too_large: int
    """Sampled points whose mesh would exceed the limit."""


def estimate(points: Points, modes: int, accuracy: float, certify: bool) -> Estimate:
    """The cost of a sweep from points spread evenly over it."""
    indices = np.unique(np.linspace(0, points.count - 1, min(SAMPLE, points.count)).astype(np.int64))
    sizes = []
    for index in indices:
        _, wave = most_amplified_wave(points.rod(int(index)))
        sizes.append(resolution_for(expected_wave_number(modes, wave), accuracy).unknowns)
    n = np.minimum(np.array(sizes, dtype=float), MOST_UNKNOWNS)
    dense = FIXED_MS + LINEAR_MS * n + CUBIC_MS * n**3
    each = np.where(n <= SPARSE_FROM, dense, SPARSE_MS * n) + (CERTIFICATE_MS if certify else 0)
    memory = BASE_MEMORY + int(n.max()) * MEMORY_PER_UNKNOWN
    return Estimate(
        (min(sizes), max(sizes)),
        float(each.mean()) * 1e-3 * points.count,
        memory,
        int((np.array(sizes) > MOST_UNKNOWNS).sum()),
    )
