"""Compiled functions that only some runs call, compiled at the installation.

The functions that every run calls are loaded by the functions `warm_up` of the solvers. Without this module,
three solves would wait up to 40 s for the compiler: the first branch with a fold, the first spectra between
which a rod loses its stability, and the first arm that varies along its length.
"""

import numpy as np

from ..determinant.parameter_path import ParameterPath
from ..determinant.stability_changes import stability_change_between
from ..discretization.elements.mesh import uniform_mesh
from ..discretization.stress.form import StressForm
from ..model.material.profile import Profile
from ..model.material.rod_material import RodMaterial
from ..model.rod import Rod
from .changes.thresholds import ThresholdsRequest, solve_thresholds
from .cycle.limit_cycle import solve_cycle
from .cycle.rod_with_known_cycle import REFERENCE_REQUEST
from .orbit.matrix.linearisation import parameter_derivatives, reduced_stage_residual_variations
from .orbit.matrix.workspace import FactorStorage, NewtonWorkspace
from .orbit.orbit import Orbit
from .orbit.symmetry import REFLECTION
from .spectrum.path.carried_count import count_right_of_widest_gap
from .spectrum.path.eigenvalue_prediction import FollowedEigenvalues
from .spectrum.path.neighbouring_rods import NeighbouringRods, follow_spectra
from .spectrum.spectrum import SpectrumRequest

SAMPLE_ROD = Rod(F=40.0, k1=1e4, k2=1e2, gamma3=1e-2)
"""A uniform rod; any rod compiles the same functions."""
SAMPLE_CONE = Rod(F=6.0, k1=1e4, k2=1e2, gamma3=1e-2, taper=0.5)
"""An arm whose properties vary smoothly along its length."""
SAMPLE_SEGMENTED_ARM = Rod(
    F=30.0,
    k1=1e4,
    k2=1e2,
    gamma3=1e-2,
    material=RodMaterial(profile=Profile((0.0, 0.5, 0.5, 1.0), ((1.0,) * 6,) * 2 + ((0.8,) * 6,) * 2)),
)
"""An arm whose properties jump at its middle."""
SAMPLE_ACCURACY = 1e-4
"""Accuracy of the spectra and thresholds of both arms."""
SAMPLE_ORBIT_INTERVAL_COUNT = 2
"""Number of time intervals of the sample orbit: the smallest number for which an orbit has a mesh."""
SAMPLE_COLLOCATION_STAGES = 3
"""Number of collocation stages per interval of the sample orbit; other numbers need no new compilation."""


def warm_up() -> None:
    """Compiles the seldom used functions for uniform rods and for arms."""
    warm_up_uniform()
    warm_up_arms()


def warm_up_arms() -> None:
    """Solves spectra of neighbouring rods of a sweep, thresholds and a cycle, for arms that vary along their
    length."""
    path = ParameterPath(SAMPLE_CONE, "F")
    spectra = SpectrumRequest(2, SAMPLE_ACCURACY, certify=True)
    follow_spectra(NeighbouringRods(path, np.linspace(SAMPLE_CONE.F, 1.2 * SAMPLE_CONE.F, 12)), spectra)
    search = ThresholdsRequest(SAMPLE_SEGMENTED_ARM.F, SAMPLE_ACCURACY, certify=True, max_thresholds=1)
    for arm in (SAMPLE_CONE, SAMPLE_SEGMENTED_ARM):
        solve_thresholds(arm, search)
    solve_cycle(SAMPLE_SEGMENTED_ARM, REFERENCE_REQUEST, None, "F")


def warm_up_uniform() -> None:
    """Compiles the seldom used functions for uniform rods, by calls with arguments of the types used in runs;
    the values of the arguments have no meaning."""
    w = np.ones((1, 2), dtype=complex)
    stability_change_between(
        (SAMPLE_ROD.coefficients, SAMPLE_ROD.coefficient_derivative("F")), (1.0, 2.0), -w[0], w[0], 2
    )
    count_right_of_widest_gap(FollowedEigenvalues(w, w, np.zeros((1, 2)), np.zeros((1, 2), np.int64)), 0, 1)
    form = StressForm(SAMPLE_ROD, uniform_mesh(1, 4))
    states = np.zeros((1 + SAMPLE_ORBIT_INTERVAL_COUNT * SAMPLE_COLLOCATION_STAGES, form.unknown_count))
    orbit = Orbit.from_states(form, REFLECTION, 1.0, states, SAMPLE_COLLOCATION_STAGES)
    memory = FactorStorage(
        NewtonWorkspace(), SAMPLE_ORBIT_INTERVAL_COUNT, SAMPLE_COLLOCATION_STAGES, form.unknown_count
    )
    variations = np.zeros((1, len(orbit.values) + 1))
    equations = orbit.orbit_equations
    reduced_stage_residual_variations(
        orbit.values, equations, parameter_derivatives(form, "F"), variations, equations, memory.factors
    )
