"""Estimated time of branches of limit cycles before the start of a sweep, from sampled points."""

from collections.abc import Mapping, Sequence

import numpy as np

from ..arrays import Array
from ..model.material.laws import LINEAR_CONSTITUTIVE_LAW
from ..model.material.rod_material import RodMaterial
from .cost_estimate import CostEstimate, sampled_points_with_rod
from .points.points import Points

COSTLIER_IF_LARGER = frozenset({"k1", "F"})
"""Parameters for which large values make branches of cycles expensive; for all other parameters, small values
do."""
BRANCH_SECONDS_PER_FORCE = 0.004
"""All branches of a rod take BRANCH_SECONDS_PER_FORCE F (accuracy/1e-7)^BRANCH_ACCURACY_EXPONENT (1 + F/(k2
t))^BRANCH_FORCE_OVER_BENDING_EXPONENT/taper^2, in seconds. t: min(1, taper)^2. F: largest force on the
branches, at most k1 t. Fourteen random rods (F up to 60 to 200, k2 from 12 to 9000, accuracies from 1e-4 to
1e-9) took 0.3 to 21 s, all within a factor of three of the formula and most within two; some near F = k1 take
four times as long. Branches of six cones, over F and over the taper, took 0.6 to 2 times as long as estimated
(0.2 to 11 s, tapers from 0.5 to 1.5)."""
BRANCH_ACCURACY_EXPONENT = -0.17
"""Exponent of the accuracy in the formula of BRANCH_SECONDS_PER_FORCE."""
BRANCH_FORCE_OVER_BENDING_EXPONENT = 1.5
"""Exponent of 1 + F/(k2 t) in the formula of BRANCH_SECONDS_PER_FORCE."""
MEASURED_TAPER_RANGE = (0.5, 1.5)
"""Smallest and largest taper of the cones in the measurement of BRANCH_SECONDS_PER_FORCE. A cone of taper
0.19 takes some hundred times as long as the formula says, swelling rubber thirty times."""
MAX_MEASURED_FORCE_OVER_CRUSHING_FORCE = 0.9
"""Largest force, divided by the crushing force, for which the formula of BRANCH_SECONDS_PER_FORCE holds."""


def branches_cost(
    points: Points, parameter_name: str, limits: tuple[float, float], accuracy: float
) -> CostEstimate:
    """Estimated cost of the branches of limit cycles of all rods in `points`, along the parameter
    `parameter_name`.

    limits: smallest and largest value of this parameter. accuracy: relative accuracy of the cycles. For kinds
    of rods whose times were not measured the estimate has `underestimated_rods`. The estimate is 0 s if no
    sampled point has a rod.
    """
    indices = sampled_points_with_rod(points)
    values: dict[str, Array | float] = points.parameter_values_of_points(indices) | {
        # The costly end of the range stands for the whole branch, because the steps near this end dominate.
        parameter_name: limits[parameter_name in COSTLIER_IF_LARGER]
    }
    taper = np.asarray(values.get("taper", 1.0))
    min_area = np.minimum(taper, 1.0) ** 2
    F = np.clip(values["F"], 0.0, values["k1"] * min_area)  # a rod under tension has no cycles
    seconds_per_force = BRANCH_SECONDS_PER_FORCE * (accuracy / 1e-7) ** BRANCH_ACCURACY_EXPONENT
    # A cone has as many waves along its length as a uniform rod under the force F/taper^2.
    seconds = (
        seconds_per_force
        * F
        / taper**2
        * (1 + F / (values["k2"] * min_area)) ** BRANCH_FORCE_OVER_BENDING_EXPONENT
    )
    if not indices.size:
        return CostEstimate(0.0)
    materials = [points.material_of(int(index)) for index in indices]
    return CostEstimate(
        float(np.mean(seconds)) * points.count,
        underestimated_rods=_underestimated_rods_text(materials, values | {"F": F}, taper),
    )


def _underestimated_rods_text(
    materials: Sequence[RodMaterial], values: Mapping[str, Array | float], taper: Array
) -> str:
    """Kind of rods among the sampled rods whose branches may take many times as long as estimated, or empty.
    materials: material of every rod. values: parameters, numbers or (rods,). taper: a number or (rods,)."""
    min_taper, max_taper = MEASURED_TAPER_RANGE
    if any(material.constitutive_law is not LINEAR_CONSTITUTIVE_LAW for material in materials):
        return "branches of rubber"
    if any(material.profile is not None for material in materials):
        return "branches of arms with a profile"
    if bool(((taper < min_taper) | (taper > max_taper)).any()):
        return f"branches of cones with a taper outside {min_taper:g} to {max_taper:g}"
    relative_load = np.asarray(values["F"] / (values["k1"] * np.minimum(taper, 1.0) ** 2))
    return (
        "branches near the crushing force"
        if bool((relative_load > MAX_MEASURED_FORCE_OVER_CRUSHING_FORCE).any())
        else ""
    )
