"""The nonlinear balance at points of a uniform rod, as the paper writes it, in the plane and in space: the
reference of the compiled functions, with the notation and shapes of `rodsweep.model.balance`."""

import numpy as np

from rodsweep.model.balance import BalanceCoefficients, axial_vector, coad

PLANE_COMPONENTS = [0, 1, 5]
"""Indices of the three components of se(2) among the six components of se(3)."""


def embed_in_se3(plane):
    """Element of se(3) or its dual space, (6, ...), from an element of se(2) or its dual space, (3, ...)."""
    space = np.zeros((6, *plane.shape[1:]), plane.dtype)
    space[PLANE_COMPONENTS] = plane
    return space


def material_in_space(rod, twist_stiffness, twist_drag):
    """Material of a uniform rod in space. twist_stiffness: in k3. twist_drag: in gamma2 L^2."""
    c1, c2, bending = rod.balance_coefficients.compliance
    axial, normal, rotational = rod.balance_coefficients.drag
    compliance = np.array([c1, c2, c2, 1 / twist_stiffness, bending, bending])
    drag = np.array([axial, normal, normal, twist_drag, rotational, rotational])
    return BalanceCoefficients(compliance, drag, rod.F, axial_vector(rod.nu, 6))


def unloaded_strain(material):
    """Ebar, the deformation of the rod without load: (1, 0, 0) or (1, 0, 0; 0, 0, 0)."""
    return axial_vector(1.0, len(material.drag))


def strain(material, Sigma):
    """Deformation E = Ebar + C Sigma under the stress Sigma, (3, ...) or (6, ...)."""
    return _diagonal(unloaded_strain(material), Sigma) + _diagonal(material.compliance, Sigma) * Sigma


def velocity(material, Sigma, dSigma):
    """Velocity V = Gamma^-1 (dSigma + ad*_E Sigma), (3, ...) or (6, ...). dSigma: derivative of Sigma along
    the rod."""
    return (dSigma + coad(strain(material, Sigma), Sigma)) / _diagonal(material.drag, Sigma)


def energy_per_length(material, Sigma):
    """Elastic energy per length, Sigma C Sigma/2, in k3/L^2, (...)."""
    return (_diagonal(material.compliance, Sigma) * Sigma * Sigma).sum(axis=0) / 2


def dissipated_power_per_length(material, V):
    """Dissipated power per length, V Gamma V, in k3/(L^2 tau2), (...)."""
    return (_diagonal(material.drag, V) * V * V).sum(axis=0)


def _diagonal(diagonal, field):
    """The diagonal of C or Gamma, (d,) or (d, nodes), reshaped to broadcast against a field, (d, ...,
    nodes)."""
    return diagonal.reshape(len(diagonal), *(1,) * (field.ndim - diagonal.ndim), *diagonal.shape[1:])
