"""Text "solving ..." on the page, with the kinds of questions being solved and their progress."""

from collections.abc import Mapping, Sequence
from html import escape

KIND_WORDS = {"cycles": "folds and torus points", "growth": "growth rates", "branch": "branches"}
"""Words for a kind of question in the text "solving ..."; an unlisted kind stands for itself."""


def solving_text(kinds: Sequence[str], progress: Mapping[str, str]) -> str:
    """Text "solving ..." for the given kinds of questions; empty without any. progress: progress as text, by
    kind.
    """
    names = [KIND_WORDS.get(kind, kind) + progress.get(kind, "") for kind in kinds]
    return f"solving {', '.join(names)} ..." if names else ""


def progress_text(words: str, share: float | None) -> str:
    """Progress of a solve as text in parentheses. share: fraction of the work that is done; None
    if unknown.
    """
    percent = "" if share is None else f", {share:.0%}"
    return f" ({escape(words)}{percent})"
