"""Names and variables of the tables of a result: a table of points, and a table for each list.

Each row of a list has the parameters and the status of its point. The table `grid` contains the grid points
of a phase diagram; the points of the file are then the rows of the diagram.
"""

from dataclasses import dataclass

from ...config.document.refusals import unknown_key_hint
from ...errors import InputError
from ...model.parameters import PARAMETERS
from ...results.file.view import ResultView
from ...results.layouts import layout_of, sweep_wide_variables
from ...results.layouts.variables import Variable

KNOWN_NAMES_PHRASE = "there are"
"""Phrase before the list of known names in an error message."""
POINTS_TABLE = "points"
"""Name of the table with one row for each point of the file."""
GRID_TABLE = "grid"
"""Name of the table of grid points of a phase diagram."""
BRANCHES_TABLE = "branches"
"""Name of the table of cycles and special points in their order on the branches."""
BRANCHES_TABLE_PARTS = {"cycles", "special_points"}
"""Names of the two tables that the table `branches` merges."""
TABLE_NAMES = {
    ("mode",): "modes",
    ("mode", "u"): "mode_shapes",
    ("crossing",): "crossings",
    ("branch_point",): "cycles",
    ("special",): "special_points",
    ("cycle_special",): "cycle_special_points",
    ("curve_point",): "curves",
    ("fold",): "folds",
    ("hopf",): "hopf_points",
    ("change",): "force_changes",
    ("cycle_curve_point",): "cycle_curves",
    ("cycle_extremum",): "cycle_curve_extrema",
    ("cycle_detached",): "cycle_detached_rows",
    ("bautin",): "generalised_hopf_points",
    ("bautin_step",): "generalised_hopf_curves",
    ("harmonic",): "harmonics",
    ("multiplier_number",): "multipliers",
    ("sample",): "samples",
    ("shape", "u"): "shapes",
    ("transient",): "motion",
}
"""Name of a table, by its dimensions other than the dimensions of the points."""
DEFAULT_TABLE = {
    "spectrum": "modes",
    "modes": "modes",
    "thresholds": POINTS_TABLE,
    "criticality": "crossings",
    "phase_diagram": GRID_TABLE,
    "limit_cycle": POINTS_TABLE,
    "branch": BRANCHES_TABLE,
}
"""Name of the default table, by task."""


@dataclass(frozen=True, slots=True)
class TableContents:
    """Variables of a result, divided into tables.

    point_variables: variables with one value per point, which are columns of all tables except sweep-wide
    lists. variables_by_list: variables of each list, by name of the table. sweep_wide_lists: names of lists
    that belong to the whole file, not to single points."""

    point_variables: tuple[Variable, ...]
    variables_by_list: dict[str, tuple[Variable, ...]]
    sweep_wide_lists: frozenset[str]

    @property
    def table_names(self) -> tuple[str, ...]:
        """Names of all tables of the result."""
        branches = (BRANCHES_TABLE,) if self.variables_by_list.keys() >= BRANCHES_TABLE_PARTS else ()
        return (POINTS_TABLE, *branches, *self.variables_by_list)

    def dimensions_of_list(self, table: str) -> tuple[str, ...]:
        """Dimensions of the list `table` other than the dimensions of the points; empty for a table that is
        no list."""
        return self.variables_by_list[table][0].extra_dimensions if table in self.variables_by_list else ()


def table_contents_of(view: ResultView) -> TableContents:
    """Names and variables of the tables of a result."""
    config = view.config
    point_variables: list[Variable] = []
    lists: dict[str, list[Variable]] = {}
    for variable in layout_of(config).variables:
        if variable.extra_dimensions:
            lists.setdefault(table_name_of(variable.extra_dimensions), []).append(variable)
        else:
            point_variables.append(variable)
    with_points = set(lists)
    for variable in sweep_wide_variables(config, view.is_grid):
        if variable.name not in view.variables:
            continue
        of_items = tuple(
            name for name in variable.extra_dimensions if name not in ("point", *view.parameters)
        )
        if of_items != variable.extra_dimensions:
            lists[table_name_of(of_items)].append(variable)
        elif variable.extra_dimensions:
            lists.setdefault(table_name_of(variable.extra_dimensions), []).append(variable)
    point_variables.sort(key=lambda variable: variable.name != "status")
    list_variables = {name: tuple(variables) for name, variables in lists.items()}
    return TableContents(
        tuple(point_variables), list_variables, frozenset(list_variables.keys() - with_points)
    )


def table_name_of(dimensions: tuple[str, ...]) -> str:
    """Name of the table of variables with the dimensions `dimensions`, given without the dimensions of the
    points."""
    return GRID_TABLE if dimensions[0] in PARAMETERS else TABLE_NAMES[dimensions]


def chosen_table(
    view: ResultView, contents: TableContents, table: str | None, columns: tuple[str, ...]
) -> str:
    """Name of the table that the user requests: `table` if given; else the list that has one of the columns
    `columns`; else POINTS_TABLE if all of them are columns of points; without columns, the default table of
    the task. Raises InputError for an unknown name, and for columns of two different lists."""
    if table is not None:
        if table not in contents.table_names:
            hint = unknown_key_hint(table, contents.table_names, KNOWN_NAMES_PHRASE)
            raise InputError(f"{view.path} has no table {table!r}; {hint}")
        return table
    holding = {
        variable.name: name
        for name, variables in contents.variables_by_list.items()
        for variable in variables
    }
    holding |= {
        name: list_name
        for list_name in contents.variables_by_list
        for name in contents.dimensions_of_list(list_name)
    }
    lists = list(dict.fromkeys(holding[name] for name in columns if name in holding))
    if set(lists) == BRANCHES_TABLE_PARTS:
        return BRANCHES_TABLE
    if len(lists) > 1:
        columns_of_two_lists = [
            next(name for name in columns if holding.get(name) == list_name) for list_name in lists[:2]
        ]
        raise InputError(
            f"{columns_of_two_lists[0]} and {columns_of_two_lists[1]} are in two tables, {lists[0]} and "
            f"{lists[1]}; name columns of one table"
        )
    all_names = (
        *(variable.name for variable in contents.point_variables),
        *holding,
        *view.point_columns,
        *view.quantities,
    )
    refuse_unknown_columns(view.path, columns, all_names, "")
    if lists:
        return lists[0]
    return POINTS_TABLE if columns else DEFAULT_TABLE[view.task]


def refuse_unknown_columns(
    path: object, columns: tuple[str, ...], allowed: tuple[str, ...], table: str
) -> None:
    """Raises InputError for the first name in `columns` that is not in `allowed` or occurs twice. table: name
    of the table, for the message; empty for all tables."""
    for index, name in enumerate(columns):
        if name not in allowed:
            subject = f"the table {table} has" if table else "its tables have"
            raise InputError(
                f"{path}: {subject} no column {name!r}; {unknown_key_hint(name, allowed, KNOWN_NAMES_PHRASE)}"
            )
        if name in columns[:index]:
            raise InputError(f"{path}: the column {name} is named twice")
