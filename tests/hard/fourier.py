"""Cycles by another method: Fourier collocation in time of the mixed form, solved densely.

Half a period is enough, X(t + T/2) = R X(t): what R keeps has even harmonics, what it reverses odd ones.
Nothing of the orbit solver is used but a first guess.
"""

import mixed_motion as mixed
import numpy as np

from rodsweep.discretization.element_strains import write_element_strains
from rodsweep.discretization.elements.mesh import shape_from_strains
from rodsweep.discretization.elements.trigonometric import fourier_coefficients, series_maxima
from rodsweep.discretization.plane_equations import write_balance
from rodsweep.discretization.state_layout import plane_layout
from rodsweep.discretization.straight.mixed_form import MixedForm

MOST_STEPS, SOLVED = 12, 1e-11


def half_period_derivatives(m):
    """By the phase at m phases over half a period: of even harmonics and of odd ones, (m, m) each."""
    shift = np.arange(2 * m)[:, None] - np.arange(2 * m)
    with np.errstate(divide="ignore"):
        D = 0.5 * (-1.0) ** shift / np.tan(np.pi * shift / (2 * m))
    np.fill_diagonal(D, 0)
    return D[:m, :m] + D[:m, m:], D[:m, :m] - D[:m, m:]


def guess_at(orbit, m):
    """X at m equidistant phases over half the period of a symmetric orbit, (m, unknowns)."""
    form, V = orbit.form, np.empty((m, 3, orbit.form.mesh.node_count + 1))
    states, reaction = orbit.states_at_time_fractions(np.arange(m) / m), np.empty(V.shape[1:])
    for x, velocities in zip(states, V, strict=True):
        write_balance(x, velocities, reaction, form.nodal_rod, form.mesh.node_matrices)
    mixed = MixedForm(form.rod, form.mesh)
    return mixed.layout.state(form.stresses(states), V.swapaxes(0, 1))


def solved_cycle(form, X, frequency):
    """(X, frequency) of the cycle near a guess; the tip is at rest in the first phase, to first order."""
    m, unknowns = X.shape
    stresses = slice(plane_layout(form.mesh.node_count).unknown_count)
    even, odd = half_period_derivatives(m)
    kept, each, r = form.reflection_signs > 0, np.arange(m), np.arange(unknowns)
    D = np.where(kept[:, None, None], even, odd)
    for _ in range(MOST_STEPS):
        dX = np.einsum("rij,jr->ir", D, X)
        J = np.zeros((m * unknowns + 1,) * 2)
        blocks = J[:-1, :-1].reshape(m, unknowns, m, unknowns)
        blocks[:, r, :, r] = frequency * form.M[:, None, None] * D
        blocks[each, :, each, :] -= np.array([mixed.jacobian(form, x) for x in X])
        J[:-1, -1] = (form.M * dX).ravel()
        J[-1, :-1] = (odd[0][:, None] * form.tip_y_functional).ravel()
        residual = np.append(
            (frequency * form.M * dX - mixed.rate(form, X)).ravel(), dX[0] @ form.tip_y_functional
        )
        step = np.linalg.solve(J, -residual)
        X, frequency = X + step[:-1].reshape(m, unknowns), frequency + step[-1]
        moved = np.abs(step[:-1].reshape(m, unknowns)[:, stresses]).max()
        if moved <= SOLVED * np.abs(X[:, stresses]).max():
            return X, frequency
    raise AssertionError("no cycle")


def period_and_largest_y(orbit, phases):
    """Of the cycle near a symmetric orbit, on the orbit's mesh in space."""
    form = MixedForm(orbit.form.rod, orbit.form.mesh)
    X, frequency = solved_cycle(form, guess_at(orbit, phases), 2 * np.pi / orbit.period)
    S, _ = form.stresses_and_velocities(X)
    E = np.empty((*S.shape[:-1], form.mesh.element_node_indices.size))
    write_element_strains(np.ascontiguousarray(S), orbit.form.nodal_rod, form.mesh.element_node_indices, E)
    y = shape_from_strains(form.mesh, E, np.zeros(3))[1, :, -1]
    whole = np.append(y, -y)[:, None]
    return 2 * np.pi / frequency, float(series_maxima(fourier_coefficients(whole), whole)[0])
