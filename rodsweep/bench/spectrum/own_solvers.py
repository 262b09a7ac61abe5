"""rodsweep on one rod: the solver of its task, and Krylov-Schur alone at every size of the pencil.

Every solver returns the leading eigenvalues, largest real part first: WANTED_MODES, and one more if found,
because the last mode may be half of a complex pair.
"""

from functools import partial
from math import ceil

import numpy as np

from ...arrays import Complex
from ...discretization.elements.resolution import RESOLUTION, Resolution
from ...model.dispersion import most_amplified_wave
from ...model.rod import Rod
from ...solve.spectrum.krylov_schur import eigen_solver
from ...solve.spectrum.search import SpectrumRequest, solve_spectrum
from ...solve.spectrum.shift_invert import KRYLOV
from ..study import Contender

WANTED_MODES = 4
ACCURACY = 1e-12
"""Accuracy requested from rodsweep; its error does not depend on the request."""
ORDERS = (8, 10, 12, 14, 16, 18, 20, 24, 28, 32, 40, 56, 80)
"""Sizes of the pencil."""
PLAIN = "rodsweep, certificate off"
PROVED = "rodsweep, certificate on"
KRYLOV_SCHUR = "Krylov-Schur alone, same pencil"
THIS_TOOL, PENCIL = "this tool", "the same pencil"
"""Groups of methods in the figure."""


def own_spectrum(rod: Rod, certify: bool) -> Complex:
    """rodsweep as in its task, with automatic size, shape (modes,)."""
    return solve_spectrum(rod, SpectrumRequest(WANTED_MODES, ACCURACY, certify)).eigenvalues


def mesh_of(order: int) -> Resolution:
    """One element of the given order, or several equal elements of at most RESOLUTION.largest_order."""
    elements = ceil(order / RESOLUTION.largest_order)
    return Resolution(elements, ceil(order / elements))


def shift_of(rod: Rod) -> float:
    """Shift of rodsweep's own shift-and-invert."""
    return KRYLOV.shift_above_growth * most_amplified_wave(rod)[0]


def krylov_schur(rod: Rod, size: int) -> Complex:
    """SLEPc's Krylov-Schur, converged to rounding, without refinement on D, shape (modes,)."""
    w = eigen_solver(mesh_of(size)).solve(rod, shift_of(rod), WANTED_MODES, tight=True)
    return leading(w, WANTED_MODES + 1)


def leading(w: Complex, count: int) -> Complex:
    """The eigenvalues with the largest real parts, largest first; from shape (n,) to (count,)."""
    return w[np.argsort(-w.real, kind="stable")][:count]


def contenders() -> list[Contender]:
    """rodsweep with and without certificate, and Krylov-Schur at all sizes."""
    return [
        Contender(PLAIN, "", THIS_TOOL, partial(own_spectrum, certify=False)),
        Contender(PROVED, "", THIS_TOOL, partial(own_spectrum, certify=True)),
        *(Contender(KRYLOV_SCHUR, str(size), PENCIL, partial(krylov_schur, size=size)) for size in ORDERS),
    ]
