"""Choice of the time schemes of an integrated motion, by the linear growth of the leading mode."""

from dataclasses import dataclass
from typing import NamedTuple

from ...motion.time_scheme import TimeScheme
from .amplitude_equation import AMPLITUDE_EQUATION


@dataclass(frozen=True, slots=True, kw_only=True)
class SchemeSettings:
    """Settings for the three time schemes of integrated motions (default, for fast growth, accurate), and for
    the choice of a scheme by the linear growth."""

    max_careful_growth: float = 0.01
    """The accurate scheme is used if the linear growth per period is less than this in modulus."""
    usual_noise: float = 1e-3
    """Largest growth per period that integration errors of the default scheme and of the scheme for fast
    growth may add; 3e-4 was measured."""
    careful_noise: float = 1e-5
    """Largest growth per period that integration errors of the accurate scheme may add; 8e-6 was measured."""
    usual_steps: int = 200
    """Maximum number of time steps of a motion with the default scheme, divided by the allowed number of
    returns. 22 to 101 time steps per return were measured on motions of 400 returns. A motion with rare
    returns takes far more time steps, and ends at this maximum."""
    careful_steps: int = 2000
    """Maximum number of time steps of a motion with the accurate scheme, divided by the allowed number of
    returns; these time steps are a tenth as long as with the default scheme."""
    usual_tolerance: float = 1e-5
    """Local tolerance of the default scheme."""
    quick_tolerance: float = 1e-4
    """Local tolerance of the scheme for fast growth."""
    careful_tolerance: float = 1e-9
    """Local tolerance of the accurate scheme."""

    @property
    def usual(self) -> TimeScheme:
        """Time scheme of most motions; Newton's method gives the accuracy of the cycle."""
        return TimeScheme("arkimex", "4", tolerance=self.usual_tolerance)

    @property
    def quick(self) -> TimeScheme:
        """Time scheme of the first run of a fast-growing motion, whose measured growth is not used."""
        return TimeScheme("arkimex", "4", tolerance=self.quick_tolerance)

    @property
    def careful(self) -> TimeScheme:
        """Time scheme of motions with a small growth per period, of which the sign must be correct, and of
        motions with a stored path."""
        return TimeScheme("arkimex", "5", tolerance=self.careful_tolerance)


SCHEMES = SchemeSettings()


class TransientSchemes(NamedTuple):
    """Time schemes of the first run and of all later runs of a motion. growth_noise: growth per period that
    integration errors may add. max_steps_per_return: maximum number of time steps, divided by the allowed
    number of returns."""

    first_run: TimeScheme
    later_runs: TimeScheme
    growth_noise: float
    max_steps_per_return: int


def schemes_for_growth(growth: float, is_stored: bool) -> TransientSchemes:
    """Time schemes of a motion. growth: linear growth per period of the leading mode. is_stored: whether the
    path of the motion is stored."""
    if abs(growth) < SCHEMES.max_careful_growth or is_stored:
        careful = SCHEMES.careful
        return TransientSchemes(careful, careful, SCHEMES.careful_noise, SCHEMES.careful_steps)
    first = SCHEMES.quick if growth > AMPLITUDE_EQUATION.max_slow_growth else SCHEMES.usual
    return TransientSchemes(first, SCHEMES.usual, SCHEMES.usual_noise, SCHEMES.usual_steps)
