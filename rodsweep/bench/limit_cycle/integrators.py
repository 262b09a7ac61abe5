"""Time integrators side by side: this tool's by PETSc, SciPy's, and CVODE of SUNDIALS by scikit-sundae.

All see the same compiled rate and exact Jacobian of a beam, and one `tolerance`: of each component of z, in
units of its largest. All are measured alike: the steps next to a return of the tip and next to the largest y
are made again in small steps, so that an error is that of the integration and not of an interpolant.
"""

import importlib
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import scipy.integrate
from numpy.polynomial import Polynomial
from numpy.typing import NDArray

from ...discretization.beam import Beam
from ...discretization.body_frame import jacobian, rate
from ...solve.cycle.shooting import PERIOD_MAP, angle_weights
from ...solve.motion.integrator import Ending, RunLimit, integrator
from ...solve.motion.time_scheme import TimeScheme

Array = NDArray[np.float64]

TIGHT = 3e-7
"""Tolerance below which Newton's errors would show in those of ARKIMEX 5 with the default's test."""
TIGHT_NEWTON = 0.03
FIRST_STEP, FIRST_MULTISTEP = 1e-3, 1e-5
"""First step in units of the duration; that of multistep methods, which start with order 1. LSODA fails
where its first step is too long for the start."""
MOST_STEPS = 200_000
SMALL_STEPS, DEGREE = 20, 8
"""Small steps about an event, and the degree of the polynomial through those next to it."""
CORRECTIONS = 2
"""Newton steps from the polynomial's root to the event: the polynomial alone leaves 1e-8 rad."""
OVERSHOOT = 1.25
"""How far a step is made again, in units of it: its end is a little off and might miss the event."""


@dataclass(frozen=True, slots=True)
class Steps:
    """times in tau2, (steps + 1,), and states z, (steps + 1, unknowns)."""

    times: Array
    states: Array


Integration = Callable[[Beam, Array, float, float], Steps]
"""(beam, z, duration, tolerance) to the steps; raises ArithmeticError where the integration fails."""


@dataclass(frozen=True, slots=True)
class Family:
    """An integrator and the tolerances, from the loosest, at which it is worth running.

    settling: those, from the loosest, at which one may wait for a cycle; none where one would not.
    """

    name: str
    integrate: Integration
    tolerances: tuple[float, ...]
    settling: tuple[float, ...] = ()


def by_petsc(family: str, variant: str, beam: Beam, z: Array, duration: float, tolerance: float) -> Steps:  # noqa: PLR0913, PLR0917
    """PETSc TS as the task limit_cycle uses it."""
    newton = TimeScheme().newton if tolerance > TIGHT else TIGHT_NEWTON
    scheme = TimeScheme(family, variant, tolerance, newton, prefix="bench_")
    run = integrator(beam.mesh, scheme).run(beam, z, duration)
    if run.ending != Ending.reached:
        raise ArithmeticError(f"{family} {variant} at {tolerance:g}: {run.ending.name} {run.message}")
    return Steps(run.times, run.states)


def by_scipy(method: str, beam: Beam, z: Array, duration: float, tolerance: float) -> Steps:
    """SciPy's solve_ivp. Its Newton test is sqrt(rtol) of the tolerance, so rtol is the tolerance too."""
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
            first_step=(FIRST_STEP if method == "Radau" else FIRST_MULTISTEP) * duration,
        )
    if not found.success:
        raise ArithmeticError(f"SciPy {method} at {tolerance:g}: {found.message}")
    return Steps(found.t, found.y.T)


def by_cvode(cvode: Any, beam: Beam, z: Array, duration: float, tolerance: float) -> Steps:
    """CVODE's BDF with its dense solver, through scikit-sundae."""
    arguments = beam.parameters, beam.mesh.element
    buffer = np.empty((len(z), len(z)))

    def right_side(_: float, x: Array, out: Array) -> None:
        rate(x, out, *arguments)

    def derivative(_: float, x: Array, __: Array, out: Array) -> None:
        jacobian(x, buffer, *arguments)
        out[:, :] = buffer.T

    solver = cvode.CVODE(
        right_side,
        method="BDF",
        linsolver="dense",
        jacfn=derivative,
        rtol=tolerance,
        atol=tolerance * np.abs(z).max(),
        first_step=FIRST_MULTISTEP * duration,
        max_num_steps=MOST_STEPS,
    )
    found = solver.solve(np.array([0.0, duration]), z)
    if not found.success:
        raise ArithmeticError(f"CVODE at {tolerance:g}: {found.message}")
    return Steps(found.t, found.y)


def cvode_module() -> Any | None:
    """scikit-sundae's CVODE, which is an optional extra (`cvode`); None where it is not installed."""
    try:
        return importlib.import_module("sksundae.cvode")
    except ImportError:
        return None


DEFAULT = "ARKIMEX 5 (default)"
SCIPY, CVODE = "SciPy ", "CVODE"
"""How the names of the families of others begin."""
PYTHON = (SCIPY + "BDF", SCIPY + "Radau")
"""SciPy's implicit methods written in Python; LSODA is compiled."""


