"""Sentences of the command line in the words of Python: `--at k1=150` is `at={"k1": 150}`."""

import re
from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, TypeVar

from ...errors import InputError

P = ParamSpec("P")
R = TypeVar("R")

PLACE = re.compile(r"--at (?:'(\w+)=([^']*)'|(\w+)=(\S*[^\s:;,)]))")
NUMBER = re.compile(r"-?(?:\d[\d.]*(?:e[+-]?\d+)?|inf)")
WORDS = (
    (re.compile(r"--what (\w+)"), r'what="\1"'),
    (re.compile(r"--point (\d+)"), r"points=\1"),
    (re.compile(r"--point\b"), "points"),
    (re.compile(r"--(at|what|output|roots|width|style|title)\b"), r"\1"),
)
"""Options of `rodsweep plot`, and how `rs.plot` has them."""


def in_python(sentence: str) -> str:
    """A sentence about options of `rodsweep plot` with the arguments of `rs.plot` in their place."""
    sentence = PLACE.sub(_place, sentence)
    for option, argument in WORDS:
        sentence = option.sub(argument, sentence)
    return sentence


def _place(match: re.Match[str]) -> str:
    """`at` as a dictionary: a number as it is, a quantity or a word in quotes."""
    name, value = (match[1], match[2]) if match[1] else (match[3], match[4])
    return f'at={{"{name}": {value}}}' if NUMBER.fullmatch(value) else f'at={{"{name}": "{value}"}}'


def refusing_in_python(function: Callable[P, R]) -> Callable[P, R]:
    """Decorator: the InputError of a call has the arguments of `rs.plot`."""

    @wraps(function)
    def call(*values: P.args, **named: P.kwargs) -> R:
        try:
            return function(*values, **named)
        except InputError as error:
            raise InputError(in_python(str(error))) from None

    return call
