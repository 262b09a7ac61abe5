"""Time integrators that rodsweep does not use: further schemes of PETSc, SciPy, and CVODE of SUNDIALS."""

import warnings
from functools import partial
from typing import Any

import numpy as np
import scipy.integrate

from rodsweep.arrays import Array
from rodsweep.bench.limit_cycle.default_integrator import (
    SETTLING_INTEGRATOR_TOLERANCES,
    IntegrationTask,
    IntegratorWithTolerances,
    petsc_trajectory,
)
from rodsweep.discretization.stress.rates import write_rate, write_rate_jacobian
from rodsweep.solve.motion.integrator import EndReason, Trajectory

from ..installed import optional_module

FIRST_STEP = 1e-3
"""First step of Radau, as a fraction of the duration."""
FIRST_MULTISTEP_STEP = 1e-5
"""First step of multistep methods, as a fraction of the duration. These methods start with order 1, and LSODA
fails if the first step is too long."""
CVODE = "CVODE"
CVODE_MODULE = "sksundae.cvode"
"""Import name of CVODE in scikit-sundae, which the optional extra `cvode` of rodsweep installs."""
CVODE_SKIPPED = f"{CVODE} is skipped: scikit-sundae is not installed (extra `cvode`)."
MAX_CVODE_STEPS = 200_000
"""Maximum number of steps of an integration by CVODE."""


def scipy_run(method: str, tolerance: float, leg: IntegrationTask) -> Trajectory:
    """Integrates a leg by SciPy's solve_ivp; ArithmeticError if the integration fails.

    SciPy's implicit methods stop Newton's method at sqrt(rtol) times the tolerance. Hence `rtol` is set to
    `tolerance` too.
    """
    system, z, duration = leg
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # LSODA warns of a failure that `found.success` reports too
        found = scipy.integrate.solve_ivp(
            lambda _, x: system.state_derivative(x),
            (0.0, duration),
            z,
            method,
            jac=lambda _, x: system.jacobian(x),
            rtol=tolerance,
            atol=tolerance * np.abs(z).max(),
            first_step=(FIRST_STEP if method == "Radau" else FIRST_MULTISTEP_STEP) * duration,
        )
    if not found.success:
        raise ArithmeticError(f"SciPy {method} at {tolerance:g}: {found.message}")
    return Trajectory(EndReason.reached, found.t, found.y.T)


def cvode_run(cvode: Any, tolerance: float, leg: IntegrationTask) -> Trajectory:
    """Integrates a leg by CVODE's BDF with its dense linear solver; ArithmeticError if this fails.

    cvode: the module CVODE_MODULE.
    """
    system, z, duration = leg
    arguments = system.sqrt_compliance, system.nodal_rod, system.mesh.node_matrices
    buffer = np.empty((len(z), len(z)))

    def right_side(_: float, x: Array, out: Array) -> None:
        write_rate(x, out, *arguments)

    def derivative(_: float, x: Array, __: Array, out: Array) -> None:
        write_rate_jacobian(x, buffer, *arguments)
        out[:, :] = buffer.T

    solver = cvode.CVODE(
        right_side,
        method="BDF",
        linsolver="dense",
        jacfn=derivative,
        rtol=tolerance,
        atol=tolerance * np.abs(z).max(),
        first_step=FIRST_MULTISTEP_STEP * duration,
        max_num_steps=MAX_CVODE_STEPS,
    )
    found = solver.solve(np.array([0.0, duration]), z)
    if not found.success:
        raise ArithmeticError(f"CVODE at {tolerance:g}: {found.message}")
    return Trajectory(EndReason.reached, found.t, found.y)


RADAU_TOLERANCES = (1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 1e-6)
FAMILIES = (
    IntegratorWithTolerances(
        "ARKIMEX 2", partial(petsc_trajectory, "arkimex", "2e"), (1e-4, 1e-5, 1e-6, 3e-7, 2e-7)
    ),
    IntegratorWithTolerances(
        "ARKIMEX 3", partial(petsc_trajectory, "arkimex", "3"), (1e-5, 1e-6, 3e-7, 1e-7, 1e-8)
    ),
    IntegratorWithTolerances(
        "ARKIMEX 4", partial(petsc_trajectory, "arkimex", "4"), (1e-5, 3e-6, 1e-6, 3e-7, 1e-7, 1e-8)
    ),
    IntegratorWithTolerances("BDF 5", partial(petsc_trajectory, "bdf", "5"), (1e-6, 1e-7, 3e-8, 1e-8, 1e-9)),
    IntegratorWithTolerances(
        "ROSW ra34pw2", partial(petsc_trajectory, "rosw", "ra34pw2"), (1e-4, 1e-5, 3e-6, 1e-6, 1e-7)
    ),
    IntegratorWithTolerances(
        "ROSW rodas3", partial(petsc_trajectory, "rosw", "rodas3"), (1e-4, 1e-5, 3e-6, 1e-6, 3e-7)
    ),
    IntegratorWithTolerances("SciPy BDF", partial(scipy_run, "BDF"), (1e-5, 1e-6, 3e-7, 1e-7, 1e-8)),
    IntegratorWithTolerances(
        "SciPy Radau",
        partial(scipy_run, "Radau"),
        RADAU_TOLERANCES,
        (*RADAU_TOLERANCES[2:5], *SETTLING_INTEGRATOR_TOLERANCES[:4]),
    ),
    IntegratorWithTolerances(
        "SciPy LSODA",
        partial(scipy_run, "LSODA"),
        (1e-5, 1e-6, 3e-7, 1e-7, 1e-8),
        SETTLING_INTEGRATOR_TOLERANCES,
    ),
)
"""Integrators of PETSc and SciPy with their tolerances. BDF 5 is nearly unstable at loose tolerances."""


def installed_families() -> tuple[IntegratorWithTolerances, ...]:
    """All installed integrators: FAMILIES, and CVODE if scikit-sundae is installed."""
    module = optional_module(CVODE_MODULE)
    ladder = (1e-5, 1e-6, 3e-7, 1e-7, 1e-8, 1e-9)
    return FAMILIES + (
        (IntegratorWithTolerances(CVODE, partial(cvode_run, module), ladder, SETTLING_INTEGRATOR_TOLERANCES),)
        if module
        else ()
    )
