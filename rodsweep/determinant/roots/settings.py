"""Settings for the refinement of eigenvalues of a mesh to roots of D."""

from dataclasses import dataclass

from ...model.compiled.settings import CompiledSettings


@dataclass(frozen=True, slots=True, kw_only=True)
class RootSettings(CompiledSettings):
    """Settings for the refinement of eigenvalues of a mesh to roots of D."""

    largest_correction: float = 1e-2
    """Largest Newton correction of an eigenvalue that approximates a root, in units of the length over which
    D changes. Eigenvalues with larger corrections are artefacts of the mesh."""
    largest_of_pair: float = 0.1
    """Largest Newton correction, in the same unit, of an eigenvalue that may be refined in a pair."""
    refined_together: float = 4.0
    """Distance of two eigenvalues, over the sum of their corrections, below which both are refined in a
    pair."""
    expansions: int = 2
    """Number of expansions of D for a pair, each about the middle of the two roots of the last."""
    on_the_axis: float = 1e-13
    """Relative real part below which an eigenvalue counts as imaginary, whatever its error estimate."""
    axis_errors: float = 4.0
    """Real part, in units of the error, below which an eigenvalue counts as imaginary."""
    blurred: float = 1e-11
    """Relative Newton correction above which a double root is checked for."""
    separated: float = 16.0
    """|D'|^2 in units of e |D''| from which the Newton correction is valid: the next root, at 2 |D'/D''|, is
    then 32 errors away."""
    same_root: float = 4.0
    """Distance of two roots, over the sum of their errors, below which the two may be equal."""
    share_of_next: float = 0.25
    """Distance of two roots, in units of that of the next root, below which both are refined to one root."""


ROOTS = RootSettings()
