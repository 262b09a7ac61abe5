"""The adjoint of the transverse operator L and its Hermitian part: equations of L, different end conditions.

Appendix B: in the Gamma inner product (psi, xi) = int psi_y* y + gamma3 psi_theta* theta, the adjoint
of L is operationally L, with psi(0) = 0 and (K D psi + ad*_psi Sigma0)(1) = 0. Since Sigma0 = (-F, 0, 0)
has ad*_psi Sigma0 = (0, -F Theta+, F Y+), the transverse block reads as follows. The shear force s+ is kept
as an unknown, so that no stiffness appears.

    w y+          = s+' - F theta+'
    w gamma3 th+  = theta+'' + g s+
    0             = y+' - nu theta+ - c2 s+
    y+(0) = theta+(0) = 0;   s+(1) = F theta+(1),   theta+'(1) = -F y+(1).

A left null vector (a, b, c) of the weak form's pencil holds this mode: a = y+, b = theta+, and
c = -(s+ - F theta+). Since (psi, L xi) = (L+ psi, xi), the eigenvalue of psi is w*. For complex w the
adjoint mode is the conjugate of the left vector.

The end conditions s(1) = e F theta(1), theta'(1) = -e F y(1) give L for e = 0 and the adjoint for e = 1.
They give the Hermitian part (L + L+)/2 for e = 1/2, if theta has a dynamics (gamma3 > 0) or no freedom beside
y (c2 = 0): the form (xi, L xi) contains no end term that depends on e, so e = 1/2 is its natural condition.

The largest Re (xi, L xi)/(xi, xi) over the domain of L is a supremum, not a maximum: the maximiser satisfies
the end conditions with e = 1/2, not e = 0. Fields of the domain come arbitrarily close (the domain is dense
in the form domain). Polynomials with s(1) = theta'(1) = 0 approach the supremum only like 1/n^2;
polynomials that satisfy the clamp alone approach it exponentially.

For gamma3 = 0 < c2, theta follows y instantaneously, with different end conditions in L and in L+. The
difference d = theta - theta+ solves c2 d'' = g nu d, and adds a term to the Hermitian part,

    s(1) = F theta(1)/2 - (F^2/4) T y(1),   T = tanh(kappa)/kappa,   kappa^2 = g nu/c2.

This layer of thickness 1/kappa is included in closed form, so no mesh has to resolve it. The numerical
abscissa jumps down by a finite amount when gamma3 reaches 0 at c2 > 0, because the initial theta is free for
every gamma3 > 0.

The statements hold for c2(u), c3(u), nu(u), gamma2(u) and gamma3(u), since the force is constant along
the arm. Then m = theta'/c3 replaces theta', the inner product has the weights gamma2 and gamma3, and
T = d(1)/m_d(1) with d' = c3 m_d, m_d' = (g nu/c2) d, d(0) = 0.
"""

from math import sqrt, tan, tanh

from .rod import Rod

SERIES_BELOW = 1e-4
"""abs(kappa^2) below which `tip_layer_factor` sums tanh(kappa)/kappa as a power series; the quotient loses
digits."""


def tip_layer_factor(rod: Rod) -> float:
    """T = tanh(kappa)/kappa of the angle's boundary layer at the tip, for a uniform rod with gamma3 = 0 < c2.

    kappa^2 = g nu/c2. T = 0 for all other rods, which have no such layer.
    """
    if rod.rotational_drag > 0 or rod.c2 == 0:
        return 0.0
    square = rod.g * rod.nu / rod.c2
    # For imaginary kappa tanh becomes tan. The series holds for either sign of kappa^2.
    if abs(square) < SERIES_BELOW:
        return 1 - square / 3 + 2 * square**2 / 15
    kappa = sqrt(abs(square))
    return tanh(kappa) / kappa if square > 0 else tan(kappa) / kappa


def hermitian_tip_coefficients(F: float, layer: float) -> tuple[float, float]:
    """Coefficients (p, r) of the tip term that turns the weak form of L into the weak form of (L + L+)/2.

    The term is p (a theta - b y) - r a y at u = 1, with test functions (a, b) and fields (y, theta).
    p = F/2 in k3/L^2; r = (F^2/4) T in k3/L^3; `layer` is the T of `tip_layer_factor`.
    """
    return F / 2, F**2 / 4 * layer
