"""Stability of a cycle from its Floquet multipliers, as far as their errors decide it."""


def least_outside(count: int, multiplier: float, error: float) -> int:
    """Least number of Floquet multipliers outside the unit circle; 0: stable, -1: stability undecided.

    count: number of multipliers outside, -1 if a multiplier lies on the circle within its error. multiplier,
    error: the
    largest modulus and its absolute error. A cycle whose largest multiplier lies outside is unstable wherever
    the others lie. A relative error r is a factor of 1 + r either way: on branches with multipliers of 1e13
    rounding leaves r above 1, and the multiplier still has an order of magnitude.
    """
    if count < 0 and multiplier > 1 + error / multiplier:
        return 1
    return count
