"""Amplitudes of cycles beside two Hopf points close together, as near an extremum of a Hopf curve.

Between two such points the growth rate of the straight rod is a parabola of the parameter p, with the slopes
s and -s at its zeros p1 and p2, and Re c (c: Landau coefficient) hardly changes. The cycles have

    y^2 = |s/Re c| |p - p1| |p - p2| / d,   d = |p2 - p1|,

an ellipse if the two branches start towards each other, otherwise a hyperbola; half its axis along y is
sqrt(|s/Re c| d)/2. Cycles of much smaller y are those of one Hopf point alone.
"""

from collections.abc import Sequence
from math import inf

from ..settings import BRANCH_START_SETTINGS
from .hopf_point import HopfBranchStart


def max_first_amplitude(hopf: HopfBranchStart, hopfs: Sequence[HopfBranchStart]) -> float:
    """Upper limit of the largest tip y, in L, of the first cycle of the branch from the Hopf point `hopf`: a
    fraction of half the axis of the ellipse that ends at the nearest of the Hopf points `hopfs`; inf if no
    branch of `hopfs` starts towards `hopf`."""
    facing = [
        other for other in hopfs if hopf.parameter_direction * _parameter_coordinate_change(hopf, other) > 0
    ]
    return BRANCH_START_SETTINGS.max_first_to_largest_amplitude_ratio * _half_axis_along_y(hopf, facing)


def min_last_amplitude(hopfs: Sequence[HopfBranchStart]) -> float:
    """Amplitude (largest tip y, in L) at and below which a cycle is the last one solved on a branch that ends
    at one of the Hopf points `hopfs`."""
    half_axis = min((_half_axis_along_y(hopf, hopfs) for hopf in hopfs), default=inf)
    settings = BRANCH_START_SETTINGS
    return min(settings.min_amplitude_before_fold, settings.last_cycle_amplitude_per_half_axis * half_axis)


def _half_axis_along_y(hopf: HopfBranchStart, hopfs: Sequence[HopfBranchStart]) -> float:
    """Half the axis along y, in L, of the ellipse or hyperbola through the Hopf point `hopf` and the nearest
    of the Hopf points `hopfs` whose branch starts in the opposite direction; inf without one."""
    opposite = [other for other in hopfs if hopf.parameter_direction * other.parameter_direction < 0]
    distance = min((abs(_parameter_coordinate_change(hopf, other)) for other in opposite), default=inf)
    return float(
        (abs(hopf.eigenvalue_slope_by_coordinate.real / hopf.normal_form_coefficients.landau.real) * distance)
        ** 0.5
        / 2
    )


def _parameter_coordinate_change(hopf: HopfBranchStart, other: HopfBranchStart) -> float:
    """Change of the parameter coordinate from the Hopf point `hopf` to `other`."""
    return other.parameter_coordinate - hopf.parameter_coordinate
