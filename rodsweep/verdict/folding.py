"""Wrapping of texts for a terminal."""

import textwrap

WIDTH = 80
"""Width of a report, in columns."""


def folded(text: str, first: str = "", further: str = "  ") -> str:
    """A text wrapped to WIDTH columns; first, further: indents of the first and of further lines."""
    return textwrap.fill(text, WIDTH, initial_indent=first, subsequent_indent=further)
