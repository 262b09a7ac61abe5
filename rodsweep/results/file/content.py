"""What a result file says, as one digest of each variable and attribute; and what must not be in a file.

A digest is of what is meant, not of how it is stored: type, shape, dimensions, numbers and attributes of a
variable. So it stays the same where another program writes the same into a file of its own, as xarray does.
Names that begin with `user_` are the user's: they have no digest, and only `rs.open` reads them.
"""

import json
import os
from collections.abc import Iterable, Iterator, Mapping
from hashlib import sha256
from typing import Any

import h5py
import numpy as np

from ...config.values import named

SEAL = "seal"
"""The attribute with the digests."""
USER_PREFIX = "user_"
DIGITS = 16
"""Hexadecimal digits of a digest: a change goes unnoticed once in 2^64 times."""
BOOKKEEPING = frozenset(
    {
        "CLASS", "NAME", "DIMENSION_LIST", "REFERENCE_LIST", "DIMENSION_LABELS", "_Netcdf4Dimid",
        "_Netcdf4Coordinates", "_NCProperties", "coordinates", SEAL,
    }
)  # fmt: skip
"""Attributes by which HDF5 and netCDF tie dimensions to variables; digests have the dimensions themselves."""
NUMBERS = "iuf"
"""Kinds of NumPy's types that variables of a result have."""
BYTES_A_READ = 1 << 18

FILLED_WITH_NAN = ("_FillValue", "[nan]")
"""An attribute that xarray adds to what it writes, and which changes nothing."""

Digests = dict[str, dict[str, str]]
"""Digests of `attributes` and of `variables`, by name."""


def is_users(name: str) -> bool:
    """Whether a name belongs to the user."""
    return name.startswith(USER_PREFIX)


def variable_digest(
    kind: np.dtype,
    shape: tuple[int, ...],
    dimensions: Iterable[str],
    attributes: Mapping[str, Any],
    blocks: Iterable[Any],
) -> str:
    """The digest of a variable, whose numbers are given as buffers in row-major order."""
    told = [kind.newbyteorder("<").str, list(shape), list(dimensions), _plain_attributes(attributes)]
    digest = sha256(json.dumps(told, sort_keys=True).encode())
    for block in blocks:
        digest.update(block)
    return digest.hexdigest()[:DIGITS]


def attribute_digests(attributes: Mapping[str, Any]) -> dict[str, str]:
    """The digest of every attribute of a whole file, by name."""
    plain = _plain_attributes(attributes)
    return {name: sha256(json.dumps(value).encode()).hexdigest()[:DIGITS] for name, value in plain.items()}


def digests_of(file: h5py.File) -> Digests:
    """The digests of an open file. ValueError, as the rest of a sentence, where it has what no result has."""
    variables = {name: _dataset_digest(name, data) for name, data in _variables(file)}
    return {"attributes": attribute_digests(file.attrs), "variables": variables}


def refuse_changed(file: h5py.File) -> None:
    """ValueError, as the rest of a sentence, unless an open file says what it said when it was sealed."""
    if SEAL not in file.attrs:
        raise ValueError("its seal is gone")
    sealed, found = json.loads(file.attrs[SEAL]), digests_of(file)
    for noun in ("attribute", "variable"):
        before, now = sealed[f"{noun}s"], found[f"{noun}s"]
        for name, digest in before.items():
            if name not in now:
                raise ValueError(f"its {noun} {name} is gone")
            if now[name] != digest:
                raise ValueError(f"its {noun} {name} is not as rodsweep wrote it")
        for name in now.keys() - before.keys():
            raise ValueError(
                f"its {noun} {named(name, 40)} is not of rodsweep; names of your own begin with {USER_PREFIX}"
            )


