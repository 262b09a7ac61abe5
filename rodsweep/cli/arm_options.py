"""The options of the command `arm` that are quantities with units."""

from collections.abc import Callable
from typing import Any

import click

from ..model.arm.quantities import QUANTITIES, UNITS

REMARKS = {
    "radius": "; or give --width and --height",
    "pressure": ", also '1.2 of flutter'; or --force; or no load",
    "fluid_density": ", for the Reynolds number; by default 1000 kg/m^3",
    "density_difference": ", for its weight",
}
"""What `--help` says of a quantity beside its meaning."""


def arm_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Adds them to a command, in their order."""
    for name in reversed(UNITS):
        meaning = QUANTITIES[name].meaning
        told = f"{meaning[0].upper()}{meaning[1:]}{REMARKS.get(name, '')}."
        option = "--" + name.replace("_", "-")
        add = click.option(option, name, metavar="QUANTITY", required=QUANTITIES[name].needed, help=told)
        command = add(command)
    return command
