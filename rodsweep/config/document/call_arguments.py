"""Error messages, of one sentence each, for missing, unknown or surplus arguments of a Python call."""

from collections.abc import Callable, Mapping
from functools import wraps
from inspect import Parameter, Signature, signature
from typing import ParamSpec, TypeVar

from ...errors import InputError
from ..values import short_repr
from .refusals import unknown_key_hint

P = ParamSpec("P")
R = TypeVar("R")


def no_hint(name: str) -> str:
    """No advice on any argument."""
    return ""


def refusing_wrong_arguments(
    example: str, hint: Callable[[str], str] = no_hint
) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Decorator: wrong arguments of a call raise an InputError that quotes `example`, not a TypeError.

    hint: function from the name of an unknown argument to advice; where the advice is empty, similar names
    are suggested.
    """

    def decorated(function: Callable[P, R]) -> Callable[P, R]:
        asked = signature(function)

        @wraps(function)
        def call(*values: P.args, **named: P.kwargs) -> R:
            require_arguments_of_signature(asked, example, values, named, hint)
            return function(*values, **named)

        return call

    return decorated


def require_arguments_of_signature(
    asked: Signature,
    example: str,
    values: tuple[object, ...],
    named: Mapping[str, object],
    hint: Callable[[str], str] = no_hint,
) -> None:
    """Raises InputError for the first surplus, repeated, unknown or missing argument of a call.

    asked: signature of the function. example: correct call, for the message. values, named: positional and
    keyword arguments of the call. hint: as in `refusing_wrong_arguments`.
    """
    ours = list(asked.parameters.values())
    by_place = [p.name for p in ours if p.kind is Parameter.POSITIONAL_OR_KEYWORD]
    if len(values) > len(by_place):
        surplus = short_repr(values[len(by_place)])
        raise InputError(f"the argument {surplus} has no name; write it as in {example}")
    known = [p.name for p in ours if p.kind not in (Parameter.VAR_KEYWORD, Parameter.VAR_POSITIONAL)]
    takes_any = any(p.kind is Parameter.VAR_KEYWORD for p in ours)
    for name in named:
        if name in by_place[: len(values)]:
            raise InputError(f"{name} is given twice; write it as in {example}")
        if not takes_any and name not in known:
            if hint(name):
                raise InputError(f"unknown key {name}; {hint(name)}")
            raise unknown_argument_error(name, [word for word in known if word != "self"])
    given = {*by_place[: len(values)], *named}
    for parameter in ours:
        if parameter.name in known and parameter.default is Parameter.empty and parameter.name not in given:
            raise InputError(f"{parameter.name} is missing; write it as in {example}")


def unknown_argument_error(name: str, known: list[str]) -> InputError:
    """InputError for an unknown argument `name`, which suggests the most similar of the names `known`, or
    lists all of these names."""
    return InputError(f"unknown key {name}; {unknown_key_hint(name, known)}")
