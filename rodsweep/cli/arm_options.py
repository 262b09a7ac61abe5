"""Options of the command `arm` for quantities with units."""

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
"""Remarks that follow a quantity's meaning in `--help`."""


def arm_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Adds the options of all quantities to a command."""
    for name in reversed(UNITS):
        meaning = QUANTITIES[name].meaning
        help_text = f"{meaning[0].upper()}{meaning[1:]}{REMARKS.get(name, '')}."
        option = "--" + name.replace("_", "-")
        add = click.option(option, name, metavar="QUANTITY", required=QUANTITIES[name].needed, help=help_text)
        command = add(command)
    return command
