"""Digests of the variables and attributes of a result file, and refusal of changed or added content.

A digest covers the content, not its storage: type, shape, dimensions, numbers and attributes of a variable. A
file rewritten by another program, such as xarray, keeps the digests. Names that begin with `user_` belong to
the user: the user's content has no digest, and only `rs.open` reads it.
"""

import json
import os
from collections.abc import Iterable, Iterator, Mapping
from hashlib import sha256
from typing import Any

import h5py
import numpy as np

from ...config.values import printable_name

SEAL_ATTRIBUTE = "seal"
"""Name of the attribute that holds the digests of all variables and attributes."""
USER_PREFIX = "user_"
"""Prefix of the names of variables and attributes that the user adds to a result file."""
DIGEST_DIGITS = 16
"""Number of hexadecimal digits of a digest: one change in 2^64 is not detected."""
UNDIGESTED_ATTRIBUTES = frozenset(
    {
        "CLASS", "NAME", "DIMENSION_LIST", "REFERENCE_LIST", "DIMENSION_LABELS", "_Netcdf4Dimid",
        "_Netcdf4Coordinates", "_NCProperties", "coordinates", SEAL_ATTRIBUTE,
    }
)  # fmt: skip
"""Names of attributes without digests: the seal, and attributes by which HDF5 and netCDF link dimensions to
variables. The digest of a variable covers its dimensions."""
ALLOWED_DTYPE_KINDS = "iuf"
"""NumPy type kinds allowed for variables of a result file: integers and floating-point numbers."""
BYTES_PER_READ = 1 << 18
"""Number of bytes per read of a variable, which bounds the memory."""
XARRAY_FILL_NAME_AND_VALUE = ("_FillValue", "[nan]")
"""(name, value as text) of an attribute that xarray adds when it writes a file, and that has no effect."""
Digests = dict[str, dict[str, str]]
"""Digests by name, in two dicts under the keys `attributes` and `variables`."""


def is_user_added(name: str) -> bool:
    """Whether a variable or attribute of this name was added by the user."""
    return name.startswith(USER_PREFIX)


def variable_digest(
    dtype: np.dtype,
    shape: tuple[int, ...],
    dimensions: Iterable[str],
    attributes: Mapping[str, Any],
    blocks: Iterable[Any],
) -> str:
    """Digest of a variable of the NumPy type `dtype` and the shape `shape`. dimensions: names of its
    dimensions. attributes: its attributes by name. blocks: its numbers as buffers in row-major order."""
    # The byte order belongs to the storage, not to the content.
    described = [dtype.newbyteorder("<").str, list(shape), list(dimensions), _plain_attributes(attributes)]
    # Sorted, because the order of attributes in a file is not fixed.
    digest = sha256(json.dumps(described, sort_keys=True).encode())
    for block in blocks:
        digest.update(block)
    return digest.hexdigest()[:DIGEST_DIGITS]


def attribute_digests(attributes: Mapping[str, Any]) -> dict[str, str]:
    """Digest of every attribute of a file by name, except attributes of HDF5, netCDF and the user."""
    texts = {name: json.dumps(value) for name, value in _plain_attributes(attributes).items()}
    return {name: sha256(text.encode()).hexdigest()[:DIGEST_DIGITS] for name, text in texts.items()}


def digests_of(file: h5py.File) -> Digests:
    """Digests of an open file. Raises ValueError, with a clause as message, for content that rodsweep does
    not write."""
    variables = {}
    for name, dataset in _variables(file):
        if dataset.dtype.kind not in ALLOWED_DTYPE_KINDS or dataset.shape is None:
            raise ValueError(f"its variable {printable_name(name, 40)} has no numbers")
        described = dataset.dtype, dataset.shape, _dimensions(name, dataset), dataset.attrs
        variables[name] = variable_digest(*described, _number_buffers(dataset))
    return {"attributes": attribute_digests(file.attrs), "variables": variables}


def refuse_changed(file: h5py.File) -> None:
    """Raises ValueError, with a clause as message, if the digests of an open file differ from its seal."""
    if SEAL_ATTRIBUTE not in file.attrs:
        raise ValueError("its checksums are missing")
    sealed = json.loads(file.attrs[SEAL_ATTRIBUTE])
    digests = digests_of(file)
    for noun in ("attribute", "variable"):
        sealed_digests = sealed[f"{noun}s"]
        current_digests = digests[f"{noun}s"]
        for name, digest in sealed_digests.items():
            if name not in current_digests:
                raise ValueError(
                    f"its {noun} {name} was removed; restore a copy of the file, or compute it again with "
                    "--fresh"
                )
            if current_digests[name] != digest:
                raise ValueError(
                    f"its {noun} {name} was changed after rodsweep wrote it; restore a copy of the file, or "
                    "compute it again with --fresh"
                )
        for name in current_digests.keys() - sealed_digests.keys():
            raise ValueError(
                f"its {noun} {printable_name(name, 40)} was not written by rodsweep; names of your own "
                f"begin with {USER_PREFIX}"
            )


