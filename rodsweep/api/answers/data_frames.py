"""Tables of a result as pandas DataFrames. Names replace stored codes, and missing values replace fill
values."""

from collections.abc import Iterable
from typing import Any

import numpy as np
import pandas as pd

from ...post.tables.column import Column


def data_frame_of(columns: Iterable[Column], index: str | None = None) -> pd.DataFrame:
    """A DataFrame with a column per `Column`; `frame.attrs` has `units` and `meanings` by name.

    index: name of the column with row numbers from 1, which becomes the index; None: rows are numbered from
    0.
    """
    columns = tuple(columns)
    result = pd.DataFrame({column.name: series_of(column) for column in columns})
    result.attrs["units"] = {column.name: column.unit for column in columns}
    result.attrs["meanings"] = {column.name: column.meaning for column in columns}
    return result if index is None else result.set_index(index)


def series_of(column: Column) -> Any:
    """Values of a column for pandas: texts or None, booleans, real numbers or NaN, integers or <NA>."""
    if column.is_boolean:
        return column.values.astype(bool)
    if column.flag_meanings:
        return np.array([text or None for text in column.csv_texts()], dtype=object)
    if column.values.dtype.kind in "iu" and column.missing_mask.any():
        return pd.Series(column.values, dtype="Int64").mask(column.missing_mask)
    if column.values.dtype.kind == "f":
        return np.where(column.missing_mask, np.nan, column.values) + column.values.dtype.type(0)  # no -0.0
    return np.array(column.values)
