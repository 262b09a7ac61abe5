"""Settings for the refinement of eigenvalues of a mesh to roots of D."""

from dataclasses import dataclass

from ...model.compiled.settings import CompiledSettings


@dataclass(frozen=True, slots=True, kw_only=True)
class RootSettings(CompiledSettings):
    """Settings for the refinement of eigenvalues of a mesh to roots of D."""

    largest_correction: float = 1e-2
    """An eigenvalue of the mesh approximates a root of D if |D/D'| <= this number times the length over which
    D changes; otherwise, unless it belongs to a close pair, it is an artefact of the mesh."""
    max_pair_correction: float = 0.1
    """Two close eigenvalues of the mesh approximate two roots of D if |D/D'| of each eigenvalue is at most
    this number times the length over which D changes."""
    pair_distance: float = 4.0
    """Two eigenvalues of the mesh are moved to the roots of a quadratic Taylor polynomial of D before
    Newton's method if their distance is at most this number times the sum of their Newton corrections."""
    parabolas_per_pair: int = 2
    """Number of successive quadratic Taylor polynomials of D for two close eigenvalues, each about the middle
    of the two roots of its predecessor."""
    axis_tolerance: float = 1e-13
    """An eigenvalue is taken to be imaginary if |Re w| <= this number times |w|."""
    axis_tolerance_in_errors: float = 4.0
    """An eigenvalue is also taken to be imaginary if |Re w| <= this number times the error of w."""
    double_root_correction: float = 1e-11
    """An eigenvalue w is checked for a double root if |D/D'| > this number times |w|."""
    min_squared_slope: float = 16.0
    """The Newton correction e/|D'| is a valid error estimate if |D'|^2 >= this number times e |D''|, with the
    error e of D: the next root, at 2 |D'/D''|, is then at least 32 corrections away."""
    same_root_distance: float = 4.0
    """Two computed roots may be the same root of D if their distance is at most this number times the sum of
    their errors."""
    same_root_fraction: float = 0.25
    """Two roots that may be the same by `same_root_distance` are the same root of D if their distance is
    below this fraction of the estimated distance 2 |D'/D''| of the next root."""


ROOT_SETTINGS = RootSettings()
