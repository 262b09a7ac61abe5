"""What a result file contains, for comparing two."""

from pathlib import Path

import h5py
import numpy as np


def content(path: Path) -> dict[str, np.ndarray]:
    """All variables of a file but the time they took."""
    with h5py.File(path) as file:
        return {name: file[name][...] for name in file if name != "seconds"}


def same(a: dict[str, np.ndarray], b: dict[str, np.ndarray]) -> bool:
    """Whether two files contain the same, to the last bit."""
    return set(a) == set(b) and all(np.array_equal(a[n], b[n], equal_nan=a[n].dtype.kind == "f") for n in a)
