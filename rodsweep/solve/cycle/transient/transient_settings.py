"""Settings for integrating a motion until its cycle is found (`transient`)."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class TransientSettings:
    """Settings for integrating a motion until Newton's method finds its cycle."""

    returns_per_run: int = 5
    """Number of returns of the tip in one run, after which the motion is classified."""
    first_steps_per_period: int = 1000
    """Number of first time steps of a motion in a period of the leading mode."""
    max_run_duration: int = 3
    """Longest duration of a run, in units of the expected duration of its returns."""
    first_returns: int = 3
    """Number of returns of the first run, after which only a periodic motion is recognised: a fast-growing
    motion may reach its cycle early."""
    max_newton_distance: float = 0.1
    """Relative distance between two returns below which Newton's method starts."""
    newton_divisor: int = 10
    """Divisor of `max_newton_distance` after each failure of Newton's method."""
    stored_path_distance: float = 1e-3
    """Relative distance between two returns below which Newton's method starts, for a stored path in the
    first half of the allowed returns: smaller, so that the path shows how the motion settles."""
    max_newton_failures: int = 5
    """Number of failures of Newton's method up to which each failure doubles the number of returns before the
    next start."""
    max_jumps: int = 60
    """Maximum number of jumps of a motion, to a scaled state or to a restart."""
    restart_deflection: float = 1e-3
    """Tip's y, in L, at a restart in the leading mode; its square is the relative change of the linear
    growth."""
    min_unit_distance: float = 3e-8
    """Distance of the largest multiplier's modulus from 1 below which a periodic orbit is no limit cycle, but
    one of a family with any amplitude."""
    max_stored_returns: int = 400
    """Number of last returns that are stored for the recognition of a torus."""
    max_periodic_distance: float = 1e-4
    """Relative distance between two returns below which a motion counts as periodic. Periodic motions,
    integrated with a tolerance of 1e-5, return to within 1e-6 to 1e-4."""
    max_failed_starts: int = 4
    """Number of successive failures of Newton's method after which the integration of a periodic motion ends:
    further starts would be the same."""
    min_returns: int = 100
    """Number of returns for which time steps are allowed even if fewer returns are requested, because few
    returns may need many time steps."""


TRANSIENT = TransientSettings()
