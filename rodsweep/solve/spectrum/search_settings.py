"""Settings of the search for the leading eigenvalues of one rod: meshes and accepted errors."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchSettings:
    """Settings of the search for the leading eigenvalues of one rod: meshes and accepted errors."""

    spare_mode_count: int = 1
    """A repeated request asks for this many eigenvalues more than the winding number counts."""
    min_unknowns_per_mode: int = 6
    """Minimum number of unknowns of a mesh per requested eigenvalue."""
    max_modes_found_without_proof: int = 50
    """If all modes found grow and no count is possible, more modes are requested only while fewer than this
    number are found: each doubling takes several times as long, and nothing is proved in the end."""
    min_found_fraction_for_more_modes: float = 0.5
    """If a mesh gives too few roots of D, but at least this fraction of the number of requested modes, the
    search requests more eigenvalues on a finer mesh; otherwise the search only refines the mesh."""
    max_meshes: int = 16
    """Maximum number of solves, each on one mesh. Only pulled rods of little rotational drag need most of
    them."""
    max_failed_solves: int = 3
    """Maximum number of solves that end with an error inside PETSc, SLEPc or LAPACK."""
    max_stalled_refinements: int = 2
    """After this number of successive refinements without progress, the error is taken to be rounding."""
    max_progress_error_ratio: float = 0.5
    """A solve counts as progress if its error is smaller than this fraction of the smallest earlier error."""
    max_error_over_limit: float = 0.5
    """A spectrum is accepted if error estimate <= `max_error_over_limit` * requested accuracy. The factor is
    below 1 because an estimate may be too small."""
    max_stalled_error_over_limit: float = 0.8
    """Largest ratio of error estimate to requested accuracy, like `max_error_over_limit`, if further meshes
    do not reduce the error."""
    max_relative_mesh_displacement: float = 1e-3
    """Largest relative distance between an eigenvalue of the mesh and the root of D to which it converges. At
    a larger distance the mesh may have missed an eigenvalue."""
    max_mesh_displacement_if_w_unbounded: float = 1e-6
    """Like `max_relative_mesh_displacement`, for a rod without an a-priori bound of its eigenvalues, where
    convergence is the only evidence that no eigenvalue is missing."""


SEARCH_SETTINGS = SearchSettings()