def _variables(file: h5py.File) -> Iterator[tuple[str, h5py.Dataset]]:
    """Yields (name, variable) of an open file, without the user's variables. Raises ValueError for links and
    for data stored in another file."""
    offsets = set()
    for name in file:
        name_text = printable_name(name, 40)
        if not isinstance(file.get(name, getlink=True), h5py.HardLink):
            raise ValueError(f"{name_text} is a link, and a result has no links")
        dataset = file[name]
        if not isinstance(dataset, h5py.Dataset):
            if is_user_added(name) and isinstance(dataset, h5py.Group):
                continue
            raise ValueError(f"{name_text} is not a variable")
        if dataset.is_virtual or dataset.external:
            raise ValueError(f"{name_text} lies in another file")
        # A variable under two names could be changed through the name without a digest.
        address = h5py.h5o.get_info(dataset.id).addr
        if address in offsets:
            raise ValueError(f"{name_text} is a second hard link to another variable")
        offsets.add(address)
        if not is_user_added(name):
            yield name, dataset


def _dimensions(name: str, dataset: h5py.Dataset) -> list[str]:
    """Names of a variable's dimensions, read from its attributes. The only dimension of a coordinate has the
    name of the coordinate. A scalar has no dimensions. Raises ValueError if the attributes are damaged.
    HDF5's own functions for dimensions are not used, because they crash on damaged attributes."""
    attributes = dataset.attrs
    name_text = printable_name(name, 40)
    changed = ValueError(f"the dimensions of {name_text} were changed after rodsweep wrote them")
    if "CLASS" in attributes:
        # Number of the dimension, in files that xarray wrote.
        dimension_id = attributes.get("_Netcdf4Dimid", 0)
        stored = [
            attributes["CLASS"],
            attributes.get("NAME"),
            attributes.get("_Netcdf4Coordinates", dimension_id),
        ]
        if list(map(_attribute_as_list, stored)) != [
            ["DIMENSION_SCALE"],
            [name],
            _attribute_as_list(dimension_id),
        ]:
            raise changed
        return [name]
    if "DIMENSION_LIST" not in attributes:
        return []
    list_dtype = h5py.check_vlen_dtype(attributes.get_id("DIMENSION_LIST").dtype)
    if list_dtype is None or h5py.check_ref_dtype(list_dtype) is not h5py.Reference:
        raise changed
    file = dataset.file.id
    try:  # by low-level handles, because `data.file[place]` takes half the time of opening a file
        references = (each for references in attributes["DIMENSION_LIST"] for each in references)
        scales = [h5py.h5r.dereference(reference, file) for reference in references]
        names = [h5py.h5i.get_name(scale) if scale else None for scale in scales]
    except (ValueError, RuntimeError, OSError, LookupError):
        raise changed from None
    dimensions = [name.decode(errors="surrogateescape").removeprefix("/") for name in names if name]
    if len(dimensions) < len(names):
        raise changed
    return dimensions


def _number_buffers(dataset: h5py.Dataset) -> Iterator[Any]:
    """Yields the numbers of a variable as buffers. Contiguous numbers are read from the file without HDF5;
    other numbers, and big-endian numbers, come as one buffer of little-endian numbers."""
    start = dataset.id.get_offset()
    size = dataset.id.get_storage_size()
    # Another program may have rewritten the file in its own layout, with equal content.
    if start is None or dataset.dtype.byteorder == ">":
        yield np.ascontiguousarray(dataset[...], dataset.dtype.newbyteorder("<"))
        return
    handle = dataset.file.id.get_vfd_handle()
    for offset in range(start, start + size, BYTES_PER_READ):
        yield os.pread(handle, min(BYTES_PER_READ, start + size - offset), offset)


def _plain_attributes(attributes: Mapping[str, Any]) -> dict[str, Any]:
    """Attributes as lists of numbers or texts by name, without attributes of HDF5, netCDF and the user."""
    names = (name for name in attributes if name not in UNDIGESTED_ATTRIBUTES and not is_user_added(name))
    values = {name: _attribute_as_list(attributes[name]) for name in names}
    return {name: value for name, value in values.items() if (name, str(value)) != XARRAY_FILL_NAME_AND_VALUE}


def _attribute_as_list(value: Any) -> Any:
    """Value of an attribute as a list for JSON; a single number becomes a list, as netCDF stores it."""
    if isinstance(value, h5py.Empty):
        return [""]
    array = np.atleast_1d(value)
    if array.dtype.kind == "S":
        array = np.char.decode(array, "utf-8")
    return array.tolist()
