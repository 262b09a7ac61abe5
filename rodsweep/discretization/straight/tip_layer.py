"""The tip layer of an arm without rotational drag, in which the angle theta follows y instantaneously.

d = theta - theta+, the difference between the angle and the adjoint angle
(`rodsweep.model.adjoint_tip_conditions`), solves d' = c3 m, m' = q d with q = g nu/c2 and d(0) = 0; this
module computes T = d(1)/m(1). With test functions b the weak form is int b' d'/c3 + b q d = b(1) m(1). T is
the energy of d for m(1) = 1, so the error of T is the square of the error of d.
"""

from dataclasses import dataclass
from math import ceil, sqrt

import numpy as np

from ...arrays import Array
from ...model.adjoint_tip_conditions import tip_layer_factor
from ...model.rod import Rod
from ..elements.basis import value_and_slope_at_gauss_points
from ..elements.quadrature import gauss_legendre_rule


@dataclass(frozen=True, slots=True, kw_only=True)
class TipLayerSettings:
    """Settings for the elements that resolve the tip layer."""

    max_tip_element_over_layer_thickness: float = 4.0
    """Maximum length of the element at the tip, divided by the layer's thickness. Other elements may be
    longer."""
    max_equal_element_count: int = 64
    """Maximum number of equal elements. For a thinner layer the elements near the tip are halved."""
    samples_per_interval: int = 33
    """Number of samples in each interval between breaks of an arm, to estimate the layer's thickness."""


TIP_LAYER_SETTINGS = TipLayerSettings()
TIP_LAYER_ORDER = 16
"""Order of the elements of the tip layer. This order resolves exp(kappa u) over a length of
`TIP_LAYER_SETTINGS.max_tip_element_over_layer_thickness`/kappa to rounding, because `tip_angle_moment_ratio`
returns its result without an error estimate. Order 8 would cause an error of 4e-11 in a numerical
abscissa."""


def tip_angle_moment_ratio(rod: Rod) -> float:
    """T = d(1)/m(1) at the tip of a rod without rotational drag; 0 for a rod with rotational drag or without
    shear. d: difference of the angle and the adjoint angle. m = d'/c3: bending moment of d."""
    if rod.base_rotational_drag > 0 or rod.c2 == 0:
        return 0.0
    if rod.is_uniform_and_linear:
        return tip_layer_factor(rod)
    edges = _edges_with_short_tip_elements(rod)
    # Two points more than the order, for coefficients that vary within an element.
    points, weights = gauss_legendre_rule(TIP_LAYER_ORDER + 2)
    value, slope = value_and_slope_at_gauss_points(TIP_LAYER_ORDER, len(points))
    lengths = np.diff(edges)
    coefficients = rod.local_coefficients(edges[:-1, None] + lengths[:, None] * (points + 1) / 2)
    stiffness = 1 / coefficients.c3 * weights * (2 / lengths)[:, None]
    foundation = coefficients.g * coefficients.nu / coefficients.c2 * weights * (lengths / 2)[:, None]
    ratio = 0.0
    # From clamp to tip, because the ratio d/m of everything before acts on an element like a spring.
    for element_stiffness, element_foundation in zip(stiffness, foundation, strict=True):
        K = (slope.T * element_stiffness) @ slope + (value.T * element_foundation) @ value
        ratio = _angle_moment_ratio_at_right_end(K, ratio)
    return ratio


def _angle_moment_ratio_at_right_end(K: Array, left_ratio: float) -> float:
    """The ratio d/m of `tip_angle_moment_ratio` at the right end of an element. left_ratio: d/m at the left
    end. K: stiffness matrix of the element, (nodes, nodes)."""
    # At the clamp (left_ratio = 0) d is not an unknown; otherwise all previous elements act as a spring of
    # stiffness 1/left_ratio.
    if left_ratio == 0:
        K = K[1:, 1:]
    else:
        K = K.copy()
        K[0, 0] += 1 / left_ratio
    load = np.zeros(len(K))
    load[-1] = 1.0
    return float(np.linalg.solve(K, load)[-1])


def _edges_with_short_tip_elements(rod: Rod) -> Array:
    """Increasing edges of elements: breaks of the arm, edges of equal elements and, for a thin layer, edges
    of shorter elements towards the tip."""
    breaks = rod.material.breaks
    intervals = zip(breaks, breaks[1:], strict=False)
    midpoints = np.concatenate(
        [np.linspace(a, b, TIP_LAYER_SETTINGS.samples_per_interval + 2)[1:-1] for a, b in intervals]
    )
    coefficients = rod.local_coefficients(midpoints)
    inverse_thickness = sqrt(
        float(np.abs(coefficients.g * coefficients.nu / coefficients.c2 * coefficients.c3).max())
    )
    element_count = min(
        max(1, ceil(inverse_thickness / TIP_LAYER_SETTINGS.max_tip_element_over_layer_thickness)),
        TIP_LAYER_SETTINGS.max_equal_element_count,
    )
    equal_edges = np.linspace(0.0, 1.0, element_count + 1)
    halving_count = max(
        0,
        ceil(
            np.log2(
                max(
                    inverse_thickness
                    / TIP_LAYER_SETTINGS.max_tip_element_over_layer_thickness
                    / element_count,
                    1.0,
                )
            )
        ),
    )
    towards_tip = 1 - 0.5 ** np.arange(1, halving_count + 1) / element_count
    return np.unique(np.concatenate([breaks, equal_edges, towards_tip]))
