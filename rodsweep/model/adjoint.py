"""The adjoint of the transverse operator L and its Hermitian part: the same equations, other ends.

Appendix B: in the Gamma inner product (psi, xi) = int psi_y* y + gamma3 psi_theta* theta, the adjoint
of L is operationally L, with psi(0) = 0 and (K D psi + ad*_psi Sigma0)(1) = 0. Since Sigma0 = (-F, 0, 0)
has ad*_psi Sigma0 = (0, -F Theta+, F Y+), the transverse block reads, with the shear force s+ kept as an
unknown so that no stiffness appears,

    w y+          = s+' - F theta+'
    w gamma3 th+  = theta+'' + g s+
    0             = y+' - nu theta+ - c2 s+
    y+(0) = theta+(0) = 0;   s+(1) = F theta+(1),   theta+'(1) = -F y+(1).

A left null vector (a, b, c) of the weak form's pencil is this mode: a = y+, b = theta+, and
c = -(s+ - F theta+). For (psi, L xi) = (L+ psi, xi) the eigenvalue of psi is w*: where w is complex the
adjoint mode is the conjugate of that left vector.

With the ends s(1) = e F theta(1), theta'(1) = -e F y(1), e = 0 is L, e = 1 its adjoint, and e = 1/2 the
Hermitian part (L + L+)/2 wherever theta has a dynamics of its own or none at all (gamma3 > 0 or c2 = 0):
the form (xi, L xi) contains no end term that depends on e, so that e = 1/2 is its natural condition.

The largest Re (xi, L xi)/(xi, xi) over the domain of L is a supremum, not a maximum: its maximiser has
the ends e = 1/2 and not e = 0. Fields of the domain reach it as closely as one likes (the domain is dense
in the form domain), but polynomials that satisfy s(1) = theta'(1) = 0 approach it only like 1/n^2,
those that satisfy none but the clamp exponentially.

Where gamma3 = 0 < c2, theta follows y at once, and it does so with different ends in L and in L+. Their
difference d = theta - theta+ solves c2 d'' = g nu d alone, which gives the Hermitian part one term more,

    s(1) = F theta(1)/2 - (F^2/4) T y(1),   T = tanh(kappa)/kappa,   kappa^2 = g nu/c2,

a layer of thickness 1/kappa that no mesh has to resolve. So the numerical abscissa jumps down by a finite
amount as gamma3 becomes 0 at c2 > 0: for any gamma3 > 0 theta may start where it likes.

All of this holds for c2(u), c3(u), nu(u), gamma2(u) and gamma3(u), since the force is the same all along
the arm: with m = theta'/c3 in place of theta', weights gamma2 and gamma3 in the inner product, and
T = d(1)/m_d(1) of d' = c3 m_d, m_d' = (g nu/c2) d, d(0) = 0.
"""

from math import sqrt, tan, tanh

from .rod import Rod

SERIES_BELOW = 1e-4
"""kappa^2 below which tanh(kappa)/kappa is summed as a series."""


def slaving_layer(rod: Rod) -> float:
    """T = tanh(kappa)/kappa of the layer in which a uniform rod slaves theta; 0 with rotational drag."""
    if rod.rotational_drag > 0 or rod.c2 == 0:
        return 0.0
    square = rod.g * rod.nu / rod.c2
    if abs(square) < SERIES_BELOW:
        return 1 - square / 3 + 2 * square**2 / 15
    kappa = sqrt(abs(square))
    return tanh(kappa) / kappa if square > 0 else tan(kappa) / kappa


def hermitian_tip(F: float, layer: float) -> tuple[float, float]:
    """(p, r) of the term p (a theta - b y) - r a y at u = 1 that makes the weak form of L that of (L + L+)/2.

    p = F/2 in k3/L^2 and r = (F^2/4) T in k3/L^3, for test functions (a, b) and the fields (y, theta);
    layer: T.
    """
    return F / 2, F**2 / 4 * layer
