"""The options of the command `arm` that are quantities with units."""

from collections.abc import Callable
from typing import Any

import click

OPTIONS = {
    "length": "Length of the arm.",
    "radius": "Radius of a circular section; or give --width and --height.",
    "inner_radius": "Radius of the bore of a tube, closed at its tip.",
    "width": "Width of a rectangular section, across the plane of motion.",
    "height": "Height of a rectangular section, in the plane of motion.",
    "young": "Young's modulus.",
    "viscosity": "Viscosity of the fluid.",
    "pressure": "Pressure on the tip's face, also '1.2 of flutter'; or --force; or no load.",
    "force": "Follower force at the tip.",
    "fluid_density": "Density of the fluid, for the Reynolds number; by default 1000 kg/m^3.",
    "density_difference": "Density of the arm over that of the fluid, for its weight.",
}
"""Quantities with units, and what `--help` says of them."""
REQUIRED = ("length", "young", "viscosity")


def arm_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Adds them to a command, in their order."""
    for name, meaning in reversed(OPTIONS.items()):
        option = "--" + name.replace("_", "-")
        add = click.option(option, name, metavar="QUANTITY", required=name in REQUIRED, help=meaning)
        command = add(command)
    return command
