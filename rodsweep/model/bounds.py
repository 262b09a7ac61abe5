"""Where transverse eigenvalues can lie: an a-priori box for every eigenvalue with Re w >= -depth.

Testing the eigenproblem of Sec. VI with its own eigenfunction, y with weight 1 and theta with a
weight rho > 0, gives, with N^2 = |y|^2 + rho gamma3 |theta|^2 (L2 norms over the rod),

    w N^2 = -c2 |s|^2 - rho |theta'|^2 + (rho g - nu) <theta, s> - F <y, theta'>.

With n^2 = (c2 |s|^2 + rho |theta'|^2)/N^2 the last two terms are at most a n N^2 in modulus, where
a^2 = max(F^2/rho, (rho g - nu)^2/(c2 rho gamma3)), so that

    Re w <= a n - n^2 <= a^2/4,   |Im w| <= a n,   and Re w >= -depth forces n^2 <= a n + depth.

The weight is free; the best one makes both entries of the maximum equal.
"""

from math import inf, sqrt

from .compilation import compiled
from .rod import Rod

MARGIN = 1.01
"""Factor on every bound, so that rounding in the bound itself cannot matter."""


def eigenvalue_box(rod: Rod, depth: float = 0.0) -> tuple[float, float]:
    """(max Re w, max |Im w|) over all eigenvalues with Re w >= -depth, depth >= 0; inf if unknown."""
    return box_of(sqrt(squared_amplification(rod)), depth)


@compiled
def box_of(a: float, depth: float) -> tuple[float, float]:
    """`eigenvalue_box` from a, the root of `squared_amplification`."""
    n = (a + sqrt(a * a + 4 * depth)) / 2
    # A pad in proportion to the depth keeps the box open where F = 0 makes the bound vanish.
    pad = 0.01 * depth + 1e-6
    return MARGIN * a * a / 4 + pad, MARGIN * a * n + pad


def squared_amplification(rod: Rod) -> float:
    """The smallest a^2 over all weights rho.

    For g > 0 it is F^2 g/(nu + |F| sqrt(c2 gamma3)), in every limit. For g < 0 (a pull beyond the
    shear stiffness) rho g - nu has no zero, and with gamma3 = 0 there is no bound at all.
    """
    drag = rod.c2 * rod.gamma3
    level = abs(rod.F) * sqrt(drag)
    if rod.g >= 0:
        return rod.F**2 * rod.g / (rod.nu + level)
    if drag == 0:
        return inf
    weights = [rod.nu / -rod.g] + ([(level - rod.nu) / -rod.g] if level > rod.nu else [])
    return min(max(rod.F**2 / rho, (rho * rod.g - rod.nu) ** 2 / (drag * rho)) for rho in weights)
