"""The tip layer of an arm without rotational drag, whose angle theta follows y: T of
`rodsweep.model.adjoint`.

d = theta - theta+ solves d' = c3 m, m' = q d with q = g nu/c2 and d(0) = 0, and T = d(1)/m(1). The weak form
is int b' d'/c3 + b q d = b(1) m(1). T is the energy of d for m(1) = 1, so the error of T is the square of the
error of d.
"""

from dataclasses import dataclass
from math import ceil, sqrt

import numpy as np

from ...arrays import Array
from ...model.adjoint import tip_layer_factor
from ...model.rod import Rod
from ..elements.basis import differentiation, interpolation
from ..elements.quadrature import gauss, gauss_lobatto


@dataclass(frozen=True, slots=True, kw_only=True)
class TipLayerSettings:
    """Settings for the elements that resolve the tip layer."""

    max_length: float = 4.0
    """Longest element next to the tip, in units of the layer's thickness; elements away from the tip may be
    longer."""
    max_equal_elements: int = 64
    """Maximum number of equal elements; a thinner layer also has elements that get shorter towards the
    tip."""
    samples_per_piece: int = 33
    """Number of samples of each interval between breaks of an arm, from which the thickness of the layer is
    estimated."""


TIP_LAYER = TipLayerSettings()
TIP_LAYER_ORDER = 16
"""Order of the elements of the tip layer. It resolves exp(kappa u) over `TIP_LAYER.max_length`/kappa to
rounding, because T is returned without an error. Order 8 would cause an error of 4e-11 of a numerical
abscissa."""


def tip_layer_ratio(rod: Rod) -> float:
    """T = d(1)/m(1) of a rod without rotational drag; 0 for a rod with rotational drag or without shear."""
    if rod.rotational_drag > 0 or rod.c2 == 0:
        return 0.0
    if rod.standard:
        return tip_layer_factor(rod)
    edges = _edges(rod)
    x, _ = gauss_lobatto(TIP_LAYER_ORDER)
    points, weights = gauss(TIP_LAYER_ORDER + 2)
    value = interpolation(x, points)
    slope = value @ differentiation(x)
    lengths = np.diff(edges)
    local = rod.local(edges[:-1, None] + lengths[:, None] * (points + 1) / 2)
    stiffness = 1 / local.c3 * weights * (2 / lengths)[:, None]
    foundation = local.g * local.nu / local.c2 * weights * (lengths / 2)[:, None]
    total = 0.0
    for bend, press in zip(stiffness, foundation, strict=True):
        K = (slope.T * bend) @ slope + (value.T * press) @ value
        total = _at_right_end(K, total)
    return total


def _at_right_end(K: Array, before: float) -> float:
    """The ratio d/m at the right end of an element, from the ratio `before` at its left end.

    K: stiffness matrix of the element, (nodes, nodes).
    """
    # 0 is the clamp, whose node is no unknown; else all elements before act as a stiffness 1/before.
    if before == 0:
        K = K[1:, 1:]
    else:
        K = K.copy()
        K[0, 0] += 1 / before
    load = np.zeros(len(K))
    load[-1] = 1.0
    return float(np.linalg.solve(K, load)[-1])


def _edges(rod: Rod) -> Array:
    """Edges of elements: breaks, equal elements and, for a thin layer, shorter elements towards the tip;
    increasing.
    """
    breaks = rod.build.breaks
    pieces = zip(breaks, breaks[1:], strict=False)
    middles = np.concatenate([np.linspace(a, b, TIP_LAYER.samples_per_piece + 2)[1:-1] for a, b in pieces])
    local = rod.local(middles)
    waves = sqrt(float(np.abs(local.g * local.nu / local.c2 * local.c3).max()))
    count = min(max(1, ceil(waves / TIP_LAYER.max_length)), TIP_LAYER.max_equal_elements)
    equal = np.linspace(0.0, 1.0, count + 1)
    halvings = max(0, ceil(np.log2(max(waves / TIP_LAYER.max_length / count, 1.0))))
    towards_tip = 1 - 0.5 ** np.arange(1, halvings + 1) / count
    return np.unique(np.concatenate([breaks, equal, towards_tip]))
