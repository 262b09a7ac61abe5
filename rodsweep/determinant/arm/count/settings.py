"""Settings for counts of an arm's eigenvalues."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ....model.compiled.settings import CompiledSettings


@dataclass(frozen=True, slots=True, kw_only=True)
class ArmCountSettings(CompiledSettings):
    """Settings for the nodes of a count and for the circles about them."""

    largest_turn: float = 1.5
    """Largest allowed error of a tangent's phase, in radians. The errors of two tangents then sum to less
    than pi."""
    circle: int = 8
    """Points of a circle about a node inside the hull; a multiple of 4."""
    between_points: float = 1.5
    """Safety factor on the maximum of |f| over the points of a circle, for larger values between the
    points."""
    clearance: float = 0.9
    """Largest allowed change of f, in units of |D|."""
    rounding: float = 100.0
    """Bound of the rounding error of D, in units of its noise; a node needs a larger |D|."""
    steepest: float = 1.0
    """Largest |L| times the unit of the radii, so that circles shrink with the distance to a zero of D."""
    sharp: float = 1e-3
    """Largest error of an eigenvalue that is divided out, in units of its distance from the line."""
    close_to_line: float = 1.0
    """Largest distance from the line of eigenvalues that are divided out, in units of their height above the
    real axis, or of |line|: without farther ones D would follow its dominant wave no more."""
    smallest_reach: float = 1e-12
    """Reach in units of |w| below which the line counts as running through a zero of D."""
    highest: float = 16.0
    """Largest W of elements that serve a node, in units of the |w| they are needed for: the many evaluations
    of a count are worth elements of their own."""
    max_nodes: int = 5000
    """Maximum nodes on all sides of the box; cones with tapers from 0.1 to 1 need 15 to 210."""
    overlap: float = 0.95
    """Distance of two nodes in units of the sum of their expected reaches."""
    largest_growth: float = 0.5
    """Largest expected growth of the reach per distance: the next node is 3.6 reaches ahead at most."""
    given_up: float = 0.2
    """A circle is given up for the next smaller one once its reach is below this fraction of its radius: the
    smaller one may reach 0.27 of the radius."""
    first_radius: float = 12.0
    """Radius of the first circle at the first node of a side without the dominant wave, in units of the
    length over which D changes."""
    smallest_radius: float = 0.75
    """Radius of the smallest circle at any node, in the same unit. Every trial halves the radius."""
    largest_radius: float = 48.0
    """Radius of the largest circle at any node, in the same unit."""
    of_height: float = 0.8
    """Largest radius with the dominant wave, in units of Im w: beyond Im w it has branch points."""
    closer: float = 0.9
    """Largest ratio of a shortened step to the step whose reaches left a gap."""
    within_reach: float = 0.99
    """Step in units of the reach of a node that lies within it whatever the rounding."""
    ranges: ClassVar = {
        "largest_turn": (0.0, math.pi / 2),
        "clearance": (0.0, 1.0),
        "of_height": (0.0, 1.0),
        "overlap": (0.0, 1.0),
        "largest_growth": (0.0, 1.0),
        "closer": (0.0, 1.0),
        "within_reach": (0.0, 1.0),
    }

    @property
    def directions(self) -> tuple[complex, ...]:
        """Directions of the points; each four in a row differ most in (v - w)^2, so that most circles too
        large for f are given up after one or two points."""
        order = np.arange(self.circle).reshape(-1, 2, 2).swapaxes(1, 2).ravel()
        return tuple(np.exp(2j * np.pi * (order + 0.5) / self.circle).tolist())


ARM_COUNT = ArmCountSettings()
