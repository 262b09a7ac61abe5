"""Error messages, of one sentence each, for missing, unknown or surplus arguments of a Python call."""

from collections.abc import Callable, Mapping
from functools import wraps
from inspect import Parameter, Signature, signature
from typing import ParamSpec, TypeVar

from ...errors import InputError, short_repr
from .refusals import unknown_key_hint

P = ParamSpec("P")
R = TypeVar("R")


def no_hint(name: str) -> str:
    """Empty advice, whatever the argument `name`."""
    return ""


def refusing_wrong_arguments(
    example: str, hint: Callable[[str], str] = no_hint
) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Decorator: wrong arguments of a call raise an InputError that quotes `example`, not a TypeError.

    hint: function from the name of an unknown argument to advice; where the advice is empty, similar names
    are suggested.
    """

    def decorated(function: Callable[P, R]) -> Callable[P, R]:
        parameters = signature(function)

        @wraps(function)
        def call(*values: P.args, **named: P.kwargs) -> R:
            require_arguments_of_signature(parameters, example, values, named, hint)
            return function(*values, **named)

        return call

    return decorated


def require_arguments_of_signature(
    allowed: Signature,
    example: str,
    values: tuple[object, ...],
    named: Mapping[str, object],
    hint: Callable[[str], str] = no_hint,
) -> None:
    """Raises InputError for the first surplus, repeated, unknown or missing argument of a call.

    allowed: signature of the called function. values, named: positional and keyword arguments of the call.
    example, hint: as in `refusing_wrong_arguments`.
    """
    parameters = list(allowed.parameters.values())
    positional = [
        parameter.name for parameter in parameters if parameter.kind is Parameter.POSITIONAL_OR_KEYWORD
    ]
    if len(values) > len(positional):
        extra_text = short_repr(values[len(positional)])
        raise InputError(f"the argument {extra_text} has no name; write it as in {example}")
    parameter_names = [
        parameter.name
        for parameter in parameters
        if parameter.kind not in (Parameter.VAR_KEYWORD, Parameter.VAR_POSITIONAL)
    ]
    takes_any_keyword = any(parameter.kind is Parameter.VAR_KEYWORD for parameter in parameters)
    for name in named:
        if name in positional[: len(values)]:
            raise InputError(f"{name} is given twice, by position and by name; write it as in {example}")
        if not takes_any_keyword and name not in parameter_names:
            if hint(name):
                raise InputError(f"unknown key {name}; {hint(name)}")
            raise unknown_argument_error(
                name, [argument_name for argument_name in parameter_names if argument_name != "self"]
            )
    given_names = {*positional[: len(values)], *named}
    for parameter in parameters:
        if (
            parameter.default is Parameter.empty
            and parameter.name in parameter_names
            and parameter.name not in given_names
        ):
            raise InputError(f"{parameter.name} is missing; write it as in {example}")


def unknown_argument_error(name: str, names: list[str]) -> InputError:
    """InputError for an unknown argument `name`, which suggests the most similar of the names `names`, or
    lists all of these names."""
    return InputError(f"unknown key {name}; {unknown_key_hint(name, names)}")
