"""Special points of cycles on the rows of a phase diagram (a row: all points with one value of the second
parameter), the rows on which curves of folds or torus points reveal further branches of cycles, and the
corresponding variables of the file."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ...results.file.view import ResultView
from ...results.layouts.detached_branches import DETACHED_ROW_VARIABLES_BY_NAME, LOST_CURVE_ENDS_VARIABLE
from ...results.layouts.variables import FilledVariable
from ..protocol import NamedArrays

if TYPE_CHECKING:
    from ...solve.branch.coexistence import CoexistenceRow
    from ...solve.branch.special.special_point import RowSpecialPoint

COMPLETE_ROW_STATUS = "ok"
"""Status of the rows of a diagram on which every branch from a Hopf point is followed to its end, and all
special points are located. On other rows a special point might be taken for a special point of another
branch."""
ROW_MESSAGE_ARRAY_NAME = "message"
"""Name of the array with the message, as bytes, in the result of a row that was solved again."""


def named_arrays_of_solved_row(row: "CoexistenceRow", record: Mapping[str, Any]) -> NamedArrays:
    """Result of a row of the diagram that was solved again, as named arrays with its message. record:
    variables of the row, by name."""
    values = {name: np.asarray(value) for name, value in record.items()}
    return values | {ROW_MESSAGE_ARRAY_NAME: np.frombuffer(row.message.encode(), np.uint8)}


def row_message(result: NamedArrays) -> str:
    """Message of a row of the diagram that was solved again, from its result."""
    return result[ROW_MESSAGE_ARRAY_NAME].tobytes().decode()


def special_points_of_rows(
    view: ResultView, line_parameter: str, rows: np.ndarray
) -> "list[RowSpecialPoint]":
    """Folds and torus points of all rows of the diagram with a finite value of the row parameter. view: the
    file with all rows. line_parameter: name of the parameter that varies along a row. rows: value of the row
    parameter, (rows,)."""
    columns = {name: view.flattened_by_point(name) for name in _special_point_names(line_parameter)}
    return [
        point
        for i in np.flatnonzero(np.isfinite(rows))
        for point in special_points_of_row(
            {name: column[i] for name, column in columns.items()}, line_parameter, int(i), float(rows[i])
        )
    ]


def special_points_of_row(
    values: Mapping[str, np.ndarray], line_parameter: str, row_index: int, row_value: float
) -> "list[RowSpecialPoint]":
    """Folds and torus points of one row of the diagram. values: variables of the row by name, of shape
    (special points,). line_parameter: name of the parameter that varies along the row. row_index, row_value:
    index of the row, and value of the row parameter."""
    from ...solve.branch.special.special_curve_tracer import FOLLOWED_KIND_NOUNS
    from ...solve.branch.special.special_point import RowSpecialPoint, SpecialPointKind

    kinds, positions, period, height = (values[name] for name in _special_point_names(line_parameter))
    return [
        RowSpecialPoint(
            row_index=row_index,
            row_parameter_value=row_value,
            kind=SpecialPointKind(int(kinds[item])),
            parameter_value=float(positions[item]),
            period=float(period[item]),
            tip_y_max=float(height[item]),
        )
        for item in np.flatnonzero(np.isin(kinds, tuple(FOLLOWED_KIND_NOUNS)))
    ]


def _special_point_names(line_parameter: str) -> list[str]:
    """Names of the variables with kind, parameter value, period and largest tip y of the special points on a
    row. line_parameter: name of the parameter that varies along a row."""
    return [f"cycle_special_{name}" for name in ("kind", line_parameter, "period", "tip_y_max")]


def rows_with_branches_across_limits(
    view: ResultView, line_parameter: str, rows: Mapping[int, float], limits: tuple[float, float]
) -> dict[int, float]:
    """The rows of `rows` with branches that leave or enter the range `limits` of `line_parameter`. rows,
    result: value of the row parameter by index of the row. view: the file with all rows. line_parameter: name
    of the parameter that varies along a row."""
    from ...solve.branch.special.special_curves import CURVE_IDENTITY_SETTINGS
    from ...solve.branch.special.special_point import SpecialPointKind

    kinds, positions = (
        view.flattened_by_point(name) for name in ("cycle_special_kind", f"cycle_special_{line_parameter}")
    )
    distances = np.abs(positions[..., None] - limits)
    is_at_limit = (
        distances <= CURVE_IDENTITY_SETTINGS.max_distance_from_curve_per_row_length * np.ptp(limits)
    ).any(axis=-1)
    is_leaving = ((kinds == SpecialPointKind.end) & is_at_limit).any(axis=1)
    return {row: value for row, value in rows.items() if is_leaving[row]}


def rows_changed_when_solved_again(
    view: ResultView, solved_again: Mapping[int, NamedArrays]
) -> dict[int, NamedArrays]:
    """The rows of `solved_again` whose number of special points, or whose status, differs from the file.
    view: the file with all rows of the diagram. solved_again: results of rows, by index of the row."""
    counts = view.flattened_by_point("cycle_special_count")
    statuses = view.variables["status"].ravel()
    return {
        row: values
        for row, values in solved_again.items()
        if int(values["cycle_special_count"]) != counts[row] or int(values["status"]) != statuses[row]
    }


def lost_curve_end_count_values(lost_end_count: int) -> list[FilledVariable]:
    """Variable with the number `lost_end_count` of ends of fold curves that were lost beyond the range of the
    diagram, in a list; [] for 0."""
    return [(LOST_CURVE_ENDS_VARIABLE, np.array(lost_end_count))] if lost_end_count else []


def detached_branch_values(view: ResultView, changed: Mapping[int, NamedArrays]) -> list[FilledVariable]:
    """Variables about the rows of the diagram on which further branches of cycles were found; [] if there are
    none. view: the file with all rows. changed: new results of these rows, by index of the row."""
    if not changed:
        return []
    stored_counts = view.flattened_by_point("cycle_special_count")
    values = (
        [row + 1 for row in changed],
        [int(result["cycle_special_count"]) - int(stored_counts[row]) for row, result in changed.items()],
    )
    return [
        (variable, np.array(column))
        for variable, column in zip(DETACHED_ROW_VARIABLES_BY_NAME.values(), values, strict=True)
    ]
