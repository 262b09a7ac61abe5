"""The nonlinear rod in the plane in its mixed form: stresses and velocities in the body frame, on a mesh.

The balance of `rodsweep.model.balance` with both fields kept as unknowns. S is what the stress has beyond
that of the straight rod, (n1 + F, n2, m3), and V = (v1, v2, Omega3); W are the weights of the quadrature,
D is the derivative:

    W C dS/dt = -D^T W V + W ad_E V          at all nodes but the tip; the clamp V(0) = 0 is natural
    0         = W (D*_E Sigma - Gamma V)     at all nodes; Sigma = (-F, 0, 0) + S, and S(1) = 0 is essential

where E = (nu, 0, 0) + C S. With X = (n1 + F, n2, m3; v1, v2, Omega3) this is quadratic,

    M dX/dt = A X + B(X, X)/2,

and affine in F. No stiffness is divided by, so that c1 = c2 = gamma3 = 0 are ordinary values. M is singular:
what of X carries no time derivative is bound by the equations. On several elements the fields are continuous
and D = W^-1 sum_e W_e D_e. Summation by parts, W D + D^T W = diag(-1, 0, ..., 0, 1), and with it the energy
law hold to rounding on every mesh.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...arrays import Array
from ...model.balance import Material, Values, ad, coad
from ...model.rod import Rod
from ..elements.mesh import Mesh, mesh
from ..state_layout import COMPONENTS, StateLayout, plane_layout

MIRROR = np.array([1.0, -1.0, -1.0])
"""Signs of the components of a stress or a velocity under reflection in the straight rod's axis."""


@dataclass(frozen=True, eq=False)
class MixedForm:
    """One rod on one mesh; k1, k2 may be inf and gamma3 may be 0.

    X has the shape (..., unknowns): with N = mesh.nodes first the N values of n1 + F, of n2 (k3/L^2) and of
    m3 (k3/L) at the nodes but the tip, then the N + 1 values of v1, of v2 (L/tau2) and of Omega3 (1/tau2) at
    all nodes. It may be complex everywhere.
    """

    rod: Rod
    mesh: Mesh

    @cached_property
    def layout(self) -> StateLayout:
        """Positions of the fields in X; every component of V is an unknown."""
        return plane_layout(self.mesh.nodes, tuple(range(COMPONENTS)))

    @property
    def stresses(self) -> int:
        """Number of unknown stresses."""
        return plane_layout(self.mesh.nodes).unknowns

    @property
    def unknowns(self) -> int:
        return self.layout.unknowns

    @cached_property
    def material(self) -> Material:
        """C, Gamma and the force."""
        return self.rod.material

    @cached_property
    def straight(self) -> Array:
        """E of the straight rod, (nu, 0, 0), shape (3,)."""
        return np.array([self.rod.nu, 0.0, 0.0])

    @cached_property
    def parity(self) -> Array:
        """The diagonal of R, which maps motions to their mirror images, motions too; +-1, (unknowns,)."""
        signs = np.repeat(MIRROR[:, None], self.mesh.nodes + 1, axis=1)
        return self.layout.state(signs, signs)

    @cached_property
    def M(self) -> Array:
        """The diagonal of M, (W C, 0), shape (unknowns,)."""
        weighted = np.outer(self.material.compliance, self.mesh.quadrature)
        return self.layout.state(weighted, np.zeros(weighted.shape))

    @cached_property
    def A(self) -> Array:
        """A, shape (unknowns, unknowns)."""
        N, stresses, velocities = self.mesh.nodes, slice(self.stresses), slice(self.stresses, None)
        WD, each = -self.mesh.matrices.weak.T, np.eye(COMPONENTS)
        A = self._coupling()
        A[stresses, velocities] -= np.kron(each, WD.T[:N])
        A[velocities, stresses] += np.kron(each, WD[:, :N])
        A[velocities, velocities] -= np.diag(np.kron(self.material.drag, self.mesh.quadrature))
        return A

    def times_A_F(self, X: Values) -> Values:
        """dA/dF X, shape (..., unknowns), the same for every F: E and Sigma at rest are affine."""
        (S, V), W = self.fields(X), self.mesh.quadrature
        Sigma = -self._along(self.material.straight, S)
        E = self.rod.c1 * Sigma
        return self.unknown(W * ad(E, V), W * (coad(E, S) + coad(self._strain(S), Sigma)))

    @cached_property
    def tip_y(self) -> Array:
        """The row that gives the tip's y in L to first order in X, int nu (1 - u) m3 + c2 n2, (unknowns,)."""
        u, W = self.mesh.positions[:-1], self.mesh.quadrature[:-1]
        return self.layout.row({"n2": self.rod.c2 * W, "m3": self.rod.nu * (1 - u) * W})

    def fields(self, X: Values) -> tuple[Values, Values]:
        """(S, V) at all nodes, the tip included, each of shape (3, ..., nodes + 1)."""
        return self.layout.stresses(X), self.layout.velocities(X)

    def unknown(self, S: Values, V: Values) -> Values:
        """X of (S, V) at all nodes, each (3, ..., nodes + 1); what S has at the tip does not count."""
        return self.layout.state(S, V)

    def bilinear(self, X: Values, Y: Values) -> Values:
        """B(X, Y) = B(Y, X), shape (..., unknowns)."""
        (S, U), (T, V) = self.fields(X), self.fields(Y)
        CS, CT, W = self._strain(S), self._strain(T), self.mesh.quadrature
        return self.unknown(W * (ad(CS, V) + ad(CT, U)), W * (coad(CS, T) + coad(CT, S)))

    def _strain(self, S: Values) -> Values:
        """C S, the strain beyond that of the straight rod."""
        return self._along(self.material.compliance, S) * S

    @staticmethod
    def _along(constant: Values, field: Values) -> Values:
        """One number a component, to be combined with a field."""
        return constant.reshape(-1, *(1,) * (field.ndim - 1))

    def _coupling(self) -> Array:
        """The matrix of W (ad_E v; ad*_E s + ad*_{C s} Sigma) in (s; v) about the straight rod."""
        each, C = np.eye(COMPONENTS), np.diag(self.material.compliance)
        E, Sigma = self.straight[:, None], self.material.tip_stress[:, None]
        N, W = self.mesh.nodes, self.mesh.quadrature[:-1]
        s = np.arange(self.stresses).reshape(COMPONENTS, N)
        v = np.arange(self.stresses, self.unknowns).reshape(COMPONENTS, N + 1)[:, :N]
        matrix = np.zeros((self.unknowns, self.unknowns))
        # At the tip nothing is left of it: s = 0 there, and E only enters an equation that is not asked.
        matrix[s[:, None], v[None]] = W * ad(E, each)[..., None]
        matrix[v[:, None], s[None]] = W * (coad(E, each) + coad(C, Sigma))[..., None]
        return matrix


def mixed_form(rod: Rod, elements: int, order: int) -> MixedForm:
    """The mixed form on `elements` equal elements of order `order`."""
    return MixedForm(rod, mesh(elements, order))
