"""The two parameters of the plane of a phase diagram in a result file, and the curves in the plane."""

from typing import NamedTuple

import numpy as np

from ..arrays import Array
from ..model.parameters import NON_OPTIONAL_LINEAR_PARAMETER_NAMES
from ..results.file.view import ResultView


class PlaneParameters(NamedTuple):
    """Names of the parameters of a phase diagram. line_parameter: parameter that varies along a row.
    row_parameter: parameter that is constant on a row."""

    line_parameter: str
    row_parameter: str


def plane_parameters(view: ResultView) -> PlaneParameters:
    """Names of the parameters of a phase diagram."""
    line = next(name for name in NON_OPTIONAL_LINEAR_PARAMETER_NAMES if name not in view.parameters)
    row = next((name for name in view.parameters if len(view.parameter_values[name]) > 1), view.parameters[0])
    return PlaneParameters(line, row)


def points_by_curve(
    view: ResultView, parameters: PlaneParameters, prefix: str, kind: int | None = None
) -> dict[int, Array]:
    """Points (line parameter, row parameter) of each curve of a phase diagram, (n, 2), by number of the
    curve. prefix: "curve" for boundary curves, "cycle_curve" for curves of special points of cycles. kind:
    code of the kind of the curves; None: all kinds."""
    variables = view.variables
    numbers = variables[f"{prefix}_number"]
    chosen_numbers = numbers if kind is None else numbers[variables[f"{prefix}_kind"] == kind]
    points = np.stack([variables[f"{prefix}_{name}"] for name in parameters], axis=-1)
    return {number: points[numbers == number] for number in np.unique(chosen_numbers).tolist()}
