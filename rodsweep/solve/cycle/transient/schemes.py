"""Time schemes of a transient, by how fast its rod leaves or approaches the straight state."""

from dataclasses import dataclass
from typing import NamedTuple

from ...motion.time_scheme import TimeScheme
from .amplitude_equation import AMPLITUDE_EQUATION


@dataclass(frozen=True, slots=True, kw_only=True)
class SchemeSettings:
    """Settings for the choice of the scheme of a motion by its growth."""

    weak_growth: float = 0.01
    """Linear growth per period below which the scheme is `careful`."""
    growth_noise: float = 1e-3
    """Growth per period that the integrator may add; 3e-4 was measured."""
    careful_noise: float = 1e-5
    """`growth_noise` of the scheme `careful`; 8e-6 was measured."""
    usual_steps: int = 200
    """Time steps per allowed return, over all returns, of the scheme `usual`: 22 to 101 were measured on
    motions of 400 returns. A motion that returns seldom takes far more, and so counts by its work."""
    careful_steps: int = 2000
    """`usual_steps` of the scheme `careful`, whose steps are a tenth as long."""
    usual_tolerance: float = 1e-5
    """Tolerance of the scheme `usual`."""
    quick_tolerance: float = 1e-4
    """Tolerance of the scheme `quick`."""
    careful_tolerance: float = 1e-9
    """Tolerance of the scheme `careful`."""

    @property
    def usual(self) -> TimeScheme:
        """Scheme of most motions: Newton's method supplies the accuracy of the cycle."""
        return TimeScheme("arkimex", "4", tolerance=self.usual_tolerance)

    @property
    def quick(self) -> TimeScheme:
        """Scheme of the first run of a fast-growing motion, which often closes: no decision uses the
        growth."""
        return TimeScheme("arkimex", "4", tolerance=self.quick_tolerance)

    @property
    def careful(self) -> TimeScheme:
        """Scheme where the sign of a small growth per period must be correct, and for stored paths."""
        return TimeScheme("arkimex", "5", tolerance=self.careful_tolerance)


SCHEMES = SchemeSettings()


class TransientSchemes(NamedTuple):
    """Schemes of the first run and of all others, and the growth per period that the others may add.

    steps: maximum number of time steps, per return of the tip that is allowed.
    """

    first: TimeScheme
    others: TimeScheme
    noise: float
    steps: int


def schemes_of(growth: float, is_stored: bool) -> TransientSchemes:
    """Schemes for a linear growth per period; is_stored: whether the path of the motion is stored."""
    if abs(growth) < SCHEMES.weak_growth or is_stored:
        careful = SCHEMES.careful
        return TransientSchemes(careful, careful, SCHEMES.careful_noise, SCHEMES.careful_steps)
    first = SCHEMES.quick if growth > AMPLITUDE_EQUATION.slow_growth else SCHEMES.usual
    return TransientSchemes(first, SCHEMES.usual, SCHEMES.growth_noise, SCHEMES.usual_steps)
