"""Settings of the curves of generalised Hopf points (`bautin_curves`)."""

from dataclasses import dataclass
from math import inf

from ..continuation.follower import StepControl

BAUTIN_STEPS = StepControl(
    first_length=0.01,
    max_length=0.1,
    min_length=1e-4,
    max_error=0.2,
    max_angle=inf,
    max_ratio=1.5,
    max_solutions=2000,
)
"""Step length control along a curve. Lengths are in units of the parameters' ranges, the prediction error in
units of the step."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BautinSettings:
    """Settings for the corrector and the ends of a curve of generalised Hopf points."""

    max_secants: int = 10
    """Maximum number of secant steps to a generalised Hopf point; the step along the curve fails beyond
    it."""
    first_secant: float = 1e-3
    """First secant step along the Hopf curve, in units of the ranges."""
    tolerance: float = 1e-12
    """Secant step, in units of the ranges, at which the secant method has converged."""
    on_edge: float = 1e-12
    """Distance from an end of a range, in units of the range, below which a point lies on this end."""
    min_loop_points: int = 5
    """Number of points that a curve must exceed before it can be recognised as closed."""
    same_point: float = 1e-6
    """Distance of two points, in units of the ranges, below which they count as the same."""


BAUTIN = BautinSettings()
