"""Stability of the straight rod by its spectrum, which overrules any motion on a mesh.

Near a Hopf point, the mesh of a motion shifts the Hopf point slightly, as does the replacement of a rod in a
limit by a rod near the limit. The exact leading eigenvalue decides, within the error estimate.
"""

from dataclasses import dataclass, field
from math import isnan, nan

import numpy as np

from ...arrays import Complex
from ...determinant.roots.settings import ROOTS
from ...model.rod import Rod
from ..spectrum.path.followed_leader import follow_leading_eigenvalue
from ..spectrum.search import SpectrumRequest, solve_spectrum


@dataclass(frozen=True, slots=True, kw_only=True)
class StraightRodSettings:
    """Settings for the stability of the straight rod."""

    errors_from_axis: float = 4.0
    """Distance from the imaginary axis, in units of the eigenvalue's error estimate, beyond which the sign of
    the growth rate is certain. The spectrum uses the same criterion."""
    accuracy: float = 1e-9
    """Relative accuracy of the leading eigenvalue."""
    modes_of_chain: int = 6
    """Number of eigenvalues of an arm from which a chain starts: enough to prove, near most Hopf points, by a
    few values of D that no further one leads; a count takes three times as long."""


STRAIGHT_ROD = StraightRodSettings()


NONE_FOLLOWED: Complex = np.empty(0, complex)


@dataclass(frozen=True, slots=True)
class StraightRod:
    """Leading eigenvalue w in 1/tau2, Im w >= 0, and the error estimate; both NaN if not known.

    message: the reason for NaN. followed: eigenvalues that were followed from a similar rod, (n,), the
    leading one first; empty after a search.
    """

    w: complex
    error: float
    message: str = ""
    followed: Complex = field(default_factory=NONE_FOLLOWED.copy, compare=False)

    @property
    def stable(self) -> bool | None:
        """Whether all small motions decay; None if the error leaves this open."""
        margin = max(STRAIGHT_ROD.errors_from_axis * self.error, ROOTS.axis_tolerance * abs(self.w))
        # A NaN satisfies no comparison, so an unknown eigenvalue gives None.
        return self.w.real < 0 if abs(self.w.real) > margin else None

    def growth_rate(self, otherwise: float) -> float:
        """Growth rate of the leading mode, 1/tau2: 0 if its sign is open, `otherwise` if the rate is
        unknown."""
        if isnan(self.error):
            return otherwise
        return 0.0 if self.stable is None else self.w.real

    @property
    def doubt(self) -> str:
        """The reason why a rod whose motion decays may not stay straight; empty for a stable straight rod."""
        if self.stable:
            return ""
        if isnan(self.error):
            return f"whether the straight rod is stable is not known: {self.message}"
        rate = f"the straight rod's growth rate is {self.w.real:.2g} +- {self.error:.0e}"
        if self.stable is None:
            return f"{rate}, so whether it stays straight is not decided"
        return f"{rate}, so it leaves the straight state, although its motion on a mesh decays to it"


def straight_rod(rod: Rod, near: Complex | None = None, certify: bool = True) -> StraightRod:
    """The leading eigenvalue of a rod with its error.

    near: eigenvalues of a similar rod, (n,), the leading one first, followed to this rod if possible.
    certify: whether the eigenvalue is proved to be the leading one.
    """
    request = SpectrumRequest(1, STRAIGHT_ROD.accuracy, certify)
    leader = None if near is None else follow_leading_eigenvalue(rod, near, request.accuracy)
    if leader is not None:
        return StraightRod(leader.w, leader.error, followed=leader.eigenvalues)
    found = solve_spectrum(rod, request)
    if isnan(found.error_estimate[0]):
        return StraightRod(complex(nan, nan), nan, found.message)
    w = complex(found.eigenvalues[0])
    return StraightRod(complex(w.real, abs(w.imag)), float(found.error_estimate[0]))


def eigenvalues_to_follow(rod: Rod, found: StraightRod) -> Complex:
    """Eigenvalues, (n,), the leading one first, from which those of a similar rod can be followed."""
    if len(found.followed):
        return found.followed
    if not rod.uniform:
        request = SpectrumRequest(STRAIGHT_ROD.modes_of_chain, STRAIGHT_ROD.accuracy, True)
        w = solve_spectrum(rod, request).eigenvalues
        if np.isfinite(w).all():
            return w[w.imag >= 0]
    return np.array([found.w])
