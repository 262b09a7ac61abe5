"""The sign of the page that names the questions being solved, and how far they are."""

from collections.abc import Mapping, Sequence
from html import escape

NAMES = {"cycles": "folds and torus points", "growth": "growth rates", "branch": "branches"}
"""Names of kinds in the sign "solving ..."; a missing kind is its own name."""


def sign(kinds: Sequence[str], progress: Mapping[str, str]) -> str:
    """The text of the sign; empty without a question. progress: in words, by kind of question."""
    names = [NAMES.get(kind, kind) + progress.get(kind, "") for kind in kinds]
    return f"solving {', '.join(names)} ..." if names else ""


def in_words(words: str, share: float | None) -> str:
    """Progress in parentheses. share: fraction of the work that is done, or None."""
    percent = "" if share is None else f", {share:.0%}"
    return f" ({escape(words)}{percent})"
