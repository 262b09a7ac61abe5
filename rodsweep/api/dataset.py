"""Result files as xarray Datasets, and Datasets as the views that figures and tables read."""

import json
import os
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from ..config.arm.axes import FILE_AXIS_OF_QUANTITY
from ..config.document.call_argument_errors import refusing_wrong_arguments
from ..errors import InputError, short_repr
from ..model.arm.quantities import ARM_FILE_VARIABLES
from ..results.file.content_digests import SEAL_ATTRIBUTE, attribute_digests, variable_digest
from ..results.file.current_state import (
    failure_reasons_with_journals,
    insert_records,
    read_file_and_journals,
    records_only_in_journals,
)
from ..results.file.validation import (
    ResultHeader,
    damage_as_refusals,
    escape_control_characters,
    one_line_message,
    open_checked,
)
from ..results.file.view import ResultView
from ..results.layouts import layout_of, sweep_wide_variables
from ..results.layouts.dimensions import UNIT_AND_LONG_NAME_OF_DIMENSION
from ..results.layouts.variables import TYPED_UNIT_ATTRIBUTE, Layout
from ..results.run.journal import journal_directory
from ..solve.solve_lock import one_at_a_time

XARRAY_ENGINE = "h5netcdf"
"""Backend with which xarray reads result files."""


@one_at_a_time
@refusing_wrong_arguments('rs.open("RESULT.h5")')
def open_result(path: str | Path) -> xr.Dataset:
    """The Dataset of a result file, read into memory. The points that a running or interrupted sweep has
    already solved are included.

    Raises InputError if the file is no result file, is damaged, or was changed by another program.
    """
    path = require_file_path(path, 'rs.open("RESULT.h5")')
    return read_file_and_journals(path, lambda: _open_result_file(path))


def require_file_path(argument: object, example: str) -> Path:
    """Path of a file named by the user; InputError, with `example`, if `argument` is no file name."""
    if not isinstance(argument, str | os.PathLike) or not isinstance(name := os.fspath(argument), str):
        raise InputError(f"{short_repr(argument)} is not the name of a file; write it as in {example}")
    if not name or "\0" in name:
        raise InputError(f"{name!r} is not the name of a file; write it as in {example}")
    path = Path(name)
    try:
        os.fsencode(name)
        return Path(os.path.realpath(path)) if path.is_symlink() else path
    except (OSError, UnicodeEncodeError) as error:  # a name that is too long, or a lone surrogate
        reason = error.strerror if isinstance(error, OSError) else error.reason
        raise InputError(
            f"{short_repr(name)} is not the name of a file ({reason}); write it as in {example}"
        ) from None


def _open_result_file(path: Path) -> xr.Dataset:
    file, header = open_checked(path)
    file.close()
    data = _load_with_checksums(path, header)
    for variable in data.variables.values():
        variable.attrs = {name: escape_control_characters(value) for name, value in variable.attrs.items()}
    data.attrs = {name: escape_control_characters(value) for name, value in data.attrs.items()}
    data = in_layout_order(data, header.layout, header.config)
    if journal_directory(path).is_dir():
        recent = records_only_in_journals(header, data["status"].values.ravel())
        for name in data.variables.keys() & (recent.dtype.names or ()):
            insert_records(data[name].values, str(name), recent)
        data.attrs |= failure_reasons_with_journals(header)
        data = with_checksums(data)
    return with_arm_indexes(data)


def with_arm_indexes(data: xr.Dataset) -> xr.Dataset:
    """The Dataset with an index for every quantity of an arm that varies along an axis, so that `sel` accepts
    this quantity."""
    for name in (
        coordinate_name
        for coordinate_name in FILE_AXIS_OF_QUANTITY
        if coordinate_name in data.coords and coordinate_name not in data.xindexes
    ):
        if data[name].dims == (FILE_AXIS_OF_QUANTITY[name],):
            data = data.set_xindex(name)
    return data


