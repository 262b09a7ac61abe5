"""The Hopf point by continuation codes: PyCont-Lite within this process, AUTO-07p as a program of its own.

Both want an ordinary differential equation. It is du/dt = M(F) u, the pencil that rodsweep uses with the
unknowns that carry no time derivative eliminated; on the trivial branch u = 0 its Jacobian is M(F).
"""

import contextlib
import importlib
import io
import os
import resource
import shutil
import subprocess
import tempfile
from math import ceil, nan
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .cases import Found, Problem
from .peers import affine

Array = NDArray[np.float64]


def reduced(problem: Problem) -> Array:
    """M0, M1, M2 of M(F) = M0 + F M1 + F^2 M2, shape (3, n, n).

    A = A0 + F A1 of the pencil, B is diagonal. Raises ArithmeticError where the block to be eliminated
    depends on F, which is so for gamma3 = 0 with a finite k1 or k2, or is singular, for c2 = 0 < gamma3.
    """
    A0, A1, B = affine(problem)
    n = int(np.count_nonzero(B))
    if A1[n:, n:].any() or not A0[n:, n:].any():
        raise ArithmeticError("the pencil does not reduce to a polynomial in F")
    S0, S1 = np.split(np.linalg.solve(A0[n:, n:], np.hstack([A0[n:, :n], A1[n:, :n]])), 2, axis=1)
    up0, up1 = A0[:n, n:], A1[:n, n:]
    pieces = [A0[:n, :n] - up0 @ S0, A1[:n, :n] - up0 @ S1 - up1 @ S0, -up1 @ S1]
    return np.array(pieces) / B[:n, None]


DIFFERENCE = 1e-8
"""Step of PyCont-Lite's differences, which are exact on a linear field, and in its search for the root."""
CHECKED = 5
"""PyCont-Lite looks for special points after so many steps."""


def pycont_module() -> Any | None:
    """PyCont-Lite, which is an optional extra (`bench`); None where it is not installed."""
    try:
        return importlib.import_module("pycont")
    except ImportError:
        return None


def hopf_by_pycont(pycont: Any, step: float, problem: Problem) -> Found:
    """PyCont-Lite from where a pair leads already: through the onset it loses what it follows.

    It cannot be told to stop at the first Hopf point and so is stopped soon after.
    """
    M0, M1, M2 = reduced(problem)
    products = 0

    def field(u: Array, F: float) -> Array:
        nonlocal products
        products += 1
        return M0 @ u + F * (M1 @ u + F * (M2 @ u))

    options = {
        "rdiff": DIFFERENCE,
        "initial_directions": "increase_p",
        "param_max": problem.enough,
        "bifurcation_detection": False,
        "analyze_stability": False,
        "hopf_detection": True,
        "limit_cycle_continuation": False,
    }
    steps = ceil((problem.enough - problem.oscillates) / step) + CHECKED
    quiet = contextlib.redirect_stdout(io.StringIO())
    try:
        with quiet, np.errstate(all="ignore"):
            found = pycont.arclengthContinuation(
                field, np.zeros(len(M0)), problem.oscillates, step / 1e3, step, step, steps, options, 0
            )
    except Exception as error:  # of whatever kind: the peer has failed
        return Found(nan, nan, products=products, failure=type(error).__name__)
    points = [event.p for event in found.events if event.kind == "HB"]
    return Found(float(points[0]) if points else nan, nan, products=products)


AUTO_LIBRARY = Path(os.environ.get("AUTO_DIR", "/usr/lib/auto-07p")) / "lib"
"""The compiled parts of AUTO-07p: AUTO_DIR is its own variable, the default is where Debian has it."""
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
ONE_THREAD = {"OMP_NUM_THREADS": "1"}
HEAD, HOPF = "0", "3"
"""In AUTO's file fort.7: the first word of a line of its head, and the third of the line of a Hopf point."""


def auto_program(directory: Path) -> Path | None:
    """AUTO-07p compiled with the equations; None where it or gfortran is missing."""
    compiler, parts = shutil.which("gfortran"), sorted(map(str, AUTO_LIBRARY.glob("*.o")))
    if compiler is None or not parts:
        return None
    (directory / "equations.f90").write_text(EQUATIONS)
    words = [compiler, "-O2", "-fopenmp", "equations.f90", *parts, "-o", "rod"]
    done = subprocess.run(words, cwd=directory, capture_output=True, check=False)
    return directory / "rod" if done.returncode == 0 else None


def auto_version() -> str:
    """The version of Debian's package, which AUTO itself does not tell; empty where there is none."""
    query = shutil.which("dpkg-query")
    words = [query or "", "-W", "-f", "${Version}", "auto-07p"]
    return subprocess.run(words, capture_output=True, text=True, check=False).stdout if query else ""


def hopf_by_auto(program: Path, step: float, tolerance: float, problem: Problem) -> Found:
    """AUTO-07p from F = 0 in equal steps up to the first Hopf point, located to its EPSS = tolerance."""
    pieces = reduced(problem)
    with tempfile.TemporaryDirectory(dir=program.parent) as place:
        directory = Path(place)
        (directory / "matrices").write_bytes(b"".join(M.tobytes("F") for M in pieces))
        constants = CONSTANTS.format(
            unknowns=pieces.shape[1], top=problem.top, tolerance=tolerance, step=step
        )
        (directory / "fort.2").write_text(constants)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        done = subprocess.run(
            [program], cwd=directory, capture_output=True, text=True, check=False, env=os.environ | ONE_THREAD
        )
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        table = directory / "fort.7"
        points = [line.split() for line in table.read_text().splitlines()] if table.exists() else []
    spent = after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime
    at = [float(line.split()[1]) for line in done.stdout.splitlines() if line.startswith("at")]
    solves = 1 + int(np.count_nonzero(np.diff(at)))
    rounded = [float(words[4]) for words in points if words[0] != HEAD and words[2] == HOPF]
    if done.returncode or not rounded:
        failed = done.returncode or not points
        return Found(nan, solves, outside=spent, failure=f"status {done.returncode}" if failed else "")
    # fort.7 has eleven digits of the force, the output all.
    return Found(min(at, key=lambda F: abs(F - rounded[0])), solves, outside=spent)
