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
from ....config.base_config import Config
from ....config.document.reading import config_from_resolved
from ....config.parameters_section import ParametersSection

MAX_VALUE_CHARACTERS = 80
"""Maximum number of characters of a value in a message; longer values are cut."""


VARYING_QUANTITY_PLACEHOLDER = "variable"
"""Stands for the values of an arm's quantity that varies between the points of a config."""


def compared_settings(config: Config) -> dict[str, Any]:
    """`Config.settings_of_results` of `config`. A quantity of the arm that varies between points is
    VARYING_QUANTITY_PLACEHOLDER instead of None, so that None always means that a key is not given."""
    settings = config.settings_of_results
    if "arm" not in settings:
        return settings
    arm = {
        name: VARYING_QUANTITY_PLACEHOLDER if value is None else value
        for name, value in settings["arm"].items()
    }
    return settings | {"arm": arm}


def fingerprint_of(config: dict[str, Any], columns: Sequence[Array]) -> str:
    """SHA-256 of a resolved config and its points: two runs with equal fingerprints have the same results.

    columns: `Points.identifying_arrays`, (n,) each. Raises ValueError for an invalid config.
    """
    parsed = config_from_resolved(config)
    identity = {"meaning": parsed.settings_of_results, "grid": not parsed.parameters.is_list}
    if parsed.parameters.arm_axes:
        identity["over"] = parsed.parameters.arm_axes
    digest = sha256(json.dumps(identity, sort_keys=True).encode())
    for column in columns:
        # The length keeps columns apart whose bytes, joined, would be equal.
        digest.update(len(column).to_bytes(8, "little"))
        # -0.0 becomes 0.0, so that equal values have equal bytes.
        digest.update(np.ascontiguousarray(column + 0.0).tobytes())
    return digest.hexdigest()


def config_change_text(stored: dict[str, Any], given: dict[str, Any]) -> str:
    """Text on the difference of two resolved configs with different fingerprints. stored: config of the file.
    given: config of the run."""
    if stored["task"] != given["task"]:
        return config_difference(stored["task"], given["task"], "task")
    configs = config_from_resolved(stored), config_from_resolved(given)
    axes = [config.parameters.axes for config in configs]
    common = axes[0].keys() & axes[1].keys()
    equal = {name for name in common if np.array_equal(axes[0][name].array(), axes[1][name].array())}
    omitted = {*equal, "points"}
    sections = (config["parameters"] for config in (stored, given))
    written = [{key: value for key, value in section.items() if key not in omitted} for section in sections]
    kinds = [_point_set_kind(config.parameters) for config in configs]
    return (
        config_difference(kinds[0], kinds[1], "parameters")
        or config_difference(written[0], written[1], "parameters")
        or config_difference(compared_settings(configs[0]), compared_settings(configs[1]))
        or "the points listed in parameters.points differ"
    )


def _point_set_kind(parameters: ParametersSection) -> str:
    """Text stating whether the points of the section `parameters` of a config are a grid, a grid over an
    arm's quantities, or a list."""
    if parameters.arm_axes:
        return f"a grid over {' and '.join(parameters.arm_axes)}"
    return "a list of points" if parameters.is_list else "a grid"


def config_difference(
    stored: Any, given: Any, key: str = "", origins: tuple[str, str] = ("the file", "the config")
) -> str:
    """Text with the first key in which two configs differ, and both values; empty for equal configs.

    key: full name of the key of `stored` and `given`. origins: names of the origins of `stored` and `given`.
    """
    if isinstance(stored, dict) and isinstance(given, dict):
        for name in [*given, *(stored_key for stored_key in stored if stored_key not in given)]:
            path = f"{key}.{name}" if key else name
            difference = config_difference(stored.get(name), given.get(name), path, origins)
            if difference:
                return difference
        return ""
    if stored == given:
        return ""
    longest = max(len(json.dumps(value)) for value in (stored, given))
    if isinstance(stored, list) and isinstance(given, list) and longest > MAX_VALUE_CHARACTERS:
        return f"{key} has {_list_difference(stored, given, origins)}"
    texts = [_value_text(value) for value in (stored, given)]
    return f"{key} is {texts[0]} in {origins[0]} and {texts[1]} in {origins[1]}"


def _value_text(value: Any) -> str:
    """A value of a config as text for a message, cut to MAX_VALUE_CHARACTERS characters."""
    if value is None or value == VARYING_QUANTITY_PLACEHOLDER:
        return "not given" if value is None else VARYING_QUANTITY_PLACEHOLDER
    return json.dumps(value)[:MAX_VALUE_CHARACTERS]


def _list_difference(stored: list[Any], given: list[Any], origins: tuple[str, str]) -> str:
    """Text on the difference of the lists `stored` and `given`, which are too long to show: their lengths,
    and the first pair that differs. origins: as in `config_difference`."""
    lengths_text = f"{len(stored)} values in {origins[0]} and {len(given)} in {origins[1]}"
    numbered_pairs = enumerate(zip_longest(stored, given), 1)
    number, values = next((i, pair) for i, pair in numbered_pairs if pair[0] != pair[1])
    stored_text, requested_text = (
        "missing" if value is None else json.dumps(value)[:MAX_VALUE_CHARACTERS] for value in values
    )
    return (
        f"{lengths_text}; value {number} is {stored_text} in {origins[0]} and {requested_text} in "
        f"{origins[1]}"
    )
