"""Variation of an arm along its length, in SI units: sections and moduli, taper, factors of stiffness and
drag.

Drags are computed from the local radius and the total length of the arm. The parameter `taper` of a cone
implies all factors except the logarithms in the translational drags; the profile of the cone contains these
logarithms.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, log
from typing import NamedTuple

import numpy as np

from ...arrays import Array, list_of
from ..material.profile import FACTOR_NAMES, RADIUS_POWERS, Profile
from .drag import Drag, drag_estimates
from .section import Circle, Section, Tube

BUCKLING_NODE_COUNT = 400
"""Number of midpoint-rule nodes in the integrals for the buckling weight; the relative error is then 5e-5."""
POWER_ITERATION_TOLERANCE = 1e-12
"""The power iteration stops when the largest eigenvalue changes relatively by at most this."""
MAX_POWER_ITERATIONS = 1000
"""Maximum number of steps of the power iteration, which usually takes twenty."""
MAX_RADIUS_RATIO_OF_PROFILE_ROWS = 1.3
"""Maximum ratio of the radii of a cone at neighbouring u of its profile. Between these u the profile
interpolates the drags by cubic polynomials, with a relative error of 6e-4 for tapers from 0.01 to 100 if the
arm is 20 or more radii long, and of 5e-3 if it is ten radii long."""


class Station(NamedTuple):
    """A cross-section of an arm, with Young's modulus `young` in Pa. end_position: material coordinate u,
    from 0 at the base to 1 at the tip, of the end of the segment with this cross-section; for a cone, the u
    of the cross-section."""

    end_position: float
    section: Section
    young: float


@dataclass(frozen=True)
class ArmGeometry:
    """Cross-sections along an arm of the length `length`, in m. stations: one station per segment from the
    base to the tip, or base and tip of a cone, or one station of a uniform arm. taper: tip radius divided by
    base radius of a cone; 1 for other arms."""

    length: float
    stations: tuple[Station, ...]
    taper: float = 1.0

    @property
    def base(self) -> Station:
        """The station at the clamp; its stiffness and drag define the dimensionless units."""
        return self.stations[0]

    @property
    def tip(self) -> Station:
        """The station at the tip; a pressure acts on its face."""
        return self.stations[-1]

    @property
    def varies_along_arm(self) -> bool:
        """Whether the cross-section or Young's modulus varies along the arm."""
        return any(station[1:] != self.base[1:] for station in self.stations)

    @property
    def largest_drag_radius(self) -> float:
        """The largest drag radius along the arm, in m."""
        return max(station.section.drag_radius for station in self.stations)

    def drag_estimates_at(self, station: Station, viscosity: float) -> tuple[Drag, ...]:
        """Drag estimates at a station, in the order of DRAG_ESTIMATE_NAMES. viscosity: in Pa s."""
        section = station.section
        return drag_estimates(viscosity, self.length, section.drag_radius, section.half_height)

    def profile(self, poisson: float, drag_index: int) -> Profile | None:
        """Factors of stiffness and drag along the arm, relative to the base; None for a uniform arm.

        The profile of a cone contains only the factors that the parameter `taper` does not imply. poisson:
        Poisson's ratio. drag_index: index of the drag estimate in DRAG_ESTIMATE_NAMES. Raises ValueError for
        a factor that overflows or underflows.
        """
        if not self.varies_along_arm:
            return None
        if self.taper != 1:
            return self._cone_profile(drag_index)
        segment_ends = [0.0, *(place.end_position for place in self.stations)]
        u = list[float]()
        rows = list[tuple[float, ...]]()
        for start, station in zip(segment_ends, self.stations, strict=False):
            factors = self._factors_at_station(station, poisson, drag_index)
            # Equal neighbouring segments are merged, because every jump, even of size 0, splits elements.
            if rows and rows[-1] == factors:
                u[-1] = station.end_position
            else:
                u += [start, station.end_position]
                rows += [factors, factors]
        return Profile(tuple(u), tuple(rows))

    def _cone_profile(self, drag_index: int) -> Profile:
        """Profile of a cone: factors of gamma1 and gamma2. All other factors are 1, because the parameter
        `taper` implies them. drag_index: index of the drag estimate in DRAG_ESTIMATE_NAMES."""
        # A single interval would be a straight line, as `Profile` has no neighbour for its slopes.
        interval_count = max(2, ceil(abs(log(self.taper)) / log(MAX_RADIUS_RATIO_OF_PROFILE_ROWS)))
        # Neighbouring radii have equal ratios, since the drag depends on the logarithm of the radius.
        radii = self.taper ** (np.arange(interval_count + 1) / interval_count)
        u = (1 - radii) / (1 - self.taper)
        base_drag = self.drag_estimates_at(self.base, 1.0)[drag_index]
        rows = list[tuple[float, ...]]()
        for radius in list_of(radii * self.base.section.drag_radius):
            local_drag = drag_estimates(1.0, self.length, radius, radius)[drag_index]
            factors = {
                "gamma1": local_drag.axial_factor / base_drag.axial_factor,
                "gamma2": local_drag.normal_factor / base_drag.normal_factor,
            }
            rows.append(tuple(factors.get(name, 1.0) for name in FACTOR_NAMES))
        return Profile((0.0, *list_of(u[1:-1]), 1.0), tuple(rows))

    def _factors_at_station(self, station: Station, poisson: float, drag_index: int) -> tuple[float, ...]:
        """k1, k2, k3, gamma1, gamma2, gamma3 at a station, each divided by the value at the base. poisson:
        Poisson's ratio. drag_index: index of the drag estimate in DRAG_ESTIMATE_NAMES."""
        values, base_values = (
            np.array(self._stiffnesses_and_drag_factors(place, poisson, drag_index))
            for place in (station, self.base)
        )
        # Overflow is refused later, with a message that names the quantities.
        with np.errstate(all="ignore"):
            return tuple(list_of(values / base_values))

    def _stiffnesses_and_drag_factors(
        self, station: Station, poisson: float, drag_index: int
    ) -> tuple[float, ...]:
        """E A, kappa E A, E I at a station, and the axial, normal and rotational drag divided by the
        viscosity. poisson: Poisson's ratio. drag_index: index of the drag estimate in DRAG_ESTIMATE_NAMES."""
        section = station.section
        local_drag = self.drag_estimates_at(station, 1.0)[drag_index]
        stretch_stiffness = station.young * section.area
        return (
            stretch_stiffness,
            section.shear_coefficient(poisson) * stretch_stiffness,
            station.young * section.second_moment,
            local_drag.axial_factor,
            local_drag.normal_factor,
            local_drag.rotational_factor,
        )

    def weight_over_buckling_weight(self, weight_density: float) -> float:
        """Ratio of the weight of the upright arm to the weight at which the arm buckles.

        weight_density: weight per volume, in N/m^3. With the weight W(u) of the part beyond u, an arm of the
        buckling weight has a nonzero solution of theta' = m/(E I), m' = -W theta, theta(0) = 0, m(1) = 0. The
        ratio is therefore the largest eigenvalue of the operator theta -> int_0^u (1/(E I)) int_u^1 W theta.
        Power iteration converges fast: the kernel of the operator is positive, and the second eigenvalue of a
        uniform arm is a seventh of the largest.
        """
        lengths, area, stiffness = self._lengths_areas_and_stiffnesses()
        # Integrals up to a midpoint include half of the interval around the midpoint.
        volume = area * lengths
        # Weight beyond a section, so the sum runs from the tip.
        volume_beyond = np.cumsum(volume[::-1])[::-1] - volume / 2
        theta: Array = np.ones(len(lengths))
        ratio = 0.0
        for _ in range(MAX_POWER_ITERATIONS):
            moment_step = volume_beyond * theta * lengths
            angle_step = (np.cumsum(moment_step[::-1])[::-1] - moment_step / 2) * lengths / stiffness
            theta = np.cumsum(angle_step) - angle_step / 2
            previous_ratio = ratio
            # The largest angle is at the tip, so the iterates keep one size.
            ratio = float(theta[-1])
            theta /= ratio
            if abs(ratio - previous_ratio) <= POWER_ITERATION_TOLERANCE * ratio:
                break
        return weight_density * ratio

    def _lengths_areas_and_stiffnesses(self) -> tuple[Array, Array, Array]:
        """Returns (length, A, E I) of the quadrature's subintervals, (subintervals,), in m, m^2, N m^2."""
        if self.taper != 1:
            u = (np.arange(BUCKLING_NODE_COUNT) + 0.5) / BUCKLING_NODE_COUNT
            radius = 1 - (1 - self.taper) * u
            base = self.base
            area = base.section.area * radius ** RADIUS_POWERS["k1"]
            stiffness = base.young * base.section.second_moment * radius ** RADIUS_POWERS["k3"]
            return np.full(len(u), self.length / len(u)), area, stiffness
        # Every segment has whole subintervals, so no midpoint lies on a jump.
        interval_count = max(4, BUCKLING_NODE_COUNT // len(self.stations))
        lengths = np.diff([0.0, *(station.end_position for station in self.stations)]) * self.length
        areas = [station.section.area for station in self.stations]
        stiffnesses = [station.young * station.section.second_moment for station in self.stations]
        return (
            np.repeat(lengths / interval_count, interval_count),
            np.repeat(areas, interval_count),
            np.repeat(stiffnesses, interval_count),
        )


def geometry_of_segments(segments: Sequence[tuple[float, Circle | Tube, float]]) -> ArmGeometry:
    """Geometry of an arm made of segments. segments: (length in m, section, Young's modulus in Pa) of each
    segment, from the base to the tip."""
    ends = np.cumsum([length for length, _, _ in segments])
    # The last end is 1 exactly, whatever the rounding of the sum.
    end_positions = [*list_of(ends[:-1] / ends[-1]), 1.0]
    stations = [
        Station(u, section, young) for u, (_, section, young) in zip(end_positions, segments, strict=True)
    ]
    return ArmGeometry(float(ends[-1]), tuple(stations))
