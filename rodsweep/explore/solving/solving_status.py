"""Text "solving ..." on the page, with the kinds of questions being solved and their progress."""

from collections.abc import Mapping, Sequence
from html import escape

KIND_WORDS = {"cycles": "folds and torus points", "growth": "growth rates", "branch": "branches"}
"""Name of a kind of question in the text "solving ..."; a kind that is not listed is its own name."""


def solving_text(kinds: Sequence[str], progress: Mapping[str, str]) -> str:
    """Text "solving ..." for the given kinds of questions; empty if `kinds` is empty. progress: progress as
    text, by kind.
    """
    names = [KIND_WORDS.get(kind, kind) + progress.get(kind, "") for kind in kinds]
    return f"solving {', '.join(names)} ..." if names else ""


def progress_text(words: str, completed_fraction: float | None) -> str:
    """Progress of a solve as text in parentheses. words: present step of the solve. completed_fraction:
    completed fraction of the work; None if unknown.
    """
    percent = "" if completed_fraction is None else f", {completed_fraction:.0%}"
    return f" ({escape(words)}{percent})"
