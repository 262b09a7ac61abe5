"""The subcritical Hopf point next to a force at which the straight rod is stable, if there is one.

From a subcritical Hopf point unstable cycles go to the side where the straight rod is stable. They are the
threshold beside it: a start beyond them leaves the straight rod, mostly for a stable cycle to which the
branch turns at a fold.
"""

from dataclasses import dataclass, replace

from ...determinant.parameter_path import Path
from ...model.rod import Rod
from ..changes.along_path import pair_crossings
from ..changes.unstable_modes import SHORT_OF_CRUSHED
from .hopf_coefficients import hopf_coefficients

FARTHEST_FORCE = 1.5
"""Ratio of the forces within which a Hopf point is looked for."""
ACCURACY = 1e-3
"""Relative, of c, of which the sign is wanted."""
LARGEST_Y = 0.5
"""Largest tip y, in L, of an unstable cycle for which the normal form may speak."""


@dataclass(frozen=True, slots=True)
class SubcriticalHopf:
    """A subcritical Hopf point at F, k3/L^2, and what its normal form gives for the force that it is next to.

    unstable_y: largest tip y, in L, of the unstable cycle at that force, to leading order.
    """

    F: float
    unstable_y: float


def subcritical_hopf_beside(rod: Rod) -> SubcriticalHopf | None:
    """The nearest of the Hopf points above and below a rod's force, if it is subcritical, else the other one.

    Only the first on either side counts, and only where its unstable cycle is no larger than LARGEST_Y. The
    straight rod is stable. Raises Unsolvable where the Hopf points or a coefficient cannot be had.
    """
    low, high = (
        rod.F / FARTHEST_FORCE,
        min(rod.F * FARTHEST_FORCE, rod.stretch_stiffness * (1 - SHORT_OF_CRUSHED)),
    )
    if not 0 < low < high:
        return None
    crossings = pair_crossings(Path(rod, "F"), low, high, certify=False).crossings
    nearest = [c for c in crossings if c.at > rod.F][:1] + [c for c in crossings if c.at <= rod.F][-1:]
    for hopf in sorted(nearest, key=lambda c: abs(c.at - rod.F)):
        found = hopf_coefficients(replace(rod, F=hopf.at), hopf, ACCURACY)
        y = abs(found.amplitude_coefficient) * abs(rod.F / hopf.at - 1) ** 0.5
        if found.criticality > 0 and y <= LARGEST_Y:
            return SubcriticalHopf(hopf.at, y)
    return None
