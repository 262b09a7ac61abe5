"""rodsweep's own spectra in the benchmark, and what all methods share."""

import numpy as np

from ...arrays import Complex
from ...model.rod import Rod
from ...solve.spectrum.search import SpectrumRequest, solve_spectrum

WANTED_MODES = 4
ACCURACY = 1e-12
"""Accuracy requested from rodsweep; its error does not depend on the request."""
PLAIN = "rodsweep, certificate off"
PROVED = "rodsweep, certificate on"
KRYLOV_SCHUR = "Krylov-Schur alone, same pencil"
THIS_TOOL, PENCIL = "this tool", "the same pencil"
"""Groups of methods in the figure."""


def own_spectrum(rod: Rod, certify: bool) -> Complex:
    """rodsweep as in its task, with automatic size, shape (modes,)."""
    return solve_spectrum(rod, SpectrumRequest(WANTED_MODES, ACCURACY, certify)).eigenvalues


def leading(w: Complex, count: int) -> Complex:
    """The eigenvalues with the largest real parts, largest first; from shape (n,) to (count,)."""
    return w[np.argsort(-w.real, kind="stable")][:count]
