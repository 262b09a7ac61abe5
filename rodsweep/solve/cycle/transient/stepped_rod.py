"""The rod as a time stepper sees it: near a limit instead of in it, on a mesh that its motion needs."""

from dataclasses import replace

from ....discretization.elements.resolution import Resolution, expected_wave_number, resolution_for
from ....model.dispersion import most_amplified_wave
from ....model.rod import Rod

EXPECTED_MODES = 3
"""Modes by whose wave number the first mesh is chosen; the cycle says whether it is fine enough."""
FOLDS = 2.5
"""Largest wave number of a cycle in units of sqrt(F), the inverse of the length to which F bends a rod."""
STIFFEST, LEAST_DRAG = 1e8, 1e-6
"""Largest stiffness and least gamma3 in a motion: what is beyond moves like these, to 1e-6 at least."""


def motion_resolution(rod: Rod, accuracy: float) -> Resolution:
    """The first mesh of a motion, to a relative accuracy."""
    wave = max(expected_wave_number(EXPECTED_MODES, most_amplified_wave(rod)[1]), FOLDS * abs(rod.F) ** 0.5)
    return resolution_for(wave, accuracy)


def near_rod(rod: Rod) -> Rod:
    """The rod itself, or one near the limit that it is: the time stepper takes no limits."""
    return replace(
        rod, k1=min(rod.k1, STIFFEST), k2=min(rod.k2, STIFFEST), gamma3=max(rod.gamma3, LEAST_DRAG)
    )
