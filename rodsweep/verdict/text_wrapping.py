"""Wrapping of the report's text for a terminal."""

import textwrap

WIDTH = 80
"""Width of a wrapped line, in characters."""


def wrapped_text(text: str, first: str = "", further: str = "  ") -> str:
    """`text` wrapped to lines of at most WIDTH characters. first: indent of the first line. further: indent
    of the following lines.
    """
    return textwrap.fill(text, WIDTH, initial_indent=first, subsequent_indent=further)
