"""Differences between the paths of the tip in two solutions of a cycle on two meshes."""

import numpy as np

from ...arrays import Array
from ...model.parameters import PARAMETERS
from ...model.rod import Rod
from .measures import CycleMotion
from .orbit import Orbit

PERIOD_INDEX, Y_INDEX, EXTREMUM_INDEX, PATH_INDEX = range(4)
"""Indices of the period, the largest y, the worst extremum and the path in the result of
`tip_path_differences`."""


def tip_path_differences(coarse: CycleMotion, fine: CycleMotion) -> Array:
    """Differences between the tip's paths in two motions of a cycle, (4,): difference of the period,
    difference of the largest y, largest difference of an extremum, and largest difference of the tip's x, y
    or theta over the period.

    The first number is the larger of two relative differences: of the periods, and of the parameters of the
    rods, which may be different on a branch. The remaining three differences are divided by the largest y of
    `fine`.
    """
    max_distance = np.abs(
        fine.tip_samples - coarse.tip_x_y_theta_from_orbit_start(len(fine.tip_samples))
    ).max()
    extrema = fine.tip_extrema
    differences = {name: abs(value - extrema[name]) for name, value in coarse.tip_extrema.items()}
    largest_y = abs(extrema["tip_y_max"])
    period_difference = max(
        abs(coarse.orbit.period / fine.orbit.period - 1),
        max_relative_parameter_difference(coarse.orbit, fine.orbit),
    )
    return np.array(
        [
            period_difference,
            *(np.array([differences["tip_y_max"], max(differences.values()), max_distance]) / largest_y),
        ]
    )


def max_relative_parameter_difference(first: Orbit, reference: Orbit) -> float:
    """Largest difference between the parameters of the rods of two orbits, relative to the parameters of the
    orbit `reference`; absolute for a parameter of `reference` that is 0."""
    a, b = (_rod_parameter_coordinates(orbit.form.rod) for orbit in (first, reference))
    # A coefficient is 0 only in a limit, such as c1 = 0, where it is exactly 0 for both rods.
    return float(np.abs((a - b) / np.where(b == 0, 1, b)).max())


def _rod_parameter_coordinates(rod: Rod) -> Array:
    """Parameters of a rod for comparison, (n,): the coefficients of its equations if it is uniform and
    linear, for any other rod the coordinates of all parameters (1/k for a stiffness k)."""
    if rod.is_uniform_and_linear:
        return np.array([*rod.coefficients, rod.base_axial_drag])
    return np.array([rod.coordinate(name) for name in PARAMETERS])
