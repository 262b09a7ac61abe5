"""Comparison of configs: whether two configs request the same results, and a text on their difference.

Configs are compared by `Config.settings_of_results`. The notation of an axis, the title, the name of a list
of points, and unused options are not compared.
"""

import json
from collections.abc import Sequence
from hashlib import sha256
from itertools import zip_longest
from typing import Any

import numpy as np

from ....arrays import Array
from ....config.document.reading import config_from_resolved
from ....config.parameters_section import Axes

LONGEST_VALUE = 80
"""Maximum number of characters of a value in a message; longer values are cut."""


def fingerprint_of(config: dict[str, Any], columns: Sequence[Array]) -> str:
    """SHA-256 of a resolved config and its points: two runs with equal fingerprints have the same results.

    columns: `Points.identifying_arrays`, (n,) each. Raises ValueError for an invalid config.
    """
    asked = config_from_resolved(config)
    identity = {"meaning": asked.settings_of_results, "grid": not asked.parameters.is_list}
    if asked.parameters.arm_axes:
        identity["over"] = asked.parameters.arm_axes
    digest = sha256(json.dumps(identity, sort_keys=True).encode())
    for column in columns:
        digest.update(len(column).to_bytes(8, "little"))
        # -0.0 becomes 0.0, so that equal values have equal bytes.
        digest.update(np.ascontiguousarray(column + 0.0).tobytes())
    return digest.hexdigest()


def config_change_text(theirs: dict[str, Any], ours: dict[str, Any]) -> str:
    """Text on the difference of two resolved configs with different fingerprints. theirs: config of the file.
    ours: config of the run.
    """
    if theirs["task"] != ours["task"]:
        return config_difference(theirs["task"], ours["task"], "task")
    configs = config_from_resolved(theirs), config_from_resolved(ours)
    axes = [config.parameters.axes for config in configs]
    shared = axes[0].keys() & axes[1].keys()
    same = {name for name in shared if np.array_equal(axes[0][name].array(), axes[1][name].array())}
    written = [
        {name: value for name, value in config["parameters"].items() if name not in same and name != "points"}
        for config in (theirs, ours)
    ]
    kinds = [_point_set_kind(config.parameters) for config in configs]
    return (
        config_difference(kinds[0], kinds[1], "parameters")
        or config_difference(written[0], written[1], "parameters")
        or config_difference(configs[0].settings_of_results, configs[1].settings_of_results)
        or "the points listed in parameters.points differ"
    )


def _point_set_kind(parameters: Axes) -> str:
    """Text stating whether the points of a config are a grid, a grid over an arm's quantities, or a list."""
    if parameters.arm_axes:
        return f"a grid over {' and '.join(parameters.arm_axes)}"
    return "a list of points" if parameters.is_list else "a grid"


def config_difference(
    theirs: Any, ours: Any, key: str = "", places: tuple[str, str] = ("the file", "the config")
) -> str:
    """Text with the first key in which two configs differ, and both values; empty for equal configs.

    key: full name of the key of `theirs` and `ours`. places: names of the origins of `theirs` and `ours`.
    """
    if isinstance(theirs, dict) and isinstance(ours, dict):
        for name in [*ours, *(n for n in theirs if n not in ours)]:
            inner = f"{key}.{name}" if key else name
            found = config_difference(theirs.get(name), ours.get(name), inner, places)
            if found:
                return found
        return ""
    if theirs == ours:
        return ""
    texts = json.dumps(theirs), json.dumps(ours)
    if isinstance(theirs, list) and isinstance(ours, list) and max(map(len, texts)) > LONGEST_VALUE:
        return f"{key} has {_list_difference(theirs, ours, places)}"
    shown = [f"{text[:LONGEST_VALUE]} in {place}" for text, place in zip(texts, places, strict=True)]
    return f"{key} is {shown[0]} and {shown[1]}"


def _list_difference(theirs: list[Any], ours: list[Any], places: tuple[str, str]) -> str:
    """Difference of two lists that are too long to show: their lengths, and the first pair that differs.
    places: names of the origins of `theirs` and `ours`.
    """
    sizes = f"{len(theirs)} values in {places[0]} and {len(ours)} in {places[1]}"
    pairs = enumerate(zip_longest(theirs, ours), 1)
    number, values = next((i, pair) for i, pair in pairs if pair[0] != pair[1])
    first, second = ("missing" if v is None else json.dumps(v)[:LONGEST_VALUE] for v in values)
    return f"{sizes}; value {number} is {first} in {places[0]} and {second} in {places[1]}"
