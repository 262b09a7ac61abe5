"""Options of the command `portrait` for the parameters of a rod."""

from collections.abc import Callable
from typing import Any

import click

from ..model.parameters import NONLINEAR_PARAMETERS, OPTIONAL_PARAMETERS, PARAMETERS


def parameter_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Adds an option for every parameter of a rod but the force, which is found. None is required, because
    an arm may give them.
    """
    for name in reversed([name for name in (*NONLINEAR_PARAMETERS, *OPTIONAL_PARAMETERS) if name != "F"]):
        parameter = PARAMETERS[name]
        meaning = f"{parameter.meaning[0].upper()}{parameter.meaning[1:]}"
        unit = "" if parameter.unit == "1" else f", in {parameter.unit}"
        default = "" if parameter.default is None else f"; by default {parameter.default:g}"
        help_text = f"{meaning}{unit}{default}."
        command = click.option(f"--{name}", name, type=float, help=help_text)(command)
    return command
