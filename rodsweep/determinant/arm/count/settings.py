"""Settings for counts of an arm's eigenvalues right of a vertical line, and for proofs that no eigenvalue
crosses such a line as a parameter varies."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ....model.compiled.kernel_constants import KernelConstants


@dataclass(frozen=True, slots=True, kw_only=True)
class ContourSettings(KernelConstants):
    """Settings for the nodes on the contour of a count, and for the circles about nodes inside the hull. L =
    D'/D; f: D without its dominant change, see `phase_node`."""

    max_tangent_phase_error: float = 1.5
    """Largest allowed error of a tangent's phase, in radians; the errors of two tangents then sum to less
    than pi."""
    circle_point_count: int = 8
    """Number of points of a circle at which |f|, f: D without its dominant change, is evaluated; a multiple
    of 4."""
    circle_safety_factor: float = 1.5
    """Safety factor on the largest |f|, f: D without its dominant change, at the points of a circle, for
    larger values between the points."""
    max_D_change_ratio: float = 0.9
    """Within the valid radius of a node w, f(v) = D(v) exp(-h(v)) differs from f(w) by at most this number
    times |D(w)|; h: tangent of log D, see `phase_node`."""
    rounding_safety_factor: float = 100.0
    """|rounding error of D| <= this number times `DeterminantValue.rounding_error`. Where |D| is below this
    bound, the valid radius of a node is 0."""
    max_log_D_change_over_radius: float = 1.0
    """The unit of the radii of circles is max_log_D_change_over_radius |D/D'| instead of the distance over
    which an exponent of D changes by about 1, if smaller: circles get smaller close to a zero of D."""
    max_divided_out_error_over_distance: float = 1e-3
    """A known eigenvalue is divided out of D only if its error is below this fraction of its distance from
    the vertical line of the count."""
    max_divided_out_line_distance_over_w: float = 1.0
    """Distance of a known eigenvalue w from the vertical line of a count, divided by max(|Im w|, |Re of the
    line|), below which the eigenvalue is divided out of D. D without farther eigenvalues would not follow the
    dominant wave."""
    min_valid_radius_over_w: float = 1e-12
    """The count fails if the valid radius of a node w, the distance within which the phase of D is known, is
    below this number times |w|: a zero of D is too close."""
    max_reused_W_over_w: float = 16.0
    """Existing propagators for |w| <= W serve a node if W <= this number times the |w| needed. Otherwise
    propagators on fewer elements are made, because a count evaluates D many times."""
    max_nodes: int = 5000
    """Maximum number of nodes on all sides of the box; cones with tapers from 0.1 to 1 need 15 to 210."""
    distance_over_sum_of_valid_radii: float = 0.95
    """Distance between neighbouring nodes on the contour of a count, divided by the sum of their expected
    valid radii, within which the tangents of log D are accurate."""
    max_valid_radius_growth: float = 0.5
    """Upper limit of the expected growth of the valid radius from one node to the next, divided by the
    distance of the nodes; the next node is at most 3.6 radii away."""
    min_valid_over_circle_radius: float = 0.2
    """If the valid radius found from a circle is below this fraction of the radius of the circle, a smaller
    circle is tried at once."""
    first_circle_radius_over_w_scale: float = 12.0
    """Radius of the first circle at a first node, divided by the distance in w over which an exponent of D
    changes by about 1."""
    min_circle_radius_over_w_scale: float = 0.75
    """Radius of the smallest circle at any node, divided by the unit of the radii, which is smaller close to
    a zero of D (`max_log_D_change_over_radius`). Every trial halves the radius."""
    max_circle_radius_over_w_scale: float = 48.0
    """Radius of the largest circle at any node, divided by the distance in w over which an exponent of D
    changes by about 1 (`mean_wave_number_and_w_scale`)."""
    max_dominant_wave_radius_over_im_w: float = 0.8
    """Largest radius over Im w of circles that use the dominant wave; its branch points lie at Im w = 0."""
    max_shortened_over_previous_step: float = 0.9
    """If the valid discs of two nodes do not overlap, the step is at most this fraction of the last step."""
    safe_step_over_radius: float = 0.99
    """A step within the valid radius of a node is at most this fraction of the radius, because of
    rounding."""
    field_ranges: ClassVar = {
        "max_tangent_phase_error": (0.0, math.pi / 2),
        "max_D_change_ratio": (0.0, 1.0),
        "max_dominant_wave_radius_over_im_w": (0.0, 1.0),
        "distance_over_sum_of_valid_radii": (0.0, 1.0),
        "max_valid_radius_growth": (0.0, 1.0),
        "max_shortened_over_previous_step": (0.0, 1.0),
        "safe_step_over_radius": (0.0, 1.0),
    }
    """Exclusive bounds (lower, upper) of fields, by name, that the proofs require; see `KernelConstants`."""

    @property
    def circle_directions(self) -> tuple[complex, ...]:
        """Unit vectors from the centre w of a circle to its points v, in the order of evaluation. Successive
        points differ much in (v - w)^2, so that circles with too large |f|, f as in `phase_node`, are mostly
        rejected after one or two points."""
        order = np.arange(self.circle_point_count).reshape(-1, 2, 2).swapaxes(1, 2).ravel()
        return tuple(np.exp(2j * np.pi * (order + 0.5) / self.circle_point_count).tolist())


