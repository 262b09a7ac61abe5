"""The Hopf point by AUTO-07p, compiled with the equations into a program of its own."""

import os
import shutil
import subprocess
import tempfile
from math import nan
from pathlib import Path

import numpy as np

from .cases import FirstThreshold, ThresholdCase
from .reduction import reduced

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
HEAD, HOPF_POINT = "0", "3"
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


def hopf_by_auto(program: Path, step: float, tolerance: float, case: ThresholdCase) -> FirstThreshold:
    """AUTO-07p from F = 0 in equal steps up to the first Hopf point, located to its EPSS = tolerance."""
    pieces = reduced(case)
    with tempfile.TemporaryDirectory(dir=program.parent) as place:
        directory = Path(place)
        (directory / "matrices").write_bytes(pieces.transpose(0, 2, 1).tobytes())
        (directory / "fort.2").write_text(
            CONSTANTS.format(unknowns=pieces.shape[1], top=case.top, tolerance=tolerance, step=step)
        )
        environment = os.environ | {"OMP_NUM_THREADS": "1"}
        done = subprocess.run(
            [program], cwd=directory, capture_output=True, text=True, check=False, env=environment
        )
        table = directory / "fort.7"
        points = [line.split() for line in table.read_text().splitlines()] if table.exists() else []
    if done.returncode or not points:
        raise RuntimeError(f"AUTO-07p ended with status {done.returncode}")
    at = [float(line.split()[1]) for line in done.stdout.splitlines() if line.startswith("at")]
    solves = 1 + int(np.count_nonzero(np.diff(at)))
    rounded = [float(words[4]) for words in points if words[0] != HEAD and words[2] == HOPF_POINT]
    # fort.7 has eleven digits of the force, the output all.
    force = min(at, key=lambda F: abs(F - rounded[0])) if rounded else nan
    return FirstThreshold(force, solves)
