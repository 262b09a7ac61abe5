"""Time integrators side by side: this tool's by PETSc, SciPy's, and CVODE of SUNDIALS by scikit-sundae.

All see the same compiled rate and exact Jacobian of a beam, and one `tolerance`: of each component of z, in
units of its largest.
"""

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import scipy.integrate

from ...arrays import Array
from ...discretization.beam import Beam
from ...discretization.stress_rates import rate, rate_jacobian
from ...solve.motion.integrator import Ending, Trajectory, integrator
from ...solve.motion.time_scheme import TimeScheme
from ..machine import installed

TIGHT = 3e-7
"""Tolerance below which Newton's errors would show in those of ARKIMEX 5 with the default's test."""
TIGHT_NEWTON = 0.03
FIRST_SHARE, FIRST_MULTISTEP_SHARE = 1e-3, 1e-5
"""First step in units of the duration; that of multistep methods, which start with order 1. LSODA fails
where its first step is too long for the start."""
CVODE_MODULE = "sksundae.cvode"
"""Of scikit-sundae, which is an optional extra (`cvode`)."""
MOST_CVODE_STEPS = 200_000

Integration = Callable[[Beam, Array, float, float], Trajectory]
"""(beam, z, duration, tolerance) to the run; raises ArithmeticError where the integration fails."""


@dataclass(frozen=True, slots=True)
class Family:
    """An integrator and the tolerances, from the loosest, at which it is worth running.

    settling: those, from the loosest, at which one may wait for a cycle; none where one would not.
    """

    name: str
    integrate: Integration
    tolerances: tuple[float, ...]
    settling: tuple[float, ...] = ()


def by_petsc(
    family: str, variant: str, beam: Beam, z: Array, duration: float, tolerance: float
) -> Trajectory:
    """PETSc TS as the task limit_cycle uses it, from z, (unknowns,)."""
    newton = TimeScheme().newton if tolerance > TIGHT else TIGHT_NEWTON
    scheme = TimeScheme(family, variant, tolerance, newton, prefix="bench_")
    run = integrator(beam.mesh, scheme).run(beam, z, duration)
    if run.ending != Ending.reached:
        raise ArithmeticError(f"{family} {variant} at {tolerance:g}: {run.ending.name} {run.message}")
    return run


def by_scipy(method: str, beam: Beam, z: Array, duration: float, tolerance: float) -> Trajectory:
    """SciPy's solve_ivp from z, shape (unknowns,).

    Its Newton test is sqrt(rtol) of the tolerance, so rtol is the tolerance too.
    """
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
    return Trajectory(Ending.reached, found.t, found.y.T)


def by_cvode(cvode: Any, beam: Beam, z: Array, duration: float, tolerance: float) -> Trajectory:
    """CVODE's BDF with its dense solver, through scikit-sundae, from z, (unknowns,)."""
    arguments = beam.roots, beam.nodal, beam.mesh.matrices
    buffer = np.empty((len(z), len(z)))

    def right_side(_: float, x: Array, out: Array) -> None:
        rate(x, out, *arguments)

    def derivative(_: float, x: Array, __: Array, out: Array) -> None:
        rate_jacobian(x, buffer, *arguments)
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
    return Trajectory(Ending.reached, found.t, found.y)


DEFAULT, CVODE = "ARKIMEX 5 (default)", "CVODE"
RADAU = (1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 1e-6)
CAREFUL = (1e-6, 3e-7, 1e-7, 3e-8, 1e-8, 3e-9, 1e-9)
FAMILIES = (
    Family("ARKIMEX 2", partial(by_petsc, "arkimex", "2e"), (1e-4, 1e-5, 1e-6, 3e-7, 2e-7)),
    Family("ARKIMEX 3", partial(by_petsc, "arkimex", "3"), (1e-5, 1e-6, 3e-7, 1e-7, 1e-8)),
    Family("ARKIMEX 4", partial(by_petsc, "arkimex", "4"), (1e-5, 3e-6, 1e-6, 3e-7, 1e-7, 1e-8)),
    Family(DEFAULT, partial(by_petsc, "arkimex", "5"), (1e-5, 5e-6, 2e-6, 1e-6, 3e-7, 1e-7, 1e-8), CAREFUL),
    Family("BDF 5", partial(by_petsc, "bdf", "5"), (1e-6, 1e-7, 3e-8, 1e-8, 1e-9)),
    Family("ROSW ra34pw2", partial(by_petsc, "rosw", "ra34pw2"), (1e-4, 1e-5, 3e-6, 1e-6, 1e-7)),
    Family("ROSW rodas3", partial(by_petsc, "rosw", "rodas3"), (1e-4, 1e-5, 3e-6, 1e-6, 3e-7)),
    Family("SciPy BDF", partial(by_scipy, "BDF"), (1e-5, 1e-6, 3e-7, 1e-7, 1e-8)),
    Family("SciPy Radau", partial(by_scipy, "Radau"), RADAU, (*RADAU[2:5], *CAREFUL[:4])),
    Family("SciPy LSODA", partial(by_scipy, "LSODA"), (1e-5, 1e-6, 3e-7, 1e-7, 1e-8), CAREFUL),
)
"""BDF 5 is at the edge of its stability until the tolerance is tight."""


def families() -> tuple[Family, ...]:
    """All that can be run here."""
    module = installed(CVODE_MODULE)
    ladder = (1e-5, 1e-6, 3e-7, 1e-7, 1e-8, 1e-9)
    return FAMILIES + ((Family(CVODE, partial(by_cvode, module), ladder, CAREFUL),) if module else ())
