"""rodsweep on one rod: as its task uses it, and its Krylov-Schur solver alone at every size of its pencil.

All give the leading eigenvalues, WANTED_MODES and one more where they are there, for a pair may straddle the
end, largest real part first.
"""

from functools import partial
from math import ceil

import numpy as np

from ...arrays import Complex
from ...discretization.elements.resolution import LARGEST_ORDER, Resolution
from ...model.dispersion import most_amplified_wave
from ...model.rod import Rod
from ...solve.spectrum.krylov_schur import eigen_solver
from ...solve.spectrum.search import SHIFT_ABOVE_GROWTH, SpectrumRequest, solve_spectrum
from ..study import Contender

WANTED_MODES = 4
ACCURACY = 1e-12
"""Asked of rodsweep, whose error does not depend on it."""
ORDERS = (8, 10, 12, 14, 16, 18, 20, 24, 28, 32, 40, 56, 80)
"""Sizes of the pencil."""
PLAIN, PROVED = "rodsweep, certificate off", "rodsweep, certificate on"
KRYLOV_SCHUR = "Krylov-Schur alone, same pencil"
THIS_TOOL, PENCIL = "this tool", "the same pencil"
"""Groups of a figure."""


def own_spectrum(rod: Rod, certify: bool) -> Complex:
    """This tool as its task uses it, shape (modes,); it chooses the size itself."""
    return solve_spectrum(rod, SpectrumRequest(WANTED_MODES, ACCURACY, certify)).eigenvalues


def mesh_of(order: int) -> Resolution:
    """One element of this order, or as many equal ones as keep to LARGEST_ORDER."""
    elements = ceil(order / LARGEST_ORDER)
    return Resolution(elements, ceil(order / elements))


def shift_of(rod: Rod) -> float:
    """The shift of rodsweep's own shift-and-invert."""
    return SHIFT_ABOVE_GROWTH * most_amplified_wave(rod)[0]


def krylov_schur(rod: Rod, size: int) -> Complex:
    """SLEPc's Krylov-Schur to its last digit, without refinement on D, shape (modes,)."""
    w = eigen_solver(mesh_of(size)).solve(rod, shift_of(rod), WANTED_MODES, tight=True)
    return leading(w, WANTED_MODES + 1)


def leading(w: Complex, count: int) -> Complex:
    """The eigenvalues with the largest real parts, largest first, shapes (n,) and (count,)."""
    return w[np.argsort(-w.real, kind="stable")][:count]


def contenders() -> list[Contender]:
    """rodsweep's ways, the solver alone at all sizes."""
    return [
        Contender(PLAIN, "", THIS_TOOL, partial(own_spectrum, certify=False)),
        Contender(PROVED, "", THIS_TOOL, partial(own_spectrum, certify=True)),
        *(Contender(KRYLOV_SCHUR, str(size), PENCIL, partial(krylov_schur, size=size)) for size in ORDERS),
    ]
