"""Crushing of the rods of a result file by the force."""

from collections.abc import Iterable

import numpy as np

from ..arrays import Array
from ..config.document.reading import config_from_resolved
from ..errors import InputError
from ..model.crushing import uncrushed_interval
from ..model.material.rod_material import RodMaterial
from ..results.file.view import ResultView
from .branch_curves import followed_parameter, followed_range
from .plane_curves import PlaneParameters
from .range_unions import ParameterRange


def material_of_rods(view: ResultView) -> RodMaterial:
    """Constitutive law and profile of the rods of a file. Raises InputError if this version of rodsweep does
    not accept the config of the file."""
    try:
        return config_from_resolved(view.config).rod_material
    except ValueError as error:
        raise InputError(f"{view.path}: {error}") from None


def uncrushed_ranges(view: ResultView, rods: Iterable[int]) -> list[ParameterRange]:
    """(start, stop) of the part of the followed range in which the force does not crush the rod, for each of
    the rods; stop <= start if the force crushes the rod in the whole range. rods: indices among the points of
    the file.
    """
    range_start, range_end = followed_range(view)
    parameter = followed_parameter(view)
    material = material_of_rods(view)
    columns = {name: values.ravel() for name, values in view.point_columns.items()}
    rods_values = ({name: float(column[index]) for name, column in columns.items()} for index in rods)
    return [uncrushed_interval(material, rod, (parameter, range_start, range_end)) for rod in rods_values]


def crushing_forces(view: ResultView) -> Array:
    """Force that crushes the weakest section of each rod of a file, in k3/L^2, (points,); inf for rubber."""
    columns = view.point_columns
    tapers = columns.get("taper", np.ones_like(columns["k1"]))
    return np.asarray(columns["k1"] * material_of_rods(view).crushing_forces_over_k1(tapers))


def crushing_ratio(view: ResultView, parameters: PlaneParameters, x: Array, y: Array) -> Array:
    """Force divided by the crushing force (zero stretch), at the points x, y of the plane of a phase diagram;
    0 if no force crushes the rod. x, y: values of the parameters, of shapes that broadcast."""
    fixed = {name: np.asarray(values[0]) for name, values in view.parameter_values.items()}
    values = {"taper": np.asarray(1.0)} | fixed | {parameters.line_parameter: x, parameters.row_parameter: y}
    force_per_k1 = material_of_rods(view).crushing_forces_over_k1(values["taper"])
    return np.asarray(values["F"] / (values["k1"] * force_per_k1) + 0 * (x + y))
