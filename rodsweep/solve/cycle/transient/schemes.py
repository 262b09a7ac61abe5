"""Choice of the time schemes of an integrated motion, by the linear growth of the leading mode."""

from dataclasses import dataclass, replace
from typing import NamedTuple

from ...motion.time_scheme import TimeScheme
from .amplitude_equation import AMPLITUDE_EQUATION_SETTINGS


@dataclass(frozen=True, slots=True, kw_only=True)
class TimeSchemeSettings:
    """Settings for the time schemes of a motion: the default scheme; the scheme of the first run of a
    fast-growing motion; the accurate scheme, for motions whose growth per period is so small that only an
    accurate scheme gives its sign, and for motions with a stored path."""

    max_growth_for_accurate_scheme: float = 0.01
    """The accurate scheme is used if |Re w| T, the linear growth of the leading mode per period T, is below
    this number."""

    max_default_scheme_growth_error: float = 1e-3
    """Largest growth per period, as a change of Re w T, that integration errors of the default scheme and of
    the fast-growth scheme may add; 3e-4 was measured."""

    max_accurate_scheme_growth_error: float = 1e-5
    """Largest growth per period, as a change of Re w T, that integration errors of the accurate scheme may
    add; 8e-6 was measured."""

    default_scheme_max_steps_per_return: int = 200
    """Maximum number of time steps of the default scheme, divided by the allowed number of returns.
    22 to 101 steps per return were measured on motions of 400 returns. A motion with rare returns takes far
    more, and ends at this maximum."""

    accurate_scheme_max_steps_per_return: int = 2000
    """Maximum number of time steps of the accurate scheme, divided by the allowed number of returns; its
    steps are a tenth as long as the steps of the default scheme."""

    default_scheme_tolerance: float = 1e-5
    """Local tolerance of the default scheme."""

    fast_growth_scheme_tolerance: float = 1e-4
    """Local tolerance of the scheme of a fast-growing motion."""

    accurate_scheme_tolerance: float = 1e-9
    """Local tolerance of the accurate scheme."""


TIME_SCHEME_SETTINGS = TimeSchemeSettings()


class TransientTimeSchemes(NamedTuple):
    """Time schemes of the first run and of all later runs of a motion. allowed_growth_error_per_period:
    growth per period that integration errors may add. max_steps_per_return: maximum number of time steps,
    divided by the allowed number of returns."""

    first_run: TimeScheme
    """Time scheme of the first run."""
    later_runs: TimeScheme
    """Time scheme of all later runs."""
    allowed_growth_error_per_period: float
    max_steps_per_return: int


def time_schemes_for_growth(growth: float, is_stored: bool) -> TransientTimeSchemes:
    """Time schemes of a motion. growth: linear growth Re w T of the leading mode per period T. is_stored:
    whether the path of the motion is stored."""
    settings = TIME_SCHEME_SETTINGS
    # An error of the scheme could change the sign of a slow growth, and with it the outcome.
    if abs(growth) < settings.max_growth_for_accurate_scheme or is_stored:
        accurate = TimeScheme("arkimex", "5", tolerance=settings.accurate_scheme_tolerance)
        return TransientTimeSchemes(
            accurate,
            accurate,
            settings.max_accurate_scheme_growth_error,
            settings.accurate_scheme_max_steps_per_return,
        )
    default = TimeScheme("arkimex", "4", tolerance=settings.default_scheme_tolerance)
    # Only the first run starts small and grows; later runs start near the cycle. The growth during the first
    # run is not used, so that a large tolerance suffices.
    is_fast = growth > AMPLITUDE_EQUATION_SETTINGS.max_slow_growth_per_return
    first = replace(default, tolerance=settings.fast_growth_scheme_tolerance) if is_fast else default
    return TransientTimeSchemes(
        first, default, settings.max_default_scheme_growth_error, settings.default_scheme_max_steps_per_return
    )
