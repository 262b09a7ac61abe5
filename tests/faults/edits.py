"""Random edits of a result file, as other programs, disks and transfers make them."""

import json
import os
import shutil
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from random import Random
from typing import Any

import h5py
import numpy as np

from .damages import BYTES

SEALS = ("", "{}", "[]", "\x1b", '{"attributes": {}, "variables": {}}')
"""What is no seal."""
Edit = Callable[[h5py.File, Random, Path], object]
"""Changes an open file; other files may be made in the directory."""


def _names(file: h5py.File, kinds: str = "iuf") -> list[str]:
    """The variables with numbers, of such types, that lie in the file itself."""
    own = [name for name in sorted(file) if isinstance(file.get(name, getlink=True), h5py.HardLink)]
    data = [name for name in own if isinstance(file[name], h5py.Dataset) and file[name].size]
    return [name for name in data if file[name].dtype.kind in kinds]


def _scales(file: h5py.File) -> list[str]:
    """The variables that are dimensions."""
    return [name for name in _names(file) if "CLASS" in file[name].attrs]


def _name(file: h5py.File, rng: Random) -> str:
    """One of the variables: an axis as often as a result."""
    scales = _scales(file)
    others = [name for name in _names(file) if name not in scales]
    return rng.choice(rng.choice([scales or others, others or scales]))


def _changed(values: np.ndarray, rng: Random) -> np.ndarray:
    """Numbers of which one, or all, are others."""
    changed = np.array(values)
    flat = changed.reshape(-1)
    places = slice(None) if rng.random() < 0.3 else rng.randrange(flat.size)
    if changed.dtype.kind == "f":
        flat[places] = rng.choice([np.nan, np.inf, 0.0, 300.0, -1.0, 1e30])
        if np.array_equal(changed, values, equal_nan=True):
            flat[places] = 7.25
    else:
        flat[places] += 1
    return changed


def value(file: h5py.File, rng: Random, _: Path) -> None:
    """Other numbers in place."""
    name = _name(file, rng)
    file[name][...] = _changed(file[name][...], rng)


def last_digit(file: h5py.File, rng: Random, _: Path) -> None:
    """The last bit of a number."""
    data = file[rng.choice(_names(file, "f"))]
    flat = data[...].reshape(-1)
    place = rng.randrange(flat.size)
    flat[place] = np.nextafter(flat[place], flat.dtype.type(np.inf)) if np.isfinite(flat[place]) else 1.0
    data[...] = flat.reshape(data.shape)


def swapped(file: h5py.File, rng: Random, _: Path) -> None:
    """The numbers of two variables exchanged, where their shapes allow it."""
    names = [name for name in _names(file, "f") if file[name].dtype.itemsize == 8]
    first = rng.choice(names)
    others = [name for name in names if file[name].shape == file[first].shape and name != first]
    if others:
        second = rng.choice(others)
        numbers = file[first][...], file[second][...]
        file[second][...], file[first][...] = numbers


def anew(file: h5py.File, rng: Random, _: Path) -> None:
    """A variable written anew: of another type, shape or layout, without its dimensions."""
    name = _name(file, rng)
    old = file[name][...]
    kinds: dict[str, Callable[[], Any]] = {
        "f4": lambda: old.astype("f4"),
        "i4": lambda: np.nan_to_num(old, posinf=0, neginf=0).astype("i4"),
        ">f8": lambda: old.astype(">f8"),
        "complex": lambda: old.astype("c16"),
        "text": lambda: "text",
        "flat": old.ravel,
        "longer": lambda: np.repeat(old, 2, 0) if old.ndim else old,
        "fewer": lambda: old[:0] if old.ndim else old,
        "same": lambda: old,
        "empty": lambda: h5py.Empty(old.dtype),
    }
    made = kinds[rng.choice(list(kinds))]()
    storage: dict[str, Any] = {}
    if isinstance(made, np.ndarray) and made.ndim and made.size:
        ways = [{}, {"chunks": True}, {"compression": "gzip"}, {"maxshape": (None,) * made.ndim}]
        storage = rng.choice(ways)
    texts = {key: text for key, text in file[name].attrs.items() if isinstance(text, str)}
    del file[name]
    file.create_dataset(name, data=made, **storage)
    if rng.random() < 0.5:
        file[name].attrs.update({key: text for key, text in texts.items() if key not in ("CLASS", "NAME")})


def attribute(file: h5py.File, rng: Random, _: Path) -> None:
    """An attribute of the file or of a variable changed, removed or added."""
    place = file if rng.random() < 0.5 else file[_name(file, rng)]
    name, flags = rng.choice(sorted(place.attrs)), len(file["status"].attrs["flag_values"])
    ways: dict[str, Callable[[], object]] = {
        "remove": lambda: place.attrs.pop(name),
        "text": lambda: place.attrs.update({name: "another\x1b[31m"}),
        "number": lambda: place.attrs.update({name: 3}),
        "array": lambda: place.attrs.update({name: np.zeros(3)}),
        "scale": lambda: place.attrs.update(scale_factor=2.0),
        "offset": lambda: place.attrs.update(add_offset=1.0),
        "fill": lambda: place.attrs.update(_FillValue=0.0),
        "netCDF": lambda: place.attrs.update(_Netcdf4Coordinates=np.array([0, 1, 0, 9], "i4")),
        "format": lambda: file.attrs.update(format=rng.choice([0, 4, 6, "5", -1])),
        "fingerprint": lambda: file.attrs.update(fingerprint="0" * 64),
        "flags": lambda: file["status"].attrs.update(flag_meanings=" ".join(["ok"] * flags)),
        "seal": lambda: file.attrs.update(seal=rng.choice(SEALS)),
    }
    ways[rng.choice(list(ways))]()


