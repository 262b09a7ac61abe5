"""Settings for integrating a motion until its cycle is found (`transient_integration`, and in part
`by_integration`)."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class TransientSettings:
    """Settings for integrating a motion until Newton's method finds its cycle. The maximum number of returns
    is the config key `most_periods`, see `rodsweep.config.task.limit_cycle`."""

    returns_per_run: int = 5
    """Number of returns of the tip in one run, after which the motion is classified."""
    first_time_steps_per_period: int = 1000
    """Period of the leading mode divided by the first time step of a motion."""
    max_actual_to_expected_run_duration: int = 3
    """Longest duration of a run divided by the number of returns and by the expected time per return: the
    period of the leading mode, or the time between the last two returns if it is longer."""
    returns_in_first_run: int = 3
    """Number of returns of the first run. A fast-growing motion may already have reached its cycle then; slow
    growth and decay are recognised only after later runs."""
    min_returns_per_run: int = 3
    """Smallest number of returns of a run after which the motion is classified. The last run takes up to this
    number minus 1 further returns, since they could not be classified in a run of their own."""
    max_return_distance_for_newton: float = 0.1
    """Relative distance between two returns, below which Newton's method starts."""
    return_distance_divisor_per_attempt: int = 10
    """After each attempt of Newton's method, `max_return_distance_for_newton` is divided by this number."""
    max_newton_return_distance_if_stored: float = 1e-3
    """Upper limit of `max_return_distance_for_newton` for a motion with a stored path, in the first half of
    the allowed returns, so that the path shows how the motion settles."""
    max_newton_start_tightenings: int = 5
    """Each attempt of Newton's method, up to this number of attempts, decreases the distance at which
    Newton's method starts, and doubles the number of returns before the next attempt."""
    max_state_jumps: int = 60
    """Maximum number of times that the state of a motion is replaced by a scaled state or by the leading mode
    at a small amplitude."""
    restart_tip_y: float = 1e-3
    """Tip's y, in L, at a restart in the leading mode; the relative nonlinear change of the growth rate is
    about the square of this number."""
    min_unit_circle_distance: float = 3e-8
    """A periodic orbit with 1 - |mu| < min_unit_circle_distance is no limit cycle, but belongs to a family of
    orbits with any amplitude; mu: largest nontrivial multiplier."""
    max_stored_returns: int = 400
    """Number of last returns that are stored for the recognition of a torus."""
    max_return_distance_if_periodic: float = 1e-4
    """Relative distance between two returns, below which a motion is periodic. Periodic
    motions, integrated with a tolerance of 1e-5, return to within 1e-6 to 1e-4."""
    max_successive_newton_failures: int = 4
    """The integration of a periodic motion ends after this number of successive failures of Newton's method:
    further starts would fail in the same way."""
    min_returns_of_step_limit: int = 100
    """The maximum number of time steps is computed for at least this number of returns, because few returns
    may need many time steps."""


TRANSIENT_SETTINGS = TransientSettings()
