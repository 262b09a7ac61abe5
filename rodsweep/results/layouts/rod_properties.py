"""Properties of the rods of a resolved config on which the variables of its result file depend."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from ...model.parameters import OPTIONAL_PARAMETER_NAMES
from .variables import Variable


def optional_parameters_in(config: Mapping[str, Any]) -> tuple[str, ...]:
    """Names of the optional parameters that have an axis or a column in a resolved config."""
    parameters = config["parameters"]
    names = (*parameters, *parameters.get("columns", ()))
    return tuple(name for name in OPTIONAL_PARAMETER_NAMES if name in names)


def has_estimated_counts(config: Mapping[str, Any]) -> bool:
    """Whether counts of unstable modes are estimates, as for rods that vary along their length."""
    parameters = config.get("parameters", {})
    arm = parameters.get("arm", {})
    taper = parameters.get("taper")
    tapered = "tip_radius" in arm if taper is None else taper.get("values") != [1.0]
    tapered = tapered or "taper" in parameters.get("columns", ())
    is_taper_followed = config.get("branch", {}).get("along") == "taper"
    return tapered or is_taper_followed or "segments" in arm or "profile" in config.get("material", {})


def has_uniform_linear_rods(config: Mapping[str, Any]) -> bool:
    """Whether all rods are uniform and of linear material. Only then can a cover of the (eigenvalue,
    parameter) region by boxes prove that the list of crossings is complete."""
    return has_linear_law(config) and not has_estimated_counts(config)


def has_linear_law(config: Mapping[str, Any]) -> bool:
    """Whether all rods of a resolved config have the linear constitutive law."""
    sections = (config.get("material", {}), config.get("parameters", {}).get("arm", {}))
    return all(section.get("law", "linear") == "linear" for section in sections)


def with_certified_long_name(
    variables: tuple[Variable, ...], config: Mapping[str, Any], noun: str
) -> tuple[Variable, ...]:
    """The variables; if completeness cannot be proved for the rods by a cover of boxes, with a long name of
    `certified` that describes confirmation by counts only.

    noun: name of the listed items, such as "Hopf points".
    """
    if has_uniform_linear_rods(config):
        return variables
    meaning = (
        f"whether counts of unstable modes confirm the list of {noun}; between the counts it rests on "
        "slopes of the eigenvalues"
    )
    return with_long_name(variables, "certified", meaning)


def with_long_name(variables: tuple[Variable, ...], name: str, meaning: str) -> tuple[Variable, ...]:
    """The variables, with the long name `meaning` for the variable `name`."""
    return tuple(
        replace(variable, long_name=meaning) if variable.name == name else variable for variable in variables
    )
