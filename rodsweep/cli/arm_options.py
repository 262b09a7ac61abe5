"""Options of the commands `arm` and `portrait`: quantities of an arm, its material, parameters of a rod."""

from collections.abc import Callable, Collection
from typing import Any

import click

from ..config.values import overflows_float
from ..errors import short_repr
from ..model.arm.quantities import GIVEN_QUANTITIES, UNITS_AND_EXAMPLES
from ..model.arm.segments import EXAMPLE_SEGMENT
from ..model.parameters import NONLINEAR_ROD_PARAMETER_NAMES, OPTIONAL_PARAMETER_NAMES, PARAMETERS

HELP_REMARKS = {
    "length": ", by default the sum of the segments",
    "young": ", and of segments without a modulus",
    "radius": "; or give --width and --height, or --segment",
    "pressure": ", also '1.2 of flutter'; or --force; or no load",
    "fluid_density": ", for the Reynolds number; by default 1000 kg/m^3",
    "density_difference": ", for its weight",
}
"""Remark after the meaning of a quantity in the help text of its option, by name of the quantity."""
MATERIAL_OPTIONS: dict[str, dict[str, Any]] = {
    "--segment": {
        "multiple": True,
        "metavar": "SEGMENT",
        "help": f"Segment, such as '{EXAMPLE_SEGMENT}', also with inner_radius; repeat the option, from base "
        "to tip.",
    },
    "--law": {"metavar": "LAW", "help": "Constitutive law, linear or neo_hookean; by default linear."},
    "--section": {
        "metavar": "SECTION",
        "help": "Cross-section of a rubber arm: fixed, or swelling as the arm shortens; by default fixed.",
    },
}
"""Arguments of `click.option` for the options of shape and material that are not quantities, by option."""


class FloatNumberType(click.types.FloatParamType):
    """Type of options that are numbers. A number too large for a float is refused; `float` would return
    inf."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """Number from the text `value`. Fails for a number too large for a float, and for any other text as
        click's own type does."""
        if isinstance(value, str) and overflows_float(value.strip()):
            self.fail(f"{short_repr(value)} is too large for a floating-point number.", param, ctx)
        number: float = super().convert(value, param, ctx)
        return number


NUMBER_TYPE = FloatNumberType()
"""Type of options that are numbers."""
CommandFunction = Callable[..., Any]
"""Function of a command."""
Decorator = Callable[[CommandFunction], CommandFunction]
"""Decorator of the function of a command."""


def arm_options(omitted: Collection[str] = (), is_required: bool = True) -> Decorator:
    """Decorator that adds the options of an arm's material, and an option for each quantity except the
    quantities in `omitted`.

    is_required: whether the options of indispensable quantities are required.
    """

    def add_options(command: CommandFunction) -> CommandFunction:
        for name in reversed([name for name in UNITS_AND_EXAMPLES if name not in omitted]):
            command = _quantity_option(name, is_required and GIVEN_QUANTITIES[name].is_required)(command)
        for option, settings in reversed(MATERIAL_OPTIONS.items()):
            command = click.option(option, **settings)(command)
        return command

    return add_options


def _quantity_option(name: str, required: bool) -> Decorator:
    """Decorator that adds the option of one quantity of an arm."""
    meaning = GIVEN_QUANTITIES[name].meaning
    help_text = f"{meaning[0].upper()}{meaning[1:]}{HELP_REMARKS.get(name, '')}."
    option = "--" + name.replace("_", "-")
    return click.option(option, name, metavar="QUANTITY", required=required, help=help_text)


def parameter_options(command: CommandFunction) -> CommandFunction:
    """Decorator that adds an option for every parameter of a rod except F. No option is required."""
    for name in reversed(
        [name for name in (*NONLINEAR_ROD_PARAMETER_NAMES, *OPTIONAL_PARAMETER_NAMES) if name != "F"]
    ):
        parameter = PARAMETERS[name]
        meaning = f"{parameter.meaning[0].upper()}{parameter.meaning[1:]}"
        unit = "" if parameter.unit == "1" else f", in {parameter.unit}"
        default_clause = "" if parameter.default is None else f"; by default {parameter.default:g}"
        command = click.option(f"--{name}", name, type=NUMBER_TYPE, help=f"{meaning}{unit}{default_clause}.")(
            command
        )
    return command
