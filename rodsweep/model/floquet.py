"""Stability of a limit cycle from its Floquet multipliers and their errors."""


def min_unstable_multipliers(count: int, multiplier: float, error: float) -> int:
    """Lower bound on the number of Floquet multipliers outside the unit circle: 0 if the cycle is stable, -1
    if the stability is undecided.

    count: number of multipliers outside the unit circle, or -1 if a multiplier lies on the circle within its
    error. multiplier, error: the largest modulus of a multiplier and its absolute error. If count is -1 and
    the largest multiplier lies outside for certain, the result is 1. A relative error r of a multiplier means
    a factor between 1/(1 + r) and 1 + r: on branches with multipliers of 1e13, rounding errors make r larger
    than 1, and the multiplier still has the right order of magnitude.
    """
    if count < 0 and multiplier > 1 + error / multiplier:
        return 1
    return count
