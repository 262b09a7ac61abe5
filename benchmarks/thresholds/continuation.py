"""The Hopf point by continuation codes: AUTO-07p, compiled into a program of its own, and PyCont-Lite.

Both follow u = 0 of the ordinary differential equation du/dt = M(F) u.
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
from rodsweep.bench.study import Contender
from rodsweep.bench.thresholds.study import FirstThreshold, ThresholdCase

from ..auto import AUTO, SKIPPED, auto_program, run_auto, table_lines
from ..installed import installed
from .spectra_by_force import affine

AUTO_SETTINGS = ((5.0, 1e-7), (1.0, 1e-4), (1.0, 1e-10))
"""(step in F, EPSS)."""
PYCONT_STEPS = (0.25, 0.5)
"""From 0.5 upwards it is chance on some rods whether it finds the Hopf point; quick runs do without 0.5."""
PYCONT = "PyCont-Lite"
CONTINUATION = "continuation"
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
subroutine pvls(ndim, u, par)  ! called wherever AUTO has solved, and so with every force it looks at
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
CONSTANTS = """NDIM={unknowns}, IPS=1, IRS=0, ILP=0, ISP=1, ISW=1, MXBF=0, NPAR=1, JAC=1, IID=0
ICP=[1], UZSTOP={{1: {top!r}}}, STOP=['HB1']
NMX=9999, NPR=0, ITMX=20, ITNW=5, EPSL=1e-9, EPSU=1e-9, EPSS={tolerance!r}
DS={step!r}, DSMIN=1e-3, DSMAX={step!r}, IADS=0
"""
HOPF_POINT = "3"
"""In AUTO's file fort.7: the third word of the line of a Hopf point."""
DIFFERENCE_STEP = 1e-8
"""Of the code's differences, which are exact on a linear field, and in its search for the root."""
CHECKED = 5
"""The code looks for special points after so many steps."""
PYCONT_MODULE = "pycont"
"""Of PyCont-Lite, which is an optional extra (`bench`)."""
HEAD_START, BEYOND_HOPF = 0.1, 6.0
"""Where it starts, as a share of the way from onset to Hopf point, and how far beyond it ends."""


def continuation_codes(directory: Path, quick: bool) -> tuple[list[Contender], list[str]]:
    """Those that are here, and a line for each that is not; programs are compiled in the directory."""
    found, skipped = [], []
    if program := auto_program(directory, EQUATIONS):
        for step, tolerance in AUTO_SETTINGS:
            by_auto = partial(hopf_by_auto, program, step, tolerance)
            found.append(Contender(AUTO, f"step {step:g}, EPSS {tolerance:.0e}", CONTINUATION, by_auto))
    else:
        skipped.append(SKIPPED)
    if module := installed(PYCONT_MODULE):
        for step in PYCONT_STEPS[: 1 if quick else None]:
            by_pycont = partial(hopf_by_pycont, module, step)
            found.append(Contender(PYCONT, f"step {step:g}", CONTINUATION, by_pycont, slow=True))
    else:
        skipped.append(f"{PYCONT} is skipped: it is not installed (extra `bench`).")
    return found, skipped


def reduced(case: ThresholdCase) -> Array:
    """M0, M1, M2 of M(F) = M0 + F M1 + F^2 M2, shape (3, n, n).

    A = A0 + F A1 of the pencil, B is diagonal; what carries no time derivative is eliminated. Raises
    ArithmeticError where the block to be eliminated depends on F, which is so for gamma3 = 0 with a finite k1
    or k2, or is singular, for c2 = 0 < gamma3.
    """
    A0, A1, B = affine(case)
    n = int(np.count_nonzero(B))
    if A1[n:, n:].any() or not A0[n:, n:].any():
        raise ArithmeticError("the pencil does not reduce to a polynomial in F")
    S0, S1 = np.split(np.linalg.solve(A0[n:, n:], np.hstack([A0[n:, :n], A1[n:, :n]])), 2, axis=1)
    up0, up1 = A0[:n, n:], A1[:n, n:]
    pieces = [A0[:n, :n] - up0 @ S0, A1[:n, :n] - up0 @ S1 - up1 @ S0, -up1 @ S1]
    return np.array(pieces) / B[:n, None]


def hopf_by_auto(program: Path, step: float, tolerance: float, case: ThresholdCase) -> FirstThreshold:
    """AUTO-07p from F = 0 in equal steps up to the first Hopf point, located to its EPSS = tolerance."""
    pieces = reduced(case)
    with tempfile.TemporaryDirectory(dir=program.parent) as place:
        directory = Path(place)
        (directory / "matrices").write_bytes(pieces.transpose(0, 2, 1).tobytes())
        constants = CONSTANTS.format(unknowns=pieces.shape[1], top=case.top, tolerance=tolerance, step=step)
        said, points = run_auto(program, directory, constants), table_lines(directory)
    at = [float(line.split()[1]) for line in said.splitlines() if line.startswith("at")]
    solves = 1 + int(np.count_nonzero(np.diff(at)))
    rounded = [float(words[4]) for words in points if words[2] == HOPF_POINT]
    # fort.7 has eleven digits of the force, the output all.
    force = min(at, key=lambda F: abs(F - rounded[0])) if rounded else nan
    return FirstThreshold(force, solves)


def hopf_by_pycont(pycont: Any, step: float, case: ThresholdCase) -> FirstThreshold:
    """PyCont-Lite from where a pair leads already: through the onset it loses what it follows.

    It cannot be told to stop at the first Hopf point and so is stopped soon after.
    """
    M0, M1, M2 = reduced(case)
    last = case.top if isnan(case.hopf) else case.hopf
    start, end = case.onset + HEAD_START * (last - case.onset), min(last + BEYOND_HOPF, case.top)
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
    steps = ceil((end - start) / step) + CHECKED
    with contextlib.redirect_stdout(io.StringIO()), np.errstate(all="ignore"):
        found = pycont.arclengthContinuation(
            field, np.zeros(len(M0)), start, step / 1e3, step, step, steps, options, 0
        )
    forces = [float(event.p) for event in found.events if event.kind == "HB"]
    return FirstThreshold(forces[0] if forces else nan, products=products)
