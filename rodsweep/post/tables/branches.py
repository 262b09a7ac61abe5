"""Table of branches: cycles in order, special points in between, and a column that marks them."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...model.arm.quantities import LOADS
from ...results.file.view import View
from .columns import Column
from .rows import Rows


def merged_rows(view: View, cycles: Rows, special: Rows) -> tuple[NDArray, NDArray, NDArray]:
    """Rows of the table: (point, row of the cycles or -1, row of the special points or -1), each (rows,).

    A special point follows the cycle before it on the branch, or precedes the first cycle of the branch.
    """
    shape = view.variables["status"].size
    branch = np.concatenate([_of(view, "branch", shape, cycles), _of(view, "special_branch", shape, special)])
    place = np.concatenate([cycles[1] + 1, _of(view, "special_point", shape, special)])
    point = np.concatenate([cycles[0], special[0]])
    kind = np.repeat([0, 1], [len(cycles[0]), len(special[0])])
    order = np.lexsort((np.concatenate([cycles[1], special[1]]), kind, place, branch, point))
    row = np.concatenate([np.arange(len(cycles[0])), np.arange(len(special[0]))])
    of_cycle = np.where(kind == 0, row, -1)
    of_special = np.where(kind == 1, row, -1)
    return point[order], of_cycle[order], of_special[order]


def merged_columns(
    cycles: list[Column], special: list[Column], of_cycle: NDArray, of_special: NDArray, along: str
) -> list[Column]:
    """Columns of the cycles, with values of the special points between them, and the kind of special point.

    of_cycle, of_special: rows of the columns, (rows,), -1 in a row without a cycle or a special point.
    """
    named = {column.name: column for column in special}
    merged = []
    for column in cycles:
        values = column.rows(of_cycle)
        counterpart = named.get(_special_of(column.name, along))
        if counterpart is not None:
            values = _filled(values, counterpart.rows(of_special))
        merged.append(values)
    return [*merged, named["special_kind"].rows(of_special)]


def _filled(values: Column, others: Column) -> Column:
    """Column `values`, with missing values taken from `others`."""
    both = np.where(values.absent, others.values, values.values)
    return replace(values, values=both, absent=values.absent & others.absent)


def _special_of(name: str, along: str) -> str:
    """Name of a variable of cycles at special points."""
    if name == f"branch_{along}":
        return "special_at"
    if along == "F" and name in {f"branch_{load}" for load in LOADS}:
        return "special_at_si"
    return f"special_{name}"


def _of(view: View, name: str, count: int, rows: Rows) -> NDArray:
    """Values of a variable at the items of a list, (rows,)."""
    return view.variables[name].reshape(count, -1)[rows]
