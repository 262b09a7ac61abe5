"""Constitutive law, profile and segments of the arms of a result file, as text for summaries and figures."""

from collections.abc import Mapping
from typing import Any

from ..results.file.view import ResultView
from ..wording import counted


def material_keys_of(view: ResultView) -> Mapping[str, Any]:
    """Law, section, profile and segments of the arms of a file, by key, if the section `material` of the
    config or the arm has these keys; empty for uniform arms of linear material."""
    arm = view.config.get("parameters", {}).get("arm") or {}
    section = dict(view.config.get("material") or {}) | {name: value for name, value in arm.items() if value}
    shape_keys = {name: section[name] for name in ("profile", "segments") if section.get(name)}
    if section.get("law", "linear") != "linear":
        shape_keys |= {"law": section["law"], "section": section.get("section", "fixed")}
    return shape_keys


def material_words(view: ResultView) -> str:
    """Law, profile and segments in a few words, for figures; empty for uniform arms of linear material."""
    section = material_keys_of(view)
    phrases = [f"neo-Hookean, {section['section']} section"] if "law" in section else []
    phrases += ["with a profile"] if "profile" in section else []
    phrases += [f"in {counted(len(section['segments']), 'segment')}"] if "segments" in section else []
    return ", ".join(phrases)


def material_lines(view: ResultView) -> list[str]:
    """Lines on law, profile and segments, for summaries; empty for uniform arms of linear material."""
    section = material_keys_of(view)
    lines = []
    if "law" in section:
        lines.append(f"material: neo-Hookean rubber with a {section['section']} section")
    if "profile" in section:
        columns = {name: values for name, values in section["profile"].items() if isinstance(values, list)}
        rows_text = counted(len(columns.pop("u")), "row")
        lines.append(f"profile of {rows_text} along the arm: {', '.join(columns)}")
    if "segments" in section:
        lines += [f"segment {number}, {text}" for number, text in enumerate(section["segments"], 1)]
    return lines
