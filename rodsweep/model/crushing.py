"""Values of a parameter at which the force does not crush the rod."""

from collections.abc import Mapping

from .material.rod_material import RodMaterial

RELATIVE_MIN_TAPER_TOLERANCE = 1e-9
"""Relative tolerance of the smallest taper at which the force does not crush the rod."""


def uncrushed_interval(
    material: RodMaterial,
    other_values: Mapping[str, float],
    varied_parameter: tuple[str, float, float],
    margin: float = 0.0,
) -> tuple[float, float]:
    """Returns (smallest, largest) value of a parameter, within an interval, at which the force does not crush
    the rod. If the force crushes the rod everywhere in the interval, the second value is not above the first.

    other_values: values of the other parameters by name. varied_parameter: name of the parameter and ends of
    the interval. margin: smallest relative distance of the force from the crushing force. For a parameter
    other than F, k1 and taper, which does not influence crushing, the whole interval is returned.
    """
    name, low, high = varied_parameter
    # The weakest section moves along the arm as the taper changes, so only a search finds the limit.
    if name == "taper":
        return _smallest_uncrushed_taper(material, other_values, (low, high), margin), high
    relative_force = material.crushing_force_over_k1(other_values.get("taper", 1.0))
    if name == "F":
        # Without a bound on the force, as for rubber, the product is inf and the interval is unchanged.
        return low, min(high, (1 - margin) * relative_force * other_values["k1"])
    if name == "k1":
        return max(low, other_values["F"] / relative_force * (1 + margin)), high
    return low, high


def _smallest_uncrushed_taper(
    material: RodMaterial, other_values: Mapping[str, float], interval: tuple[float, float], margin: float
) -> float:
    """Smallest taper of the interval at which the force does not crush the rod; the largest taper of the
    interval if the force crushes every rod of the interval. other_values, margin: as in
    `uncrushed_interval`."""

    def is_uncrushed(taper: float) -> bool:
        return (1 - margin) * material.crushing_force_over_k1(taper) * other_values["k1"] > other_values["F"]

    low, high = interval
    # A wider tip never weakens a section, so one sign change at most lies in the interval.
    if is_uncrushed(low) or not is_uncrushed(high):
        return low if is_uncrushed(low) else high
    while high - low > RELATIVE_MIN_TAPER_TOLERANCE * high:
        middle = (low + high) / 2
        if is_uncrushed(middle):
            high = middle
        else:
            low = middle
    # The upper end of the bracket, at which the rod is known to be uncrushed.
    return high
