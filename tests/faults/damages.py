"""Files made bad: bytes as a disk, a transfer or a kill may change them, and odd things in directories."""

import os
import shutil
from collections.abc import Callable
from pathlib import Path
from random import Random

import h5py
import numpy as np

from rodsweep.model.parameters import PARAMETERS


def cut(data: bytes, rng: Random) -> bytes:
    """The beginning of a file."""
    return data[: rng.randrange(len(data))]


def flip(data: bytes, rng: Random) -> bytes:
    """A file with bits flipped, a few or many."""
    changed = bytearray(data)
    for _ in range(rng.choice([1, 1, 1, 3, 10, 100])):
        changed[rng.randrange(len(changed))] ^= 1 << rng.randrange(8)
    return bytes(changed)


def overwrite(data: bytes, rng: Random) -> bytes:
    """A file with a piece that is all zeros, all ones, or random."""
    start, size = rng.randrange(len(data)), rng.choice([1, 8, 64, 512, 4096])
    size = min(size, len(data) - start)
    piece = rng.choice([bytes(size), b"\xff" * size, rng.randbytes(size)])
    return data[:start] + piece + data[start + size :]


def flip_head(data: bytes, rng: Random) -> bytes:
    """A file with a bit flipped near its beginning, where a format says how to read the rest."""
    changed = bytearray(data)
    changed[rng.randrange(min(len(data), 3000))] ^= 1 << rng.randrange(8)
    return bytes(changed)


def zero_tail(data: bytes, rng: Random) -> bytes:
    """A file whose end was never written, as after a power cut: zeros."""
    start = rng.randrange(len(data))
    return data[:start] + bytes(len(data) - start)


def leave_out(data: bytes, rng: Random) -> bytes:
    """A file without a piece in its middle."""
    start = rng.randrange(len(data))
    return data[:start] + data[start + rng.choice([1, 8, 512]) :]


def append(data: bytes, rng: Random) -> bytes:
    """A file with something behind its end."""
    return data + rng.randbytes(rng.choice([1, 1000]))


def repeat(data: bytes, rng: Random) -> bytes:
    """A file with a piece copied over another."""
    start, other = rng.randrange(len(data)), rng.randrange(len(data))
    piece = data[other : other + rng.choice([8, 64, 512])][: len(data) - start]
    return data[:start] + piece + data[start + len(piece) :]


BYTES: tuple[Callable[[bytes, Random], bytes], ...] = (
    cut, flip, flip_head, overwrite, zero_tail, leave_out, append, repeat,
)  # fmt: skip


def foreign(directory: Path, rng: Random) -> list[Path]:
    """What is no result at all, made in a directory."""
    contents = {
        "empty.h5": b"", "text.h5": b"F, growth\n1, 2\n", "signature.h5": b"\x89HDF\r\n\x1a\n",
        "random.h5": rng.randbytes(9000), "zeros.h5": bytes(9000),
        "begins like HDF5.h5": b"\x89HDF\r\n\x1a\n" + rng.randbytes(9000),
        "png.h5": b"\x89PNG\r\n\x1a\n" + bytes(99), "line.h5": b"x" * 10**6,
    }  # fmt: skip
    paths = []
    for name, content in contents.items():
        paths.append(directory / name)
        paths[-1].write_bytes(content)
    paths.append(directory / "another's.h5")
    with h5py.File(paths[-1], "w") as file:
        file["status"] = np.zeros(3)
        file.attrs["title"] = "not ours"
    paths.append(directory / "another's with our name.h5")
    with h5py.File(paths[-1], "w") as file:
        file.attrs.update(program="rodsweep", config_resolved="{}", fingerprint="")
    return paths


def obstacles(directory: Path) -> list[Path]:
    """What cannot be a result file, made in a directory."""
    os.mkfifo(directory / "pipe")
    (directory / "folder").mkdir()
    (directory / "null").symlink_to("/dev/null")
    (directory / "zero").symlink_to("/dev/zero")
    return [directory / name for name in ("pipe", "folder", "null", "zero")]


def _page(journal: Path) -> Path:
    return next(journal.glob("rank-*"))


def _chain(journal: Path) -> Path:
    return next(journal.glob("chain-*"), journal / "chain-000000000")


def _instead(path: Path, make: Callable[[Path], object]) -> None:
    """Something else in the place of a file or an empty directory."""
    if path.is_dir():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)
    make(path)


