"""Settings of the curves of generalised Hopf points (`bautin_curves`)."""

from dataclasses import dataclass
from math import inf

from ..continuation.curve import StepControl

BAUTIN_STEP_CONTROL = StepControl(
    first_length=0.01,
    max_length=0.1,
    min_length=1e-4,
    max_prediction_error=0.2,
    max_angle=inf,
    max_successive_length_ratio=1.5,
    max_solutions=2000,
)
"""Step length control along a curve of generalised Hopf points. The range of each parameter has length 1.
Prediction errors are fractions of the step length."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BautinSettings:
    """Settings of the corrector and of the ends of a curve of generalised Hopf points."""

    max_secant_steps: int = 10
    """Maximum number of secant steps to a generalised Hopf point; after more steps the step along the curve
    has failed."""
    first_secant_step: float = 1e-3
    """First secant step along the Hopf curve; each parameter's range has length 1."""
    secant_tolerance: float = 1e-12
    """The secant method stops when the step is at most this number, or at most the error caused by the error
    of c (cubic coefficient of the normal form, Re c = 0 at the point); each parameter's range has length
    1."""
    edge_tolerance: float = 1e-12
    """A point lies on an end of a range if its distance, as a fraction of the range, is below this."""
    min_loop_points: int = 5
    """A curve can be recognised as closed only if it has more than this number of points."""
    same_point_distance: float = 1e-6
    """Two points are identical if their coordinates (scaled parameters, log frequency) differ by less than
    this."""


BAUTIN_SETTINGS = BautinSettings()
