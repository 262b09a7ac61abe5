"""Options of the command `arm`: quantities with units, segments, and the law."""

from collections.abc import Callable
from typing import Any

import click

from ..model.arm.quantities import QUANTITIES, UNITS
from ..model.arm.segments import EXAMPLE

REMARKS = {
    "length": ", by default the sum of the segments",
    "young": ", and of segments without one",
    "radius": "; or give --width and --height, or --segment",
    "pressure": ", also '1.2 of flutter'; or --force; or no load",
    "fluid_density": ", for the Reynolds number; by default 1000 kg/m^3",
    "density_difference": ", for its weight",
}
"""Remarks that follow a quantity's meaning in `--help`."""


OF_MATERIAL: dict[str, dict[str, Any]] = {
    "--segment": {
        "multiple": True,
        "metavar": "SEGMENT",
        "help": f"A segment, as '{EXAMPLE}', also with inner_radius; repeat it, from base to tip.",
    },
    "--law": {"metavar": "LAW", "help": "Constitutive law, linear or neo_hookean; by default linear."},
    "--section": {
        "metavar": "SECTION",
        "help": "Whether the section of rubber is fixed or swelling as the arm shortens; by default fixed.",
    },
}
"""Options of shape and material that are no quantities."""


def arm_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Adds the options of all quantities to a command."""
    for name in reversed(UNITS):
        meaning = QUANTITIES[name].meaning
        help_text = f"{meaning[0].upper()}{meaning[1:]}{REMARKS.get(name, '')}."
        option = "--" + name.replace("_", "-")
        add = click.option(option, name, metavar="QUANTITY", required=QUANTITIES[name].needed, help=help_text)
        command = add(command)
    for option, settings in reversed(OF_MATERIAL.items()):
        command = click.option(option, **settings)(command)
    return command
