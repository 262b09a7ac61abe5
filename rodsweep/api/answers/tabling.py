"""`rs.table`: a table of a result as a pandas DataFrame, equal to the CSV of `rodsweep export`."""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pandas as pd
import xarray as xr

from ...config.document.call_argument_errors import refusing_wrong_arguments
from ...errors import InputError, short_repr
from ...post.tables.tables import Tables
from ...results.file.view import ResultView, read_view
from ...solve.solve_lock import one_at_a_time
from ..dataset import require_file_path, view_of_dataset
from .answer import Answer
from .data_frames import data_frame_of

TABLE_EXAMPLE = 'rs.table(data, "crossings")'
TableSource = xr.Dataset | Answer | str | Path
"""Result from which `rs.table` makes a table; text and paths name a result file."""


@one_at_a_time
@refusing_wrong_arguments(TABLE_EXAMPLE)
def table(data: TableSource, name: str | None = None, *, columns: Sequence[str] = ()) -> pd.DataFrame:
    """A table of a result, with one row per item and the item's parameters in each row.

    name: `points`, or a list of the task such as `modes`, `crossings` or `branches`. The default is the table
    with the requested columns, or the task's first table. columns: names of columns, by default all.
    `frame.attrs` of the DataFrame has `units` and `meanings`. Raises InputError for unknown names.
    """
    if name is not None and not isinstance(name, str):
        raise InputError(
            f"name = {short_repr(name)} is not the name of a table; write it as in {TABLE_EXAMPLE}"
        )
    names = [columns] if isinstance(columns, str) else columns
    if not isinstance(names, list | tuple) or not all(isinstance(column_name, str) for column_name in names):
        text = short_repr(columns)
        raise InputError(f"columns = {text} is not a list of names, such as ['F', 'growth_rate']")
    return data_frame_of(Tables(view_of_result(data, TABLE_EXAMPLE)).table(name, tuple(names)).columns)


def view_of_result(data: Any, example: str) -> ResultView:
    """The view of a result from which figures and tables are made. Raises InputError, with the example call
    `example`, if `data` is not a result."""
    if isinstance(data, str | os.PathLike):
        return read_view(require_file_path(data, example))
    if not isinstance(data, Answer | xr.Dataset):
        raise InputError(
            f"{short_repr(data)} is not a result; give a Dataset, an answer or a file, as in {example}"
        )
    full_answer = data.whole if isinstance(data, Answer) else data
    return view_of_dataset(full_answer, Path(str(full_answer.attrs.get("title", "data"))))