def _reheaded(journal: Path) -> None:
    """A second journal, of another config."""
    head, fingerprint, rest = _page(journal).read_bytes().split(b"\n", 2)
    (journal / "rank-other").write_bytes(b"\n".join([head, fingerprint[::-1], rest]))


JOURNALS: dict[str, Callable[[Path], object]] = {
    "gone": shutil.rmtree,
    "a file": lambda journal: _instead(journal, lambda path: path.write_text("x")),
    "a link to nowhere": lambda journal: _instead(journal, lambda path: path.symlink_to("nowhere")),
    "a link to another directory": lambda journal: journal.symlink_to(
        journal.rename(journal.with_name("moved")).name
    ),
    "page twice": lambda journal: shutil.copy(_page(journal), journal / "rank-again"),
    "page of another config": _reheaded,
    "page empty": lambda journal: _page(journal).write_bytes(b""),
    "page unreadable": lambda journal: _page(journal).chmod(0),
    "another page empty": lambda journal: (journal / "rank-x").write_bytes(b""),
    "another page random": lambda journal: (journal / "rank-x").write_bytes(Random(1).randbytes(9000)),
    "another page a directory": lambda journal: (journal / "rank-x").mkdir(),
    "another page a pipe": lambda journal: os.mkfifo(journal / "rank-x"),
    "another page endless": lambda journal: (journal / "rank-x").symlink_to("/dev/zero"),
    "another page a link to itself": lambda journal: (journal / "rank-x").symlink_to("rank-x"),
    "lock gone": lambda journal: (journal / "lock").unlink(),
    "lock a directory": lambda journal: _instead(journal / "lock", Path.mkdir),
    "lock a pipe": lambda journal: _instead(journal / "lock", os.mkfifo),
    "lock a link to nowhere": lambda journal: _instead(
        journal / "lock", lambda path: path.symlink_to("no/where")
    ),
    "copy left": lambda journal: (journal / "next.h5").write_bytes(b"half a copy"),
    "copy a directory": lambda journal: (journal / "next.h5").mkdir(),
    "copy a pipe": lambda journal: os.mkfifo(journal / "next.h5"),
    "copy a link": lambda journal: (journal / "next.h5").symlink_to("../points.csv"),
    "notes": lambda journal: (journal / "notes.txt").write_text("mine"),
    "chain gone": lambda journal: _chain(journal).unlink(missing_ok=True),
    "chain empty": lambda journal: _chain(journal).write_bytes(b""),
    "chain random": lambda journal: _chain(journal).write_bytes(Random(1).randbytes(300)),
    "chain a directory": lambda journal: _instead(_chain(journal), Path.mkdir),
    "chain a pipe": lambda journal: _instead(_chain(journal), os.mkfifo),
    "chain endless": lambda journal: _instead(_chain(journal), lambda path: path.symlink_to("/dev/zero")),
}
"""What may be odd in the directory of the journals."""
OF_CHAINS = [name for name in JOURNALS if name.startswith("chain")]


def _replaced(name: str, value: Callable[[np.ndarray], object]) -> Callable[[h5py.File], None]:
    """Another value for a variable of the file."""

    def edit(file: h5py.File) -> None:
        old = file[name][...]
        del file[name]
        file[name] = value(old)

    return edit


def _attribute(name: str, value: object) -> Callable[[h5py.File], None]:
    return lambda file: file.attrs.update({name: value})


def _numbers(value: Callable[[np.ndarray], object]) -> Callable[[h5py.File], None]:
    """Other values for every number that a point has."""

    def edit(file: h5py.File) -> None:
        for name, data in file.items():
            if (
                name not in PARAMETERS
                and data.dtype.kind == "f"
                and not h5py.h5ds.is_scale(data.id)
                and data.size
            ):
                data[...] = value(data[...])

    return edit


def _move_axis(file: h5py.File, by: float) -> None:
    """Another first value on the first axis, or in the first column of a list."""
    data = file[_first_axis(file)]
    data[...] = np.concatenate([data[...][:1] * by + by, data[...][1:]])


def _random_bits(old: np.ndarray) -> np.ndarray:
    return np.frombuffer(Random(old.size).randbytes(old.nbytes), old.dtype).reshape(old.shape)


def _first_axis(file: h5py.File) -> str:
    return next(name for name in ("F", "k1") if name in file)


