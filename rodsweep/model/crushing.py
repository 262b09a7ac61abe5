"""Values of a parameter at which the force does not crush the rod."""

from collections.abc import Mapping

from .material.rod_material import RodMaterial

TAPER_ACCURACY = 1e-9
"""Relative tolerance of the smallest taper at which the force does not crush the tip."""


def uncrushed_interval(
    material: RodMaterial, rod: Mapping[str, float], varied: tuple[str, float, float], margin: float = 0.0
) -> tuple[float, float]:
    """(smallest, largest) value of a parameter at which the force does not crush the rod, within an interval;
    the second is not above the first if the force crushes the rod everywhere in the interval.

    rod: values of the other parameters by name. varied: name of the parameter and ends of the interval.
    margin: smallest relative distance from the crushing force. Only F, k1 and taper have an influence on
    crushing; for another parameter the whole interval is returned.
    """
    name, low, high = varied
    if name == "taper":
        return _smallest_uncrushed_taper(material, rod, (low, high), margin), high
    relative_force = material.relative_crushing_force(rod.get("taper", 1.0))
    if name == "F":
        return low, min(high, (1 - margin) * relative_force * rod["k1"])
    if name == "k1":
        return max(low, rod["F"] / relative_force * (1 + margin)), high
    return low, high


def _smallest_uncrushed_taper(
    material: RodMaterial, rod: Mapping[str, float], interval: tuple[float, float], margin: float
) -> float:
    """Smallest taper of the interval at which the force does not crush the rod; the largest one if it crushes
    the rod everywhere."""

    def is_uncrushed(taper: float) -> bool:
        return (1 - margin) * material.relative_crushing_force(taper) * rod["k1"] > rod["F"]

    low, high = interval
    if is_uncrushed(low) or not is_uncrushed(high):
        return low if is_uncrushed(low) else high
    while high - low > TAPER_ACCURACY * high:
        middle = (low + high) / 2
        low, high = (low, middle) if is_uncrushed(middle) else (middle, high)
    return high
