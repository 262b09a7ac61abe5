"""Phrases for the material and the segments of an arm."""

from ..model.arm.arm import SlenderArm
from ..model.arm.section import Tube
from ..model.arm.shape import Station
from ..model.material.laws import LINEAR
from ..model.units import with_si_prefix


def law_phrase(arm: SlenderArm) -> str:
    """Phrase for the constitutive law of an arm: "linear", or "neo-Hookean" and the kind of section."""
    law = "linear" if arm.law == LINEAR.law else "neo-Hookean"
    return f"{law}, {arm.section} section" if arm.law != LINEAR.law else law


def station_phrase(station: Station) -> str:
    """Phrase for the radius, the inner radius (of a tube) and Young's modulus of a segment: "radius 6 mm,
    inner radius 3 mm, 80 kPa".
    """
    sides = {"radius": station.section.drag_radius}
    if isinstance(station.section, Tube):
        sides["inner radius"] = station.section.inner_radius
    parts = [f"{name} {_with_si_prefix(value, 'm')}" for name, value in sides.items()]
    return ", ".join([*parts, _with_si_prefix(station.young, "Pa")])


def _with_si_prefix(value: float, si: str) -> str:
    """A value in the SI unit `si` as text with four digits and a prefix: "6 mm"."""
    factor, unit = with_si_prefix(value, si)
    return f"{value * factor:.4g} {unit}"
