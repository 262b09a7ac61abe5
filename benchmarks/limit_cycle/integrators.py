"""Integrators that rodsweep does not use: others of PETSc, SciPy's, CVODE of SUNDIALS by scikit-sundae."""

import warnings
from functools import partial
from typing import Any

import numpy as np
import scipy.integrate

from rodsweep.arrays import Array
from rodsweep.bench.limit_cycle.integrators import (
    WAITING_TOLERANCES,
    IntegrationTask,
    IntegratorFamily,
    by_petsc,
)
from rodsweep.discretization.stress.rates import write_rate, write_rate_jacobian
from rodsweep.solve.motion.integrator import RunEnding, Trajectory

from ..installed import installed

FIRST_SHARE, FIRST_MULTISTEP_SHARE = 1e-3, 1e-5
"""First step in units of the duration; that of multistep methods, which start with order 1. LSODA fails
where its first step is too long for the start."""
CVODE = "CVODE"
CVODE_MODULE = "sksundae.cvode"
"""Of scikit-sundae, which is an optional extra (`cvode`)."""
CVODE_SKIPPED = f"{CVODE} is skipped: scikit-sundae is not installed (extra `cvode`)."
MOST_CVODE_STEPS = 200_000


def by_scipy(method: str, tolerance: float, leg: IntegrationTask) -> Trajectory:
    """SciPy's solve_ivp.

    Its Newton test is sqrt(rtol) of the tolerance, so rtol is the tolerance too.
    """
    beam, z, duration = leg
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # LSODA warns of what its success says
        found = scipy.integrate.solve_ivp(
            lambda _, x: beam.rate(x),
            (0.0, duration),
            z,
            method,
            jac=lambda _, x: beam.jacobian(x),
            rtol=tolerance,
            atol=tolerance * np.abs(z).max(),
            first_step=(FIRST_SHARE if method == "Radau" else FIRST_MULTISTEP_SHARE) * duration,
        )
    if not found.success:
        raise ArithmeticError(f"SciPy {method} at {tolerance:g}: {found.message}")
    return Trajectory(RunEnding.reached, found.t, found.y.T)


def by_cvode(cvode: Any, tolerance: float, leg: IntegrationTask) -> Trajectory:
    """CVODE's BDF with its dense solver, through scikit-sundae."""
    beam, z, duration = leg
    arguments = beam.sqrt_compliance, beam.nodal, beam.mesh.matrices
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
        first_step=FIRST_MULTISTEP_SHARE * duration,
        max_num_steps=MOST_CVODE_STEPS,
    )
    found = solver.solve(np.array([0.0, duration]), z)
    if not found.success:
        raise ArithmeticError(f"CVODE at {tolerance:g}: {found.message}")
    return Trajectory(RunEnding.reached, found.t, found.y)


RADAU = (1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 1e-6)
FAMILIES = (
    IntegratorFamily("ARKIMEX 2", partial(by_petsc, "arkimex", "2e"), (1e-4, 1e-5, 1e-6, 3e-7, 2e-7)),
    IntegratorFamily("ARKIMEX 3", partial(by_petsc, "arkimex", "3"), (1e-5, 1e-6, 3e-7, 1e-7, 1e-8)),
    IntegratorFamily("ARKIMEX 4", partial(by_petsc, "arkimex", "4"), (1e-5, 3e-6, 1e-6, 3e-7, 1e-7, 1e-8)),
    IntegratorFamily("BDF 5", partial(by_petsc, "bdf", "5"), (1e-6, 1e-7, 3e-8, 1e-8, 1e-9)),
    IntegratorFamily("ROSW ra34pw2", partial(by_petsc, "rosw", "ra34pw2"), (1e-4, 1e-5, 3e-6, 1e-6, 1e-7)),
    IntegratorFamily("ROSW rodas3", partial(by_petsc, "rosw", "rodas3"), (1e-4, 1e-5, 3e-6, 1e-6, 3e-7)),
    IntegratorFamily("SciPy BDF", partial(by_scipy, "BDF"), (1e-5, 1e-6, 3e-7, 1e-7, 1e-8)),
    IntegratorFamily(
        "SciPy Radau", partial(by_scipy, "Radau"), RADAU, (*RADAU[2:5], *WAITING_TOLERANCES[:4])
    ),
    IntegratorFamily(
        "SciPy LSODA", partial(by_scipy, "LSODA"), (1e-5, 1e-6, 3e-7, 1e-7, 1e-8), WAITING_TOLERANCES
    ),
)
"""BDF 5 is at the edge of its stability until the tolerance is tight."""


def families() -> tuple[IntegratorFamily, ...]:
    """All that can be run here."""
    module = installed(CVODE_MODULE)
    ladder = (1e-5, 1e-6, 3e-7, 1e-7, 1e-8, 1e-9)
    return FAMILIES + (
        (IntegratorFamily(CVODE, partial(by_cvode, module), ladder, WAITING_TOLERANCES),) if module else ()
    )
