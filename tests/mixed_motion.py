"""Motion of the rod in its mixed form: rate, Jacobian, energy and reaction, built from the form's parts."""

import numpy as np
from pointwise_balance import dissipated_power_per_length, energy_per_length

from rodsweep.discretization.elements.mesh import uniform_mesh
from rodsweep.discretization.straight.mixed_form import MixedForm
from rodsweep.discretization.straight.straight_matrices import StraightMatrices
from rodsweep.model.balance import ad


def mixed_form(rod, elements, order):
    """The mixed form on `elements` equal elements of order `order`."""
    return MixedForm(rod, uniform_mesh(elements, order))


def whole_A(form):
    """The matrix A of all components, (unknowns, unknowns)."""
    return StraightMatrices(form, (0, 1, 2)).A.toarray()


def along(constant, field):
    """One number a component, to be combined with a field (3, ..., nodes + 1)."""
    return constant.reshape(-1, *(1,) * (field.ndim - 1))


def rate(form, X):
    """M dX/dt = A X + B(X, X)/2, shape (..., unknowns)."""
    return X @ whole_A(form).T + form.bilinear_map(X, X) / 2


def jacobian(form, X):
    """A + B(X, .) of one X, shape (unknowns, unknowns)."""
    return whole_A(form) + form.bilinear_map(X[None], np.eye(form.unknown_count)).T


def reaction(form, X):
    """r = -D^T W V + W ad_E V at the tip, shape (3, ...): -V(1) in the limit of fine meshes.

    F r1 is the power of the force: dU/dt = F r1 - <Gamma V, V> holds to rounding on every mesh.
    """
    _, V = form.stresses_and_velocities(X)
    WD = -form.mesh.node_matrices.weak_derivative_matrix.T
    return (
        form.mesh.quadrature_weights[-1]
        * ad(along(form.rod.balance_coefficients.straight_state_strain, V), V)[..., -1]
        - V @ WD[:, -1]
    )


def energy(form, X):
    """U = 1/2 int Sigma C Sigma in k3/L, shape (...)."""
    S, _ = form.stresses_and_velocities(X)
    return (
        energy_per_length(
            form.rod.balance_coefficients, S + along(form.rod.balance_coefficients.tip_stress, S)
        )
        @ form.mesh.quadrature_weights
    )


def dissipation(form, X):
    """<Gamma V, V>, the power lost to the fluid in k3/(L tau2), shape (...)."""
    return (
        dissipated_power_per_length(form.rod.balance_coefficients, form.stresses_and_velocities(X)[1])
        @ form.mesh.quadrature_weights
    )
