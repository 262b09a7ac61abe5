"""Stability of a limit cycle from its Floquet multipliers and their errors."""


def min_unstable_multipliers(count: int, multiplier: float, error: float) -> int:
    """Lower bound on the number of Floquet multipliers outside the unit circle: 0 means stable, -1 undecided.

    count: number of multipliers outside, or -1 if a multiplier lies on the circle within its error.
    multiplier, error: the largest modulus and its absolute error. If count is -1, the cycle is unstable
    (result 1) when the largest multiplier certainly lies outside. A relative error r stands for a factor
    between 1/(1 + r) and 1 + r: on branches with multipliers of 1e13, rounding leaves r above 1, and the
    multiplier still has the right order of magnitude.
    """
    if count < 0 and multiplier > 1 + error / multiplier:
        return 1
    return count
