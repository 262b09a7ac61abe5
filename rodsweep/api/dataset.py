"""Result files as xarray Datasets, and Datasets in the form that figures and tables read."""

import json
import os
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from ..config.arm.axes import STORED_ALONG
from ..config.document.call_arguments import in_sentences
from ..config.values import short
from ..errors import InputError
from ..model.arm.quantities import ALL_QUANTITIES
from ..results.file.content import SEAL_ATTRIBUTE, attribute_digests, variable_digest
from ..results.file.recent import insert_records, journalled_points, journalled_reasons, read_unfolded
from ..results.file.validation import ResultHeader, cleaned, open_whole, reading, reason_of
from ..results.file.view import View
from ..results.layouts import beside_points, layout_of
from ..results.layouts.variables import DIMENSIONS, TYPED_UNIT, Layout
from ..results.run.journal import journal_directory
from ..solve.exclusive import one_at_a_time

ENGINE = "h5netcdf"


@one_at_a_time
@in_sentences('rs.open("RESULT.h5")')
def open_result(path: str | Path) -> xr.Dataset:
    """Reads a whole result file into memory. For a running sweep, the points done so far are included.

    Raises InputError if the file is no result, is damaged, or was changed by another program.
    """
    path = file_path(path, 'rs.open("RESULT.h5")')
    return read_unfolded(path, lambda: _opened(path))


def file_path(given: object, example: str) -> Path:
    """Path of a file named by the user; InputError, with an example, if `given` is no file name."""
    if not isinstance(given, str | os.PathLike) or not isinstance(name := os.fspath(given), str):
        raise InputError(f"{short(given)} is not the name of a file; write it as in {example}")
    if not name or "\0" in name:
        raise InputError(f"{name!r} is not the name of a file; write it as in {example}")
    path = Path(name)
    return Path(os.path.realpath(path)) if path.is_symlink() else path


def _opened(path: Path) -> xr.Dataset:
    file, header = open_whole(path)
    file.close()
    data = _loaded(path, header)
    for variable in data.variables.values():
        variable.attrs = {name: cleaned(value) for name, value in variable.attrs.items()}
    data.attrs = {name: cleaned(value) for name, value in data.attrs.items()}
    data = ordered(data, header.layout, header.config)
    if journal_directory(path).is_dir():
        recent = journalled_points(header, data["status"].values.ravel())
        for name in data.variables.keys() & recent.dtype.fields.keys():
            insert_records(data[name].values, str(name), recent)
        data.attrs |= journalled_reasons(header)
        data = sealed(data)
    return selectable(data)


def selectable(data: xr.Dataset) -> xr.Dataset:
    """Makes the quantities of an arm selectable along an axis, such as F by pressure."""
    for name in STORED_ALONG:
        if name in data.coords and data[name].dims == (STORED_ALONG[name],) and name not in data.xindexes:
            data = data.set_xindex(name)
    return data


def ordered(data: xr.Dataset, layout: Layout, config: dict[str, Any]) -> xr.Dataset:
    """The Dataset with its variables in the order of the layout. HDF5 stores variables alphabetically."""
    declared = (*layout.variables, *beside_points(config, "point" not in data.dims))
    places = {name: i for i, name in enumerate([*DIMENSIONS, *ALL_QUANTITIES, *(v.name for v in declared)])}
    names = sorted(data.variables, key=lambda name: places.get(str(name), len(places)))
    variables = {name: data.variables[name] for name in names}
    coords = {name: variables.pop(name) for name in names if name in data.coords}
    return xr.Dataset(variables, coords, data.attrs)


def _loaded(path: Path, header: ResultHeader) -> xr.Dataset:
    """A whole file as read by xarray; InputError if values or dimensions differ from the checksums."""
    digests = json.loads(header.attributes[SEAL_ATTRIBUTE])["variables"]
    with reading(path):
        try:
            with xr.open_dataset(path, engine=ENGINE, phony_dims="sort") as stored:
                data = stored.load()
        except Exception as error:  # xarray and its engine raise many types on foreign attributes
            raise ValueError(reason_of(error)) from error
        found = json.loads(sealed(data).attrs[SEAL_ATTRIBUTE])["variables"]
        for name, digest in digests.items():
            if found.get(name) != digest:
                raise ValueError(f"its variable {name} was changed after rodsweep wrote it")
    return data


def sealed(data: xr.Dataset) -> xr.Dataset:
    """Adds checksums. After xarray has written this Dataset to a file, readers recognise by the checksums
    that the file is complete."""
    variables = {
        str(name): variable_digest(
            v.dtype, v.shape, map(str, v.dims), v.attrs, [np.ascontiguousarray(v.values)]
        )
        for name, v in data.variables.items()
    }
    digests = {"attributes": attribute_digests(data.attrs), "variables": variables}
    return data.assign_attrs({SEAL_ATTRIBUTE: json.dumps(digests)})


def view_of(data: xr.Dataset, path: Path) -> View:
    """A Dataset in the form read by `show` and `plot`; InputError if the result is not complete."""
    try:
        layout = layout_of(json.loads(data.attrs["config_resolved"]))
        status = data["status"]
        words = str(status.attrs["flag_meanings"]).split()
        flags = dict(zip(map(int, np.atleast_1d(status.attrs["flag_values"])), words, strict=True))
    except (LookupError, ValueError, TypeError):
        raise InputError(
            "the data are not a complete rodsweep result: its variables and attributes are needed"
        ) from None
    points = layout.dimensions(is_list="point" in data.dims)
    for variable in layout.variables:
        dimensions = (*points, *variable.extra)
        if variable.name not in data or data[variable.name].dims != dimensions:
            raise InputError(
                f"the data are not whole: {variable.name} should be there with the dimensions "
                f"{', '.join(dimensions)}; give all of them, with at={{...}} for one value, "
                "or draw a selection by xarray's own plot"
            )
    variables = {str(name): array.values for name, array in data.variables.items()}
    typed = {
        str(name): str(v.attrs[TYPED_UNIT]) for name, v in data.variables.items() if TYPED_UNIT in v.attrs
    }
    return View(path, dict(data.attrs), variables, layout.parameters, flags, 0, layout.over, typed)
