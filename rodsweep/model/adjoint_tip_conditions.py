"""The adjoint L+ of the transverse operator L, and the Hermitian part (L + L+)/2: end conditions at the tip.

Appendix B: in the Gamma inner product (psi, xi) = int psi_y* y + gamma3 psi_theta* theta, with xi = (y,
theta), L+ has the equations of L, with psi(0) = 0 and (K D psi + ad*_psi Sigma0)(1) = 0. Since Sigma0 = (-F,
0, 0) has ad*_psi Sigma0 = (0, -F Theta+, F Y+), the transverse block reads as follows. The shear force s+ is
an additional unknown, so that no stiffness appears; g = nu + F c2.

    w y+          = s+' - F theta+'
    w gamma3 th+  = theta+'' + g s+
    0             = y+' - nu theta+ - c2 s+
    y+(0) = theta+(0) = 0;   s+(1) = F theta+(1),   theta+'(1) = -F y+(1).

A left null vector (a, b, c) of the pencil of the weak form contains this mode: a = y+, b = theta+ and c = F
theta+ - s+. Since (psi, L xi) = (L+ psi, xi), L+ has the eigenvalue w*, the conjugate of the eigenvalue w of
L. For complex w the adjoint mode is the conjugate of the left vector.

The end conditions s(1) = e F theta(1), theta'(1) = -e F y(1) give L for e = 0 and the adjoint for e = 1. For
e = 1/2 the end conditions give the Hermitian part (L + L+)/2 if gamma3 > 0 (theta has a time derivative) or
c2 = 0 (y determines theta): Re (xi, L xi) contains no end term that depends on e, so e = 1/2 is the natural
condition of this form.

The largest Re (xi, L xi)/(xi, xi) over the domain of L is a supremum, not a maximum: the maximiser satisfies
the end conditions with e = 1/2, not e = 0, and is the limit of fields in the domain (which is dense in the
form domain). Polynomials with s(1) = theta'(1) = 0 approach the supremum only like 1/n^2; polynomials that
satisfy only the clamp conditions approach the supremum exponentially.

For gamma3 = 0 < c2, theta follows y instantaneously; its end conditions differ between L and L+. The
difference d = theta - theta+ solves c2 d'' = g nu d, and adds a term to the Hermitian part,

    s(1) = F theta(1)/2 - (F^2/4) T y(1),   T = tanh(kappa)/kappa,   kappa^2 = g nu/c2.

d is a boundary layer of thickness 1/kappa. T includes the layer in closed form, so no mesh must resolve the
layer. The numerical abscissa jumps down by a finite amount when gamma3 reaches 0 at c2 > 0, because the
initial theta is free for every gamma3 > 0.

All statements also hold for coefficients c2(u), c3(u), nu(u), gamma2(u) and gamma3(u) that vary along an arm,
since the force is constant. Then m = theta'/c3 replaces theta', the inner product has the weights gamma2 and
gamma3, and T = d(1)/m_d(1) with d' = c3 m_d, m_d' = (g nu/c2) d, d(0) = 0.
"""

from math import sqrt, tan, tanh

from .rod import Rod

TANH_SERIES_BELOW = 1e-4
"""If abs(kappa^2) is below this, `tip_layer_factor` computes tanh(kappa)/kappa by a power series, because the
quotient loses digits."""


def tip_layer_factor(rod: Rod) -> float:
    """T = tanh(kappa)/kappa of the boundary layer of theta at the tip of a uniform rod with gamma3 = 0 < c2.
    kappa^2 = g nu/c2, g = nu + F c2. T = 0 for all other rods, which have no such layer."""
    # With rotational drag theta has its own time derivative, and without shear it is no unknown of its own.
    if rod.base_rotational_drag > 0 or rod.c2 == 0:
        return 0.0
    squared_kappa = rod.g * rod.nu / rod.c2
    # For imaginary kappa tanh becomes tan. The series holds for either sign of kappa^2.
    if abs(squared_kappa) < TANH_SERIES_BELOW:
        return 1 - squared_kappa / 3 + 2 * squared_kappa**2 / 15
    kappa = sqrt(abs(squared_kappa))
    # Both quotients are even in kappa, so the sign of the root does not matter.
    return tanh(kappa) / kappa if squared_kappa > 0 else tan(kappa) / kappa


def hermitian_tip_coefficients(F: float, layer_factor: float) -> tuple[float, float]:
    """Returns (p, r), the factors in the tip term that (L + L+)/2 has in addition to L in weak form. The term
    is p (a theta - b y) - r a y at u = 1, with test functions (a, b) and fields (y, theta). p = F/2 in
    k3/L^2; r = (F^2/4) T in k3/L^3. layer_factor: T as returned by `tip_layer_factor`."""
    return F / 2, F**2 / 4 * layer_factor
