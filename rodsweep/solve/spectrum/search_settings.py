"""Settings of the search for one spectrum: meshes, attempts and accepted errors."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchSettings:
    """Settings of the search for one spectrum: meshes, attempts and accepted errors."""

    spare_modes: int = 1
    """Number of eigenvalues requested beyond the count of the winding number."""
    unknowns_a_mode: int = 6
    """Fewest unknowns of a mesh for each requested eigenvalue."""
    enough_unproved: int = 50
    """Number of growing modes after which no more are solved for if no count is possible: each doubling costs
    several times as much, and nothing is proved in the end."""
    resolved_share: float = 0.5
    """Fewest roots found on a mesh, in units of the requested modes, after which more eigenvalues are
    requested."""
    max_meshes: int = 16
    """Maximum number of attempts. Pulled rods with little rotational drag take most of them."""
    max_failures: int = 3
    """Maximum number of attempts that end with an error inside PETSc, SLEPc or LAPACK."""
    no_progress: int = 2
    """Number of refinements without a smaller error after which rounding is taken as the limit."""
    progress: float = 0.5
    """Largest ratio of the errors of two attempts that counts as progress."""
    error_share: float = 0.5
    """Largest error estimate in units of the accuracy: it is an estimate only."""
    stalled_error_share: float = 0.8
    """`error_share` if rounding limits the error."""
    largest_displacement: float = 1e-3
    """Relative distance of the mesh's eigenvalues from the roots of D, above which the mesh may have missed
    an eigenvalue."""
    unbounded_displacement: float = 1e-6
    """`largest_displacement` without an a-priori bound, if convergence is the only evidence."""


SEARCH = SearchSettings()
