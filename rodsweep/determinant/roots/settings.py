"""Settings for the refinement of eigenvalues of a mesh to roots of D."""

from dataclasses import dataclass

from ...model.compiled.settings import CompiledSettings


@dataclass(frozen=True, slots=True, kw_only=True)
class RootSettings(CompiledSettings):
    """Settings for the refinement of eigenvalues of a mesh to roots of D."""

    largest_correction: float = 1e-2
    """Largest Newton correction |D/D'| of an eigenvalue of the mesh that approximates a root of D, in units
    of the length over which D changes. Eigenvalues with a larger correction are artefacts of the mesh."""
    largest_of_pair: float = 0.1
    """Largest Newton correction |D/D'| of an eigenvalue of the mesh that, with a close second one,
    approximates two roots of D; in units of the length over which D changes."""
    pair_distance: float = 4.0
    """Distance of two eigenvalues of the mesh, over the sum of their Newton corrections, below which both are
    moved to the two roots of a quadratic Taylor polynomial of D before Newton's method."""
    parabolas_per_pair: int = 2
    """Number of successive quadratic Taylor polynomials of D for two close eigenvalues, each about the middle
    of the two roots of its predecessor."""
    axis_tolerance: float = 1e-13
    """|Re w|/|w| below which an eigenvalue is taken to be imaginary, whatever its error estimate."""
    axis_errors: float = 4.0
    """|Re w| in units of the error of w below which an eigenvalue is taken to be imaginary."""
    double_root_correction: float = 1e-11
    """Relative Newton correction above which an eigenvalue is checked for a double root."""
    min_squared_slope: float = 16.0
    """Least |D'|^2, in units of e |D''| with the error e of D, at which the Newton correction is a valid
    error estimate: the next root, at 2 |D'/D''|, is then 32 errors away."""
    same_root_distance: float = 4.0
    """Distance of two roots, over the sum of their errors, below which the two may be one root of D."""
    same_root_fraction: float = 0.25
    """Distance of two roots, in units of the estimated distance 2 |D'/D''| of the next root, below which
    Newton's method has found one root twice."""


ROOTS = RootSettings()
