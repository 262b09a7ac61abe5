"""One attempt at a rod's leading eigenvalues, and its judge, which knows nothing of meshes.

A mesh finds them, Newton's method on D refines them, the winding number of D judges whether one is
missing. What to do about it is `rodsweep.solve.spectrum.search`'s to decide.
"""

from dataclasses import dataclass
from operator import truediv
from typing import Any

import numpy as np

from ...arrays import Complex
from ...determinant.certificate.winding_number import Count
from ...determinant.roots import Roots
from ..backend.petsc import PETSC_ERRORS
from ..point import cause_of
from .problem import Mesh, TransverseProblem, forget_solvers

WAVES_A_NODE = 2.0
"""Largest |q| of an eigenvalue, in units of the nodes, that a mesh can stand for."""
WIDE_GAP, WIDE_GAP_OF_FLUTTER = 0.2, 0.05
"""Relative gap between two real parts that is wide enough to draw a line through: in a wider one a count is
cheaper, but where modes grow those far to the left are found last, and to ask for them costs a finer mesh."""
BEHIND = 0.05
"""How far behind the last eigenvalue found the unknown is counted in, in units of its modulus."""
NO_GAP = 1e-6
"""Relative gap below which two real parts count as equal."""
BELOW, CLOSE_BELOW = 3.0, 1e-9
"""Distance of the last wanted eigenvalue from the line of a proof without a count, in units of its error and
of its modulus."""
LINES_TRIED = 3
"""Lines tried before the count is given up."""


@dataclass(frozen=True, slots=True)
class Candidates:
    """What one attempt found: roots of D, k of them, sorted as `rodsweep.model` states.

    vectors: the mesh's, shape (unknowns, k), or None; failure: why SLEPc or LAPACK gave nothing, or empty.
    """

    mesh: Mesh
    roots: Roots
    vectors: Complex | None
    failure: str = ""

    def worst(self, modes: int) -> float:
        """Largest relative error estimate of the leading modes."""
        errors: Any = self.roots.error[:modes].tolist()
        w: Any = self.roots.w[:modes].tolist()
        return max(0.0, *map(truediv, errors, map(abs, w)))


@dataclass(frozen=True, slots=True)
class Verdict:
    """The count right of a line, and how many of the found eigenvalues lie there."""

    count: Count
    here: int
    clear: bool
    """Whether every found eigenvalue is farther from the line than twice its error."""

    @property
    def agrees(self) -> bool:
        return self.clear and self.count.number == self.here


def attempt(problem: TransverseProblem, mesh: Mesh, wanted: int, vectors: bool, tight: bool) -> Candidates:
    """The eigenvalues nearest the problem's shift, at least `wanted` where they converge, without impostors.

    tight: to the last digit of the mesh before they are refined on D. An error inside PETSc, SLEPc or LAPACK
    is no eigenvalue found: to them another mesh is another matrix, on which the same need not happen.
    """
    raw: Complex = np.empty(0, complex)
    kept, failure = None, ""
    try:
        solver = problem.solver(mesh)
        raw = solver.solve(problem.rod, problem.shift, wanted, tight)
        kept = solver.vectors(len(raw)) if vectors else None
    except PETSC_ERRORS as error:
        forget_solvers()
        failure = cause_of(error)
    kept_roots = problem.roots(raw, WAVES_A_NODE * mesh.elements * mesh.order)
    kept = kept[:, kept_roots.chosen] if kept is not None else None
    return Candidates(mesh, kept_roots, kept, failure)


def judge(problem: TransverseProblem, found: Roots, modes: int) -> Verdict:
    """Counts the eigenvalues right of a line below the last wanted and below every unstable mode."""
    w: Any = found.w.tolist()  # so few that Python is faster than NumPy
    errors: Any = found.error.tolist()
    last = w[modes - 1]
    line = min(last.real - BELOW * errors[modes - 1] - CLOSE_BELOW * abs(last), 0.0)
    complete, evaluations = problem.none_is_missing(line, found)
    if complete:
        here, clear = _right_of(line, w, errors)
        return Verdict(Count(here, evaluations), here, clear)
    for line in lines(w, modes):
        count = problem.count(line)
        if count.number is not None:
            break
    return Verdict(count, *_right_of(line, w, errors))


def _right_of(line: float, w: list[complex], errors: list[float]) -> tuple[int, bool]:
    """(how many lie right of a line, whether each is farther from the line than twice its error)."""
    clear = all(abs(value.real - line) > 2 * error for value, error in zip(w, errors, strict=True))
    return sum(value.real > line for value in w), clear


def lines(w: list[complex], modes: int) -> list[float]:
    """Where to draw the line, best first: in gaps between the real parts, the first wide one foremost.

    Behind the last of them it is drawn through the unknown, where the count may ask for more.
    """
    wide = WIDE_GAP_OF_FLUTTER if w[0].real > 0 else WIDE_GAP
    target = min(w[modes - 1].real, 0.0)
    below = [target] + [value.real for value in w if value.real < target]
    gaps = []
    for right, left in zip(below[:-1], below[1:], strict=True):
        width = (right - left) / abs(left)
        if width > NO_GAP:
            gaps.append((min(width, wide), (left + right) / 2))
    gaps.sort(key=lambda gap: -gap[0])  # stable: of the wide ones the first stays foremost
    last = below[-1]
    behind = last - BEHIND * (abs(w[-1]) if last < 0 else abs(w[0].real) + 1.0)
    return [*(middle for _, middle in gaps[: LINES_TRIED - 1]), behind]
