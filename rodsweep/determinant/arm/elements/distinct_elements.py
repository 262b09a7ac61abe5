"""Numbering of the elements of an arm by their propagators. Neighbouring elements of a segment with constant
coefficients have equal propagators, which are then computed once."""

import numpy as np
from numpy.typing import NDArray

from ....arrays import Array
from ....model.compiled.compilation import compiled
from ...exponents import TWO_MACHINE_EPSILONS


@compiled
def distinct_element_indices(local: Array, lengths: Array) -> NDArray[np.int64]:
    """Index of each element among the distinct elements, (elements,), not decreasing, from 0. Neighbouring
    elements with equal coefficients and lengths, as in a segment without taper, have the same index. local:
    `LocalCoefficients` of n arms, (6, n, elements, STAGES). lengths: lengths of the elements, in L,
    (elements,)."""
    numbers = np.zeros(len(lengths), np.int64)
    for e in range(1, len(lengths)):
        # Lengths are differences of positions from 0 to 1, so they have rounding errors.
        is_equal = abs(lengths[e] - lengths[e - 1]) <= 2 * TWO_MACHINE_EPSILONS
        is_equal = is_equal and (local[:, :, e] == local[:, :, e - 1]).all()
        numbers[e] = numbers[e - 1] if is_equal else numbers[e - 1] + 1
    return numbers
