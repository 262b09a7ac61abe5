"""Thresholds of stability of the straight rod along a parameter, in `rodsweep show`."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from ...results.file.view import ResultView
from ...sweep.points.points import ParameterLine, lines_along
from ...wording import count_of_total, counted
from ..located_thresholds import BracketedThreshold, LocatedThreshold
from .arm.arm_texts import arm_threshold_sentences
from .number_texts import error_text, rounded_number_and_total_error

MAX_POINT_LINES_LISTED_ONE_BY_ONE = 3
"""The thresholds of up to this number of lines of points are listed one by one; for more lines the range is
printed."""
FORCE_THRESHOLD_WORDS = {
    "onset": "F* (straight rod starts to oscillate, still stable)",
    "hopf": "F** (straight rod starts to flutter)",
    "restabilization": "restabilization (straight rod is stable again)",
}
"""Phrase for a threshold along F, by kind."""
NON_FORCE_THRESHOLD_WORDS = {
    "hopf": "the straight rod starts to flutter, as {name} grows, at {name}",
    "restabilization": "the straight rod is stable again, as {name} grows, at {name}",
}
"""Phrase for a threshold along any parameter other than F, by kind."""
LocatedOrBracketedThreshold = LocatedThreshold | BracketedThreshold
"""A threshold of the straight rod: located, or bracketed by two points of the file."""


def rod_and_arm_stability_lines(
    view: ResultView,
    name: str,
    thresholds_on: Callable[[ParameterLine], Sequence[LocatedOrBracketedThreshold]],
) -> tuple[list[str], list[str]]:
    """Returns (sentences, sentences in an arm's units), one for each kind of threshold along the parameter
    `name`. The second list is empty unless the parameter is F; both lists are empty if the parameter does not
    vary.

    thresholds_on: function that returns the thresholds on a line of points.
    """
    column = view.point_columns[name]
    if len(np.unique(column[np.isfinite(column)])) < 2:
        return [], []
    lines = list(lines_along(view.point_columns, name))
    varied = [
        parameter_name
        for parameter_name in lines[0].other_parameters
        if len({line.other_parameters[parameter_name] for line in lines}) > 1
    ]
    parameter_texts = [
        ", ".join(
            f"{parameter_name} = {line.other_parameters[parameter_name]:.6g}" for parameter_name in varied
        )
        for line in lines
    ]
    by_line = [thresholds_on(line) for line in lines]
    searched_count = sum(len(line.indices) > 1 for line in lines)
    texts = list[str]()
    arm_sentences = list[str]()
    for kind, phrase in (FORCE_THRESHOLD_WORDS if name == "F" else NON_FORCE_THRESHOLD_WORDS).items():
        kind_points = [[point for point in points if point.kind == kind] for points in by_line]
        if points_of_line := {i: points for i, points in enumerate(kind_points) if points}:
            places_text = _positions_text(points_of_line, parameter_texts, searched_count, name)
            texts.append(f"{phrase.format(name=name)}: {places_text}")
            pairs = [(point, lines[i].indices) for i, points in points_of_line.items() for point in points]
            located = [(point, indices) for point, indices in pairs if isinstance(point, LocatedThreshold)]
            arm_sentences += arm_threshold_sentences(view, kind, located) if name == "F" else []
    return texts, arm_sentences


def _positions_text(
    by_line: Mapping[int, list[LocatedOrBracketedThreshold]],
    names: list[str],
    searched_count: int,
    parameter_name: str,
) -> str:
    """Positions of thresholds as text: one by one for a few lines of points, otherwise as a range.
    parameter_name: parameter along the lines. by_line: thresholds by index of the line. names: text for each
    line. searched_count: number of lines with at least two points; a threshold of any other line is not
    known."""
    points = [point for line in by_line.values() for point in line]
    located = [point for point in points if isinstance(point, LocatedThreshold)]
    errors = [rounded_number_and_total_error(point.position, point.position_error)[1] for point in located]
    error_clause = f" (+- {error_text(max(errors))})" if errors else ""
    count_text = count_of_total(len(by_line), searched_count, "line")
    lines_text = f", found on {count_text} of points along {parameter_name}"
    lines_text *= len(by_line) < len(names)
    if len(located) == len(points) and all(point.equals_within_errors(located[0]) for point in located):
        frequency = located[0].frequency
        rate_text = f", frequency {frequency:.6g} rad/tau2" if np.isfinite(frequency) else ""
        return _position_text(located[0]) + error_clause + lines_text + rate_text
    if len(by_line) <= MAX_POINT_LINES_LISTED_ONE_BY_ONE:
        texts = ((" and ".join(map(_position_text, by_line[i])), names[i]) for i in by_line)
        return f"{', '.join(' for '.join(filter(None, pair)) for pair in texts)}{error_clause}"
    bracketed = [point for point in points if isinstance(point, BracketedThreshold)]
    if not located:
        lowest = min(point.low for point in bracketed)
        highest = max(point.high for point in bracketed)
        return f"between {lowest:.6g} and {highest:.6g}{lines_text}"
    ends = (choice(located, key=lambda point: point.position) for choice in (min, max))
    text = f"{' to '.join(map(_position_text, ends))}{error_clause}{lines_text}"
    if bracketed:
        text += f"; {counted(len(bracketed), 'further threshold')} known only to lie between two points"
    return text


def _position_text(threshold: LocatedOrBracketedThreshold) -> str:
    """Position of a threshold as text, rounded according to its error; for a bracketed threshold, both
    ends."""
    if isinstance(threshold, BracketedThreshold):
        return f"between {threshold.low:.6g} and {threshold.high:.6g}"
    return rounded_number_and_total_error(threshold.position, threshold.position_error)[0]
