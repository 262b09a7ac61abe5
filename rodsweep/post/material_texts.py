"""Constitutive law, profile and segments of the arms of a result file, as text for summaries and figures."""

from collections.abc import Mapping
from typing import Any

from ..results.file.view import View
from ..wording import counted


def material_of(view: View) -> Mapping[str, Any]:
    """The given keys of law, section, profile and segments of the arms of a file, in the section `material`
    of the config or in the arm; empty for uniform arms of linear material."""
    given = dict(view.config.get("material") or {})
    given |= {
        name: value for name, value in (view.config.get("parameters", {}).get("arm") or {}).items() if value
    }
    chosen = {name: given[name] for name in ("profile", "segments") if given.get(name)}
    if given.get("law", "linear") != "linear":
        chosen |= {name: given.get(name, default) for name, default in (("law", ""), ("section", "fixed"))}
    return chosen


def material_words(view: View) -> str:
    """Law, profile and segments in a few words, for figures; empty for uniform arms of linear material."""
    given = material_of(view)
    words = [f"neo-Hookean, {given['section']} section"] if "law" in given else []
    words += ["with a profile"] if "profile" in given else []
    words += [f"in {counted(len(given['segments']), 'segment')}"] if "segments" in given else []
    return ", ".join(words)


def material_lines(view: View) -> list[str]:
    """Lines on law, profile and segments, for summaries; empty for uniform arms of linear material."""
    given = material_of(view)
    lines = []
    if "law" in given:
        lines.append(f"material: neo-Hookean rubber with a {given['section']} section")
    if "profile" in given:
        columns = {name: values for name, values in given["profile"].items() if isinstance(values, list)}
        rows = counted(len(columns.pop("u")), "row")
        lines.append(f"profile of {rows} along the arm: {', '.join(columns)}")
    if "segments" in given:
        lines += [
            f"segment {number}, {text}" for number, text in enumerate(map(str, given["segments"]), start=1)
        ]
    return lines
