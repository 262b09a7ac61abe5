"""Spectra of rods at neighbouring values of one parameter: followed eigenvalues, and one count for many rods.

Krylov-Schur solves the first rod for a few modes more than requested, and solves again at a rod where
following stops or a count disagrees. Rods without a proof or with lost digits are left to be solved one by
one. The outcome depends only on the given rods.
"""

import time
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....arrays import COMPLEX_NAN, Array, Complex
from ....determinant.certificate.winding_number import count_right_of
from ....determinant.parameter_path import Path
from ....model.rod import Rod, coefficients_of
from ...backend.solver_pools import destroy_pooled_solvers
from ...point_outcome import FAILURES
from ..search import SpectrumRequest, SpectrumSearch
from ..search import warm_up as warm_up_search
from ..spectrum import FollowedPoints, Spectrum, errors_with_rounding
from ..status import SpectrumStatus
from .arm_spectra import follow_spectra_of_arms
from .carried_count import assess_points, carry_count, leading_eigenvalues, line_in_gap, widest_gap
from .following import follow_eigenvalues
from .prediction import Track, slice_track, start_track


@dataclass(frozen=True, slots=True, kw_only=True)
class NeighbouringRodsSettings:
    """Settings for eigenvalues followed along neighbouring rods of a sweep."""

    further_modes: int = 2
    """Number of modes followed in addition to the requested modes. The line of a count lies in a gap between
    these additional modes."""


NEIGHBOURING_RODS_SETTINGS = NeighbouringRodsSettings()


@dataclass(frozen=True, slots=True)
class NeighbouringRods:
    """Neighbouring rods of a sweep that differ in one parameter: `path` names the parameter, `values`, (n,),
    are its values.
    """

    path: Path
    values: Array

    def __len__(self) -> int:
        return len(self.values)

    def rod_at(self, i: int) -> Rod:
        """Rod of index i."""
        return self.path.rod.with_values(**{self.path.name: float(self.values[i])})

    @property
    def path_variables(self) -> Array:
        """Path variable p of every rod, (n,)."""
        return 1 / self.values if self.path.is_compliance_path else self.values

    @property
    def coefficients(self) -> Array:
        """(F, nu, c2, gamma3) of every rod, (n, 4), identical to `Rod.coefficients`."""
        columns = coefficients_of({**self.path.rod.values, self.path.name: self.values})
        table = np.empty((len(self), len(columns)))
        for number, column in enumerate(columns):
            table[:, number] = column
        return table


@dataclass(frozen=True, slots=True)
class FollowedSpectra:
    """Spectra of `NeighbouringRods`. is_solved: whether the spectrum of each rod is known, (n,); the
    remaining rods must be solved one by one.
    """

    spectra: Spectrum
    is_solved: NDArray[np.bool_]


def follow_spectra(rods: NeighbouringRods, request: SpectrumRequest) -> FollowedSpectra:
    """The leading `request.modes` eigenvalues of all rods, as far as eigenvalues can be followed from rod to
    rod and proved complete; `is_solved` is False for every other rod.
    """
    began = time.perf_counter()
    n = len(rods)
    columns = _unsolved_fields(n, request.modes)
    solved = np.zeros(n, np.bool_)
    start = 0
    patience = 1
    while start < n:
        found = _followed_eigenvalues(rods, start, request)
        if found is None:
            # If no proof succeeds, for example without a bound, following is tried less and less often.
            start += patience
            patience *= 2
            continue
        here = slice(start, start + len(found.is_accepted))
        columns["eigenvalues"][here] = found.w
        columns["error_estimate"][here] = errors_with_rounding(found.w, found.error, rods.path.rod)
        columns["unstable_count"][here] = found.unstable_count
        columns["certified"][here] = True
        solved[here] = found.is_accepted
        start = here.stop
        patience = 1
    seconds = np.full(n, (time.perf_counter() - began) / max(1, int(solved.sum())))
    return FollowedSpectra(Spectrum(seconds=seconds, **columns), solved)


def _unsolved_fields(n: int, modes: int) -> dict[str, Any]:
    """Arrays for the fields of a `Spectrum` of n rods, filled with the values of an unsolved rod."""
    whole = np.zeros(n, np.int64)
    return {
        "eigenvalues": np.full((n, modes), COMPLEX_NAN),
        "error_estimate": np.full((n, modes), np.nan),
        "unstable_count": whole - 1,
        "certified": np.zeros(n, np.bool_),
        "elements": whole.copy(),
        "order": whole.copy(),
        "status": whole + SpectrumStatus.ok,
        "message": np.full(n, "", object),
    }


