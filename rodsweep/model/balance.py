"""The nonlinear balance of the rod in the body frame, on se(2) and se(3), at points, without a mesh.

A deformation E = (h; kappa) and a velocity V = (v; Omega) are elements of the Lie algebra; a stress Sigma =
(n; m) is an element of the dual space. Components are (h1, h2, kappa3), (v1, v2, Omega3) and (n1, n2, m3) in
the plane, all six in space. With ' = d/du the second formulation of Sec. III reads

    dE/dt = D_E V = V' + ad_E V,                        ad_E V      = (kappa x v + h x Omega; kappa x Omega)
    Gamma V = D*_E Sigma = Sigma' + ad*_E Sigma,        ad*_E Sigma = (kappa x n; kappa x m + h x n)
    E = Ebar + C Sigma,     V(0) = 0,     Sigma(1) = (-F, 0, 0; 0, 0, 0)

where <ad*_E Sigma, V> = -<Sigma, ad_E V>. The products of the equations with Sigma and V, integrated over the
rod, give the energy law dU/dt = Sigma(1) V(1) - <Gamma V, V> with U = <Sigma, C Sigma>/2 and Sigma(1) V(1) =
-F v1(1).

Arrays have the shape (3, ...) in the plane and (6, ...) in space. A compliance may be 0, since no formula
divides by a compliance. `rodsweep.discretization.straight.mixed_form` uses these functions;
`rodsweep.discretization.stress.balance` uses `lie_algebra` and `BalanceCoefficients`.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .lie_algebra import ALGEBRAS

Values = NDArray[Any]
"""Components of a deformation, velocity or stress: real, or complex for complex-step derivatives."""


def ad(E: Values, V: Values) -> Values:
    """ad_E V of two elements E and V of se(2) or se(3), (3, ...) or (6, ...) each; the shapes broadcast."""
    out = np.zeros(np.broadcast(E, V).shape, np.result_type(E, V))
    for a, b, c, sign in ALGEBRAS[len(E)].structure_constants:
        # out[a, ...] is a view also for scalar components; out[a] would be a copy.
        add = np.add if sign > 0 else np.subtract
        add(out[a], E[b] * V[c], out[a, ...])
    return out


def coad(E: Values, Sigma: Values) -> Values:
    """ad*_E Sigma of a deformation E and a stress Sigma, (3, ...) each in the plane or (6, ...) in space."""
    # The result type keeps complex steps complex even if only one argument is.
    out = np.zeros(np.broadcast(E, Sigma).shape, np.result_type(E, Sigma))
    for a, b, c, sign in ALGEBRAS[len(E)].structure_constants:
        # ad* is minus the transpose of `ad`.
        subtract = np.subtract if sign > 0 else np.add
        subtract(out[c], E[b] * Sigma[a], out[c, ...])
    return out


class BalanceCoefficients(NamedTuple):
    """Coefficients of the nonlinear balance of one rod under its tip force F. compliance: diagonal of C.
    drag: diagonal of Gamma. straight_state_strain: deformation E of the straight rod under the force. Each
    array has the shape (3,) or (6,) for a uniform rod, and (3, nodes + 1) for other rods."""

    compliance: Values
    drag: Values
    F: float
    straight_state_strain: Values

    @property
    def tip_stress(self) -> Values:
        """Sigma(1), the stress at the tip: (-F, 0, ...), (3,) or (6,)."""
        return axial_vector(-self.F, len(self.drag))


def axial_vector(value: float, size: int) -> Values:
    """The vector (value, 0, ..., 0) of length `size`."""
    vector = np.zeros(size)
    vector[0] = value
    return vector
