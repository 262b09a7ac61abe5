"""First mesh for the leading modes of a uniform rod of linear material."""

from math import hypot, sqrt

from ...model.dispersion import largest_growth_and_wave_number
from ...model.rod import Rod
from ..elements.resolution import Resolution, expected_wave_number, resolution_for


def first_resolution(
    rod: Rod, mode_count: int, accuracy: float, amplified_wave_number: float | None = None
) -> Resolution:
    """The mesh expected to give `mode_count` leading eigenvalues of a uniform rod of linear material to the
    relative `accuracy`. amplified_wave_number: as from `largest_growth_and_wave_number`, in 1/L; computed if
    None.

    However few modes are requested, the modes of a pulled rod have layers exp(-q u) at both ends, with q =
    sqrt(-F g), g = nu + F c2, at small growth rates. Raises NotUniform for a varying arm or a nonlinear law.
    """
    if amplified_wave_number is None:
        _, amplified_wave_number = largest_growth_and_wave_number(rod)
    layer_wave_number = sqrt(max(-rod.F * rod.g, 0.0))
    wave_number = hypot(expected_wave_number(mode_count, amplified_wave_number), layer_wave_number)
    return resolution_for(wave_number, accuracy)
