"""Shapes and samples of cycles, for figures of files without shapes: the cycles are solved again."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ..config.arm.axes import LOAD_KEYS
from ..config.document.reading import validated_config
from ..errors import EnvironmentIncomplete, InputError
from ..model.arm.drag import DRAG_ESTIMATE_NAMES
from ..results.file.view import ResultView
from ..results.layouts.limit_cycle import ENERGY_VARIABLES, SHAPE_VARIABLES, TIP_VARIABLES
from .running.job import Job, job_of_config

SHAPE_COUNT = 48
"""Number of shapes per period; an animation needs about 50 frames."""
TIP_AND_ENERGY_SAMPLE_COUNT = 256
"""Number of samples of the tip and of the energy per period."""
MAX_PERIOD_DIFFERENCE_IN_ERRORS = 100
"""Two cycles are treated as different if the difference between the stored and the new period exceeds this
multiple of the sum of the estimated errors of both periods."""


def with_shapes(view: ResultView, numbers: Sequence[int]) -> ResultView:
    """A copy of the file's view with shapes and samples of the cycles at some points; NaN at all other
    points.

    numbers: numbers of the points, from 1. Raises InputError if the new cycle of a point differs from the
    stored cycle, which is possible because the initial guess may differ.
    """
    shape = view.variables["status"].shape
    added: dict[str, np.ndarray] = {}
    for number in numbers:
        job, record = _solve_stored_point(view, number)
        for name in (variable.name for variable in SHAPE_VARIABLES + TIP_VARIABLES + ENERGY_VARIABLES):
            values = np.asarray(record[name])
            table = added.setdefault(name, np.full((*shape, *values.shape), np.nan))
            table.reshape(-1, *values.shape)[number - 1] = values
        added |= job.task.coordinates()
    return replace(view, variables=dict(view.variables) | added)


def _solve_stored_point(view: ResultView, number: int) -> tuple[Job, dict[str, Any]]:
    """Solves a point of the file again; returns (job of the point, variables of its cycle). number: number of
    the point, from 1. Raises InputError if the cycle cannot be solved here, or ends in a state that differs
    from the stored state."""
    job = _job_of_point(view, number)
    try:
        solver = job.solver()
        solver.warm_up()
        record = solver.file_values_of_outcome(0, solver.solve(0))
    except EnvironmentIncomplete as lack:
        raise InputError(
            f"{view.path} has no shapes of cycles, and the cycles cannot be solved here: {lack}; run with "
            "limit_cycle.shapes > 0, which stores them"
        ) from None
    names = ("period", "period_error")
    stored_period, error = (float(view.variables[name].ravel()[number - 1]) for name in names)
    allowed = MAX_PERIOD_DIFFERENCE_IN_ERRORS * stored_period * (error + float(record["period_error"]))
    if not abs(float(record["period"]) - stored_period) <= allowed:
        raise InputError(
            f"{view.path} has no shapes of cycles, and point {number}, solved without its neighbour, ends "
            "in a state that differs from the stored state; run with limit_cycle.shapes > 0 to store shapes"
        )
    return job, record


def _job_of_point(view: ResultView, number: int) -> Job:
    """Job that solves one point of the file again with SHAPE_COUNT shapes and TIP_AND_ENERGY_SAMPLE_COUNT
    samples. Parameters, material, accuracy, harmonics and start are taken from the file; unless the start is
    a Hopf point, also amplitude and most_periods. A start from a neighbour becomes a start from the leading
    mode. number: number of the point, from 1."""
    stored = view.config["limit_cycle"]
    is_from_hopf = stored["start"] == "hopf"
    kept_options = ["harmonics"] if is_from_hopf else ["harmonics", "amplitude", "most_periods"]
    options = {
        "shapes": SHAPE_COUNT,
        "samples": TIP_AND_ENERGY_SAMPLE_COUNT,
        "start": "hopf" if is_from_hopf else "mode",
    }
    options |= {name: stored[name] for name in kept_options}
    document = {
        "task": "limit_cycle",
        "parameters": _parameters_section_of_point(view.as_list, number),
        "accuracy": view.config["accuracy"],
        "limit_cycle": options,
    }
    document |= {"material": view.config["material"]} if "material" in view.config else {}
    return job_of_config(Path(view.path.name), validated_config(document), document)


def _parameters_section_of_point(view: ResultView, number: int) -> dict[str, Any]:
    """Section `parameters` of a config with one point of a list of points: the parameters of a rod, or an arm
    and its follower force, with the parameters that the file's config gives in addition to the arm. number:
    number of the point, from 1."""
    point_values = {name: float(column[number - 1]) for name, column in view.point_columns.items()}
    section = view.config["parameters"]
    if "arm" not in section:
        return point_values
    arm: dict[str, Any] = {}
    for key, value in section["arm"].items():
        if key in LOAD_KEYS:
            continue
        # An axis of a quantity; the names of a law, a section or segments are no axes.
        values = view.quantities[key].ravel() if isinstance(value, dict) else None
        arm[key] = value if values is None else float(values[number - 1 if values.size > 1 else 0])
    if "drag" in arm:
        arm["drag"] = DRAG_ESTIMATE_NAMES[int(arm["drag"])]
    given_values = {name: value for name, value in point_values.items() if name == "F" or name in section}
    return given_values | {"arm": arm}
