"""Labels of figures as plain text for the values under the pointer: TeX becomes Unicode."""

import re
import unicodedata
from functools import cache

FORMULA = re.compile(r"\$(.+?)(?<!\\)\$")
"""A formula between dollars."""
DERIVATIVE = re.compile(r"\\dot\s*(?:\{([^{}]*)\}|(\w))")
WITH_ARGUMENT = re.compile(r"\\(?:mathrm|text|tilde|mathit)\s*(?:\{([^{}]*)\}|(\w))")
"""A TeX command that is replaced by its argument: upright letters, and marks above a letter."""
SUBSCRIPT = re.compile(r"_(?:\{([^{}]*)\}|(.))")
POWER = re.compile(r"\^(?:\{([^{}]*)\}|(\\?\w+|.))")
COMMAND = re.compile(r"\\([A-Za-z]+|.)")
SIGNS = {"times": "×", "infty": "∞", "dagger": "†", "partial": "∂", ",": " ", ";": " ", " ": " ", "$": "$"}
"""Signs of the commands that are neither Greek letters nor names of functions."""


def label_text(label: str) -> str:
    """A label as plain text in a single line; a dollar of a user's text stays a dollar."""
    text = FORMULA.sub(lambda found: _formula(found[1]), label).replace(r"\$", "$")
    return " ".join(text.split())


def _formula(tex: str) -> str:
    """A formula as text: indices stand behind their letter, powers behind a ^."""
    tex = DERIVATIVE.sub(lambda found: rf"d{found[1] or found[2]}/dt\,", tex)
    previous = None
    while previous != tex:  # arguments may contain commands
        previous = tex
        tex = WITH_ARGUMENT.sub(lambda found: found[1] or found[2] or "", tex)
    tex = SUBSCRIPT.sub(lambda found: found[1] or found[2], tex)
    tex = POWER.sub(lambda found: _power(found[1] or found[2]), tex)
    return COMMAND.sub(lambda found: _sign(found[1]), tex).replace("{", "").replace("}", "")


def _power(exponent: str) -> str:
    """An exponent as text; the dagger of an adjoint mode is no power."""
    return exponent if exponent == r"\dagger" else f"^{exponent}"


@cache
def _sign(command: str) -> str:
    """The sign of a command: a Greek letter, a sign, or the command's own name, as for max."""
    if command in SIGNS:
        return SIGNS[command]
    size = "CAPITAL" if command[0].isupper() else "SMALL"
    name = "lamda" if command == "lambda" else command  # Unicode's spelling
    try:
        return unicodedata.lookup(f"GREEK {size} LETTER {name.upper()}")
    except KeyError:
        return command
