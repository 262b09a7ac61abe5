"""Number of returns of the tip in the next run of a motion, so that the motion ends at its maximum number of
returns."""

from ....arrays import Array
from .transient_settings import TRANSIENT_SETTINGS


def is_too_short(times: Array) -> bool:
    """Whether a run has too few returns for a classification. times: times of its returns, (k,)."""
    return len(times) < TRANSIENT_SETTINGS.min_returns_per_run


def classified_run_length(is_first: bool, left: int) -> int:
    """Number of returns of the next run of a motion that is classified after every run. is_first: whether it
    is the first run. left: number of returns left up to the maximum."""
    usual = TRANSIENT_SETTINGS.returns_in_first_run if is_first else TRANSIENT_SETTINGS.returns_per_run
    return _run_length(usual, left, TRANSIENT_SETTINGS.min_returns_per_run)


def compared_run_length(left: int) -> int:
    """Number of returns of the next run of a motion whose returns are compared after every run. left: number
    of returns left up to the maximum."""
    return _run_length(TRANSIENT_SETTINGS.returns_per_run, left, TRANSIENT_SETTINGS.returns_per_run)


def _run_length(usual: int, left: int, least: int) -> int:
    """`usual`, or all returns `left` if fewer than `least` would be left for a further run."""
    return usual if left - usual >= least else left
