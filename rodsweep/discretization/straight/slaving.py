"""The layer in which an arm without rotational drag slaves theta: T of `rodsweep.model.adjoint` for profiles.

d = theta - theta+ solves d' = c3 m, m' = q d with q = g nu/c2 and d(0) = 0, and T = d(1)/m(1). In weak form
int b' d'/c3 + b q d = b(1) m(1), of which T is the energy: its error is the square of that of d.
"""

from math import ceil, sqrt

import numpy as np

from ...arrays import Array
from ...model.adjoint import slaving_layer
from ...model.rod import Rod
from ..elements.basis import differentiation, interpolation
from ..elements.quadrature import gauss, gauss_lobatto

ORDER = 16
"""Order of the elements: it resolves exp(kappa u) over `LONGEST`/kappa to rounding."""
LONGEST = 4.0
"""Longest element in units of the thickness of the layer, except away from the tip."""
MOST_EQUAL = 64
"""Largest number of equal elements; where the layer is thinner, elements get shorter towards the tip."""


def slaving_of(rod: Rod) -> float:
    """T = d(1)/m(1) of a rod without rotational drag; 0 of one that has drag or does not shear."""
    if rod.rotational_drag > 0 or rod.c2 == 0:
        return 0.0
    if rod.standard:
        return slaving_layer(rod)
    edges = _edges(rod)
    (x, _), (points, weights) = gauss_lobatto(ORDER), gauss(ORDER + 2)
    value = interpolation(x, points)
    slope = value @ differentiation(x)
    lengths = np.diff(edges)
    local = rod.local(edges[:-1, None] + lengths[:, None] * (points + 1) / 2)
    stiffness = 1 / local.c3 * weights * (2 / lengths)[:, None]
    foundation = local.g * local.nu / local.c2 * weights * (lengths / 2)[:, None]
    total = 0.0
    for bend, press in zip(stiffness, foundation, strict=True):
        K = (slope.T * bend) @ slope + (value.T * press) @ value
        total = _behind(K, total)
    return total


def _behind(K: Array, before: float) -> float:
    """d/m at the right end of an element of stiffness K, (ORDER + 1, ORDER + 1), from d/m at its left end."""
    if before == 0:
        K = K[1:, 1:]
    else:
        K = K.copy()
        K[0, 0] += 1 / before
    load = np.zeros(len(K))
    load[-1] = 1.0
    return float(np.linalg.solve(K, load)[-1])


def _edges(rod: Rod) -> Array:
    """Ends of elements: the breaks, equal elements, and shorter ones towards the tip."""
    breaks = rod.build.breaks
    middles = np.concatenate([np.linspace(a, b, 35)[1:-1] for a, b in zip(breaks, breaks[1:], strict=False)])
    local = rod.local(middles)
    waves = sqrt(float(np.abs(local.g * local.nu / local.c2 * local.c3).max()))
    count = min(max(1, ceil(waves / LONGEST)), MOST_EQUAL)
    equal = np.linspace(0.0, 1.0, count + 1)
    halvings = max(0, ceil(np.log2(max(waves / LONGEST / count, 1.0))))
    towards_tip = 1 - 0.5 ** np.arange(1, halvings + 1) / count
    return np.unique(np.concatenate([breaks, equal, towards_tip]))