def families() -> list[Family]:
    """All that can be run here; BDF 5 is at the edge of its stability until the tolerance is tight."""
    own = {
        "ARKIMEX 2": ("arkimex", "2e", (1e-4, 1e-5, 1e-6, 3e-7, 2e-7)),
        "ARKIMEX 3": ("arkimex", "3", (1e-5, 1e-6, 3e-7, 1e-7, 1e-8)),
        "ARKIMEX 4": ("arkimex", "4", (1e-5, 3e-6, 1e-6, 3e-7, 1e-7, 1e-8)),
        DEFAULT: ("arkimex", "5", (1e-5, 5e-6, 2e-6, 1e-6, 3e-7, 1e-7, 1e-8)),
        "BDF 5": ("bdf", "5", (1e-6, 1e-7, 3e-8, 1e-8, 1e-9)),
        "ROSW ra34pw2": ("rosw", "ra34pw2", (1e-4, 1e-5, 3e-6, 1e-6, 1e-7)),
        "ROSW rodas3": ("rosw", "rodas3", (1e-4, 1e-5, 3e-6, 1e-6, 3e-7)),
    }
    scipy_own = {
        "BDF": (1e-5, 1e-6, 3e-7, 1e-7, 1e-8),
        "Radau": (1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 1e-6),
        "LSODA": (1e-5, 1e-6, 3e-7, 1e-7, 1e-8),
    }
    careful = (1e-6, 3e-7, 1e-7, 3e-8, 1e-8, 3e-9, 1e-9)
    settling = {"Radau": (1e-4, 3e-5, 1e-5, *careful[:4]), "LSODA": careful}
    found = [
        Family(name, partial(by_petsc, family, variant), tolerances, careful if name == DEFAULT else ())
        for name, (family, variant, tolerances) in own.items()
    ]
    found += [
        Family(SCIPY + method, partial(by_scipy, method), tolerances, settling.get(method, ()))
        for method, tolerances in scipy_own.items()
    ]
    module = cvode_module()
    if module is not None:
        ladder = (1e-5, 1e-6, 3e-7, 1e-7, 1e-8, 1e-9)
        found.append(Family(CVODE, partial(by_cvode, module), ladder, careful))
    return found


@dataclass(frozen=True, eq=False)
class Returns:
    """The returns of a run: theta of the tip rises through 0.

    times in tau2, (k,), states z, (k, unknowns); heights: the tip's largest y in L between two, (k - 1,).
    """

    times: Array
    states: Array
    heights: Array


def returns(beam: Beam, steps: Steps) -> Returns:
    """All returns of a run."""
    row, y = angle_weights(beam), beam.tip(steps.states)[1]
    angle = steps.states @ row
    rising = np.nonzero((angle[:-1] < 0) & (angle[1:] >= 0))[0]
    times, states, heights = [], [], []
    for k in rising:
        t, z = _again(beam, steps.states[k], OVERSHOOT * (steps.times[k + 1] - steps.times[k]))
        when = _rise(t, z @ row)
        for _ in range(CORRECTIONS):
            there = _again(beam, steps.states[k], when)[1][-1]
            when -= float(row @ there) / float(row @ beam.rate(there))
        times.append(steps.times[k] + when)
        states.append(_again(beam, steps.states[k], when)[1][-1])
    for first, last in zip(rising[:-1], rising[1:], strict=True):
        k = first + int(np.argmax(y[first : last + 1]))
        t, z = _again(beam, steps.states[k - 1], steps.times[k + 1] - steps.times[k - 1])
        heights.append(_highest(t, beam.tip(z)[1]))
    return Returns(np.array(times), np.array(states), np.array(heights))


def _again(beam: Beam, z: Array, duration: float) -> tuple[Array, Array]:
    """Times and states of equal small steps from a state of a run."""
    step = duration / SMALL_STEPS
    run = integrator(beam.mesh, PERIOD_MAP).run(beam, z, duration, step, RunLimit(most_steps=SMALL_STEPS + 2))
    return run.times, run.states


def _near(times: Array, values: Array, k: int) -> Polynomial:
    """The polynomial through the samples next to the k-th."""
    first = min(max(k - DEGREE // 2, 0), len(times) - DEGREE - 1)
    here = slice(first, first + DEGREE + 1)
    return Polynomial.fit(times[here], values[here], DEGREE)


def _nearest_root(polynomial: Polynomial, when: float) -> float:
    roots: NDArray[Any] = polynomial.roots()
    return float(roots[np.argmin(abs(roots - when))].real)


def _rise(times: Array, values: Array) -> float:
    """When the samples rise through 0."""
    k = int(np.argmax(values >= 0))
    return _nearest_root(_near(times, values, k), times[k])


def _highest(times: Array, values: Array) -> float:
    """The maximum of a function given by samples."""
    k = int(np.argmax(values))
    polynomial = _near(times, values, k)
    return float(polynomial(_nearest_root(polynomial.deriv(), times[k])))
