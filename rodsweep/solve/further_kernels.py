"""Compiled functions that a run calls seldom, compiled at the installation.

A run loads what every point needs by the functions `warm_up` of the solvers. The first branch with a fold,
and the first spectra between which a rod loses its stability, would wait for the functions below.
"""

import numpy as np

from ..determinant.stability_changes import stability_change_between
from ..discretization.elements.mesh import mesh
from ..discretization.stress.form import StressForm
from ..model.rod import Rod
from .orbit.matrix.linearisation import change_along, reduced_variations
from .orbit.matrix.workspace import MatrixMemory, NewtonWorkspace
from .orbit.orbit import Orbit
from .orbit.symmetry import REFLECTION
from .spectrum.path.carried_count import widest_gap
from .spectrum.path.prediction import Track

SAMPLE_ROD = Rod(F=40.0, k1=1e4, k2=1e2, gamma3=1e-2)
SAMPLE_INTERVALS = 2
"""Number of intervals in time, the smallest for which an orbit has a mesh."""
SAMPLE_STAGES = 3
"""Number of stages of an interval, for which the functions are not compiled anew."""


def warm_up() -> None:
    """Calls each function with arrays of the types that runs have, and of values without a meaning."""
    w = np.ones((1, 2), dtype=complex)
    stability_change_between((SAMPLE_ROD.coefficients, SAMPLE_ROD.direction("F")), (1.0, 2.0), -w[0], w[0], 2)
    widest_gap(Track(w, w, np.zeros((1, 2)), np.zeros((1, 2), np.int64)), 0, 1)
    form = StressForm(SAMPLE_ROD, mesh(1, 4))
    states = np.zeros((1 + SAMPLE_INTERVALS * SAMPLE_STAGES, form.unknowns))
    orbit = Orbit.of(form, REFLECTION, 1.0, states, SAMPLE_STAGES)
    memory = MatrixMemory(NewtonWorkspace(), SAMPLE_INTERVALS, SAMPLE_STAGES, form.unknowns)
    variations = np.zeros((1, len(orbit.values) + 1))
    of_rod = orbit.semidiscrete
    reduced_variations(orbit.values, of_rod, change_along(form, "F"), variations, of_rod, memory.factors)
