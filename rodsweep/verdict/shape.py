"""Shape and material of an arm in words, such as "a cone of rubber"."""

from ..model.arm.arm import SlenderArm
from ..model.arm.section import Tube
from ..model.arm.shape import Station
from ..model.material.laws import LINEAR
from ..model.units import compact


def shape_words(arm: SlenderArm) -> str:
    """Shape of an arm, and its material if rubber, in words: "a cone of rubber", "an arm of segments"."""
    shape = "an arm"
    if arm.shape.varies:
        shape = "a cone" if arm.taper != 1 else "an arm of segments"
    return shape if arm.law == LINEAR.law else f"{shape} of rubber"


def law_words(arm: SlenderArm) -> str:
    """Constitutive law of an arm in words: "linear", or "neo-Hookean" with the kind of section."""
    law = "linear" if arm.law == LINEAR.law else "neo-Hookean"
    return f"{law}, {arm.section} section" if arm.law != LINEAR.law else law


def station_words(station: Station) -> str:
    """Radius, inner radius of a tube, and Young's modulus of a segment: "radius 6 mm, inner radius 3 mm, 80
    kPa".
    """
    sides = {"radius": station.section.drag_radius}
    if isinstance(station.section, Tube):
        sides["inner radius"] = station.section.inner_radius
    parts = [f"{name} {_in_prefix(value, 'm')}" for name, value in sides.items()]
    return ", ".join([*parts, _in_prefix(station.young, "Pa")])


def _in_prefix(value: float, si: str) -> str:
    """A value in the SI unit `si` as text with four digits and a prefix: "6 mm"."""
    factor, unit = compact(value, si)
    return f"{value * factor:.4g} {unit}"
