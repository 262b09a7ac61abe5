"""A table of a result as a pandas DataFrame: words where the file has numbers, nothing for nothing."""

from collections.abc import Iterable
from typing import Any

import numpy as np
import pandas as pd

from ...post.tables.columns import Column


def frame_of(columns: Iterable[Column], index: str | None = None) -> pd.DataFrame:
    """A DataFrame of columns; its attributes `units` and `meanings` say by name what each is.

    index: a column that numbers the rows, from 1.
    """
    columns = tuple(columns)
    frame = pd.DataFrame({column.name: series_of(column) for column in columns})
    frame.attrs["units"] = {column.name: column.unit for column in columns}
    frame.attrs["meanings"] = {column.name: column.meaning for column in columns}
    return frame if index is None else frame.set_index(index)


def series_of(column: Column) -> Any:
    """The values of a column as pandas has them: words or None, truths, numbers, counts or <NA>."""
    if column.is_boolean:
        return column.values.astype(bool)
    if column.words:
        return np.array(words_of(column), dtype=object)
    if column.values.dtype.kind in "iu" and column.absent.any():
        return pd.Series(column.values, dtype="Int64").mask(column.absent)
    if column.values.dtype.kind == "f":
        return np.where(column.absent, np.nan, column.values)
    return np.array(column.values)


def words_of(column: Column) -> list[str | None]:
    """The words of a column, None where it has none."""
    return [text or None for text in column.text()]
