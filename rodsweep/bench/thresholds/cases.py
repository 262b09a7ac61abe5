"""The rods of the thresholds benchmark, what a method is given, and what it gives."""

from dataclasses import dataclass
from math import inf, isnan, nan

from ...discretization.resolution import Resolution, expected_wave_number, resolution_for
from ...model.dispersion import most_amplified_wave
from ...model.rod import Rod

MODES, MESH_ACCURACY = 2, 1e-12
"""Leading eigenvalues for which the mesh is chosen, and their relative error on it."""
HEAD_START, ENOUGH = 0.1, 6.0
"""Where PyCont-Lite starts, as a share of the way from onset to Hopf point, and how far beyond it ends."""
ANOTHER = 0.3
"""Relative distance beyond which what was found is not the first change."""


@dataclass(frozen=True, slots=True)
class Problem:
    """A rod without its force, the mesh that its thresholds need, and where the search ends.

    oscillates: a force at which a pair leads already; enough: one well beyond the Hopf point.
    """

    k1: float
    k2: float
    gamma3: float
    mesh: Resolution
    top: float
    oscillates: float = nan
    enough: float = nan

    def rod(self, F: float) -> Rod:
        return Rod(F, self.k1, self.k2, self.gamma3)


@dataclass(frozen=True, slots=True)
class Found:
    """A threshold, nan where none was found, and what it took: eigenproblems, evaluations of D.

    products: of a matrix and a vector, for who solves no whole eigenproblem. outside: processor seconds of
    another program. failure: why a method gave up.
    """

    force: float
    solves: float
    determinants: float = nan
    products: float = nan
    outside: float = 0.0
    failure: str = ""


@dataclass(frozen=True, slots=True)
class Case:
    """A rod with its first onset and Hopf point, nan for none, from 30 digits (tests/reference).

    top: where the peers end their search.
    """

    name: str
    k1: float
    k2: float
    gamma3: float
    onset: float
    hopf: float
    top: float = 60.0

    def problem(self) -> Problem:
        """What the peers are given: a mesh fine enough, and where to start and to end."""
        last, end = (self.onset, self.top) if isnan(self.hopf) else (self.hopf, self.hopf)
        wave = most_amplified_wave(Rod(last, self.k1, self.k2, self.gamma3))[1]
        mesh = resolution_for(expected_wave_number(MODES, wave), MESH_ACCURACY)
        start, enough = self.onset + HEAD_START * (end - self.onset), min(end + ENOUGH, self.top)
        return Problem(self.k1, self.k2, self.gamma3, mesh, self.top, start, enough)


CASES = (
    Case("Fig. 2a", 1e4, 1e4, 1e-4, 20.0080206921030685, 37.6559805452710669),
    Case("Fig. 2b", 1e4, 1e2, 1e-2, 14.7993326711955545, 27.4271941267592812),
    Case("Fig. 2c", 2e2, 1e4, 1e-4, 22.4709774737663225, 49.7580049161915004),
    Case("Fig. 2d", 1e2, 1e4, 1e-4, 27.4058263581942648, nan),
    Case("filament", inf, inf, 0.0, 20.0509536189737612, 37.6954308403185779),
    Case("narrow", 147.93, 1e4, 1e-4, 23.7456428120601644, 74.8251556528066767, 140.0),
    Case("soft", 1e4, 3.0, 1e-2, 4.15946661669787928, 7.93638669176118928),
)
"""The window of flutter of the last but one, from 74.83 to 75.98, falls between the points of a coarse grid;
the last one takes up ever more unstable pairs, so that a long step passes the first."""
QUICK_CASES = tuple(case for case in CASES if case.name in ("Fig. 2b", "Fig. 2d", "filament"))


def error_of(found: float, exact: float) -> float:
    """The relative error; nan where there is nothing to be found, inf where that is missed or invented."""
    if isnan(exact):
        return nan if isnan(found) else inf
    error = abs(found - exact) / exact
    return error if error < ANOTHER else inf