def _followed_eigenvalues(
    rods: NeighbouringRods, start: int, request: SpectrumRequest
) -> FollowedPoints | None:
    """Eigenvalues followed from the rod with index `start` as far as possible, with counts; None if the first
    rod fails, or for a uniform rod of nonlinear material, which is solved as an equivalent linear rod."""
    rod = rods.path.rod
    varies = rods.path.name == "taper"
    if rod.is_uniform and not (rod.is_uniform_and_linear or varies):
        return None  # the linear rod to which uniform rubber is equivalent has the closed form and its proof
    if varies or not rod.is_uniform_and_linear:
        return follow_spectra_of_arms(rods.path, rods.path_variables[start:], request)
    seed = _first_eigenvalues(rods.rod_at(start), request)
    if seed is None:
        return None
    first, complete = seed
    modes = request.modes
    rest = NeighbouringRods(rods.path, rods.values[start:])
    track = start_track(first, len(rest))
    n = follow_eigenvalues(track, rest.coefficients, rest.path_variables, rods.path.direction, modes)
    if n == 0:
        return None
    track = slice_track(track, 0, n)
    known = _proved_counts_along(rest, track, modes, complete)
    reached = slice_track(track, 0, len(known))
    good, unstable = assess_points(reached, known, modes, request.accuracy)
    return FollowedPoints(*leading_eigenvalues(reached, modes), unstable, good)


def _proved_counts_along(
    rods: NeighbouringRods, track: Track, modes: int, complete: int
) -> NDArray[np.int64]:
    """Number of leading eigenvalues proved complete at each point of a track, up to the last point with a
    proof, (points,).

    modes: number of requested eigenvalues. complete: number of eigenvalues proved complete at the first
    point. If a proof does not carry the number to the next point, a new count there is tried.
    """
    n = len(track.w)
    coefficients = rods.coefficients[:n]
    p = rods.path_variables[:n]
    known = np.zeros(n, np.int64)
    known[0] = complete
    at = 0
    while True:
        rest = slice_track(track, at, n)
        at += carry_count(rest, coefficients[at:], p[at:], rods.path.direction, modes, known[at:])
        if at == n - 1:
            break
        gap = widest_gap(track, at + 1, modes)
        line = float(line_in_gap(track, at + 1, gap)[0]) if gap else 0.0
        if not gap or count_right_of(line, rods.rod_at(at + 1)).number != gap:
            break
        at += 1
        known[at] = gap
    return known[: at + 1]


def _first_eigenvalues(rod: Rod, request: SpectrumRequest) -> tuple[Complex, int] | None:
    """Returns (eigenvalues, complete); None after a failure or without a proof. eigenvalues: eigenvalues to
    follow, (m,), without unpaired complex eigenvalues. complete: number of eigenvalues proved complete.
    """
    try:
        modes = request.modes + NEIGHBOURING_RODS_SETTINGS.further_modes
        search = SpectrumSearch(rod, replace(request, modes=modes - 1, certify=True), requested=modes)
        with np.errstate(all="ignore"):
            outcome = search.outcome()
    except FAILURES:
        destroy_pooled_solvers()
        return None
    if search.best is None or search.best.comparison is None or not outcome.certified:
        return None
    w = search.best.candidates.roots.w.copy()
    complete = search.best.comparison.found_count
    w = w[: complete + 1 + (complete < len(w) and w[complete].imag > 0)]
    for k in np.flatnonzero(w.imag > 0):
        if k + 1 == len(w):
            return w[:k], min(complete, int(k))
        w[k + 1] = w[k].conjugate()
    return w, complete


def warm_up() -> None:
    """Loads compiled code and creates the solver objects, so that the first sweep takes no extra time."""
    warm_up_search()
    path = Path(Rod(F=15.0, k1=1e4, k2=1e4, gamma3=1e-4), "F")
    follow_spectra(
        NeighbouringRods(path, np.linspace(15.0, 45.0, 12)), SpectrumRequest(2, 1e-4, certify=True)
    )
