"""The first Hopf point by continuation codes: AUTO-07p, compiled with the equations, and PyCont-Lite.

Both codes follow the equilibrium u = 0 of the ordinary differential equation du/dt = M(F) u.
"""

import contextlib
import io
import tempfile
from functools import partial
from math import ceil, isnan, nan
from pathlib import Path
from typing import Any

import numpy as np

from rodsweep.arrays import Array
from rodsweep.bench.study import TimedMethod
from rodsweep.bench.thresholds.study import FirstThreshold, ThresholdCase

from ..auto import AUTO, AUTO_SKIPPED, auto_program, run_auto, table_lines
from ..installed import optional_module
from .spectra_by_force import affine_pencil

AUTO_SETTINGS = ((5.0, 1e-7), (1.0, 1e-4), (1.0, 1e-10))
"""Settings of AUTO-07p: (step in F, EPSS, the relative tolerance of special points)."""
PYCONT_STEPS = (0.25, 0.5)
"""Steps of PyCont-Lite in F. With steps of 0.5 or more, PyCont-Lite finds the Hopf point of some rods only by
chance. Quick runs omit 0.5."""
PYCONT = "PyCont-Lite"
CONTINUATION_GROUP = "continuation"
"""Group of the continuation codes in the figure."""
EQUATIONS = """
subroutine func(ndim, u, icp, par, ijac, f, dfdu, dfdp)
  integer ndim, icp(*), ijac
  double precision u(ndim), par(*), f(ndim), dfdu(ndim, ndim), dfdp(ndim, *), A(ndim, ndim)
  double precision, allocatable, save :: M(:, :, :)
  if (.not. allocated(M)) then
    allocate (M(ndim, ndim, 3))
    open (77, file='matrices', form='unformatted', access='stream')
    read (77) M
    close (77)
  end if
  A = M(:, :, 1) + par(1)*(M(:, :, 2) + par(1)*M(:, :, 3))
  f = matmul(A, u)
  if (ijac >= 1) dfdu = A
  if (ijac == 2) dfdp(:, 1) = matmul(M(:, :, 2) + 2*par(1)*M(:, :, 3), u)
end subroutine
subroutine stpnt(ndim, u, par, t)
  integer ndim
  double precision u(ndim), par(*), t
  u = 0
  par(1) = 0
end subroutine
subroutine pvls(ndim, u, par)  ! AUTO calls this at every solution, hence for every force that it tries
  integer ndim
  double precision u(ndim), par(*)
  write (*, '("at", es25.16)') par(1)
end subroutine
subroutine bcnd
end subroutine
subroutine icnd
end subroutine
subroutine fopt
end subroutine
"""
"""Fortran subroutines of du/dt = M(F) u for AUTO-07p; they read M0, M1 and M2 from the file `matrices`."""
AUTO_CONSTANTS = """NDIM={unknowns}, IPS=1, IRS=0, ILP=0, ISP=1, ISW=1, MXBF=0, NPAR=1, JAC=1, IID=0
ICP=[1], UZSTOP={{1: {top!r}}}, STOP=['HB1']
NMX=9999, NPR=0, ITMX=20, ITNW=5, EPSL=1e-9, EPSU=1e-9, EPSS={tolerance!r}
DS={step!r}, DSMIN=1e-3, DSMAX={step!r}, IADS=0
"""
"""Content of AUTO's constants file for a continuation in F to the first Hopf point, a format of `str.format`.
"""
HOPF_POINT = "3"
"""Third word of the line of a Hopf point in AUTO's table fort.7."""
DIFFERENCE_STEP = 1e-8
"""Step of PyCont-Lite's finite differences, which are exact for a linear field, and of its root finding."""
STEPS_BETWEEN_CHECKS = 5
"""Number of steps after which PyCont-Lite looks for special points."""
PYCONT_MODULE = "pycont"
"""Import name of PyCont-Lite, which the optional extra `bench` of rodsweep installs."""
START_FRACTION = 0.1
"""Start of PyCont-Lite, as a fraction of the interval of F from the onset to the Hopf point."""
BEYOND_HOPF = 6.0
"""Distance in F beyond the Hopf point at which PyCont-Lite ends."""


