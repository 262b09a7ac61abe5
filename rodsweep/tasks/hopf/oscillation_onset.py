"""Onset of oscillation between two forces, far from each other, of a file of spectra.

Newton's method for the double eigenvalue needs a good guess. Where Newton's method fails, or finds
eigenvalues other than the leading ones, the interval is halved: the leading eigenvalues at the middle force,
computed on a mesh, show which half contains the onset. Only NumPy is needed, so that files can be merged
without PETSc.
"""

import numpy as np

from ...arrays import Complex
from ...determinant.stability_changes import (
    CoefficientsLinearInForce,
    StabilityChange,
    oscillation_onset_between,
)
from ...discretization.straight.dense_eigenproblem import dense_eigenproblem
from ...discretization.straight.transverse_mesh import pencil_on
from ...discretization.straight.uniform_resolution import first_resolution
from ...model.rod import Rod
from ...solve.modes.propagator import symmetrised_shifted_inverse

MAX_HALVINGS = 8
"""Maximum number of halvings of the interval. If the interval has no onset, because a complex pair overtakes
the leading real eigenvalue, no number of halvings is sufficient."""
LEADING_DOUBLE_EIGENVALUE_TOLERANCE = 0.01
"""A double eigenvalue is the leading eigenvalue if its relative distance from the mean of the two leading
eigenvalues on the mesh is at most this number."""
MESH_ACCURACY = 1e-6
"""Relative accuracy of eigenvalues on a mesh: sufficient to tell real eigenvalues from a complex pair."""


def locate_oscillation_onset(
    rods: CoefficientsLinearInForce,
    rod: Rod,
    end_forces: tuple[float, float],
    lower_eigenvalues: Complex,
    upper_eigenvalues: Complex,
) -> StabilityChange | None:
    """The force between the forces `end_forces` at which the two leading real eigenvalues merge into a pair;
    None if no such force is found.

    rods: coefficients of `rod` at F = 0, and their derivatives with respect to F. lower_eigenvalues,
    upper_eigenvalues: leading eigenvalues at the first and second force, (modes,); the leading eigenvalue is
    real at the first force and complex at the second.
    """
    low, high = end_forces
    for _ in range(1 + MAX_HALVINGS):
        if not lower_eigenvalues[:2].imag.any():
            change = oscillation_onset_between(rods, (low, high), lower_eigenvalues, upper_eigenvalues)
            if change is not None and _is_double_eigenvalue_leading(rod, change):
                return change
        middle = (low + high) / 2
        eigenvalues = leading_pair_on_mesh(rod.with_coordinate("F", middle))
        if eigenvalues[0].imag:
            high, upper_eigenvalues = middle, eigenvalues
        else:
            low, lower_eigenvalues = middle, eigenvalues
    return None


def _is_double_eigenvalue_leading(rod: Rod, change: StabilityChange) -> bool:
    """Whether the double eigenvalue `change` is the leading eigenvalue of the rod at this force. Between two
    forces far from each other, other eigenvalues can merge too."""
    pair = leading_pair_on_mesh(rod.with_coordinate("F", change.F))
    return bool(
        abs(pair.mean() - change.growth_rate) <= LEADING_DOUBLE_EIGENVALUE_TOLERANCE * abs(change.growth_rate)
    )


def leading_pair_on_mesh(rod: Rod) -> Complex:
    """The two leading eigenvalues of a uniform rod, in 1/tau2, (2,), on a mesh of the relative accuracy
    MESH_ACCURACY."""
    eigenproblem = dense_eigenproblem(rod, pencil_on(first_resolution(rod, 2, MESH_ACCURACY)))
    inverses = np.linalg.eigvals(symmetrised_shifted_inverse(eigenproblem.A, eigenproblem.B, 0.0)).astype(
        complex
    )
    eigenvalues = 1 / inverses[inverses != 0]
    return eigenvalues[np.lexsort((-eigenvalues.imag, -eigenvalues.real))[:2]]
