"""File of a benchmark: a group of columns for each study, and attributes that describe the machine."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import h5py
import numpy as np

from ...errors import EnvironmentIncomplete

Table = dict[str, Sequence[str] | Sequence[float]]
"""Table of the measurements of a benchmark study: columns of equal length, by name."""
COLUMN_UNITS = {"seconds": "s", "error": "1"}
"""Unit of a column, by name of the column; all other columns have no unit."""


def write_measurements(path: Path, tables: Mapping[str, Table], attributes: Mapping[str, str]) -> None:
    """Writes `tables`, the tables of benchmark studies by name of the study, to the file `path`: a group for
    each study, with a dataset for each column, (measurements,) each. `attributes` become attributes of the
    file. Raises EnvironmentIncomplete if writing fails.
    """
    try:
        with h5py.File(path, "w") as file:
            file.attrs.update(attributes)
            for study_name, table in tables.items():
                group = file.create_group(study_name)
                rows = group.create_dataset("measurement", data=np.arange(len(table["case"])))
                rows.make_scale("measurement")
                for name, values in table.items():
                    is_text = bool(values) and isinstance(values[0], str)
                    column = np.array(values, dtype=h5py.string_dtype() if is_text else float)
                    dataset = group.create_dataset(name, data=column)
                    dataset.dims[0].attach_scale(rows)
                    if name in COLUMN_UNITS:
                        dataset.attrs["units"] = COLUMN_UNITS[name]
    except OSError as error:
        raise EnvironmentIncomplete(f"{path} cannot be written: {error}") from error
