"""Stability of a limit cycle from its nontrivial Floquet multipliers and their errors."""


def min_unstable_multiplier_count(outside_count: int, largest_modulus: float, modulus_error: float) -> int:
    """Lower bound on the number of nontrivial Floquet multipliers outside the unit circle. A result of 0
    means that the cycle is stable, -1 that its stability is undecided.

    outside_count: number of nontrivial multipliers outside the unit circle, or -1 if one of them has modulus
    1 within its error. largest_modulus, modulus_error: largest modulus of a nontrivial multiplier, and its
    absolute error. If `outside_count` is -1 and the largest multiplier certainly lies outside, the result is
    1; otherwise the result is `outside_count`. A relative error r of a multiplier means a factor between 1/(1
    + r) and 1 + r: on branches with multipliers of 1e13, rounding errors make r larger than 1, and the
    multiplier still has the right order of magnitude.
    """
    # Even if the full count is undecided, the largest multiplier may lie clearly outside.
    if outside_count < 0 and largest_modulus > 1 + modulus_error / largest_modulus:
        return 1
    return outside_count
