"""Numbers of the integration of a motion until its cycle is found (`transient`)."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class TransientSettings:
    """Settings for the integration of a motion until Newton's method finds its cycle."""

    returns_per_run: int = 5
    """Returns per run, before the motion is classified."""
    first_steps: int = 1000
    """Period of the leading mode in units of a motion's first time step."""
    longest_wait: int = 3
    """Longest duration of a run in units of the expected duration of its returns."""
    first_returns: int = 3
    """Returns of the first run, after which only closed motions are recognised: a fast-growing motion may
    close early."""
    newton_distance: float = 0.1
    """Relative distance of two returns at which Newton's method starts."""
    newton_divisor: int = 10
    """Divisor of this distance for each failure of Newton's method."""
    stored_path_distance: float = 1e-3
    """`newton_distance` for a stored path in the first half of the allowed periods: smaller, to show the
    settling."""
    max_newton_failures: int = 5
    """Failures of Newton's method up to which each failure doubles the returns before the next attempt."""
    max_jumps: int = 60
    """Maximum number of scaled or restarted states."""
    restart_deflection: float = 1e-3
    """Tip deflection of a restart in L; its square is the relative change of the linear growth."""
    neutral_distance: float = 3e-8
    """Distance of the largest multiplier from 1 below which a closed orbit does not determine its
    amplitude."""
    max_returns: int = 400
    """Number of last returns that are kept to recognise a torus."""
    closed_distance: float = 1e-4
    """Relative distance of two returns at which a motion is closed. With the integrator's tolerance of 1e-5
    closed motions return to within 1e-6 to 1e-4, by chance."""
    max_unsolved: int = 4
    """Number of times that Newton's method has no cycle near a motion, after which a closed motion ends: the
    last start is from a closed motion, and the next one would be the same."""
    min_returns: int = 100
    """Smallest number of returns for which time steps are allowed: a few returns may need many."""


TRANSIENT = TransientSettings()
