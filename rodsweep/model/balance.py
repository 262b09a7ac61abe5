"""The nonlinear balance of the rod in its body frame, on se(2) and se(3), at one point, without a mesh.

A deformation E = (h; kappa) and a velocity V = (v; Omega) are elements of the Lie algebra; a stress
Sigma = (n; m) is an element of the dual space. Components are (h1, h2, kappa3), (v1, v2, Omega3) and
(n1, n2, m3) in the plane, all six in space. With ' = d/du the second formulation of Sec. III reads

    dE/dt = D_E V = V' + ad_E V,                        ad_E V      = (kappa x v + h x Omega; kappa x Omega)
    Gamma V = D*_E Sigma = Sigma' + ad*_E Sigma,        ad*_E Sigma = (kappa x n; kappa x m + h x n)
    E = Ebar + C Sigma,     V(0) = 0,     Sigma(1) = (-F, 0, 0; 0, 0, 0)

where <ad*_E Sigma, V> = -<Sigma, ad_E V>. The equations times Sigma and V, integrated, give the energy
law dU/dt = Sigma(1) V(1) - <Gamma V, V> with U = <Sigma, C Sigma>/2 and Sigma(1) V(1) = -F v1(1).

Arrays have the shape (3, ...) in the plane and (6, ...) in space. A compliance may be 0, since no formula
divides by a compliance. `rodsweep.discretization.straight.mixed_form` uses these functions;
`rodsweep.discretization.stress.balance` uses `algebra` and `Material`.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .algebra import ALGEBRAS

Values = NDArray[Any]
"""Real array, or complex array for a derivative by complex step."""

IN_SPACE = [0, 1, 5]
"""Indices of the plane's components among the six components in space."""


def ad(E: Values, V: Values) -> Values:
    """ad_E V of two elements of se(2) or se(3), (3, ...) or (6, ...)."""
    out = np.zeros(np.broadcast(E, V).shape, np.result_type(E, V))
    for a, b, c, sign in ALGEBRAS[len(E)].terms:
        # With an output argument that is a view also for single elements, which out[a] alone is not.
        (np.add if sign > 0 else np.subtract)(out[a], E[b] * V[c], out[a, ...])
    return out


def coad(E: Values, Sigma: Values) -> Values:
    """ad*_E Sigma of an element E of the algebra and an element Sigma of the dual, (3, ...) or (6, ...)."""
    out = np.zeros(np.broadcast(E, Sigma).shape, np.result_type(E, Sigma))
    for a, b, c, sign in ALGEBRAS[len(E)].terms:
        # Minus the transpose of `ad`: work of the stress is invariant under rigid motions.
        (np.subtract if sign > 0 else np.add)(out[c], E[b] * Sigma[a], out[c, ...])
    return out


def elastic_force(E: Values, Sigma: Values, dSigma: Values) -> Values:
    """Force per length D*_E Sigma from Sigma and dSigma = Sigma', in k3/L^3 (moments: k3/L^2)."""
    return dSigma + coad(E, Sigma)


class Material(NamedTuple):
    """Diagonals of C and Gamma, the tip force F, and `rest`, the deformation E of the straight loaded rod.

    Shapes are (3,) or (6,) for a uniform rod; (3, nodes + 1) for other rods.
    """

    compliance: Values
    drag: Values
    F: float
    rest: Values

    @property
    def straight(self) -> Values:
        """Ebar, the deformation of the undeformed rod: (1, 0, 0) or (1, 0, 0; 0, 0, 0)."""
        return first_component(1.0, len(self.drag))

    @property
    def tip_stress(self) -> Values:
        """Sigma(1), the stress at the tip: (-F, 0, ...), (3,) or (6,)."""
        return first_component(-self.F, len(self.drag))

    def strain(self, Sigma: Values) -> Values:
        """Deformation E = Ebar + C Sigma under the stress Sigma."""
        return _along(self.straight, Sigma) + _along(self.compliance, Sigma) * Sigma

    def velocity(self, Sigma: Values, dSigma: Values) -> Values:
        """V = Gamma^-1 D*_E Sigma, for nonzero drags; dSigma is the derivative of Sigma along the rod."""
        return elastic_force(self.strain(Sigma), Sigma, dSigma) / _along(self.drag, Sigma)

    def energy(self, Sigma: Values) -> Values:
        """The density of U, Sigma C Sigma/2, in k3/L^2."""
        return (_along(self.compliance, Sigma) * Sigma * Sigma).sum(axis=0) / 2

    def dissipation(self, V: Values) -> Values:
        """The density of the power lost to the fluid, V Gamma V, in k3/(L^2 tau2)."""
        return (_along(self.drag, V) * V * V).sum(axis=0)


def in_space(plane: Values) -> Values:
    """Embedding of an element of se(2) or its dual, (3, ...), in se(3) or its dual, (6, ...)."""
    space = np.zeros((6, *plane.shape[1:]), plane.dtype)
    space[IN_SPACE] = plane
    return space


def first_component(number: float, size: int) -> Values:
    """The vector (number, 0, 0, ...), (size,)."""
    element = np.zeros(size)
    element[0] = number
    return element


def _along(diagonal: Values, field: Values) -> Values:
    """Reshapes a diagonal, (d,) or (d, nodes), to broadcast against a field, (d, ..., nodes)."""
    return diagonal.reshape(len(diagonal), *(1,) * (field.ndim - diagonal.ndim), *diagonal.shape[1:])
