"""Choice of the time schemes of an integrated motion, by the linear growth of the leading mode."""

from dataclasses import dataclass
from typing import NamedTuple

from ...motion.time_scheme import TimeScheme
from .amplitude_equation import AMPLITUDE_EQUATION_SETTINGS


@dataclass(frozen=True, slots=True, kw_only=True)
class TimeSchemeSettings:
    """Settings for the time schemes `default_scheme`, `fast_growth_scheme` and `accurate_scheme`, and for the
    choice of a scheme by the linear growth."""

    max_growth_for_accurate_scheme: float = 0.01
    """Linear growth per period, in modulus, below which the scheme is `accurate_scheme`."""

    default_growth_error: float = 1e-3
    """Largest growth per period that integration errors of the schemes `default_scheme` and
    `fast_growth_scheme` may add; 3e-4 was measured."""

    accurate_growth_error: float = 1e-5
    """Largest growth per period that integration errors of the scheme `accurate_scheme` may add; 8e-6 was
    measured."""

    default_max_steps_per_return: int = 200
    """Maximum number of time steps of the scheme `default_scheme`, divided by the allowed number of returns.
    22 to 101 steps per return were measured on motions of 400 returns. A motion with rare returns takes far
    more, and ends at this maximum."""

    accurate_max_steps_per_return: int = 2000
    """Maximum number of time steps of the scheme `accurate_scheme`, divided by the allowed number of returns;
    its steps are a tenth as long as those of `default_scheme`."""

    default_tolerance: float = 1e-5
    """Local tolerance of the scheme `default_scheme`."""

    fast_growth_tolerance: float = 1e-4
    """Local tolerance of the scheme `fast_growth_scheme`."""

    accurate_tolerance: float = 1e-9
    """Local tolerance of the scheme `accurate_scheme`."""

    @property
    def default_scheme(self) -> TimeScheme:
        """Time scheme of most motions; Newton's method gives the accuracy of the cycle."""
        return TimeScheme("arkimex", "4", tolerance=self.default_tolerance)

    @property
    def fast_growth_scheme(self) -> TimeScheme:
        """Time scheme of the first run of a fast-growing motion. A large tolerance suffices, because the
        growth in this run is not used."""
        return TimeScheme("arkimex", "4", tolerance=self.fast_growth_tolerance)

    @property
    def accurate_scheme(self) -> TimeScheme:
        """Time scheme of motions with a growth per period so small that only an accurate scheme gives its
        sign, and of motions with a stored path."""
        return TimeScheme("arkimex", "5", tolerance=self.accurate_tolerance)


TIME_SCHEME_SETTINGS = TimeSchemeSettings()


class TransientSchemes(NamedTuple):
    """Time schemes of the first run and of all later runs of a motion. growth_error: growth per period that
    integration errors may add. max_steps_per_return: maximum number of time steps, divided by the allowed
    number of returns."""

    first_run: TimeScheme
    later_runs: TimeScheme
    growth_error: float
    max_steps_per_return: int


def schemes_for_growth(growth: float, is_stored: bool) -> TransientSchemes:
    """Time schemes of a motion. growth: linear growth per period of the leading mode. is_stored: whether the
    path of the motion is stored."""
    # An error of the scheme could change the sign of a slow growth, and with it the outcome.
    if abs(growth) < TIME_SCHEME_SETTINGS.max_growth_for_accurate_scheme or is_stored:
        accurate_scheme = TIME_SCHEME_SETTINGS.accurate_scheme
        return TransientSchemes(
            accurate_scheme,
            accurate_scheme,
            TIME_SCHEME_SETTINGS.accurate_growth_error,
            TIME_SCHEME_SETTINGS.accurate_max_steps_per_return,
        )
    # Only the first run starts small and grows; later runs start near the cycle.
    first = (
        TIME_SCHEME_SETTINGS.fast_growth_scheme
        if growth > AMPLITUDE_EQUATION_SETTINGS.max_slow_growth
        else TIME_SCHEME_SETTINGS.default_scheme
    )
    return TransientSchemes(
        first,
        TIME_SCHEME_SETTINGS.default_scheme,
        TIME_SCHEME_SETTINGS.default_growth_error,
        TIME_SCHEME_SETTINGS.default_max_steps_per_return,
    )
