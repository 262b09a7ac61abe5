"""Conversion of figure labels from TeX to plain Unicode text, for the values under the pointer."""

import re
import unicodedata
from functools import cache

FORMULA_PATTERN = re.compile(r"\$(.+?)(?<!\\)\$")
"""Pattern for a formula between two dollar signs."""
DERIVATIVE_PATTERN = re.compile(r"\\dot\s*(?:\{([^{}]*)\}|(\w))")
"""Pattern for the TeX command of a time derivative: a dot above the argument."""
COMMAND_WITH_ARGUMENT_PATTERN = re.compile(r"\\(?:mathrm|text|tilde|mathit)\s*(?:\{([^{}]*)\}|(\w))")
"""Pattern for a TeX command that is replaced by its argument: a font, or a tilde above a letter."""
SUBSCRIPT_PATTERN = re.compile(r"_(?:\{([^{}]*)\}|(.))")
"""Pattern for a TeX subscript."""
SUPERSCRIPT_PATTERN = re.compile(r"\^(?:\{([^{}]*)\}|(\\?\w+|.))")
"""Pattern for a TeX superscript."""
TEX_COMMAND_PATTERN = re.compile(r"\\([A-Za-z]+|.)")
"""Pattern for a TeX command that has no pattern of its own."""
TEX_SIGNS = {
    "times": "×",
    "infty": "∞",
    "dagger": "†",
    "partial": "∂",
    ",": " ",
    ";": " ",
    " ": " ",
    "$": "$",
}
"""Unicode text of the TeX commands that are neither Greek letters nor names of functions."""


def plain_text_of_label(label: str) -> str:
    """A label as plain text on one line. An escaped dollar sign becomes a dollar sign."""
    text = FORMULA_PATTERN.sub(lambda match: _unicode_of_formula(match[1]), label).replace(r"\$", "$")
    return " ".join(text.split())


def _unicode_of_formula(tex: str) -> str:
    """A formula as text: a subscript directly after its letter, a power after "^"."""
    tex = DERIVATIVE_PATTERN.sub(lambda match: rf"d{match[1] or match[2]}/dt\,", tex)
    previous = None
    while previous != tex:  # arguments may contain commands
        previous = tex
        tex = COMMAND_WITH_ARGUMENT_PATTERN.sub(lambda match: match[1] or match[2] or "", tex)
    tex = SUBSCRIPT_PATTERN.sub(lambda match: match[1] or match[2], tex)
    tex = SUPERSCRIPT_PATTERN.sub(lambda match: f"^{match[1] or match[2]}", tex)
    tex = tex.replace(r"^\dagger", r"\dagger")  # of an adjoint mode
    tex = TEX_COMMAND_PATTERN.sub(lambda match: _unicode_of_tex_command(match[1]), tex)
    return tex.replace("{", "").replace("}", "")


@cache
def _unicode_of_tex_command(command: str) -> str:
    """Unicode text of a TeX command: a Greek letter, a sign, or the name of the command, such as "max"."""
    if command in TEX_SIGNS:
        return TEX_SIGNS[command]
    letter_case = "CAPITAL" if command[0].isupper() else "SMALL"
    name = "lamda" if command == "lambda" else command  # Unicode's spelling
    try:
        return unicodedata.lookup(f"GREEK {letter_case} LETTER {name.upper()}")
    except KeyError:
        return command
