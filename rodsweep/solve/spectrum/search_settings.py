"""Settings of the search for the leading eigenvalues of one rod: meshes, attempts and accepted errors."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchSettings:
    """Settings of the search for the leading eigenvalues of one rod: meshes, attempts and accepted errors."""

    spare_modes: int = 1
    """Number of eigenvalues requested from the mesh beyond the number that the winding number counts."""
    min_unknowns_per_mode: int = 6
    """Minimum number of unknowns of a mesh per requested eigenvalue."""
    max_unproved_modes: int = 50
    """Number of growing modes found beyond which no more modes are requested if no count is possible: each
    doubling costs several times as much, and nothing is proved in the end."""
    min_resolved_fraction: float = 0.5
    """Fraction of the requested modes. If at least this many roots of D, but too few, come from a mesh, the
    next attempt requests more eigenvalues; with fewer roots it only refines the mesh."""
    max_meshes: int = 16
    """Maximum number of attempts, each on one mesh. Only pulled rods with little rotational drag need most of
    these."""
    max_failures: int = 3
    """Maximum number of attempts that end with an error inside PETSc, SLEPc or LAPACK."""
    max_stalled_refinements: int = 2
    """Number of successive mesh refinements without `progress_ratio` after which the error is taken to be
    rounding error."""
    progress_ratio: float = 0.5
    """Largest ratio of the error of an attempt to the best error before that counts as progress."""
    max_error_over_limit: float = 0.5
    """Largest error estimate of an accepted spectrum, in units of the requested accuracy. It is below 1
    because an estimate may be too small."""
    max_stalled_error_over_limit: float = 0.8
    """`max_error_over_limit` of a spectrum whose error further meshes do not reduce."""
    largest_displacement: float = 1e-3
    """Largest relative distance between eigenvalues of the mesh and the roots of D to which they converge.
    Beyond it the mesh may have missed an eigenvalue."""
    unbounded_displacement: float = 1e-6
    """`largest_displacement` for a rod without an a-priori bound of its eigenvalues, where convergence is the
    only evidence."""


SEARCH = SearchSettings()
