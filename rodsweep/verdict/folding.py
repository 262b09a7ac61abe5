"""Texts in lines of a terminal."""

import textwrap

WIDTH = 80
"""Columns of a line of a report."""


def folded(text: str, first: str = "", further: str = "  ") -> str:
    """A text in lines of at most 80 columns, with what they begin with."""
    return textwrap.fill(text, WIDTH, initial_indent=first, subsequent_indent=further)