def continuation_codes(directory: Path, quick: bool) -> tuple[list[TimedMethod], list[str]]:
    """(the installed continuation codes at their settings, a sentence for each code that is missing).

    AUTO-07p is compiled in `directory`. quick: fewer steps of PyCont-Lite.
    """
    found, skipped = [], []
    if program := auto_program(directory, EQUATIONS):
        for step, tolerance in AUTO_SETTINGS:
            by_auto = partial(hopf_by_auto, program, step, tolerance)
            found.append(
                TimedMethod(AUTO, f"step {step:g}, EPSS {tolerance:.0e}", CONTINUATION_GROUP, by_auto)
            )
    else:
        skipped.append(AUTO_SKIPPED)
    if module := optional_module(PYCONT_MODULE):
        for step in PYCONT_STEPS[: 1 if quick else None]:
            by_pycont = partial(hopf_by_pycont, module, step)
            found.append(TimedMethod(PYCONT, f"step {step:g}", CONTINUATION_GROUP, by_pycont, is_slow=True))
    else:
        skipped.append(f"{PYCONT} is skipped: it is not installed (extra `bench`).")
    return found, skipped


def matrix_polynomial(case: ThresholdCase) -> Array:
    """M0, M1, M2 of M(F) = M0 + F M1 + F^2 M2 in du/dt = M(F) u, shape (3, n, n).

    The pencil has A = A0 + F A1 and a diagonal B. Unknowns without a time derivative are eliminated. Raises
    ArithmeticError if the eliminated block depends on F, as for gamma3 = 0 with a finite k1 or k2, or if it
    is singular, as for c2 = 0 < gamma3.
    """
    A0, A1, B = affine_pencil(case)
    n = int(np.count_nonzero(B))
    if A1[n:, n:].any() or not A0[n:, n:].any():
        raise ArithmeticError("the pencil does not reduce to a polynomial in F")
    S0, S1 = np.split(np.linalg.solve(A0[n:, n:], np.hstack([A0[n:, :n], A1[n:, :n]])), 2, axis=1)
    up0, up1 = A0[:n, n:], A1[:n, n:]
    pieces = [A0[:n, :n] - up0 @ S0, A1[:n, :n] - up0 @ S1 - up1 @ S0, -up1 @ S1]
    return np.array(pieces) / B[:n, None]


def hopf_by_auto(program: Path, step: float, tolerance: float, case: ThresholdCase) -> FirstThreshold:
    """The first Hopf point by AUTO-07p, from F = 0 in equal steps; tolerance: EPSS, of the located point."""
    pieces = matrix_polynomial(case)
    with tempfile.TemporaryDirectory(dir=program.parent) as folder:
        directory = Path(folder)
        (directory / "matrices").write_bytes(pieces.transpose(0, 2, 1).tobytes())
        constants = AUTO_CONSTANTS.format(
            unknowns=pieces.shape[1], top=case.search_end, tolerance=tolerance, step=step
        )
        said, points = run_auto(program, directory, constants), table_lines(directory)
    at = [float(line.split()[1]) for line in said.splitlines() if line.startswith("at")]
    solves = 1 + int(np.count_nonzero(np.diff(at)))
    rounded = [float(words[4]) for words in points if words[2] == HOPF_POINT]
    # fort.7 states eleven digits of the force, the standard output all digits.
    force = min(at, key=lambda F: abs(F - rounded[0])) if rounded else nan
    return FirstThreshold(force, solves)


def hopf_by_pycont(pycont: Any, step: float, case: ThresholdCase) -> FirstThreshold:
    """The first Hopf point by PyCont-Lite, started beyond the onset, where a complex pair leads.

    Started below the onset, PyCont-Lite loses the followed eigenvalue there. PyCont-Lite has no option to
    stop at the first Hopf point; hence the run ends BEYOND_HOPF above the known Hopf point.
    """
    M0, M1, M2 = matrix_polynomial(case)
    last = case.search_end if isnan(case.hopf) else case.hopf
    start, end = case.onset + START_FRACTION * (last - case.onset), min(last + BEYOND_HOPF, case.search_end)
    products = 0

    def field(u: Array, F: float) -> Array:
        nonlocal products
        products += 1
        return M0 @ u + F * (M1 @ u + F * (M2 @ u))

    options = {
        "rdiff": DIFFERENCE_STEP,
        "initial_directions": "increase_p",
        "param_max": end,
        "bifurcation_detection": False,
        "analyze_stability": False,
        "hopf_detection": True,
        "limit_cycle_continuation": False,
    }
    steps = ceil((end - start) / step) + STEPS_BETWEEN_CHECKS
    with contextlib.redirect_stdout(io.StringIO()), np.errstate(all="ignore"):
        found = pycont.arclengthContinuation(
            field, np.zeros(len(M0)), start, step / 1e3, step, step, steps, options, 0
        )
    forces = [float(event.p) for event in found.events if event.kind == "HB"]
    return FirstThreshold(forces[0] if forces else nan, matrix_vector_product_count=products)