def in_layout_order(data: xr.Dataset, layout: Layout, config: dict[str, Any]) -> xr.Dataset:
    """The Dataset with its variables in the order of the layout, as HDF5 stores variables alphabetically."""
    layout_variables = (*layout.variables, *sweep_wide_variables(config, "point" not in data.dims))
    ordered_names = (
        *UNIT_AND_LONG_NAME_OF_DIMENSION,
        *ARM_FILE_VARIABLES,
        *(variable.name for variable in layout_variables),
    )
    order = {name: i for i, name in enumerate(ordered_names)}
    names = sorted(data.variables, key=lambda name: order.get(str(name), len(order)))
    variables = {name: data.variables[name] for name in names}
    coords = {name: variables.pop(name) for name in names if name in data.coords}
    return xr.Dataset(variables, coords, data.attrs)


def _load_with_checksums(path: Path, header: ResultHeader) -> xr.Dataset:
    """The Dataset that xarray reads from a result file; InputError if values or dimensions differ from the
    checksums in the file."""
    digests = json.loads(header.attributes[SEAL_ATTRIBUTE])["variables"]
    with damage_as_refusals(path):
        try:
            with xr.open_dataset(path, engine=XARRAY_ENGINE, phony_dims="sort") as stored:
                data = stored.load()
        except Exception as error:  # xarray and its engine raise many types on foreign attributes
            raise ValueError(one_line_message(error)) from error
        stored_digests = json.loads(with_checksums(data).attrs[SEAL_ATTRIBUTE])["variables"]
        for name, digest in digests.items():
            if stored_digests.get(name) != digest:
                raise ValueError(
                    f"its variable {name} was changed after rodsweep wrote it; restore a copy of the file"
                )
    return data


def with_checksums(data: xr.Dataset) -> xr.Dataset:
    """The Dataset with an additional attribute, the checksums of all variables and attributes, by which
    readers verify a file that xarray has written."""
    variables = {}
    for name, variable in data.variables.items():
        buffers = [np.ascontiguousarray(variable.values)]
        variables[str(name)] = variable_digest(
            variable.dtype, variable.shape, map(str, variable.dims), variable.attrs, buffers
        )
    digests = {"attributes": attribute_digests(data.attrs), "variables": variables}
    return data.assign_attrs({SEAL_ATTRIBUTE: json.dumps(digests)})


def view_of_dataset(data: xr.Dataset, path: Path) -> ResultView:
    """The view of a Dataset from which tables and figures are made; InputError if the Dataset is not a
    complete result.

    path: name of the result for messages.
    """
    try:
        layout = layout_of(json.loads(data.attrs["config_resolved"]))
        status = data["status"]
        status_words = str(status.attrs["flag_meanings"]).split()
        flags = dict(zip(map(int, np.atleast_1d(status.attrs["flag_values"])), status_words, strict=True))
    except (LookupError, ValueError, TypeError):
        raise InputError(
            "the data are not a complete rodsweep result: all variables and attributes are needed"
        ) from None
    points = layout.dimensions(is_list="point" in data.dims)
    for variable in layout.variables:
        dimensions = (*points, *variable.extra_dimensions)
        if variable.name not in data or data[variable.name].dims != dimensions:
            raise InputError(
                f"the data are not a complete result: they lack {variable.name} with the dimensions "
                f"{', '.join(dimensions)}; give the complete result and select points with at={{...}}, or "
                "draw a selection with xarray's own plot"
            )
    stored = {str(name): variable for name, variable in data.variables.items()}
    values = {name: variable.values for name, variable in stored.items()}
    units = {
        name: str(stored_variable.attrs[TYPED_UNIT_ATTRIBUTE])
        for name, stored_variable in stored.items()
        if TYPED_UNIT_ATTRIBUTE in stored_variable.attrs
    }
    return ResultView(path, dict(data.attrs), values, layout.parameters, flags, 0, layout.arm_axes, units)
