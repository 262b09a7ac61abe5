"""Rods of the thresholds benchmark, and the result of a method."""

from dataclasses import dataclass
from math import inf, isnan, nan

from ...model.rod import Rod

ONSET, HOPF = "onset", "hopf"
"""Kinds of thresholds: fields of ThresholdCase and names in rodsweep's results."""
ANOTHER = 0.3
"""Relative distance from the exact value beyond which the result is a different change."""


@dataclass(frozen=True)
class ThresholdCase:
    """A rod without force, its first onset and Hopf point (nan for none), rounded from 30 digits.

    top: force at which the peers end their search.
    """

    name: str
    k1: float
    k2: float
    gamma3: float
    onset: float
    hopf: float
    top: float = 60.0

    def rod(self, F: float) -> Rod:
        return Rod(F=F, k1=self.k1, k2=self.k2, gamma3=self.gamma3)

    def error_of(self, kind: str, found: float) -> float:
        """Relative error; nan if there is no threshold, inf if it was missed or invented."""
        exact = getattr(self, kind)
        if isnan(exact):
            return nan if isnan(found) else inf
        error = abs(found - exact) / exact
        return error if error < ANOTHER else inf


@dataclass(frozen=True, slots=True)
class FirstThreshold:
    """First threshold of a kind, nan if none was found, and the work spent on it.

    solves: eigenproblems. determinants: evaluations of D. products: matrix-vector products, for methods that
    solve no complete eigenproblem.
    """

    force: float
    solves: float = nan
    determinants: float = nan
    products: float = nan


CASES = (
    ThresholdCase("Fig. 2a", 1e4, 1e4, 1e-4, 20.0080206921030685, 37.6559805452710669),
    ThresholdCase("Fig. 2b", 1e4, 1e2, 1e-2, 14.7993326711955545, 27.4271941267592812),
    ThresholdCase("Fig. 2c", 2e2, 1e4, 1e-4, 22.4709774737663225, 49.7580049161915004),
    ThresholdCase("Fig. 2d", 1e2, 1e4, 1e-4, 27.4058263581942648, nan),
    ThresholdCase("filament", inf, inf, 0.0, 20.0509536189737612, 37.6954308403185779),
    ThresholdCase("narrow", 147.93, 1e4, 1e-4, 23.7456428120601644, 74.8251556528066767, 140.0),
    ThresholdCase("soft", 1e4, 3.0, 1e-2, 4.15946661669787928, 7.93638669176118928),
)
"""The flutter window of "narrow", from 74.83 to 75.98, falls between the points of a coarse grid. In "soft",
more and more pairs become unstable, and a long step passes the first one."""
QUICK_CASES = tuple(case for case in CASES if case.name in ("Fig. 2b", "Fig. 2d", "filament"))
