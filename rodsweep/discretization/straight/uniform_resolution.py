"""First mesh for the leading modes of a uniform rod of linear material."""

from math import hypot, pi, sqrt

from ...model.dispersion import growth_rate, largest_growth_and_wave_number
from ...model.rod import Rod
from ..elements.resolution import Resolution, expected_wave_number, resolution_for


def first_resolution(
    rod: Rod, mode_count: int, accuracy: float, amplified_wave_number: float | None = None
) -> Resolution:
    """The mesh expected to give `mode_count` leading eigenvalues of a uniform rod of linear material to the
    relative `accuracy`. amplified_wave_number: as from `largest_growth_and_wave_number`, in 1/L; computed if
    None.

    However few modes are requested, the modes of a pulled rod have layers at both ends. Raises NotUniform for
    a varying arm or a nonlinear law.
    """
    if amplified_wave_number is None:
        _, amplified_wave_number = largest_growth_and_wave_number(rod)
    wave_number = expected_wave_number(mode_count, amplified_wave_number)
    if rod.F < 0:
        wave_number = hypot(wave_number, _layer_wave_number(rod))
    return resolution_for(wave_number, accuracy)


def _layer_wave_number(rod: Rod) -> float:
    """Wave number q, in 1/L, of the layers exp(-q u) at the ends of a pulled uniform rod in its leading mode.

    Of the two roots q^2 of the dispersion relation at the rate w the mode has the wave -kappa^2, and the
    layers q^2 = (c2 + gamma3) w - F g + kappa^2. Beyond the shear stiffness, g < 0, the longest wave that
    fits the rod, kappa = pi/2, may grow at a rate w proportional to 1/gamma3; otherwise w is small.
    """
    w = growth_rate(rod, pi / 2) if rod.g < 0 else 0.0
    squared_wave_number = (rod.c2 + rod.gamma3) * w - rod.F * rod.g
    # The difference of two infinite numbers is no wave number.
    return sqrt(squared_wave_number) if squared_wave_number > 0 else 0.0
