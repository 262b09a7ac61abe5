"""Wrapping of the report's text for a terminal."""

import textwrap

WIDTH = 80
"""Width of a wrapped line, in characters."""


def folded(text: str, first: str = "", further: str = "  ") -> str:
    """`text` wrapped to lines of WIDTH characters. first, further: indents of the first line and of all
    further lines.
    """
    return textwrap.fill(text, WIDTH, initial_indent=first, subsequent_indent=further)
