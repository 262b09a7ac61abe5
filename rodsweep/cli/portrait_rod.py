"""The rod described by the options of the command `portrait`, and the progress display of its solves."""

import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from ..model.arm.quantities import LOAD_NAMES
from ..model.parameters import PARAMETERS
from ..solve_progress import reporting_to

if TYPE_CHECKING:
    from ..post.rod_portrait.results import DescribedRod
    from ..results.file.view import ResultView
    from ..sweep.progress import ProgressReporter
    from ..tasks.rod_portrait import SolveJobFunction
    from ..tasks.running.job import Job

QUANTITIES_WITHOUT_OPTION = (*LOAD_NAMES, "fluid_density", "density_difference")
"""Quantities of an arm without an option: the portrait varies the load, and the model does not depend on
densities."""

OPTIONS_OF_KEYS = {
    "thresholds.F_max": "--F-max",
    "accuracy": "--accuracy",
    **{f"material.{name}": f"--{name}" for name in ("law", "section", "profile")},
}
"""Options of `rodsweep portrait` by the keys of configs that they set."""


def rod_of_options(
    parameters: Mapping[str, float | None], quantities: Mapping[str, Any], material: Mapping[str, str | None]
) -> "DescribedRod":
    """The rod described by options; InputError for options outside their ranges.

    quantities: quantities of an arm, poisson and segments. material: law, section and profile. Values of
    omitted options are None. A parameter given in addition to an arm replaces the arm's parameter.
    """
    from ..config.parameters_section import DEFAULT_VALUES_OF_PARAMETERS, REQUIRED_PARAMETERS
    from ..model.arm.arm import SlenderArm
    from ..post.rod_portrait.results import DescribedRod
    from .arm_report import with_option_names

    parameter_values = _options_that_are_set(parameters)
    for name, value in parameter_values.items():
        allowed = PARAMETERS[name].allowed_range
        if not allowed.contains(value):
            raise InputError(
                f"--{name} = {value:g} is not allowed; it must be {allowed.description_for_rejected(value)}"
            )
    material_values = _options_that_are_set(material)
    of_arm = _options_that_are_set(quantities)
    if of_arm:
        of_arm |= {name: material_values.pop(name) for name in ("law", "section") if name in material_values}
        if "viscosity" not in of_arm:
            raise InputError("--viscosity is missing; an arm needs the viscosity of its fluid")
        try:
            SlenderArm(**of_arm)
        except InputError as error:
            raise InputError(with_option_names(str(error))) from None
        return DescribedRod(parameters=parameter_values, material=_read_material(material_values), arm=of_arm)
    for name in REQUIRED_PARAMETERS:
        if name not in parameter_values:
            options_text = ", ".join(f"--{option}" for option in REQUIRED_PARAMETERS)
            arm_text = "or the quantities of an arm, such as --length"
            raise InputError(f"--{name} is missing; give {options_text}, {arm_text}")
    values = {name: parameter_values.get(name, DEFAULT_VALUES_OF_PARAMETERS.get(name)) for name in PARAMETERS}
    return DescribedRod(parameters=_options_that_are_set(values), material=_read_material(material_values))


@contextmanager
def portrait_option_names_in_errors() -> Iterator[None]:
    """Within this context, an InputError names the options of `rodsweep portrait` instead of keys of a
    config."""
    try:
        yield
    except InputError as error:
        sentence = str(error)
        key = next((key for key in OPTIONS_OF_KEYS if re.match(rf"{re.escape(key)}\b", sentence)), "")
        raise InputError(OPTIONS_OF_KEYS.get(key, "") + sentence.removeprefix(key)) from None


def _read_material(material: Mapping[str, Any]) -> Any:
    """The section `material` of a config, with the profile read from its file."""
    from ..config.material import with_profile_read

    return with_profile_read({"material": dict(material)}, Path())["material"]


def _options_that_are_set(options: Mapping[str, Any]) -> dict[str, Any]:
    """The options whose value is not None, by name."""
    return {name: value for name, value in options.items() if value is not None}


@contextmanager
def solve_with_progress(
    reporter: "ProgressReporter", solve: "SolveJobFunction"
) -> "Iterator[SolveJobFunction]":
    """Yields `solve` with a progress display: number of solved jobs, and position of a long solve."""
    from ..sweep.progress import display_listener

    job_numbers = count(1)

    def solve_and_show(job: "Job") -> "ResultView":
        name = job.config.task.replace("_", " ")
        with reporting_to(display_listener(reporter, name)):
            view = solve(job)
        reporter(next(job_numbers))
        return view

    reporter(0)
    try:
        yield solve_and_show
    finally:
        reporter.close()