CONTOUR_SETTINGS = ContourSettings()


@dataclass(frozen=True, slots=True, kw_only=True)
class NoCrossingSettings(KernelConstants):
    """Settings for the discs that cover a vertical line, and for the arms at which D is evaluated. f: see
    `no_crossing`."""

    arm_count: int = 5
    """Number of arms of an interval at which D is evaluated, including the middle arm and both ends."""
    line_distance_over_last_w: float = 0.05
    """The vertical line that no eigenvalue crosses lies left of the last requested eigenvalue w, or left of
    the imaginary axis if Re w > 0, at the distance of this number times |w|."""
    between_arms_safety_factor: float = 1.5
    """Safety factor on the largest change of f between the evaluated arms, which covers all arms between
    them; f(v, p): D divided by the factors of its known zeros and by its dominant exponential, see the module
    `no_crossing`."""
    max_divided_out_distance_over_radius: float = 3.0
    """Distance of a known eigenvalue from a node, divided by the radius of the node's disc, below which the
    eigenvalue is divided out of D."""
    min_known_distance_over_w: float = 1e-6
    """Distance of a point v of a circle from a known eigenvalue, divided by |v|, below which the circle is
    not used: D and the divisor are then both inaccurate."""
    min_known_distance_over_error: float = 1e3
    """Distance of a point of a circle from a known eigenvalue, divided by the error of this eigenvalue, below
    which the circle is not used."""
    covered_length_over_radius: float = 0.98
    """Length of the vertical line that a disc covers on each side of its node, divided by the radius."""
    min_radius_fraction_inside_W: float = 0.25
    """If the bound W of the propagators allows a disc of less than this fraction of the radius to be tried,
    propagators for a larger |w| are made."""
    W_over_largest_w: float = 2.0
    """Propagators are made valid up to W, this number times the largest |w| on the line inside the hull."""
    radius_growth_factor: float = 2.0
    """Radius of the first disc tried at a node, divided by the radius of the previous disc."""
    radius_divisor_after_failure: float = 1.5
    """If D, without its zeros and its dominant exponential, changes too much on the circle of a disc, the
    radius is divided by this number."""
    min_radius_over_w_scale: float = 0.05
    """Radius below which no disc is tried, divided by the distance in w over which an exponent of D changes
    by about 1 (`mean_wave_number_and_w_scale`) near the real axis."""

    field_ranges: ClassVar = {
        "arm_count": (2, math.inf),
        "between_arms_safety_factor": (1.0, math.inf),
        "covered_length_over_radius": (0.0, 1.0),
        "radius_divisor_after_failure": (1.0, math.inf),
    }
    """Exclusive bounds (lower, upper) of fields, by name, that the proofs require; see `KernelConstants`."""

    @property
    def max_D_change_ratio(self) -> float:
        """Largest allowed change of f (see the module `no_crossing`) over the points of a circle and the
        evaluated arms, divided by |f| at the node for the middle arm."""
        return CONTOUR_SETTINGS.max_D_change_ratio / (
            CONTOUR_SETTINGS.circle_safety_factor * self.between_arms_safety_factor
        )


NO_CROSSING_SETTINGS = NoCrossingSettings()