MISFITS: dict[str, Callable[[h5py.File], object]] = {
    "status gone": lambda file: file.pop("status"),
    "seconds gone": lambda file: file.pop("seconds"),
    "status of another type": _replaced("status", lambda old: old.astype("f8")),
    "status of another shape": _replaced("status", lambda old: old.ravel()[:-1]),
    "status a number": _replaced("status", lambda old: 0),
    "status text": _replaced("status", lambda old: "ok"),
    "seconds of another shape": _replaced("seconds", lambda old: np.zeros((2, *old.shape))),
    "status a group": lambda file: (file.pop("status"), file.create_group("status")),
    "status a link to nowhere": lambda file: (file.pop("status"), file.update(status=h5py.SoftLink("/no"))),
    "status a link to itself": lambda file: (
        file.pop("status"),
        file.update(status=h5py.SoftLink("/status")),
    ),
    "axis gone": lambda file: file.pop(_first_axis(file)) if "point" not in file else file.pop("point"),
    "no config": lambda file: file.attrs.pop("config_resolved"),
    "no fingerprint": lambda file: file.attrs.pop("fingerprint"),
    "config no JSON": _attribute("config_resolved", "task: spectrum"),
    "config a list": _attribute("config_resolved", "[]"),
    "config empty": _attribute("config_resolved", "{}"),
    "config deep": _attribute("config_resolved", "[" * 5000),
    "config of no task": _attribute("config_resolved", '{"task": "dance", "dance": {}}'),
    "config without options": _attribute("config_resolved", '{"task": "modes", "modes": {}}'),
    "config a number": _attribute("config_resolved", 3),
    "config an array": _attribute("config_resolved", np.zeros(3)),
    "another title": _attribute("title", "mine"),
    "a title that is an array": _attribute("title", np.zeros(3)),
    "no title": lambda file: file.attrs.pop("title"),
    "no sentences": lambda file: file.attrs.pop("status_sentences"),
    "an axis moved": lambda file: _move_axis(file, 1.5),
    "an axis not a number": lambda file: _move_axis(file, np.nan),
    "a number changed": _numbers(lambda old: old + 1),
    "a unit changed": lambda file: file["seconds"].attrs.update(units="ms"),
    "a factor added": lambda file: file["seconds"].attrs.update(scale_factor=2.0),
    "another attribute": _attribute("note", "mine"),
    "another variable": lambda file: file.update(mine=np.zeros(3)),
    "a group": lambda file: file.create_group("mine"),
    "a type": lambda file: file.update(mine=np.dtype("f8")),
    "a link to nowhere": lambda file: file.update(user_mine=h5py.SoftLink("/no")),
    "a link to another file": lambda file: file.update(user_mine=h5py.ExternalLink("no.h5", "/no")),
    "another name": lambda file: file.update(user_mine=file["seconds"]),
    "no seal": lambda file: file.attrs.pop("seal"),
}
"""What another program may have made of a result file that then is none any more."""
ODD_NUMBERS: dict[str, Callable[[h5py.File], object]] = {
    "status unknown": lambda file: file["status"].write_direct(np.full(file["status"].shape, 77, "i1")),
    "numbers not known": _numbers(lambda old: np.nan),
    "numbers infinite": _numbers(lambda old: np.inf),
    "numbers zero": _numbers(lambda old: 0.0),
    "numbers negative": _numbers(lambda old: -old),
    "numbers huge": _numbers(lambda old: 1e300 if old.itemsize == 8 else 1e38),
    "numbers random": _numbers(_random_bits),
}
"""What a solver may have made of a result, however odd, and what is sealed as such."""
ADDITIONS: dict[str, Callable[[h5py.File], object]] = {
    "an attribute": _attribute("user_note", "mine"),
    "an attribute of a variable": lambda file: file["seconds"].attrs.update(user_note="mine"),
    "a group": lambda file: file.create_group("user_mine"),
    "numbers": lambda file: file.update(user_mine=np.zeros(3)),
    "text": lambda file: file.update(user_mine="mine"),
    "no numbers": lambda file: file.update(user_mine=h5py.Empty("f8")),
    "chunks": lambda file: file.create_dataset("user_mine", data=np.arange(9.0), chunks=(3,)),
}
"""What a user may put into a result file, under names that begin with user_."""
