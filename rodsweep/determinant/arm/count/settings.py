"""Settings for counts of an arm's eigenvalues right of a vertical line."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ....model.compiled.settings import CompiledSettings


@dataclass(frozen=True, slots=True, kw_only=True)
class ArmCountSettings(CompiledSettings):
    """Settings for the nodes on the contour of a count, and for the circles about nodes inside the hull."""

    max_tangent_error: float = 1.5
    """Largest allowed error of a tangent's phase, in radians. The errors of two tangents then sum to less
    than pi."""
    circle_points: int = 8
    """Number of points of a circle at which |f| is evaluated; a multiple of 4."""
    between_points_factor: float = 1.5
    """Safety factor on the largest |f| at the points of a circle, for larger values between the points."""
    max_change: float = 0.9
    """Largest allowed change of f within the reach of a node, in units of |D|."""
    rounding_over_noise: float = 100.0
    """Bound of the rounding error of D, in units of its `noise`; if |D| is smaller, the reach of the node is
    0."""
    max_log_slope: float = 1.0
    """Largest |L| times the unit of the radii, so that circles get smaller close to a zero of D."""
    max_known_error: float = 1e-3
    """Largest error of a known eigenvalue that is divided out of D, in units of its distance from the
    line."""
    max_known_distance: float = 1.0
    """Largest distance from the line of known eigenvalues that are divided out of D, in units of |Im w| or
    |line|, whichever is larger. If farther ones were divided out too, D would no longer follow its dominant
    wave."""
    min_reach: float = 1e-12
    """Reach of a node, in units of |w|, below which the contour is taken to meet a zero of D, and the count
    fails."""
    max_level_ratio: float = 16.0
    """Largest bound W of existing propagators that serve a node, in units of the |w| needed. Beyond it new
    ones on fewer elements are made, which pays because a count evaluates D many times."""
    max_nodes: int = 5000
    """Maximum number of nodes on all sides of the box; cones with tapers from 0.1 to 1 need 15 to 210."""
    reach_overlap: float = 0.95
    """Distance of the next node, in units of the sum of the expected reaches of both nodes."""
    largest_growth: float = 0.5
    """Largest expected growth of the reach per distance; the next node is then at most 3.6 reaches away."""
    min_reach_fraction: float = 0.2
    """Fraction of a circle's radius. If the reach falls below it, the next smaller circle is tried at once,
    which may reach 0.27 of the larger radius."""
    first_radius: float = 12.0
    """Radius of the first circle at the first node of a side of the box, without the dominant wave, in units
    of the length over which D changes."""
    smallest_radius: float = 0.75
    """Radius of the smallest circle at any node, in units of the length over which D changes. Every trial
    halves the radius."""
    largest_radius: float = 48.0
    """Radius of the largest circle at any node, in units of the length over which D changes."""
    max_wave_radius: float = 0.8
    """Largest radius of a circle with the dominant wave, in units of Im w: the wave may have branch points on
    the real axis."""
    max_step_ratio: float = 0.9
    """Largest ratio of a new step to the step before it, whose two reaches did not overlap."""
    safe_step: float = 0.99
    """Step from a node, in units of its reach, that is certainly within the reach despite rounding."""
    ranges: ClassVar = {
        "max_tangent_error": (0.0, math.pi / 2),
        "max_change": (0.0, 1.0),
        "max_wave_radius": (0.0, 1.0),
        "reach_overlap": (0.0, 1.0),
        "largest_growth": (0.0, 1.0),
        "max_step_ratio": (0.0, 1.0),
        "safe_step": (0.0, 1.0),
    }

    @property
    def directions(self) -> tuple[complex, ...]:
        """Unit vectors to the points of a circle, in the order of evaluation.

        Each four in succession differ most in (v - w)^2, so that most circles too large for f are given up
        after one or two points.
        """
        order = np.arange(self.circle_points).reshape(-1, 2, 2).swapaxes(1, 2).ravel()
        return tuple(np.exp(2j * np.pi * (order + 0.5) / self.circle_points).tolist())


ARM_COUNT = ArmCountSettings()
