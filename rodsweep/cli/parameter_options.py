"""Options of the command `portrait` for the parameters of a rod."""

from collections.abc import Callable
from typing import Any

import click

from ..model.parameters import NONLINEAR_PARAMETERS, OPTIONAL_PARAMETERS, PARAMETERS


def parameter_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Adds an option for every parameter of a rod but the force, which is found."""
    for name in reversed([name for name in (*NONLINEAR_PARAMETERS, *OPTIONAL_PARAMETERS) if name != "F"]):
        parameter = PARAMETERS[name]
        meaning = f"{parameter.meaning[0].upper()}{parameter.meaning[1:]}"
        default = parameter.default if name in NONLINEAR_PARAMETERS else None
        command = click.option(
            f"--{name}",
            name,
            type=float,
            required=parameter.default is None,
            default=default,
            show_default=default is not None,
            help=f"{meaning}, in {parameter.unit}." if parameter.unit != "1" else f"{meaning}.",
        )(command)
    return command
