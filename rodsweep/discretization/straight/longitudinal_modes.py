"""Longitudinal eigenvalues of an arm that varies along its length or has a nonlinear law.

In the linearised rod longitudinal and transverse modes are decoupled (Sec. VI). With the axial drag
gamma1(u), the stretch energy W of the law and the tangent stiffness K(u) = k1(u) W''(nu(u)), a displacement x
obeys

    gamma1 w x = (K x')',   x(0) = 0,   K x'(1) = 0.

This is a Sturm-Liouville problem: all w are real, negative and simple. The unknowns are the strains e = x' at
the Gauss points of spectral elements, each multiplied by the square root of K and of the Gauss weight. The
elements end where the material jumps. The matrix A maps these unknowns to the displacements x = int e,
multiplied by the square root of gamma1 and of the quadrature weight. Then w = -1/sigma^2 for the singular
values sigma of A. All integrals are sums of positive numbers, so the largest singular values are accurate to
nearly all digits for every profile. By the Rayleigh quotient the n-th computed eigenvalue is not larger than
the n-th exact eigenvalue. Therefore no eigenvalue is missing among the eigenvalues on which two orders agree.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.polynomial import legendre

from ...arrays import Array
from ...model.rod import Rod
from ..elements.elements import Elements
from ..elements.quadrature import gauss_legendre_rule
from .arm_resolution import arm_elements


@dataclass(frozen=True, slots=True, kw_only=True)
class LongitudinalModeSettings:
    """Settings for the mesh of longitudinal modes, and for error estimates from two orders."""

    first_mesh_accuracy: float = 1e-12
    """Relative accuracy of the eigenvalues for which the first mesh is chosen."""
    order_increase: int = 4
    """Increase of the elements' order in each refinement; eigenvalues of successive orders are compared."""
    max_order: int = 60
    """Maximum order of an element; the error at this order is returned even if it is large."""
    converged_relative_difference: float = 1e-13
    """The order is no longer increased if the relative difference of two orders' eigenvalues is at most
    this."""
    relative_rounding_error: float = 5e-14
    """Relative rounding error of an eigenvalue; the error estimate is a difference of orders plus this."""
    extra_point_count: int = 6
    """Number of quadrature points per element for displacements, minus the number for strains."""


LONGITUDINAL_MODE_SETTINGS = LongitudinalModeSettings()


def longitudinal_eigenvalues_and_errors(rod: Rod, mode_count: int) -> tuple[Array, Array]:
    """Returns (w, relative errors) of the leading longitudinal eigenvalues w, in 1/tau2, (modes,) each.
    Raises ValueError for an inextensible rod."""
    settings = LONGITUDINAL_MODE_SETTINGS
    if not rod.c1 > 0:
        raise ValueError("an inextensible rod (k1 = inf) has no longitudinal modes")
    mesh = arm_elements(rod, np.pi * mode_count, settings.first_mesh_accuracy)
    # At least one more unknown than modes, rounded up to whole elements.
    order = max(mesh.order, -(-(mode_count + 1) // mesh.element_count))
    eigenvalues = _leading_eigenvalues(rod, mesh, order, mode_count)
    while True:
        order += settings.order_increase
        # No a-priori bound of the error holds for every profile, so the error is estimated from a second
        # order.
        finer_eigenvalues = _leading_eigenvalues(rod, mesh, order, mode_count)
        error = np.abs(finer_eigenvalues / eigenvalues - 1)
        if error.max() <= settings.converged_relative_difference or order >= settings.max_order:
            return finer_eigenvalues, error + settings.relative_rounding_error
        eigenvalues = finer_eigenvalues


def _leading_eigenvalues(rod: Rod, mesh: Elements, order: int, mode_count: int) -> Array:
    """The leading eigenvalues w, (modes,), from elements with `order` strains each."""
    singular_values = np.linalg.svd(
        _displacement_matrix(rod, np.asarray(mesh.edges), order), compute_uv=False
    )
    eigenvalues: Array = -1 / singular_values[:mode_count] ** 2
    return eigenvalues


def _displacement_matrix(rod: Rod, edges: Array, order: int) -> Array:
    """The matrix A of the module docstring, (elements (order + extra_point_count), elements order). edges:
    edges of the elements, (elements + 1,). order: number of strains per element."""
    strain_points, strain_weights = gauss_legendre_rule(order)
    points, weights = gauss_legendre_rule(order + LONGITUDINAL_MODE_SETTINGS.extra_point_count)
    half_lengths = np.diff(edges)[:, None] / 2
    midpoints = (edges[1:] + edges[:-1])[:, None] / 2
    sections_at_strains, sections_at_points = (
        rod.cross_sections_at((midpoints + half_lengths * x).ravel()) for x in (strain_points, points)
    )
    tangent = (
        rod.material.constitutive_law.stiffness(sections_at_strains.nu) / sections_at_strains.compliance[0]
    )
    strain_scale = np.sqrt(tangent * (half_lengths * strain_weights).ravel())
    drag_scale = np.sqrt(sections_at_points.drag[0] * (half_lengths * weights).ravel())
    element_count = len(half_lengths)
    elements_before = np.tril(np.ones((element_count, element_count)), -1)[:, None, :, None] * (
        half_lengths * strain_weights
    )
    integrals = np.broadcast_to(elements_before, (element_count, len(points), element_count, order)).copy()
    diagonal = np.arange(element_count)
    # Within the element of the point, the integral ends at the point, so Gauss weights of the full element do
    # not apply.
    to_points = legendre.legval(points, _legendre_coefficients_of_lagrange_integrals(order)).T
    integrals[diagonal, :, diagonal, :] = half_lengths[:, :, None] * to_points
    matrix: Array = drag_scale[:, None] * integrals.reshape(len(drag_scale), len(strain_scale)) / strain_scale
    return matrix


@cache
def _legendre_coefficients_of_lagrange_integrals(order: int) -> Array:
    """Legendre coefficients of the integrals from -1 of the Lagrange polynomials through the Gauss points,
    (order + 1, order)."""
    nodes, weights = gauss_legendre_rule(order)
    coefficients: Array = legendre.legvander(nodes, order - 1).T * weights * (np.arange(order)[:, None] + 0.5)
    return legendre.legint(coefficients, lbnd=-1)


def longitudinal_eigenvalues(k1: float, gamma1: float, mode_count: int) -> Array:
    """Longitudinal eigenvalues -(k1/gamma1) (pi (n - 1/2))^2, n = 1..mode_count, in 1/tau2, (n,). Raises
    ValueError for an inextensible rod (k1 = inf), which has no longitudinal motion."""
    if np.isinf(k1):
        raise ValueError("an inextensible rod (k1 = inf) has no longitudinal modes")
    n = np.arange(1, mode_count + 1, dtype=np.float64)
    return -(k1 / gamma1) * (np.pi * (n - 0.5)) ** 2
