"""Subcritical Hopf point near a force at which the straight rod is stable.

The unstable cycles of a subcritical Hopf point coexist with the stable straight rod and bound its basin of
attraction. After a perturbation larger than the unstable cycle, the rod does not return to the straight
state; mostly it approaches a stable cycle on the same branch beyond a fold.
"""

from dataclasses import dataclass, replace

from ...determinant.parameter_path import ParameterPath
from ...model.rod import Rod
from ..changes.search_range import search_end_below_crushing
from ..changes.thresholds_along_path import find_imaginary_axis_crossings
from .hopf_coefficients import hopf_coefficients


@dataclass(frozen=True, slots=True, kw_only=True)
class SubcriticalHopfSearchSettings:
    """Settings for the search for a subcritical Hopf point near the force of a rod."""

    max_hopf_force_ratio: float = 1.5
    """Hopf points are searched from F/`max_hopf_force_ratio` to F times `max_hopf_force_ratio`, F: force of
    the rod."""
    landau_accuracy: float = 1e-3
    """Relative accuracy of the Landau coefficient c; only the sign and the first digits of c are needed."""
    max_unstable_cycle_y: float = 0.5
    """Hopf points are ignored if the largest tip y of their unstable cycle, in L, exceeds this number: the
    normal form is too inaccurate."""


SUBCRITICAL_HOPF_SEARCH_SETTINGS = SubcriticalHopfSearchSettings()


@dataclass(frozen=True, slots=True)
class SubcriticalHopf:
    """Subcritical Hopf point near the force of a rod, with the size of its unstable cycle. F: force of the
    Hopf point, in k3/L^2. unstable_cycle_y: largest tip y, in L, of the unstable cycle at the force of the
    rod, to leading order."""

    F: float
    unstable_cycle_y: float


def subcritical_hopf_near(rod: Rod) -> SubcriticalHopf | None:
    """The subcritical Hopf point nearest to the force of `rod`; None if no candidate is subcritical, or if
    the force is not positive.

    The candidates are the first Hopf point above and the first Hopf point below the force, both within a
    factor of `max_hopf_force_ratio` of the force. A candidate is ignored if, by the normal form, the largest
    tip y of its unstable cycle exceeds `max_unstable_cycle_y`. The straight rod must be stable. Raises
    Unsolvable if the search for Hopf points or a coefficient fails.
    """
    min_force = rod.F / SUBCRITICAL_HOPF_SEARCH_SETTINGS.max_hopf_force_ratio
    max_force = search_end_below_crushing(rod, rod.F * SUBCRITICAL_HOPF_SEARCH_SETTINGS.max_hopf_force_ratio)
    if not 0 < min_force < max_force:
        return None
    crossings = find_imaginary_axis_crossings(
        ParameterPath(rod, "F"), min_force, max_force, certify=False
    ).thresholds
    crossings_above = [crossing for crossing in crossings if crossing.value > rod.F]
    crossings_below = [crossing for crossing in crossings if crossing.value <= rod.F]
    nearest_crossings = crossings_above[:1] + crossings_below[-1:]
    for hopf in sorted(nearest_crossings, key=lambda one: abs(one.value - rod.F)):
        coefficients = hopf_coefficients(
            replace(rod, F=hopf.value), hopf, SUBCRITICAL_HOPF_SEARCH_SETTINGS.landau_accuracy
        )
        unstable_y = abs(coefficients.amplitude_coefficient) * abs(rod.F / hopf.value - 1) ** 0.5
        # A positive criticality means subcritical.
        if (
            coefficients.criticality > 0
            and unstable_y <= SUBCRITICAL_HOPF_SEARCH_SETTINGS.max_unstable_cycle_y
        ):
            return SubcriticalHopf(hopf.value, unstable_y)
    return None
