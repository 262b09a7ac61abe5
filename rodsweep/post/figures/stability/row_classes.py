"""Stability classes along the rows of a phase diagram, between the located crossings."""

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ....arrays import Array, list_of
from ....model.crushing import uncrushed_interval
from ....model.material.rod_material import RodMaterial
from ....results.file.view import ResultView
from ....results.layouts.phase_diagram import STABILITY_CLASSES, STABLE_STATES
from ....results.layouts.thresholds import CROSSING_KINDS, HOPF_CROSSING_CODES
from ....results.layouts.variables import stored_number_of_word
from ...crushing import material_of_rods
from ...plane_curves import PlaneParameters

CLASS_WORDS = {"class": STABILITY_CLASSES, "stable_states": STABLE_STATES}
"""(code, word) of the values of the variables `class` and `stable_states`, by variable."""
ONSET_CODE = CROSSING_KINDS.index("onset")
"""Code of an onset of oscillations."""
MIN_RELATIVE_CLASS_CHANGE_DISTANCE = 1e-9
"""A point closer to a change of class than this relative distance is not used, because its class is
uncertain."""
STABLE_CLASS_ABOVE_CROSSING = {
    "onset": "oscillatory",
    "restabilization": "oscillatory",
    "real_again": "monotone",
    "real_leads": "monotone",
    "pair_leads": "oscillatory",
}
"""Class of a rod without unstable modes at forces just above a crossing, by kind of the crossing."""


def classes_between_crossings(
    view: ResultView, parameters: PlaneParameters
) -> tuple[Array, Array, NDArray[np.intp]]:
    """Returns (x, y, classes), (n,) each: points of a phase diagram whose stability class follows from the
    crossings on their row, even where the crossings are close. They are the midpoints between neighbouring
    crossings, and between the outermost crossings and the ends of the row or the force that crushes the rod.

    x: values of the parameter along a row. y: values of the parameter that is constant on a row. The part
    before the first crossing has a point only if a stable rod begins to oscillate at this crossing, the part
    behind the last stored crossing only if all crossings are stored and no range of the row is undecided.
    Rows with an infinite y are left out.
    """
    names = ("crossing_kind", "unstable_after", "crossing_at", "crossing_count", "open_from")
    kinds, unstable_counts, positions, counts, undecided_from = map(view.flattened_by_point, names)
    values = view.point_columns[parameters.row_parameter]
    material = material_of_rods(view)
    rows: list[tuple[float, float, int]] = []
    for index in np.flatnonzero(np.isfinite(values)):
        stored_indices = np.flatnonzero(kinds[index] > 0)
        if not len(stored_indices):
            continue
        low, high = _uncrushed_range_of_row(view, material, parameters, int(index))
        ends = [low, *list_of(positions[index, stored_indices]), high]
        crossings = [(int(kinds[index, i]), int(unstable_counts[index, i])) for i in stored_indices]
        curve_words = ["monotone" if crossings[0] == (ONSET_CODE, 0) else ""]
        curve_words += [class_above_crossing(*crossing) for crossing in crossings]
        if len(stored_indices) < counts[index] or np.isfinite(undecided_from[index]):
            curve_words[-1] = ""
        for word, (start, end) in zip(curve_words, pairwise(ends), strict=True):
            if word and start < end:
                rows.append(
                    ((start + end) / 2, float(values[index]), stored_number_of_word(word, STABILITY_CLASSES))
                )
    x, y, classes = np.array(rows, dtype=float).reshape(-1, 3).T
    return x, y, classes.astype(np.intp)


def _uncrushed_range_of_row(
    view: ResultView, material: RodMaterial, parameters: PlaneParameters, index: int
) -> tuple[float, float]:
    """Returns (first, last): the interval of the parameter along the row with the index `index` in which the
    force does not crush the rod."""
    rod = {name: float(column[index]) for name, column in view.point_columns.items()}
    row_start, row_end = list_of(view.variables[parameters.line_parameter][[0, -1]])
    return uncrushed_interval(material, rod, (parameters.line_parameter, row_start, row_end))


def class_above_crossing(kind: int, unstable: int) -> str:
    """Class of a rod at F just above a crossing. kind: index of the kind in CROSSING_KINDS. unstable: number
    of unstable modes above the crossing; -1 if unknown."""
    stable = STABLE_CLASS_ABOVE_CROSSING.get(CROSSING_KINDS[kind], "undecided")
    if unstable > 0:
        return "flutter"
    return stable if unstable == 0 else "undecided"


def pixel_classes_of_row(
    view: ResultView, variable: str, parameters: PlaneParameters, index: int, pixel_edges: Array
) -> NDArray[np.intp]:
    """Class of each pixel of the row with the index `index` in a diagram, (n,). variable: `class` or
    `stable_states`. pixel_edges: edges of the pixels, (n + 1,).

    A pixel has the class of the nearest computed point between the same two changes of class; "undecided" if
    there is no such point.
    """
    x = view.variables[parameters.line_parameter]
    classes = view.flattened_by_point(variable)[index]
    changes = _class_change_positions(view, variable, parameters, index)
    if variable == "class":
        positions, rows, classified = classes_between_crossings(view, parameters)
        is_in_row = rows == view.parameter_values[parameters.row_parameter][index]
        x = np.append(x, positions[is_in_row])
        classes = np.append(classes, classified[is_in_row])
    decided = np.abs(x[:, None] - changes).min(
        axis=1, initial=np.inf
    ) > MIN_RELATIVE_CLASS_CHANGE_DISTANCE * np.abs(x)
    pixels = (pixel_edges[1:] + pixel_edges[:-1]) / 2
    piece_of_pixels = np.searchsorted(changes, pixels)
    piece_of_points = np.searchsorted(changes, x)
    classified = np.full(
        len(pixels), stored_number_of_word("undecided", CLASS_WORDS[variable]), dtype=np.intp
    )
    for piece_number in np.unique(piece_of_pixels):
        own_pixels = piece_of_pixels == piece_number
        own_points = decided & (piece_of_points == piece_number)
        if own_points.any():
            nearest_point = np.abs(x[own_points] - pixels[own_pixels][:, None]).argmin(axis=1)
            classified[own_pixels] = classes[own_points][nearest_point]
    return classified


def _class_change_positions(
    view: ResultView, variable: str, parameters: PlaneParameters, index: int
) -> Array:
    """Positions of the changes of class along the row with the index `index`, in increasing order, (m,).
    variable: `class` or `stable_states`."""
    names = ("crossing_at", "crossing_kind", f"cycle_special_{parameters.line_parameter}")
    values_by_name = {name: view.flattened_by_point(name)[index] for name in names if name in view.variables}
    positions = values_by_name["crossing_at"]
    kinds = values_by_name["crossing_kind"]
    if variable == "class":
        change_positions = [positions[kinds > 0]]
    else:
        change_positions = [
            positions[np.isin(kinds, HOPF_CROSSING_CODES)],
            values_by_name[f"cycle_special_{parameters.line_parameter}"],
        ]
    row_ends = view.variables[parameters.line_parameter][[0, -1]]
    ends = np.array(_uncrushed_range_of_row(view, material_of_rods(view), parameters, index))
    changes = np.concatenate([*change_positions, ends[ends != row_ends]])
    return np.unique(changes[np.isfinite(changes)])
