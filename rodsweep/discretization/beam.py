"""One nonlinear rod on one mesh: strains, rates, energy and shape, for what steps in time.

The equations are `rodsweep.discretization.body_frame`'s, and so is the unknown z; here are the mesh, the
parameters, and the way from strains to a shape: theta(u) = int Pi, r(u) = int R(theta) (h1, h2).
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from ..arrays import Array
from ..model.rod import Rod
from .basis import differentiation, interpolation
from .body_frame import BeamParameters, Element, jacobians, rates
from .pencil import assemble
from .quadrature import gauss, gauss_lobatto

EXTRA_POINTS = 10
"""Gauss points beyond the nodes with which shapes are integrated: theta turns by a radian or two."""
TINY = 1e-30
"""Complex step of a velocity."""


@dataclass(frozen=True, eq=False)
class Mesh:
    """`elements` equal elements of order `order` on [0, 1], and the matrices of one of them."""

    elements: int
    order: int
    element: Element

    @property
    def nodes(self) -> int:
        """Nodes without the tip."""
        return self.elements * self.order

    @property
    def unknowns(self) -> int:
        return 3 * self.nodes

    @cached_property
    def positions(self) -> Array:
        """u of all nodes, the tip included, shape (nodes + 1,)."""
        return np.append(0.0, assemble(self.elements, self.order).positions())

    @cached_property
    def quadrature(self) -> Array:
        """Weights of all nodes, the tip included, shape (nodes + 1,)."""
        total = np.zeros(self.nodes + 1)
        for e in range(self.elements):
            total[e * self.order : (e + 1) * self.order + 1] += self.element.weights
        return total

    def evaluation(self, points: Array) -> Array:
        """Matrix from values at all nodes to values at `points` in [0, 1], shape (points, nodes + 1)."""
        return assemble(self.elements, self.order).evaluation(points)


@lru_cache(maxsize=64)
def mesh(elements: int, order: int) -> Mesh:
    """The mesh of `elements` equal elements of order `order`."""
    x, w = gauss_lobatto(order)
    D, weights = differentiation(x) * 2 * elements, w / (2 * elements)
    return Mesh(elements, order, Element(*map(np.ascontiguousarray, (D, D.T, -(D.T * weights) @ D, weights))))


@dataclass(frozen=True, eq=False)
class Beam:
    """One rod with finite k1, k2 and gamma3 > 0, its axial drag gamma1 in gamma2, on one mesh.

    z has shape (unknowns,) and the unit of sqrt(energy density), sqrt(k3)/L.
    """

    rod: Rod
    gamma1: float
    mesh: Mesh

    @cached_property
    def parameters(self) -> BeamParameters:
        """The parameters as the compiled functions take them."""
        r = self.rod
        return BeamParameters(*map(float, (r.F, r.nu, r.k1**0.5, r.k2**0.5, self.gamma1, r.gamma3)))

    @cached_property
    def stiffness_roots(self) -> Array:
        """Square roots of (k1, k2, k3), shape (3,)."""
        return np.array([self.parameters.root_k1, self.parameters.root_k2, 1.0])

    def rate(self, z: Array) -> Array:
        """dz/dt in 1/tau2 of one state or of many, shape (..., unknowns) as that of z."""
        out = np.empty(z.shape)
        size = self.mesh.unknowns
        rates(z.reshape(-1, size), out.reshape(-1, size), self.parameters, self.mesh.element)
        return out

    def jacobian(self, z: Array) -> Array:
        """d(dz/dt)/dz of one state or of many, shape (..., unknowns, unknowns) for z (..., unknowns)."""
        size = self.mesh.unknowns
        out = np.empty((*z.shape, size))
        jacobians(z.reshape(-1, size), out.reshape(-1, size, size), self.parameters, self.mesh.element)
        return out.swapaxes(-1, -2)

    def strains(self, z: Array) -> Array:
        """(h1, h2, Pi) at all nodes, the tip included, shape (3, ..., nodes + 1) for z (..., unknowns)."""
        E = np.zeros((3, *z.shape[:-1], self.mesh.nodes + 1), dtype=z.dtype)
        for a, (part, root) in enumerate(zip(np.split(z, 3, axis=-1), self.stiffness_roots, strict=True)):
            E[a, ..., :-1] = part / root
        E[0] += self.rod.nu
        return E

    def unknown(self, strains: Array) -> Array:
        """z of (h1, h2, Pi) at all nodes, shape (3, nodes + 1); the tip's values are not free."""
        deviation = strains[:, :-1] - np.array([[self.rod.nu], [0.0], [0.0]])
        return (deviation * self.stiffness_roots[:, None]).ravel()

    def energy(self, z: Array) -> Array:
        """U = 1/2 int k1 (h1 - 1)^2 + k2 h2^2 + Pi^2 in k3/L, shape (...)."""
        E = self.strains(z)
        E[0] -= 1.0
        return 0.5 * np.tensordot(self.stiffness_roots**2, E * E @ self.mesh.quadrature, 1)

    def shape(self, z: Array) -> Array:
        """(x, y, theta) at all nodes in L and rad, shape (3, ..., nodes + 1), the clamp at 0 along e_x."""
        return configuration(self.mesh, self.strains(z), np.zeros(3))

    def tip(self, z: Array) -> Array:
        """(x, y, theta) of the tip, shape (3, ...) for z of shape (..., unknowns)."""
        return self.shape(z)[..., -1]

    def tip_velocity(self, z: Array, direction: Array) -> Array:
        """d/dt of the tip's (x, y, theta) for dz/dt = direction, by complex step, shape (3,)."""
        velocity: Array = np.divide(self.tip(z + 1j * TINY * direction).imag, TINY)
        return velocity

    def least_stretch(self, z: Array) -> float:
        """min h1 over the nodes of all states; the model holds while it is positive."""
        least = min(0.0, float(z[..., : self.mesh.nodes].min()))
        return float(self.rod.nu + least / self.parameters.root_k1)