def config(file: h5py.File, rng: Random, _: Path) -> None:
    """Another value in the config."""
    tree = json.loads(file.attrs["config_resolved"])
    task = tree["task"]
    ways: dict[str, Callable[[], object]] = {
        "accuracy": lambda: tree.update(accuracy=1e-3),
        "title": lambda: tree.update(title="\x1b[31mother"),
        "axis": lambda: tree["parameters"]["k2"].update(values=[77.0]),
        "option": lambda: tree[task].update({next(iter(tree[task])): 1}),
        "gone": lambda: tree.pop(task),
    }
    ways[rng.choice(list(ways))]()
    file.attrs["config_resolved"] = json.dumps(tree)


def link(file: h5py.File, rng: Random, directory: Path) -> None:
    """A link in the place of a variable or beside them, or another name for one."""
    name = _name(file, rng)
    other = directory / "other.h5"
    with h5py.File(other, "w") as stranger:
        stranger[name] = _changed(file[name][...], rng)
    aside = rng.choice(["aside", "user_aside"])
    ways: dict[str, Callable[[], object]] = {
        "external": lambda: h5py.ExternalLink(other.name, f"/{name}"),
        "soft": lambda: h5py.SoftLink(f"/{aside}/x"),
        "nowhere": lambda: h5py.SoftLink("/nowhere"),
        "itself": lambda: h5py.SoftLink(f"/{name}"),
        "hard": lambda: file[_name(file, rng)],
    }
    way = rng.choice(list(ways))
    if way == "soft":
        file.require_group(aside)["x"] = _changed(file[name][...], rng)
    place = rng.choice(["extra", "user_extra", "gamma1", "point", *[name] * 6])
    made = ways[way]()
    if place in file:
        del file[place]
    file[place] = made


def elsewhere(file: h5py.File, rng: Random, directory: Path) -> None:
    """A variable whose numbers lie in another file: virtual, or raw external storage."""
    name = _name(file, rng)
    values = np.atleast_1d(_changed(file[name][...], rng))
    del file[name]
    if rng.random() < 0.5:
        with h5py.File(directory / "other.h5", "w") as stranger:
            stranger[name] = values
        layout = h5py.VirtualLayout(values.shape, values.dtype)
        layout[...] = h5py.VirtualSource(str(directory / "other.h5"), name, values.shape)
        file.create_virtual_dataset(name, layout)
    else:
        (directory / "raw").write_bytes(values.tobytes())
        pieces = [(os.fsencode(directory / "raw"), 0, values.nbytes)]
        file.create_dataset(name, values.shape, values.dtype, external=pieces)


def addition(file: h5py.File, rng: Random, _: Path) -> None:
    """Something beside what rodsweep wrote, under a name of the user's or another."""
    name = rng.choice(["user_mine", "mine", "gamma1", "curve_F", "point", "\x1b[31m", "F "])
    ways: dict[str, Callable[[], object]] = {
        "numbers": lambda: file.update({name: np.arange(3.0)}),
        "group": lambda: file.create_group(name),
        "type": lambda: file.update({name: np.dtype("f8")}),
        "text": lambda: file.update({name: "text"}),
        "attribute": lambda: file.attrs.update({name: "text"}),
    }
    if name not in file:
        ways[rng.choice(list(ways))]()


def is_whole_list(data: h5py.Dataset) -> bool:
    """Whether a variable has a list of dimensions as HDF5 writes it."""
    if "DIMENSION_LIST" not in data.attrs:
        return False
    return h5py.check_vlen_dtype(data.attrs.get_id("DIMENSION_LIST").dtype) is not None


def dimensions(file: h5py.File, rng: Random, _: Path) -> None:
    """A dimension of a variable taken off, or another in its place."""
    scales = _scales(file)
    # HDF5 crashes where its lists of dimensions are not as it wrote them.
    names = [name for name in _names(file) if is_whole_list(file[name])]
    axis = rng.choice(list(file[rng.choice(names)].dims))
    axis.detach_scale(next(iter(axis.values())))
    if rng.random() < 0.6:
        axis.attach_scale(file[rng.choice(scales)])


def nothing(file: h5py.File, rng: Random, _: Path) -> None:
    """Opened for writing, and closed."""


BY_HDF5: tuple[Edit, ...] = (
    value, value, last_digit, swapped, anew, anew, attribute, attribute, config, link, link, elsewhere,
    addition, dimensions, nothing,
)  # fmt: skip
SHARE_OF_BYTES = 0.25
"""Of the edits, those that are no program's but a disk's or a transfer's."""


def edited(path: Path, rng: Random) -> str:
    """Edits a file by chance, once or twice, by HDF5 or byte by byte; returns what was done."""
    if rng.random() < SHARE_OF_BYTES:
        damage = rng.choice(BYTES)
        path.write_bytes(damage(path.read_bytes(), rng))
        return damage.__name__
    edits = rng.sample(BY_HDF5, rng.choice([1, 1, 2]))
    with h5py.File(path, "r+") as file:
        edits[0](file, rng, path.parent)
        for edit in edits[1:]:
            with suppress(LookupError, StopIteration, RuntimeError):  # the first has left nothing to this one
                edit(file, rng, path.parent)
    return " and ".join(edit.__name__ for edit in edits)


def copied(source: Path, to: Path) -> Path:
    """A copy of a file in an empty directory."""
    shutil.rmtree(to, ignore_errors=True)
    to.mkdir()
    return Path(shutil.copy(source, to / "a.h5"))