def _variables(file: h5py.File) -> Iterator[tuple[str, h5py.Dataset]]:
    """The variables of a file with their names. ValueError for links, and for what lies in another file."""
    places = set()
    for name in file:
        shown = named(name, 40)
        if not isinstance(file.get(name, getlink=True), h5py.HardLink):
            raise ValueError(f"{shown} is a link, which no result has")
        data = file[name]
        if not isinstance(data, h5py.Dataset):
            if is_users(name) and isinstance(data, h5py.Group):
                continue
            raise ValueError(f"{shown} is no variable")
        if data.is_virtual or data.external:
            raise ValueError(f"{shown} lies in another file")
        place = h5py.h5o.get_info(data.id).addr
        if place in places:
            raise ValueError(f"{shown} is another name of a variable")
        places.add(place)
        if not is_users(name):
            yield name, data


def _dataset_digest(name: str, data: h5py.Dataset) -> str:
    """The digest of a variable of an open file."""
    if data.dtype.kind not in NUMBERS or data.shape is None:
        raise ValueError(f"{named(name, 40)} has no numbers")
    return variable_digest(data.dtype, data.shape, _dimensions(name, data), data.attrs, _blocks(data))


def _dimensions(name: str, data: h5py.Dataset) -> list[str]:
    """The dimensions of a variable: itself, or those that its attributes refer to.

    Not by HDF5's own functions for dimensions, which crash where these attributes are not as HDF5 wrote them.
    """
    attributes = data.attrs
    changed = ValueError(f"the dimensions of {named(name, 40)} are not as rodsweep wrote them")
    if "CLASS" in attributes:
        number = attributes.get("_Netcdf4Dimid", 0)  # of netCDF's dimensions, in files that xarray wrote
        told = [attributes["CLASS"], attributes.get("NAME"), attributes.get("_Netcdf4Coordinates", number)]
        if [_plain(value) for value in told] != [["DIMENSION_SCALE"], [name], _plain(number)]:
            raise changed
        return [name]
    if "DIMENSION_LIST" not in attributes:
        return []
    kind = h5py.check_vlen_dtype(attributes.get_id("DIMENSION_LIST").dtype)
    if kind is None or h5py.check_ref_dtype(kind) is not h5py.Reference:
        raise changed
    file = data.file.id
    try:  # by handles: an object of each, `data.file[place]`, took half of the time of opening a file
        scales = [h5py.h5r.dereference(r, file) for places in attributes["DIMENSION_LIST"] for r in places]
        names = [h5py.h5i.get_name(scale) if scale else None for scale in scales]
    except (ValueError, RuntimeError, OSError, LookupError):
        raise changed from None
    told = [name.decode(errors="surrogateescape").removeprefix("/") for name in names if name]
    if len(told) < len(names):
        raise changed
    return told


def _blocks(data: h5py.Dataset) -> Iterator[Any]:
    """The numbers of a variable as buffers, straight from the file where they lie in one piece."""
    start, size = data.id.get_offset(), data.id.get_storage_size()
    if start is None or data.dtype.byteorder == ">":
        yield np.ascontiguousarray(data[...], data.dtype.newbyteorder("<"))
        return
    handle = data.file.id.get_vfd_handle()
    for at in range(start, start + size, BYTES_A_READ):
        yield os.pread(handle, min(BYTES_A_READ, start + size - at), at)


def _plain_attributes(attributes: Mapping[str, Any]) -> dict[str, Any]:
    """Attributes without those of HDF5 and netCDF and the user's, each as a list of numbers or texts."""
    names = (name for name in attributes if name not in BOOKKEEPING and not is_users(name))
    plain = {name: _plain(attributes[name]) for name in names}
    return {name: value for name, value in plain.items() if (name, str(value)) != FILLED_WITH_NAN}


def _plain(value: Any) -> Any:
    """The value of an attribute as JSON has it: netCDF takes one number and a list of one for the same."""
    if isinstance(value, h5py.Empty):
        return [""]
    array = np.atleast_1d(value)
    if array.dtype.kind == "S":
        array = np.char.decode(array, "utf-8")
    return array.tolist()