def configuration(grid: Mesh, strains: Array, clamp: Array) -> Array:
    """(x, y, theta) at all nodes from strains (h1, h2, Pi), both (3, ..., nodes + 1), and `clamp`, (3,)."""
    values, angles, integrals, ends = reconstruction(grid.order)
    m, p = grid.elements, grid.order
    state = np.empty_like(strains)
    start = np.broadcast_to(clamp.reshape(3, *(1,) * (strains.ndim - 1)), (3, *strains.shape[1:-1], 1))
    for e in range(m):
        here = slice(e * p, (e + 1) * p + 1)
        h1, h2, Pi = (strain[..., here] for strain in strains)
        theta = start[2] + Pi @ angles / m
        cos, sin = np.cos(theta), np.sin(theta)
        state[0][..., here] = start[0] + (cos * (h1 @ values) - sin * (h2 @ values)) @ integrals / m
        state[1][..., here] = start[1] + (sin * (h1 @ values) + cos * (h2 @ values)) @ integrals / m
        state[2][..., here] = start[2] + Pi @ ends / m
        start = state[..., here][..., -1:]
    return state


@lru_cache(maxsize=64)
def reconstruction(order: int) -> tuple[Array, Array, Array, Array]:
    """Matrices, to be applied from the right, on an element [0, 1] with Gauss points finer than its nodes.

    values: nodes to Gauss points; angles: integrals of nodal polynomials from 0 to the Gauss points; both
    (p + 1, m). integrals: integrals from 0 to the nodes of functions given at the Gauss points, (m, p + 1);
    ends: integrals of nodal polynomials from 0 to the nodes, (p + 1, p + 1).
    """
    x, g = gauss_lobatto(order)[0], gauss(order + EXTRA_POINTS)[0]
    return interpolation(x, g).T, primitive(x, g).T, primitive(g, x).T, primitive(x, x).T


def primitive(nodes: Array, ends: Array) -> Array:
    """Matrix from values at `nodes` to half the integral of their polynomial from -1 to each end.

    Shape (ends, nodes).
    """
    points, weights = gauss(len(nodes))
    return np.array(
        [(end + 1) / 4 * weights @ interpolation(nodes, -1 + (end + 1) * (points + 1) / 2) for end in ends]
    )
